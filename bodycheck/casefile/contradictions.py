"""Check rules that connect several keys of a case file, which the grammar of single keys cannot express."""

import math
from collections.abc import Iterator, Mapping
from typing import Any, get_args

from bodycheck.casefile.axes import AXES
from bodycheck.casefile.body_faults import body_faults
from bodycheck.casefile.content import MAX_STEPS
from bodycheck.casefile.ensemble_faults import ensemble_faults
from bodycheck.casefile.expectation import ORDER, REFINEMENTS
from bodycheck.casefile.grammar import Status, with_shape
from bodycheck.casefile.raw_values import mapping, number, numbers
from bodycheck.casefile.surroundings import BODY, surroundings_faults
from bodycheck.casefile.toml_positions import Path
from bodycheck.casefile.values import MAX_INSTANTS, MAX_POINTS, MAX_SAMPLES
from bodycheck.figures.columns import LIMITED


def contradictions(document: dict[str, Any]) -> Iterator[tuple[Path, str]]:
    """Yield the faults between keys, as pairs of path and message. The raw document may have any other faults too."""
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
    """Yield the faults between the keys of what is done with a scene of any format, as pairs of path and message."""
    duration = number(mapping(document.get("run")).get("duration"))
    expect = document.get("expect")
    expectations = expect if isinstance(expect, list) else []
    steps, samples = len(_timesteps(expectations)), number(mapping(document.get("run")).get("samples"))
    instants = steps * min(samples, MAX_SAMPLES)  # more samples are a fault of their own
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
    """Return the different time steps (s) of the runs that expectations need, with those from which an order is measured."""
    found = set()
    for expectation in map(mapping, expectations):
        finer = REFINEMENTS if ORDER in expectation else ()
        found |= {number(expectation.get("timestep")) / by for by in (1, *finer)}
    return found


def _expect_contradictions(expectation: dict[str, Any], duration: float) -> Iterator[tuple[Path, str]]:
    limits = [name for name in LIMITED if name in expectation]
    status = expectation.get("status", "ok")
    if not limits and "status" not in expectation:
        yield (), f"contains no expectation; give at least one of status, {', '.join(LIMITED)}"
    if limits and status in get_args(Status) and status != "ok":
        yield (limits[0],), f"a run with the status {status} has no errors to limit; give status alone"
    for name in limits:
        allowed = expectation[name]
        if isinstance(allowed, dict):
            if not allowed:
                yield (name,), "contains no limit; allowed: at_least, at_most"
            if "at_most" in allowed and number(allowed.get("at_least")) > number(allowed["at_most"]):
                yield (name,), "at_least is larger than at_most"
    for one, other in (("known", "until"), ("until", "known")):
        if one in expectation and other not in expectation:
            yield (other,), f"is missing; {one} requires it"
    timestep = number(expectation.get("timestep"))
    if duration > 0 and timestep > 0 and duration / timestep > MAX_STEPS:
        yield ("timestep",), f"results in {duration / timestep:.3g} steps; at most {MAX_STEPS:.0e} are allowed"


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
