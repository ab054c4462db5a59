"""The reference trajectory with the bound of its own error, earned by three ways that must agree.

A body in free flight is integrated from the Euler-Lagrange equations in Euler angles: that is the truth. Euler's equations
with a quaternion, integrated apart, and the closed form, which integrates nothing, are its witnesses.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference import closed_form, lagrangian, quasi_coordinates
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array, Trajectory


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


@dataclass(frozen=True)
class Backend:
    """A solver of both forms of the equations of motion.

    euler_lagrange: trajectories. attitudes: quaternions (n, 4) of Euler's equations, in the type that they were solved in.
    """

    name: str
    euler_lagrange: Callable[[Scene, Array], Trajectory]
    attitudes: Callable[[Scene, Array], NDArray[Any]]


def missing_model(scene: Scene) -> str | None:
    """What the scene requires and the reference cannot model, in words; None where it can."""
    if scene.plane is not None:
        return "contact with a plane"
    if scene.drag:
        return "drag"
    return None


def backend() -> Backend:
    """heyoka's Taylor series in the widest float of the machine where heyoka is installed, else SciPy's DOP853."""
    try:
        from bodycheck.reference import taylor
    except ImportError:
        return dop853()
    name = taylor.NAMES["extended"]
    return Backend(name, taylor.integrate, lambda scene, times: taylor.quasi_coordinates(scene, times).quaternion)


def dop853() -> Backend:
    """SciPy's DOP853 in double precision."""
    return Backend("scipy-dop853", lagrangian.integrate, lambda s, t: quasi_coordinates.integrate(s, t).quaternion)


def truth(scene: Scene, times: Array, solver: Backend | None = None) -> Truth:
    """The motion of a scene's body at ascending times (n,) >= 0 s, by the best backend there is unless one is given.

    The error is at most the distance from the closed form and the closed form's own bound together. It is never stated
    below the disagreement with Euler's equations, and never as less than it was before.

    Raises `NotModelled` for what the reference cannot model and `OutOfReach` for what it cannot follow.
    """
    if (missing := missing_model(scene)) is not None:
        raise NotModelled(missing)
    solver = solver or backend()
    trajectory = solver.euler_lagrange(scene, times)
    witnesses = (solver.attitudes(scene, times), closed_form.motion(scene, times).quaternion)
    apart = [attitude_difference(trajectory.quaternion, witness) for witness in witnesses]
    error = np.maximum.accumulate(np.maximum(*apart)) + closed_form.bound(scene, times)
    return Truth(scene, trajectory, error, model="euler-lagrange", backend=solver.name)


def attitude_difference(p: NDArray[Any], q: NDArray[Any]) -> Array:
    """Geodesic angle (n,) in rad between quaternions (n, 4) of double or extended precision, formed in the wider type."""
    wide = np.result_type(p, q)
    return geodesic_angle(p.astype(wide), q.astype(wide)).astype(float)
