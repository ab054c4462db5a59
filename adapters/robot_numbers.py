"""Convert numbers of an engine to the forms of `bodycheck.adapters.robot_reading`."""

import math
from collections.abc import Mapping
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from bodycheck.adapters.robot_reading import Components
from bodycheck.reference.kinematics import normalise, rotate
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array


def components(tensor: ArrayLike) -> Components:
    """Return the components xx, yy, zz, xy, xz, yz of a tensor (3, 3)."""
    entries = np.asarray(tensor, dtype=float)
    places = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    return cast("Components", tuple(float(entries[index]) for index in places))


def vector(values: ArrayLike) -> Vector:
    """Return three numbers as a tuple."""
    x, y, z = (float(value) for value in np.asarray(values, dtype=float))
    return x, y, z


def matrix(quaternion: ArrayLike) -> Array:
    """Return the rotation matrix (3, 3) of a quaternion w, x, y, z of any norm.

    It converts components in the rotated frame to components in the frame that was rotated.
    """
    unit = normalise(np.asarray(quaternion, dtype=float))
    return rotate(np.broadcast_to(unit, (3, 4)), np.eye(3)).T


def scalar_first(quaternion: ArrayLike) -> Array:
    """Return a quaternion (4,) in the order w, x, y, z, from an engine's order x, y, z, w."""
    return np.asarray(quaternion, dtype=float)[[3, 0, 1, 2]]


def along(moments: ArrayLike, axes: Array) -> Array:
    """Return the tensor (3, 3) of principal moments (3,), whose axes are the columns of a matrix (3, 3)."""
    return np.asarray(axes * np.asarray(moments, dtype=float) @ axes.T)


def pose(position: ArrayLike, quaternion: ArrayLike) -> Array:
    """Return the row (7,) of a position and a quaternion w, x, y, z."""
    return np.concatenate([np.asarray(position, dtype=float), np.asarray(quaternion, dtype=float)])


def finite(limit: float, beyond: float = math.inf) -> float | None:
    """Return a limit; None if its size is `beyond`, by which the engine says that there is no limit, or more."""
    return float(limit) if abs(limit) < beyond else None


def values_of(values: Mapping[str, tuple[float, ...]], joint: str, count: int) -> Array | None:
    """Return the numbers of a joint in a state; None if the state has none, or not the number that the engine's joint has."""
    numbers = values.get(joint, ())
    return np.array(numbers) if numbers and len(numbers) == count else None
