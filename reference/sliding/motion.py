"""The flat body that slides and spins on a plane with Coulomb friction, until it stops [G, Example 2.2, corrected].

Three coordinates, x, y and the yaw psi. A straight slide and a pure spin, and everything under the book's decoupled law, have
closed forms; a body that slides and spins at once is solved twice, in log time and in plain time.
"""

import math
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.errors import NotFlat, WouldTip
from bodycheck.reference.kinematics import multiply
from bodycheck.reference.planar import Stop, planar_state
from bodycheck.reference.scene import Plane, Scene
from bodycheck.reference.sliding.coupled_motion import Flat, Motion, in_log_time, in_plain_time
from bodycheck.reference.sliding.footprint import nearness
from bodycheck.reference.sliding.friction import Law, decoupled_friction, footprint_of, friction, refuse_tipping
from bodycheck.reference.trajectory import Array, Trajectory

EPS = float(np.finfo(float).eps)

#: Relative error of some ten roundings in double precision: those of a closed form, and of a stored result.
RELATIVE_ROUNDING = 16 * EPS


@dataclass(frozen=True, eq=False)
class Slide:
    """A slide and how far it can be trusted.

    stop: None for a body that still moves at the last instant. error, position_error: (n,) bounds of the errors of the yaw
    (rad) and of the position (m), never decreasing. model: the equations, and reason: why they are enough.
    """

    trajectory: Trajectory
    stop: Stop | None
    error: Array
    position_error: Array
    model: str
    reason: str


def slide(scene: Scene, times: Array) -> Slide:
    """The motion of a flat body on the scene's plane at ascending times (n,) >= 0 s; drag is not looked at.

    The bound of a closed form is that of its roundings. Otherwise it is twice the largest disagreement so far between two
    formulations, and those roundings.

    Raises `NotFlat` for a body that does not lie flat on the plane or has no face to lie on, `WouldTip` where a balanced load
    would have to pull, and `OutOfReach` for a slide that cannot be followed: too long, or with one corner that comes to rest
    before the others. `ValueError` for a balanced load under the decoupled law, in which the place of the load has no meaning.
    """
    if scene.plane is None:
        raise NotFlat("the scene has no plane to lie on")
    plane, start = scene.plane, planar_state(scene)
    if plane.law != "decoupled" and start[3:5].any() and start[5] and plane.friction * scene.gravity > 0:
        motion, witness = coupled(scene, plane, start, times)
        apart = np.abs(motion.rows[:, :3] - witness.rows[:, :3])
        position_error = 2 * np.maximum.accumulate(np.hypot(apart[:, 0], apart[:, 1]))
        error = 2 * np.maximum.accumulate(apart[:, 2])
        equations = "Euler-Lagrange"
    else:
        motion = in_closed_form(scene, plane, start, times)
        position_error = error = np.zeros(len(times))
        equations = "closed form"
    x, y, yaw = np.abs(motion.rows[:, :3] - start[:3]).T
    error = error + RELATIVE_ROUNDING * np.maximum.accumulate(1 + yaw)
    position_error = position_error + RELATIVE_ROUNDING * np.maximum.accumulate(np.abs(start[:2]).sum() + x + y)
    stop = None
    if motion.stop is not None:
        time, to_x, to_y, to_yaw = motion.stop.tolist()
        stop = Stop(time, (to_x, to_y, scene.initial.position[2]), to_yaw)
    model = f"{equations}, {plane.law} friction, {plane.pressure} load"
    trajectory = in_space(scene, times, motion.rows, start[2])
    return Slide(trajectory, stop, error, position_error, model, why(plane, scene.gravity, start))


def why(plane: Plane, gravity: float, start: Array) -> str:
    """Why x, y and yaw, and the equations chosen for them, are enough; start: as `planar_state` has it."""
    moves, spins = bool(start[3:5].any()), bool(start[5])
    if moves and spins and plane.friction * gravity:
        apart = plane.law == "decoupled"
        motion = "its law of friction has translation and spin apart" if apart else "it slides and spins at once"
    elif moves and spins:
        motion = "nothing brakes it"
    else:
        motion = "it slides without a spin" if moves else "it spins in its place" if spins else "it is at rest"
    return f"it lies flat, and {motion}"


def smallest_friction(scene: Scene, plane: Plane) -> tuple[Law, bool]:
    """The smallest law of friction that is exact for a body that lies flat, and whether it brakes translation and spin apart.

    In a straight slide friction has no moment and in a pure spin no resultant, under every law and load: the motion stays what
    it is, and the one part of friction that there is keeps its size. Raises as `planar_state` does.
    """
    start = planar_state(scene)
    if plane.law == "decoupled" or not (start[3:5].any() and start[5]):
        footprint = footprint_of(scene.body.shape, plane.law)
        return decoupled_friction(footprint, plane.friction, scene.body.mass * scene.gravity), True
    return friction(scene.body, plane, scene.gravity), False


def coupled(scene: Scene, plane: Plane, start: Array, times: Array) -> tuple[Motion, Motion]:
    """The motion by both formulations."""
    body, gravity = scene.body, scene.gravity
    refuse = refuse_tipping(body, plane, gravity)

    def reached(time: float, v1: float, v2: float, w: float) -> None:
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
    return in_log_time(flat, start, times, reached), in_plain_time(flat, start, times)


def in_closed_form(scene: Scene, plane: Plane, start: Array, times: Array) -> Motion:
    """Translation and spin each with a deceleration of its own, mu g and |torque|/C, and at rest after it; no friction is 0.

    True of a straight slide, in which friction has no moment, of a pure spin, in which it has no resultant, and by
    definition of the decoupled law. The stop is the later of the two.
    """
    law = friction(scene.body, plane, scene.gravity)
    speed, spin = math.hypot(*start[3:5]), float(start[5])
    refuse_tipping(scene.body, plane, scene.gravity)(float(start[3]), float(start[4]), spin)
    ends = (
        stopping_time(speed, plane.friction * scene.gravity),
        stopping_time(abs(spin), abs(law(0.0, 0.0, spin)[2]) / scene.body.moments[2]),
    )

    def rows(at: Array) -> Array:
        (way, slowing), (turn, braking) = (braked(end, at) for end in ends)
        ways, fractions = np.column_stack([way, way, turn]), np.column_stack([slowing, slowing, braking])
        return np.concatenate([start[:3] + start[3:] * ways, start[3:] * fractions], axis=1)

    end = max(ends)
    stop = np.array([end, *rows(np.array([end]))[0, :3]]) if len(times) and end <= times[-1] else None
    return Motion(rows(times), stop)


def stopping_time(rate: float, deceleration: float) -> float:
    """Time (s) in which a rate >= 0 is lost: none at rest, for ever without deceleration."""
    if rate == 0:
        return 0.0
    return rate / deceleration if deceleration else math.inf


def braked(end: float, at: Array) -> tuple[Array, Array]:
    """Way over the initial rate (k,), s, and fraction of the rate that is left (k,), at times (k,) of an even slowing down
    that ends at a time (s)."""
    if end == 0:
        return np.zeros_like(at), np.zeros_like(at)
    now = np.minimum(at, end)
    return now * (1 - now / (2 * end)), 1 - now / end


def in_space(scene: Scene, times: Array, rows: Array, yaw: float) -> Trajectory:
    """The trajectory of a planar motion: rows (n, 6), and the yaw (rad) of the initial attitude."""
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
