"""Poses in double precision, and the matrices of cross products, with any leading axes."""

import numpy as np

from bodycheck.reference.kinematics import conjugate, geodesic_angle, multiply, normalise, rotate
from bodycheck.reference.trajectory import Array


def crossing(vectors: Array) -> Array:
    """Return the matrices (..., 3, 3) that take the cross product with vectors (..., 3) from the left."""
    x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    zero = np.zeros_like(x)
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(*vectors.shape[:-1], 3, 3)


def relative(parent: Array, child: Array) -> Array:
    """Return the poses (..., 7) of child frames in parent frames, both given by their poses (..., 7) in the world."""
    back = conjugate(normalise(parent[..., 3:]))
    return np.concatenate([rotate(back, child[..., :3] - parent[..., :3]), multiply(back, normalise(child[..., 3:]))], axis=-1)


def composed(first: Array, second: Array) -> Array:
    """Return the poses (..., 7) of frames that are given by poses `second` in frames with poses `first`."""
    origin = first[..., :3] + rotate(first[..., 3:], second[..., :3])
    return np.concatenate([origin, multiply(first[..., 3:], second[..., 3:])], axis=-1)


def inverse(poses: Array) -> Array:
    """Return the inverse poses (..., 7)."""
    back = conjugate(poses[..., 3:])
    return np.concatenate([-rotate(back, poses[..., :3]), back], axis=-1)


def gaps(one: Array, other: Array) -> tuple[Array, Array]:
    """Return the distances (...) between the origins of poses (..., 7) (m), and the angles (...) between their axes (rad)."""
    shift = np.linalg.norm(one[..., :3] - other[..., :3], axis=-1)
    return shift, geodesic_angle(normalise(one[..., 3:]), normalise(other[..., 3:]))
