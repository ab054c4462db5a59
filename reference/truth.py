"""The truth of a scene: its reference trajectory together with a bound of the trajectory's own error.

The truth is computed from the smallest model that is exact. In free flight this is a closed form, with translation and
rotation solved independently. A body that rotates also has two independent witnesses: the Euler-Lagrange equations in Euler
angles and Euler's equations with a quaternion, both integrated numerically. Drag on the translation is integrated in two
formulations. A body that lies flat on a plane has three coordinates; see `sliding`.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.errors import NotFlat, NotModelled, OutOfReach, WouldTip
from bodycheck.reference.flight import closed_form, drag
from bodycheck.reference.flight.closed_form import smallest_rotation
from bodycheck.reference.integration import lagrangian, quasi_coordinates
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.planar import Stop, planar_state
from bodycheck.reference.principal_frame import IDENTITY, along_principal_axes, in_body_frame
from bodycheck.reference.requirements import requirements
from bodycheck.reference.scene import Scene
from bodycheck.reference.sliding.motion import slide
from bodycheck.reference.trajectory import Array, Trajectory

#: Name of the backend that evaluates closed forms.
CLOSED_FORM_BACKEND = "numpy"

#: Name of the backend that integrates drag and slides.
INTEGRATION_BACKEND = "scipy-dop853"


@dataclass(frozen=True, eq=False)
class Truth:
    """The reference trajectory of a scene, and the bound of its error.

    Attributes
    ----------
    scene
        The scene.
    trajectory
        The reference trajectory at n instants, in the frame of the scene's body.
    error
        (n,) bound of the attitude error of the trajectory itself at each instant (rad), never decreasing.
    position_error
        (n,) bound of the position error of the trajectory itself at each instant (m), never decreasing.
    model
        Name of the equations that were solved.
    reason
        Why these equations are exact for the scene.
    backend
        Name of the software that solved them.
    witnesses
        Names of the independent solutions that the bounds rely on; empty where none is needed, and where none can be computed.
    stop
        The instant and place where a body on a plane comes to rest; None in free flight and where it still moves at the last
        instant.
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
        """The truth of the same scene at other ascending times (n,) >= 0, s; raises as `truth` does."""
        return self if np.array_equal(times, self.trajectory.t) else truth(self.scene, times)


@dataclass(frozen=True)
class NoTruth:
    """The answer where the reference has no truth.

    Attributes
    ----------
    reason
        Why there is none.
    """

    reason: str


@dataclass(frozen=True)
class Backend:
    """A solver of two forms of the equations of motion of a body in free flight.

    Attributes
    ----------
    name
        Name of the solver in results.
    euler_lagrange
        Solves the Euler-Lagrange equations: maps a scene along principal axes and ascending times (n,) >= 0, s, to attitudes
        (n, 4), w x y z, body to world, in the floating-point type of the solver. Raises `OutOfReach`.
    quasi_coordinates
        Solves Euler's equations with a quaternion, with the same arguments and result.
    """

    name: str
    euler_lagrange: Callable[[Scene, Array], NDArray[Any]]
    quasi_coordinates: Callable[[Scene, Array], NDArray[Any]]


def missing_model(scene: Scene) -> str | None:
    """The feature of a scene that the reference has no model of, in words, or None where it can model the scene."""
    if scene.plane is None:
        return None
    if scene.drag:
        return "drag on a body that slides"
    if scene.body.axes != IDENTITY:
        return "a sliding body whose frame is not that of its principal axes"
    try:
        planar_state(scene)
    except NotFlat as error:
        return str(error)
    return None


def backend() -> Backend:
    """The best solver that is installed: heyoka's Taylor series in extended precision, otherwise SciPy's DOP853."""
    try:
        from bodycheck.reference.integration import taylor
    except ImportError:
        return dop853()
    return Backend(
        taylor.BACKEND_NAMES["extended"],
        lambda scene, times: taylor.euler_lagrange(scene, times).quaternion,
        lambda scene, times: taylor.quasi_coordinates(scene, times).quaternion,
    )


