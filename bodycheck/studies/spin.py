"""The rate at which a scene turns at its start."""

import math

import numpy as np

from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism


def fastest_spin(scene: AnyScene) -> float:
    """Return the initial angular velocity (rad/s) of the body, or the largest of the bodies of a mechanism."""
    if isinstance(scene, Mechanism):
        return float(np.linalg.norm(kinematics.initial(scene).angular_velocity, axis=-1).max())
    return math.hypot(*scene.initial.angular_velocity)
