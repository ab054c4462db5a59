"""Convert states along the principal axes of a body, in which many engines step, to the body frame of its scene.

`bodycheck.reference.principal_frame.along_principal_axes` converts the scene, and with it the initial state.
"""

import numpy as np

from bodycheck.reference.kinematics import conjugate, multiply, rotate
from bodycheck.reference.principal_frame import IDENTITY
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array


def in_body_frame(scene: Scene, rows: Array) -> Array:
    """Return states (n, 13) in the frame of the scene's body, from those of a body whose frame is that of the principal axes.

    The columns are those of `bodycheck.adapters.contract.Simulation.advance`.
    """
    if scene.body.axes == IDENTITY:
        return rows
    axes = np.tile(scene.body.axes, (len(rows), 1))
    attitude = multiply(rows[:, 3:7], conjugate(axes))
    return np.concatenate([rows[:, :3], attitude, rows[:, 7:10], rotate(axes, rows[:, 10:])], axis=1)
