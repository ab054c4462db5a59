"""Convert attitudes for engines that keep them as rotation vectors."""

import numpy as np

from bodycheck.reference.trajectory import Array


def rotation_vector(quaternion: Array) -> Array:
    """Return the rotation vector (3,), rad, of at most a half turn, of a unit quaternion (4,)."""
    w, vector = quaternion[0], quaternion[1:]
    size = float(np.linalg.norm(vector))
    if size == 0.0:
        return np.zeros(3)
    angle = 2 * np.arctan2(size, abs(w))
    return np.asarray(np.copysign(angle / size, w) * vector)


def quaternions(rotation_vectors: Array) -> Array:
    """Return the unit quaternions (n, 4) of rotation vectors (n, 3), rad."""
    half = np.linalg.norm(rotation_vectors, axis=1, keepdims=True) / 2
    return np.hstack([np.cos(half), rotation_vectors / 2 * np.sinc(half / np.pi)])
