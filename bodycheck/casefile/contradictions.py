"""Check rules that connect several keys of a case file, which the grammar of single keys cannot express."""

import math
from collections.abc import Iterator, Sequence
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from bodycheck.casefile.axes import AXES
from bodycheck.casefile.ensemble_faults import ensemble_faults
from bodycheck.casefile.expectation import ORDER, REFINEMENTS
from bodycheck.casefile.grammar import Status, shape_of, with_shape
from bodycheck.casefile.raw_values import mapping, number, numbers
from bodycheck.casefile.toml_positions import Path
from bodycheck.casefile.values import MAX_INSTANTS, MAX_POINTS, MAX_SAMPLES, MAX_STEPS
from bodycheck.figures.columns import LIMITED
from bodycheck.reference.definition import Tensor
from bodycheck.reference.exact.start import defined_inertia
from bodycheck.reference.inertia import satisfies_triangle_inequality

#: The keys for the size of a part, by its shape.
PART_SIZES = {
    "brick": ("semi_axes",),
    "ellipsoid": ("semi_axes",),
    "cylinder": ("radius", "half_length"),
    "sphere": ("radius",),
}


def contradictions(document: dict[str, Any]) -> Iterator[tuple[Path, str]]:
    """Yield the faults between keys, as pairs of path and message. The raw document may have any other faults too."""
    yield from _body_contradictions(mapping(document.get("body")))
    initial = mapping(document.get("initial"))
    for one, other in (("euler_zxz", "quaternion"), ("euler_rates", "angular_velocity")):
        if one in initial and other in initial:
            yield ("initial", other), f"{one} is given too; give only one"
    quaternion = numbers(initial.get("quaternion"), 4)
    if quaternion and not 0.999 < math.hypot(*quaternion) < 1.001:
        yield ("initial", "quaternion"), f"its length is {math.hypot(*quaternion):.6g}; must be 1 within 0.1 %"
    plane = mapping(mapping(document.get("scene")).get("plane"))
    if plane.get("law") == "decoupled" and plane.get("pressure") == "balanced":
        yield ("scene", "plane", "pressure"), "the decoupled law does not depend on where the load is; allowed: uniform"
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


def _body_contradictions(body: dict[str, Any]) -> Iterator[tuple[Path, str]]:
    if (fault := _inertia_fault(body.get("inertia"), number(body.get("mass")))) is not None:
        yield ("body", "inertia"), fault
    if shape_of(with_shape(body)) == "none":
        made = [key for key in ("inertia", "particles", "parts") if key in body]
        if len(made) != 1:
            yield ("body",), f"a body without a shape needs {'only ' if made else ''}one of inertia, particles, parts"
        if "inertia" in body and "mass" not in body:
            yield ("body", "mass"), "is missing"
        if made and "inertia" not in body and "mass" in body:
            yield ("body", "mass"), f"{made[0]} are given too; give only one"
    parts = body.get("parts")
    for index, part in enumerate(parts if isinstance(parts, list) else []):
        needs = PART_SIZES.get(shape_of(part), ())
        for key in ("semi_axes", "radius", "half_length"):
            if needs and (key in needs) != (key in part):
                what = "is missing" if key in needs else f"does not apply to a {part['shape']}; allowed: {', '.join(needs)}"
                yield ("body", "parts", index, key), what
        if "euler_zxz" in mapping(part) and "quaternion" in part:
            yield ("body", "parts", index, "quaternion"), "euler_zxz is given too; give only one"
        quaternion = numbers(mapping(part).get("quaternion"), 4)
        if quaternion and not any(quaternion):
            yield ("body", "parts", index, "quaternion"), "its length is 0; any other length is allowed"


#: What is told of a tensor that no body has, while one has that with the other signs.
OTHER_SIGNS = (
    "; with the opposite signs of Ixy, Ixz and Iyz it would be possible: the products of inertia stand in the tensor as "
    "Ixy = -(sum of m x y)"
)


def _inertia_fault(inertia: Any, mass: float) -> str | None:
    """Return why no body has the inertia in a document; None if one may have it, and for what the grammar reports.

    mass: of the body (kg).
    """
    if (moments := numbers(inertia, 3)) is not None:
        return _impossible(moments) if min(moments) > 0 else None
    rows = [numbers(row, 3) for row in inertia] if isinstance(inertia, list) else []
    if len(rows) != 3 or not all(rows):
        return None
    tensor = np.array(rows)
    if not np.allclose(tensor, tensor.T, rtol=1e-12, atol=0):
        return "the tensor must be symmetric"
    fault = _impossible(_principal_moments(tensor, mass))
    if fault is not None and _impossible(_principal_moments(2 * np.diag(np.diag(tensor)) - tensor, mass)) is None:
        return fault + OTHER_SIGNS
    return fault


def _impossible(moments: Sequence[float]) -> str | None:
    """Return why no body has three principal moments (kg m^2); None if one has them."""
    if min(moments) <= 0:
        return f"its smallest principal moment is {min(moments):.6g}; all must be positive"
    if not satisfies_triangle_inequality((moments[0], moments[1], moments[2])):
        return "no body has these moments: no moment may exceed the sum of the other two"
    return None


def _principal_moments(tensor: NDArray[np.float64], mass: float) -> list[float]:
    """Return the principal moments of a tensor (3, 3) by the function that makes the body of the case, which keeps them."""
    a, b, c = ((float(row[0]), float(row[1]), float(row[2])) for row in tensor)
    return [float(moment) for moment in defined_inertia(Tensor(mass, (a, b, c))).moments]
