"""Motion of a flat body that slides and spins on a plane with Coulomb friction, until it stops [G, Example 2.2, corrected].

There are three coordinates: x, y and the yaw psi. A straight slide, a pure spin, and every motion under the book's decoupled
law have closed forms. A body that slides and spins at once is integrated twice, in log time and in plain time.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.errors import NotFlat, WouldTip
from bodycheck.reference.kinematics import multiply
from bodycheck.reference.planar import Stop, planar_state
from bodycheck.reference.scene import Plane, Scene
from bodycheck.reference.sliding.bounds import error_bounds
from bodycheck.reference.sliding.coupled_motion import Flat, Motion, in_log_time, in_plain_time
from bodycheck.reference.sliding.footprint import nearness
from bodycheck.reference.sliding.friction import Law, decoupled_friction, footprint_of, friction, refuse_tipping
from bodycheck.reference.sliding.panels import between
from bodycheck.reference.trajectory import Array, Trajectory


@dataclass(frozen=True, eq=False)
class Slide:
    """A slide, with the bounds of its error.

    Attributes
    ----------
    trajectory
        The trajectory at n instants.
    stop
        The stop, or None for a body that still moves at the last instant.
    error, position_error
        (n,) bounds of the errors of the yaw (rad) and of the position (m), never decreasing.
    velocity_error, angular_velocity_error
        (n,) bounds of the errors of the velocity (m/s) and of the angular velocity (rad/s), zero when the body surely rests.
    model
        Name of the equations that were solved.
    reason
        Why these equations are exact for the scene.
    """

    trajectory: Trajectory
    stop: Stop | None
    error: Array
    position_error: Array
    velocity_error: Array
    angular_velocity_error: Array
    model: str
    reason: str


def slide(scene: Scene, times: Array) -> Slide:
    """The motion of a flat body on the scene's plane, at ascending times (n,) >= 0, s. Drag is ignored.

    The bounds are those of `error_bounds`.

    Raises
    ------
    NotFlat
        If the body does not lie flat on the plane, or has no face to lie on.
    WouldTip
        If a balanced pressure would have to be negative somewhere.
    OutOfReach
        If the integration takes too many steps, or one corner comes to rest before the others.
    ValueError
        If the pressure is balanced under the decoupled law of friction, which does not depend on where the load is.
    """
    if scene.plane is None:
        raise NotFlat("the scene has no plane to lie on")
    plane, start = scene.plane, planar_state(scene)
    if is_coupled(scene, plane, start):
        flat, check = coupled_body(scene, plane)
        motion = in_log_time(flat, start, times, check)
        equations = "Euler-Lagrange"
    else:
        motion = in_closed_form(scene, plane, start, times)
        equations = "closed form"
    trajectory = to_trajectory(scene, times, motion.rows, start[2])
    bounds = error_bounds(scene, motion, trajectory)
    stop = None
    if motion.stop is not None:
        time, to_x, to_y, to_yaw = motion.stop.tolist()
        stop = Stop(time, (to_x, to_y, scene.initial.position[2]), to_yaw)
    model = f"{equations}, {plane.law} friction, {plane.pressure} load"
    return Slide(
        trajectory,
        stop,
        bounds.yaw,
        bounds.position,
        bounds.velocity,
        bounds.spin,
        model,
        reason(plane, scene.gravity, start),
    )


def is_coupled(scene: Scene, plane: Plane, start: Array) -> bool:
    """Return whether friction couples translation and spin, so that the motion from a planar state (6,) has no closed form."""
    return bool(plane.law != "decoupled" and start[3:5].any() and start[5] and plane.friction * scene.gravity > 0)


def reason(plane: Plane, gravity: float, start: Array) -> str:
    """Return the reason why the coordinates x, y and yaw, and the equations chosen for them, are exact for a scene.

    Parameters
    ----------
    plane
        The plane.
    gravity
        Gravitational acceleration (m/s^2).
    start
        (6,) initial state, from `planar.planar_state`.

    Returns
    -------
    str
        The reason, as results show it.
    """
    moves, spins = bool(start[3:5].any()), bool(start[5])
    if moves and spins and plane.friction * gravity:
        decoupled = plane.law == "decoupled"
        motion = "its law of friction has translation and spin apart" if decoupled else "it slides and spins at once"
    elif moves and spins:
        motion = "nothing brakes it"
    else:
        motion = "it slides without a spin" if moves else "it spins in its place" if spins else "it is at rest"
    return f"it lies flat, and {motion}"


def smallest_friction(scene: Scene, plane: Plane) -> tuple[Law, bool]:
    """The simplest law of friction that is exact for a body that lies flat.

    The second value tells whether this law brakes translation and spin independently of each other.
    In a straight slide friction has no moment, and in a pure spin it has no resultant, under every law and pressure. So the
    motion remains a straight slide or a pure spin, and the remaining part of friction has a constant magnitude.

    Raises `NotFlat` for a body that does not lie flat, and `ValueError` as `friction.friction` does.
    """
    start = planar_state(scene)
    if plane.law == "decoupled" or not (start[3:5].any() and start[5]):
        footprint = footprint_of(scene.body.shape, plane.law)
        return decoupled_friction(footprint, plane.friction, scene.body.mass * scene.gravity), True
    return friction(scene.body, plane, scene.gravity), False


def coupled(scene: Scene, plane: Plane, start: Array, times: Array) -> tuple[Motion, Motion]:
    """The motion of a body that slides and spins at once, in both formulations.

    Parameters
    ----------
    scene
        The scene, whose body lies flat.
    plane
        The plane of the scene.
    start
        (6,) initial state, from `planar.planar_state`.
    times
        (n,) ascending times >= 0 (s).

    Returns
    -------
    tuple of Motion
        The motion in log time and in plain time.

    Raises
    ------
    WouldTip
        If the body would tip, with the instant.
    OutOfReach
        If the motion cannot be integrated; see `coupled_motion`.
    """
    flat, check = coupled_body(scene, plane)
    return in_log_time(flat, start, times, check), in_plain_time(flat, start, times)


def coupled_body(scene: Scene, plane: Plane) -> tuple[Flat, Callable[[float, float, float, float], None]]:
    """The body of a scene for `coupled_motion`, and a check that raises `WouldTip`, with the instant, where it tips."""
    body, gravity = scene.body, scene.gravity
    refuse = refuse_tipping(body, plane, gravity)

    def check(time: float, v1: float, v2: float, w: float) -> None:
        try:
            refuse(v1, v2, w)
        except WouldTip as tipping:
            raise WouldTip(f"at t = {time:.6g} s {tipping}") from None

    flat = Flat(
        body.mass,
        math.sqrt(body.moments[2] / body.mass),
        plane.friction * gravity,
        friction(body, plane, gravity),
        nearness(footprint_of(body.shape, plane.law)),
    )
    return flat, check


def in_closed_form(scene: Scene, plane: Plane, start: Array, times: Array) -> Motion:
    """The motion with constant decelerations mu g of the translation and |torque|/C of the spin, each until it is at rest.

    It is exact for a straight slide, in which friction has no moment, for a pure spin, in which friction has no resultant, for
    a motion without friction, and by definition under the decoupled law. The body stops when both are at rest.

    Parameters
    ----------
    scene
        The scene, whose body lies flat.
    plane
        The plane of the scene.
    start
        (6,) initial state, from `planar.planar_state`.
    times
        (n,) ascending times >= 0 (s).

    Returns
    -------
    Motion
        The motion at the times, at rest after the stop.

    Raises
    ------
    WouldTip
        If the body would tip.
    """
    law = friction(scene.body, plane, scene.gravity)
    speed, spin = math.hypot(*start[3:5]), float(start[5])
    refuse_tipping(scene.body, plane, scene.gravity)(float(start[3]), float(start[4]), spin)
    ends = (
        stopping_time(speed, plane.friction * scene.gravity),
        stopping_time(abs(spin), abs(law(0.0, 0.0, spin)[2]) / scene.body.moments[2]),
    )

    def rows(at: Array) -> Array:
        (way, slowing), (turn, braking) = (decelerated(end, at) for end in ends)
        ways, fractions = np.column_stack([way, way, turn]), np.column_stack([slowing, slowing, braking])
        return np.concatenate([start[:3] + start[3:] * ways, start[3:] * fractions], axis=1)

    end = max(ends)
    last = float(times[-1]) if len(times) else 0.0
    stop = np.array([end, *rows(np.array([end]))[0, :3]]) if len(times) and end <= last else None
    return Motion(rows(times), stop, between(rows, np.unique([0.0, *(min(time, last) for time in ends)])))


def stopping_time(rate: float, deceleration: float) -> float:
    """Time (s) until a speed or spin rate >= 0 is zero at a deceleration >= 0; infinite without deceleration, 0 at rest."""
    if rate == 0:
        return 0.0
    return rate / deceleration if deceleration else math.inf


def decelerated(end: float, at: Array) -> tuple[Array, Array]:
    """A uniformly decelerated motion that ends at the time `end` (s), at times `at` (k,), s.

    Returns the distance divided by the initial speed (k,), s, and the remaining fraction of the speed (k,).
    """
    if end == 0:
        return np.zeros_like(at), np.zeros_like(at)
    now = np.minimum(at, end)
    return now * (1 - now / (2 * end)), 1 - now / end


def to_trajectory(scene: Scene, times: Array, rows: Array, yaw: float) -> Trajectory:
    """The trajectory in space of a planar motion.

    Parameters
    ----------
    scene
        The scene, which gives the initial attitude and the height of the centre of mass.
    times
        (n,) times (s).
    rows
        (n, 6) x, y, psi and their rates (m, rad, s), world frame.
    yaw
        Yaw of the initial attitude (rad).

    Returns
    -------
    Trajectory
        The trajectory at the times.
    """
    half, nothing = (rows[:, 2] - yaw) / 2, np.zeros(len(rows))
    turned = multiply(np.column_stack([np.cos(half), nothing, nothing, np.sin(half)]), np.array(scene.initial.quaternion))
    position = np.column_stack([rows[:, :2], np.full(len(rows), scene.initial.position[2])])
    return Trajectory(
        times,
        position,
        turned,
        np.column_stack([rows[:, 3:5], nothing]),
        np.column_stack([nothing, nothing, rows[:, 5]]),
    )
