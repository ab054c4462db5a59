"""The reference trajectory with the bound of its own error."""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference import lagrangian, quasi_coordinates
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array, Trajectory

SAFETY = 2.0
"""The two ways round independently, so that their disagreement is the size of either's error, give or take."""

ROUNDING = 4 * float(np.finfo(float).eps)
"""Attitude error (rad) of any quaternion that is stored in double precision."""


class NotModelled(Exception):
    """The reference has no model of something that the scene requires; the text names it."""


@dataclass(frozen=True, eq=False)
class Truth:
    """What mechanics says of a scene, and how far it can be trusted.

    error: (n,) bound of the trajectory's own attitude error at each instant (rad), never decreasing.
    model: the equations. backend: what solved them.
    """

    scene: Scene
    trajectory: Trajectory
    error: Array
    model: str
    backend: str

    def at(self, times: Array) -> "Truth":
        """The truth of the same scene at other ascending times (n,) >= 0 s."""
        return self if np.array_equal(times, self.trajectory.t) else truth(self.scene, times)


def missing_model(scene: Scene) -> str | None:
    """What the scene requires and the reference cannot model, in words; None where it can."""
    if scene.plane is not None:
        return "contact with a plane"
    if scene.drag:
        return "drag"
    return None


def truth(scene: Scene, times: Array) -> Truth:
    """The motion of a scene's body at ascending times (n,) >= 0 s.

    The trajectory is that of the Euler-Lagrange equations; Euler's equations with a quaternion, integrated apart, give the
    error bound: the largest disagreement so far.

    Raises `NotModelled` for what the reference cannot model and `OutOfReach` for what it cannot follow.
    """
    if (missing := missing_model(scene)) is not None:
        raise NotModelled(missing)
    trajectory = lagrangian.integrate(scene, times)
    witness = quasi_coordinates.integrate(scene, times)
    disagreement = geodesic_angle(trajectory.quaternion, witness.quaternion)
    error = SAFETY * np.maximum.accumulate(disagreement) + ROUNDING
    return Truth(scene, trajectory, error, model="euler-lagrange", backend="scipy-dop853")
