"""Check rules that connect several keys of a case file, which the grammar of single keys cannot express."""

import math
import sys
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any, get_args

import numpy as np

from bodycheck.adapters.engine_name import EngineName
from bodycheck.adapters.method import Method
from bodycheck.casefile.axes import AXES
from bodycheck.casefile.content import MAX_STEPS
from bodycheck.casefile.ensemble import ensemble_faults
from bodycheck.casefile.expectation import ORDER, REFINEMENTS, unit
from bodycheck.casefile.grammar import Status, shape_of, with_shape
from bodycheck.casefile.raw_values import mapping, number, numbers
from bodycheck.casefile.surroundings import BODY, surroundings_faults
from bodycheck.casefile.toml_positions import Path
from bodycheck.casefile.values import MAX_EXPECTATIONS, MAX_INSTANTS, MAX_POINTS, MAX_SAMPLES
from bodycheck.errors import BadInput
from bodycheck.figures.columns import LIMITED, most_possible
from bodycheck.reference.possible_inertia import impossible_moments, impossible_tensor
from bodycheck.suggestion import did_you_mean


def contradictions(document: dict[str, Any]) -> Iterator[tuple[Path, str]]:
    """Yield the faults between keys of a raw document, which may also have other faults, as pairs of path and message."""
    for path, message in body_faults(with_shape(mapping(document.get("body")))):
        yield ("body", *path), message
    for path, message in start_faults(mapping(document.get("initial"))):
        yield ("initial", *path), message
    yield from surroundings_faults(document, [BODY])
    yield from run_faults(document)


def start_faults(initial: Mapping[str, Any]) -> Iterator[tuple[Path, str]]:
    """Yield the faults between keys of a raw table with a pose and velocities, as pairs of path in the table and message."""
    for one, other in (("euler_zxz", "quaternion"), ("euler_rates", "angular_velocity")):
        if one in initial and other in initial:
            yield (other,), f"{one} is given too; give only one"
    quaternion = numbers(initial.get("quaternion"), 4)
    if quaternion and not 0.999 < math.hypot(*quaternion) < 1.001:
        yield ("quaternion",), f"its length is {math.hypot(*quaternion):.6g}; must be 1 within 0.1 %"


def run_faults(document: dict[str, Any]) -> Iterator[tuple[Path, str]]:
    """Yield the faults between keys of run, expectations, extremes and ensemble, as pairs of path and message."""
    duration = number(mapping(document.get("run")).get("duration"))
    expect = document.get("expect")
    expectations = expect if isinstance(expect, list) else []
    steps, samples = len(_timesteps(expectations)), number(mapping(document.get("run")).get("samples"))
    instants = steps * min(samples, MAX_SAMPLES)  # more samples are a fault that is reported elsewhere
    if instants > MAX_INSTANTS:
        yield (
            ("expect",),
            f"needs a reference at {instants:.3g} instants, for {steps} time steps with {samples:.0f} samples each; at most "
            f"{MAX_INSTANTS:.3g} are allowed",
        )
    for index, expectation in enumerate(expectations):
        for path, message in _expect_contradictions(mapping(expectation), duration):
            yield ("expect", index, *path), message
    yield from _extremes_contradictions(mapping(document.get("extremes")), duration)
    yield from ensemble_faults(document)


def _timesteps(expectations: list[Any]) -> set[float]:
    """Return the different time steps (s) of the runs that expectations need, including the runs that measure an order."""
    timesteps = set()
    for expectation in map(mapping, expectations):
        finer = REFINEMENTS if ORDER in expectation else ()
        timesteps |= {number(expectation.get("timestep")) / by for by in (1, *finer)}
    return timesteps


