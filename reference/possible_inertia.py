"""Inertias that no body has: negative moments, and a moment that exceeds the sum of the other two."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.exact.start import defined_inertia
from bodycheck.reference.inertia import satisfies_triangle_inequality
from bodycheck.reference.robots.physical import MARGIN
from bodycheck.reference.scene import Tensor

#: How far below zero rounding may move a moment of zero, relative to the largest moment; see `robots.physical`.
ROUNDING = MARGIN

#: The start of the message about moments of which one exceeds the sum of the others.
NO_BODY = "no body has these moments: "

#: The end of the message about an impossible tensor that would be possible with the opposite signs of the products of inertia.
OTHER_SIGNS = (
    "; with the opposite signs of Ixy, Ixz and Iyz it would be possible: the products of inertia stand in the tensor as "
    "Ixy = -(sum of m x y)"
)


def impossible_tensor(tensor: NDArray[np.float64], mass: float, zero_allowed: bool) -> str | None:
    """Return why no body has an inertia tensor (3, 3), kg m^2; None if a body may have it.

    mass: the mass of the body (kg). zero_allowed: whether moments may be 0.
    """
    fault = impossible_moments(_principal_moments(tensor, mass), zero_allowed)
    other_signs = 2 * np.diag(np.diag(tensor)) - tensor
    if fault is not None and impossible_moments(_principal_moments(other_signs, mass), zero_allowed) is None:
        return fault + OTHER_SIGNS
    return fault


def impossible_moments(moments: Sequence[float], zero_allowed: bool) -> str | None:
    """Return why no body has three principal moments (kg m^2); None if a body may have them."""
    if zero_allowed:
        if min(moments) < -ROUNDING * max(moments):
            return f"its smallest principal moment is {min(moments):.6g}; none may be negative"
    elif min(moments) <= 0:
        return f"its smallest principal moment is {min(moments):.6g}; all must be positive"
    if not satisfies_triangle_inequality((moments[0], moments[1], moments[2])):
        by = 2 * max(moments) - sum(moments)
        return f"{NO_BODY}no moment may exceed the sum of the other two; the largest does by {by:.3g} kg m^2"
    return None


def _principal_moments(tensor: NDArray[np.float64], mass: float) -> list[float]:
    """Return the principal moments (kg m^2) of a tensor (3, 3), by the function that computes them for a case's body."""
    a, b, c = ((float(row[0]), float(row[1]), float(row[2])) for row in tensor)
    return [float(moment) for moment in defined_inertia(Tensor(mass, (a, b, c))).moments]
