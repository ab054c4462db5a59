"""Convert attitudes of engines: from the frame of principal axes, in which many engines step, and to and from rotation vectors.

`bodycheck.reference.inertia.along_principal_axes` converts a scene, with its initial state, to the frame of principal axes.
"""

import numpy as np

from bodycheck.reference.inertia import IDENTITY
from bodycheck.reference.kinematics import conjugate, multiply, rotate
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array


def in_body_frame(scene: Scene, rows: Array) -> Array:
    """Return states (n, 13) of the frame of the scene's body, from states (n, 13) of the frame of its principal axes.

    The columns are those of `bodycheck.adapters.contract.Simulation.advance`.
    """
    if scene.body.axes == IDENTITY:
        return rows
    axes = np.tile(scene.body.axes, (len(rows), 1))
    attitude = multiply(rows[:, 3:7], conjugate(axes))
    return np.concatenate([rows[:, :3], attitude, rows[:, 7:10], rotate(axes, rows[:, 10:])], axis=1)


def rotation_vector(quaternion: Array) -> Array:
    """Return the rotation vector (3,) of a unit quaternion (4,), in rad and at most pi long."""
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