def _expect_contradictions(expectation: dict[str, Any], duration: float) -> Iterator[tuple[Path, str]]:
    limits = [name for name in (*LIMITED, "sensors") if name in expectation]
    status = expectation.get("status", "ok")
    if not limits and "status" not in expectation:
        yield (), f"contains no expectation; give at least one of status, {', '.join(LIMITED)}, sensors"
    if limits and status in get_args(Status) and status != "ok":
        yield (limits[0],), f"a run with the status {status} has no errors to limit; give status alone"
    for name in limits:
        allowed = expectation[name]
        if isinstance(allowed, dict) and name != "sensors":
            if not allowed:
                yield (name,), "contains no limit; allowed: at_least, at_most"
            if "at_most" in allowed and number(allowed.get("at_least")) > number(allowed["at_most"]):
                yield (name,), "at_least is larger than at_most"
    if ORDER in limits and _controls_errors(expectation.get("integrator")):
        yield (
            (ORDER,),
            "a method with an accuracy chooses its steps, and has no order in them; give one without accuracy",
        )
    for one, other in (("known", "until"), ("until", "known")):
        if one in expectation and other not in expectation:
            yield (other,), f"is missing; {one} requires it"
    timestep = number(expectation.get("timestep")) / (REFINEMENTS[-1] if ORDER in expectation else 1)
    if duration > 0 and timestep > 0 and duration / timestep > MAX_STEPS:
        yield ("timestep",), f"results in {duration / timestep:.3g} steps; at most {MAX_STEPS:.0e} are allowed"


def _controls_errors(integrator: Any) -> bool:
    """Return whether a value is the spelling of a method with an accuracy; the grammar reports invalid spellings."""
    try:
        return isinstance(integrator, str) and Method.parse(integrator, 0.0).accuracy is not None
    except BadInput:
        return False


def _extremes_contradictions(extremes: dict[str, Any], duration: float) -> Iterator[tuple[Path, str]]:
    lengths = {name: len(values) for name, values in extremes.items() if isinstance(values, list)}
    if "spin" in lengths and "timestep" in lengths:
        lengths["spin"] *= lengths.pop("timestep")
    points = sum(lengths.values())
    if points > MAX_POINTS:
        yield ("extremes",), f"results in {points} points; at most {MAX_POINTS} are allowed"
    for name, axis in AXES.items():
        values = extremes.get(name)
        for index, value in enumerate(values if isinstance(values, list) else []):
            size = number(value)
            if size > 0 and duration > 0 and (rule := axis.refused(size, duration)) is not None:
                yield ("extremes", name, index), rule


#: The keys for the size of a part, by its shape.
PART_SIZES = {
    "brick": ("semi_axes",),
    "ellipsoid": ("semi_axes",),
    "cylinder": ("radius", "half_length"),
    "sphere": ("radius",),
}


def body_faults(body: Mapping[str, Any], zero_allowed: bool = False) -> Iterator[tuple[Path, str]]:
    """Yield the faults between keys of a raw table of a body, as pairs of path in the table and message.

    zero_allowed: whether moments of inertia may be 0. The table may also have other faults.
    """
    if (fault := _inertia_fault(body.get("inertia"), number(body.get("mass")), zero_allowed)) is not None:
        yield ("inertia",), fault
    if shape_of(body) == "none":
        keys = [key for key in ("inertia", "particles", "parts") if key in body]
        if len(keys) != 1:
            yield (), f"a body without a shape needs {'only ' if keys else ''}one of inertia, particles, parts"
        if "inertia" in body and "mass" not in body:
            yield ("mass",), "is missing"
        if keys and "inertia" not in body and "mass" in body:
            yield ("mass",), f"{keys[0]} are given too; give only one"
    parts = body.get("parts")
    for index, part in enumerate(parts if isinstance(parts, list) else []):
        needs = PART_SIZES.get(shape_of(part), ())
        for key in ("semi_axes", "radius", "half_length"):
            if needs and (key in needs) != (key in part):
                what = "is missing" if key in needs else f"does not apply to a {part['shape']}; allowed: {', '.join(needs)}"
                yield ("parts", index, key), what
        if "euler_zxz" in mapping(part) and "quaternion" in part:
            yield ("parts", index, "quaternion"), "euler_zxz is given too; give only one"
        quaternion = numbers(mapping(part).get("quaternion"), 4)
        if quaternion and not any(quaternion):
            yield ("parts", index, "quaternion"), "its length is 0; any other length is allowed"


