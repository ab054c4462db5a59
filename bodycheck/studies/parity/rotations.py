"""Small matrices of rotations and twists in double precision, with any leading axes."""

import numpy as np

from bodycheck.reference.kinematics import conjugate, multiply, normalise, rotate
from bodycheck.reference.trajectory import Array


def matrices(quaternions: Array) -> Array:
    """Return the rotation matrices (..., 3, 3) of unit quaternions w, x, y, z (..., 4)."""
    columns = [rotate(quaternions, np.broadcast_to(axis, (*quaternions.shape[:-1], 3))) for axis in np.eye(3)]
    return np.stack(columns, axis=-1)


def crossing(vectors: Array) -> Array:
    """Return the matrices (..., 3, 3) of the cross product by vectors (..., 3) from the left."""
    x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    zero = np.zeros_like(x)
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(*vectors.shape[:-1], 3, 3)


def rotation_vectors(quaternions: Array) -> Array:
    """Return the vectors (..., 3) along the axes of rotations whose lengths are their angles, of unit quaternions (..., 4)."""
    nearer = np.where(quaternions[..., :1] < 0, -quaternions, quaternions)
    sine = np.linalg.norm(nearer[..., 1:], axis=-1, keepdims=True)
    angle = 2 * np.arctan2(sine, nearer[..., :1])
    return np.asarray(nearer[..., 1:] * np.where(sine > 0, angle / np.where(sine > 0, sine, 1.0), 2.0))


def relative(parent: Array, child: Array) -> Array:
    """Return the poses (..., 7) of frames in other frames, both given by their poses (..., 7) in the world."""
    back = conjugate(normalise(parent[..., 3:]))
    return np.concatenate([rotate(back, child[..., :3] - parent[..., :3]), multiply(back, normalise(child[..., 3:]))], axis=-1)


def composed(first: Array, second: Array) -> Array:
    """Return the poses (..., 7) of frames that are given by poses `second` in frames with poses `first`."""
    place = first[..., :3] + rotate(first[..., 3:], second[..., :3])
    return np.concatenate([place, multiply(first[..., 3:], second[..., 3:])], axis=-1)


def inverse(poses: Array) -> Array:
    """Return the inverse poses (..., 7)."""
    back = conjugate(poses[..., 3:])
    return np.concatenate([-rotate(back, poses[..., :3]), back], axis=-1)
