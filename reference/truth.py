"""The reference trajectory with the bound of its own error, earned by ways that must agree.

The truth is the smallest model that is exact. In free flight that is a closed form, translation apart from rotation; a body
that turns is held against two independent witnesses: the Euler-Lagrange equations in Euler angles and Euler's equations with
a quaternion, both integrated in all coordinates. A body on a plane has three coordinates.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.flight import closed_form, drag
from bodycheck.reference.flight.closed_form import smallest_rotation
from bodycheck.reference.integration import lagrangian, quasi_coordinates
from bodycheck.reference.integration.dop853 import OutOfReach
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.lying import NotFlat, Stop, planar_state
from bodycheck.reference.principal import ALIGNED, along_principal_axes, in_body_frame
from bodycheck.reference.requirements import requirements
from bodycheck.reference.scene import Scene
from bodycheck.reference.sliding.motion import slide
from bodycheck.reference.sliding.pressure import WouldTip
from bodycheck.reference.trajectory import Array, Trajectory

#: What evaluates closed forms, and what integrates drag and slides.
CLOSED_FORMS, INTEGRATED = "numpy", "scipy-dop853"


class NotModelled(Exception):
    """The reference has no model of something that the scene requires; the text names it."""


@dataclass(frozen=True, eq=False)
class Truth:
    """What mechanics says of a scene, and how far it can be trusted.

    error: (n,) bound of the trajectory's own attitude error at each instant (rad), never decreasing.
    position_error: (n,) likewise of its position (m).
    model: the equations, and reason: why they are enough. backend: what solved them. witnesses: the independent solutions that
    the bounds are held against; none where nothing needs a witness, or where none can follow. stop: where a body on a plane
    comes to rest.
    """

    scene: Scene
    trajectory: Trajectory
    error: Array
    position_error: Array
    model: str
    reason: str
    backend: str
    witnesses: tuple[str, ...] = ()
    stop: Stop | None = None

    def at(self, times: Array) -> "Truth":
        """The truth of the same scene at other ascending times (n,) >= 0 s."""
        return self if np.array_equal(times, self.trajectory.t) else truth(self.scene, times)


@dataclass(frozen=True)
class Backend:
    """A solver of both forms of the equations of motion: attitudes (n, 4) in the type that they were solved in."""

    name: str
    euler_lagrange: Callable[[Scene, Array], NDArray[Any]]
    quasi_coordinates: Callable[[Scene, Array], NDArray[Any]]


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
        from bodycheck.reference.integration import taylor
    except ImportError:
        return dop853()
    return Backend(
        taylor.NAMES["extended"],
        lambda scene, times: taylor.euler_lagrange(scene, times).quaternion,
        lambda scene, times: taylor.quasi_coordinates(scene, times).quaternion,
    )


def dop853() -> Backend:
    """SciPy's DOP853 in double precision."""
    return Backend(
        INTEGRATED,
        lambda scene, times: lagrangian.integrate(scene, times).quaternion,
        lambda scene, times: quasi_coordinates.integrate(scene, times).quaternion,
    )


def truth(scene: Scene, times: Array, solver: Backend | None = None) -> Truth:
    """The motion of a scene's body at ascending times (n,) >= 0 s.

    A body that turns has two witnesses, solved by the best backend there is unless one is given.
    The attitude error of a body that turns is stated as the closed form's own bound and the largest disagreement so far with
    either witness together, never as less than it was before. Where the witnesses cannot follow, it is the closed form's own.

    Raises `NotModelled` for what the reference cannot model and `OutOfReach` for what it cannot follow.
    """
    if (missing := missing_model(scene)) is not None:
        raise NotModelled(missing)
    if scene.plane is not None:
        return on_plane(scene, times)
    principal = along_principal_axes(scene)
    form = smallest_rotation(principal.body.moments, principal.initial.angular_velocity)
    motion, error = closed_form.motion(principal, times), closed_form.bound(principal, times)
    turns = any(principal.initial.angular_velocity)
    apart, witnesses = disagreement(principal, motion, solver or backend()) if turns else (np.zeros(len(times)), ())
    flight = Truth(
        scene,
        in_body_frame(scene, motion),
        error + apart,
        rounding(motion),
        f"closed form: {form.name}",
        form.reason,
        CLOSED_FORMS,
        witnesses,
    )
    return with_drag(flight) if requirements(scene).drag else flight


def disagreement(scene: Scene, motion: Trajectory, solver: Backend) -> tuple[Array, tuple[str, ...]]:
    """The largest angle (n,), rad, so far between a motion's attitudes and those of two witnesses, and their names.

    No names, and no disagreement, where a witness cannot follow the motion.
    """
    ways = {"euler-lagrange": solver.euler_lagrange, "quasi-coordinates": solver.quasi_coordinates}
    try:
        apart = [attitude_difference(motion.quaternion, way(scene, motion.t)) for way in ways.values()]
    except OutOfReach:
        return np.zeros(len(motion)), ()
    return np.maximum.accumulate(np.maximum(*apart)), tuple(f"{way}, {solver.name}" for way in ways)


def on_plane(scene: Scene, times: Array) -> Truth:
    """The truth of a flat body that slides; raises as `truth` does."""
    try:
        found = slide(scene, times)
    except WouldTip as error:
        raise NotModelled(f"a body that would tip: {error}") from error
    closed = found.model.startswith("closed form")
    return Truth(
        scene,
        found.trajectory,
        found.error,
        found.position_error,
        found.model,
        found.reason,
        CLOSED_FORMS if closed else INTEGRATED,
        () if closed else (f"plain time, {INTEGRATED}",),
        found.stop,
    )


def with_drag(flight: Truth) -> Truth:
    """A flight with its translation slowed by drag, which acts at the centre of mass and leaves the rotation alone.

    The bound (n,) of the position error (m) is twice the distance between two formulations, both in double precision.
    """
    motion = flight.trajectory
    position, velocity = drag.cartesian(flight.scene, motion.t)
    witness, _ = drag.hodograph(flight.scene, motion.t)
    slowed = replace(motion, position=position, velocity=velocity)
    return replace(
        flight,
        trajectory=slowed,
        position_error=2 * np.maximum.accumulate(distance(position, witness)) + rounding(slowed),
        model=f"{flight.model}, drag integrated",
        backend=INTEGRATED,
        witnesses=(*flight.witnesses, f"hodograph, {INTEGRATED}"),
    )


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
