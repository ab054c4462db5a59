"""The reference trajectory with the bound of its own error, earned by three ways that must agree.

A body in free flight is integrated from the Euler-Lagrange equations in Euler angles: that is the truth. Euler's equations
with a quaternion, integrated apart, and the closed form, which integrates nothing, are its witnesses.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference import closed_form, drag, lagrangian, quasi_coordinates
from bodycheck.reference.friction import NotFlat
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.pressure import WouldTip
from bodycheck.reference.principal import ALIGNED, along_principal_axes, in_body_frame
from bodycheck.reference.scene import Scene
from bodycheck.reference.sliding import Stop, planar_state, slide
from bodycheck.reference.trajectory import Array, Trajectory


class NotModelled(Exception):
    """The reference has no model of something that the scene requires; the text names it."""


@dataclass(frozen=True, eq=False)
class Truth:
    """What mechanics says of a scene, and how far it can be trusted.

    error: (n,) bound of the trajectory's own attitude error at each instant (rad), never decreasing.
    position_error: (n,) likewise of its position (m).
    model: the equations. backend: what solved them. stop: where a body on a plane comes to rest.
    """

    scene: Scene
    trajectory: Trajectory
    error: Array
    position_error: Array
    model: str
    backend: str
    stop: Stop | None = None

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
    if scene.plane is None:
        return None
    if scene.drag:
        return "drag on a body that slides"
    if scene.body.axes != ALIGNED:
        return "a sliding body whose frame is not that of its principal axes"
    try:
        planar_state(scene)
    except NotFlat as error:
        return str(error)
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

    The attitude error is at most the distance from the closed form and the closed form's own bound together. It is never
    stated below the disagreement with Euler's equations, and never as less than it was before.

    Raises `NotModelled` for what the reference cannot model and `OutOfReach` for what it cannot follow.
    """
    if (missing := missing_model(scene)) is not None:
        raise NotModelled(missing)
    if scene.plane is not None:
        return on_plane(scene, times)
    solver = solver or backend()
    principal = along_principal_axes(scene)
    motion = solver.euler_lagrange(principal, times)
    exact = closed_form.motion(principal, times)
    apart = [attitude_difference(motion.quaternion, other) for other in (solver.attitudes(principal, times), exact.quaternion)]
    error = np.maximum.accumulate(np.maximum(*apart)) + closed_form.bound(principal, times)
    if scene.drag:
        motion, position_error = with_drag(scene, motion)
    else:
        position_error = np.maximum.accumulate(distance(motion.position, exact.position)) + rounding(motion)
    model = "euler-lagrange with drag" if scene.drag else "euler-lagrange"
    return Truth(scene, in_body_frame(scene, motion), error, position_error, model, solver.name)


def on_plane(scene: Scene, times: Array) -> Truth:
    """The truth of a flat body that slides; raises as `truth` does."""
    try:
        found = slide(scene, times)
    except WouldTip as error:
        raise NotModelled(f"a body that would tip: {error}") from error
    solver = "numpy" if found.model.startswith("closed form") else "scipy-dop853"
    return Truth(scene, found.trajectory, found.error, found.position_error, found.model, solver, found.stop)


def with_drag(scene: Scene, motion: Trajectory) -> tuple[Trajectory, Array]:
    """A motion with its translation slowed by drag, which acts at the centre of mass and leaves the rotation alone.

    The bound (n,) of the position error (m) is twice the distance between two formulations, both in double precision.
    """
    position, velocity = drag.cartesian(scene, motion.t)
    witness, _ = drag.hodograph(scene, motion.t)
    slowed = replace(motion, position=position, velocity=velocity)
    return slowed, 2 * np.maximum.accumulate(distance(position, witness)) + rounding(slowed)


def rounding(motion: Trajectory) -> Array:
    """Position error (n,), m, of some roundings of the largest distances so far."""
    reach = np.linalg.norm(motion.position, axis=1) + np.linalg.norm(motion.velocity, axis=1) * motion.t
    return np.asarray(4 * np.finfo(float).eps * np.maximum.accumulate(reach))


def distance(one: Array, other: Array) -> Array:
    """Euclidean distances (n,) between vectors (n, 3)."""
    return np.asarray(np.linalg.norm(one - other, axis=1))


def attitude_difference(p: NDArray[Any], q: NDArray[Any]) -> Array:
    """Geodesic angle (n,) in rad between quaternions (n, 4) of double or extended precision, formed in the wider type."""
    wide = np.result_type(p, q)
    return geodesic_angle(p.astype(wide), q.astype(wide)).astype(float)