def dop853() -> Backend:
    """SciPy's DOP853 in double precision."""
    return Backend(
        INTEGRATION_BACKEND,
        lambda scene, times: lagrangian.integrate(scene, times).quaternion,
        lambda scene, times: quasi_coordinates.integrate(scene, times).quaternion,
    )


def truth(scene: Scene, times: Array, solver: Backend | None = None) -> Truth:
    """The truth of a scene.

    The bound of the attitude error of a body that rotates is the sum of the bound of its closed form and of the largest
    disagreement so far with either witness. Where the witnesses cannot be computed, it is the bound of the closed form.

    Parameters
    ----------
    scene
        The scene.
    times
        (n,) ascending times >= 0 (s).
    solver
        Solver of the witnesses of a body that rotates in free flight; by default `backend`.

    Returns
    -------
    Truth
        The trajectory at these times, with the bound of its error.

    Raises
    ------
    NotModelled
        If the reference has no model of the scene.
    OutOfReach
        If the motion cannot be computed, or takes too many integration steps.
    ValueError
        If the scene has a balanced pressure under the decoupled law of friction, or numbers that are not finite.
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
        CLOSED_FORM_BACKEND,
        witnesses,
    )
    return with_drag(flight) if requirements(scene).drag else flight


def disagreement(scene: Scene, motion: Trajectory, solver: Backend) -> tuple[Array, tuple[str, ...]]:
    """Disagreement of a motion with its two witnesses.

    Parameters
    ----------
    scene
        The scene, along the principal axes of its body.
    motion
        The motion at n instants, in the same frame.
    solver
        The solver of the witnesses.

    Returns
    -------
    tuple
        (n,) largest angle so far between the attitudes of the motion and those of either witness (rad), and the names of the
        witnesses. Where a witness cannot be computed, the angles are zero and there are no names.
    """
    ways = {"euler-lagrange": solver.euler_lagrange, "quasi-coordinates": solver.quasi_coordinates}
    try:
        apart = [attitude_difference(motion.quaternion, way(scene, motion.t)) for way in ways.values()]
    except OutOfReach:
        return np.zeros(len(motion)), ()
    return np.maximum.accumulate(np.maximum(*apart)), tuple(f"{way}, {solver.name}" for way in ways)


def on_plane(scene: Scene, times: Array) -> Truth:
    """The truth of a body that lies flat on a plane, at ascending times (n,) >= 0, s; raises as `truth` does."""
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
        CLOSED_FORM_BACKEND if closed else INTEGRATION_BACKEND,
        () if closed else (f"plain time, {INTEGRATION_BACKEND}",),
        found.stop,
    )


def with_drag(flight: Truth) -> Truth:
    """The truth of a flight with drag, from the truth of the same flight without it.

    Drag acts at the centre of mass and does not change the rotation. The bound of the position error is twice the largest
    distance so far between two formulations, both in double precision, plus rounding. Raises `OutOfReach`.
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
        backend=INTEGRATION_BACKEND,
        witnesses=(*flight.witnesses, f"hodograph, {INTEGRATION_BACKEND}"),
    )


def rounding(motion: Trajectory) -> Array:
    """Position error (n,), m, of a few roundings of the largest distance so far."""
    reach = np.linalg.norm(motion.position, axis=1) + np.linalg.norm(motion.velocity, axis=1) * motion.t
    return np.asarray(4 * np.finfo(float).eps * np.maximum.accumulate(reach))


def distance(one: Array, other: Array) -> Array:
    """Euclidean distances (n,) between vectors (n, 3)."""
    return np.asarray(np.linalg.norm(one - other, axis=1))


def attitude_difference(p: NDArray[Any], q: NDArray[Any]) -> Array:
    """Angle (n,), rad, between attitudes (n, 4) in double or extended precision, computed in the wider of the two types."""
    wide = np.result_type(p, q)
    return geodesic_angle(p.astype(wide), q.astype(wide)).astype(float)