def _inertia_fault(inertia: Any, mass: float, zero_allowed: bool) -> str | None:
    """Return why no body has the inertia in a document; None if a body may have it or the grammar reports the fault.

    mass: the mass of the body (kg).
    """
    if zero_allowed and mass == 0:
        return _of_a_frame(inertia)
    if (moments := numbers(inertia, 3)) is not None:
        stated = min(moments) > 0 or (zero_allowed and min(moments) == 0)
        return impossible_moments(moments, zero_allowed) if stated else None
    rows = [numbers(row, 3) for row in inertia] if isinstance(inertia, list) else []
    if len(rows) != 3 or not all(rows):
        return None
    tensor = np.array(rows)
    if not np.allclose(tensor, tensor.T, rtol=1e-12, atol=0):
        return "the tensor must be symmetric"
    return impossible_tensor(tensor, mass, zero_allowed)


def _of_a_frame(inertia: Any) -> str | None:
    """Return why the inertia of a body without mass is not zero; None if it is, or the grammar reports the fault."""
    rows = inertia if isinstance(inertia, list) else []
    parts = [part for row in rows for part in (row if isinstance(row, list) else [row])]
    return (
        "a body without mass is a frame; allowed: zeros"
        if any(isinstance(part, int | float) and part for part in parts)
        else None
    )


def uncheckable(document: Mapping[str, Any]) -> Iterator[tuple[Path, str]]:
    """Yield the faults of expectations that cannot be checked, as pairs of path and message.

    Their engine does not exist, their time step is longer than the run, or a limit cannot fail, so that the test would always
    pass without any meaning.

    Texts stored in results are not checked for this, because they may come from earlier versions of bodycheck and from machines
    with other engines. The raw document may also have other faults.
    """
    duration = number(mapping(document.get("run")).get("duration"))
    expect = document.get("expect")
    for index, table in enumerate(expect[:MAX_EXPECTATIONS] if isinstance(expect, list) else []):
        expectation = mapping(table)
        if (fault := _unknown_engine(expectation.get("engine"))) is not None:
            yield ("expect", index, "engine"), fault
        if number(expectation.get("timestep")) > duration > 0:
            yield ("expect", index, "timestep"), f"is longer than the run; allowed: at most its duration, {duration:g} s"
        last = duration + number(expectation.get("timestep")) / 2  # the instants of a run are the nearest ends of steps
        for name in [name for name in expectation if name in LIMITED]:
            for path, message in _idle(name, expectation[name], last):
                yield ("expect", index, name, *path), message


def _unknown_engine(engine: Any) -> str | None:
    """Return the fault of an engine without an adapter; None if it has an adapter or the grammar reports the fault."""
    try:
        adapter = EngineName.parse(engine).adapter if isinstance(engine, str) else None
    except BadInput:
        return None
    known = _known_engines(tuple(sys.path))
    if adapter is None or adapter in known:
        return None
    return f"there is no such engine; allowed: {', '.join(known)}{did_you_mean(engine, known)}"


@cache
def _known_engines(path: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names of all engines with an adapter on a module search path; each process searches once."""
    from bodycheck.adapters import registry  # stored cases are read without it: their engines need not be known

    return registry.names()


def _idle(name: str, allowed: Any, last: float) -> Iterator[tuple[Path, str]]:
    """Yield path and message for the ends of a range that no run can break. last: the last instant of the run (s)."""
    ends = allowed if isinstance(allowed, dict) else {"at_most": allowed}
    path = ("at_most",) if isinstance(allowed, dict) else ()
    most = most_possible(name, last)
    if last > 0 and number(ends.get("at_most")) >= most:
        least = f"{most:.6g}{unit(name)}"
        yield path, f"this limit cannot fail, because no run has more than {least}; allowed: less than {least}"
    if list(ends) == ["at_least"] and ends["at_least"] == 0 and name != ORDER:
        yield ("at_least",), "this limit cannot fail, because no run has less than 0; allowed: more than 0, or at_most too"
