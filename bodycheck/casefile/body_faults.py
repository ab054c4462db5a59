"""Check the rules that connect several keys of a body: what it is made of, and that a body may have its inertia."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.casefile.grammar import shape_of
from bodycheck.casefile.raw_values import mapping, number, numbers
from bodycheck.casefile.toml_positions import Path
from bodycheck.reference.exact.start import defined_inertia
from bodycheck.reference.inertia import satisfies_triangle_inequality
from bodycheck.reference.scene import Tensor

#: The keys for the size of a part, by its shape.
PART_SIZES = {
    "brick": ("semi_axes",),
    "ellipsoid": ("semi_axes",),
    "cylinder": ("radius", "half_length"),
    "sphere": ("radius",),
}

#: How far below zero a moment may be that rounding has made of zero, relative to the largest moment.
ROUNDING = 1e-12


def body_faults(body: Mapping[str, Any], zero_allowed: bool = False) -> Iterator[tuple[Path, str]]:
    """Yield the faults between keys of a raw table of a body, as pairs of path in the table and message.

    zero_allowed: whether moments of inertia may be 0. The table may have any other faults too.
    """
    if (fault := _inertia_fault(body.get("inertia"), number(body.get("mass")), zero_allowed)) is not None:
        yield ("inertia",), fault
    if shape_of(body) == "none":
        made = [key for key in ("inertia", "particles", "parts") if key in body]
        if len(made) != 1:
            yield (), f"a body without a shape needs {'only ' if made else ''}one of inertia, particles, parts"
        if "inertia" in body and "mass" not in body:
            yield ("mass",), "is missing"
        if made and "inertia" not in body and "mass" in body:
            yield ("mass",), f"{made[0]} are given too; give only one"
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


#: What is told of a tensor that no body has, while one has that with the other signs.
OTHER_SIGNS = (
    "; with the opposite signs of Ixy, Ixz and Iyz it would be possible: the products of inertia stand in the tensor as "
    "Ixy = -(sum of m x y)"
)


def _inertia_fault(inertia: Any, mass: float, zero_allowed: bool) -> str | None:
    """Return why no body has the inertia in a document; None if one may have it, and for what the grammar reports.

    mass: of the body (kg).
    """
    if (moments := numbers(inertia, 3)) is not None:
        return _impossible(moments, zero_allowed) if min(moments) > 0 or (zero_allowed and min(moments) == 0) else None
    rows = [numbers(row, 3) for row in inertia] if isinstance(inertia, list) else []
    if len(rows) != 3 or not all(rows):
        return None
    tensor = np.array(rows)
    if not np.allclose(tensor, tensor.T, rtol=1e-12, atol=0):
        return "the tensor must be symmetric"
    fault = _impossible(_principal_moments(tensor, mass), zero_allowed)
    other_signs = 2 * np.diag(np.diag(tensor)) - tensor
    if fault is not None and _impossible(_principal_moments(other_signs, mass), zero_allowed) is None:
        return fault + OTHER_SIGNS
    return fault


def _impossible(moments: Sequence[float], zero_allowed: bool) -> str | None:
    """Return why no body has three principal moments (kg m^2); None if one has them."""
    if zero_allowed:
        if min(moments) < -ROUNDING * max(moments):
            return f"its smallest principal moment is {min(moments):.6g}; none may be negative"
    elif min(moments) <= 0:
        return f"its smallest principal moment is {min(moments):.6g}; all must be positive"
    if not satisfies_triangle_inequality((moments[0], moments[1], moments[2])):
        return "no body has these moments: no moment may exceed the sum of the other two"
    return None


def _principal_moments(tensor: NDArray[np.float64], mass: float) -> list[float]:
    """Return the principal moments of a tensor (3, 3) by the function that makes the body of the case, which keeps them."""
    a, b, c = ((float(row[0]), float(row[1]), float(row[2])) for row in tensor)
    return [float(moment) for moment in defined_inertia(Tensor(mass, (a, b, c))).moments]
