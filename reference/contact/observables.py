"""Observables of bodies that touch: slip, the beginning of rolling, rest, depth, tilt, and the work of pushes.

They are computed from sampled states alone, with the same formulas for the truth and for every engine.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference import contact_observables
from bodycheck.reference.contact.impacts import Impact
from bodycheck.reference.contact.touching import Touching, into_plane, lowest
from bodycheck.reference.contact_observables import STOP_SPEED_FRACTION
from bodycheck.reference.kinematics import dot, rotate
from bodycheck.reference.scene import Brick, Cylinder, Push, Sphere
from bodycheck.reference.trajectory import Array, Trajectory


@dataclass(frozen=True)
class Rolling:
    """The instant at which a body begins to roll (s), and its velocity (3,) at this instant, world frame (m/s)."""

    time: float
    velocity: Array


def depth(body: Touching, motion: Trajectory) -> Array:
    """Depth (n,), m, of the lowest point of a body below the plane, along the normal; zero while it is above the plane."""
    return contact_observables.depth(body.shape, motion, body.normal)


def lean(body: Touching, motion: Trajectory) -> Array | None:
    """Angle (n,), rad, between the plane and the face of a body that is nearest to the plane; None for a body without faces."""
    down = into_plane(body, motion)
    match body.shape:
        case Brick():
            largest = np.abs(down).argmax(axis=-1)
        case Cylinder():
            largest = np.full(len(motion), 2)
        case _:
            return None
    cosine = np.abs(np.take_along_axis(down, largest[:, None], axis=-1)[:, 0])
    down[np.arange(len(motion)), largest] = 0.0
    return np.asarray(np.arctan2(np.sqrt(dot(down, down)), cosine))


def slip(body: Touching, motion: Trajectory) -> Array:
    """Speed (n,), m/s, along the plane, of the point of a body that is nearest to the plane."""
    normal = np.array(body.normal)
    spin = rotate(motion.quaternion, motion.angular_velocity)
    moved = motion.velocity + np.cross(spin, rotate(motion.quaternion, lowest(body, motion)))
    along = moved - (moved @ normal)[:, None] * normal
    return np.asarray(np.sqrt(dot(along, along)))


def rolling(body: Touching, motion: Trajectory, until: float) -> Rolling:
    """The instant at which a body that slips at t = 0 begins to roll; if it slips until `until` (s), the last instant before.

    The body rolls when its slip stays below `STOP_SPEED_FRACTION` of the initial slip. Friction reduces the slip at a constant
    rate, so the instant is extrapolated from the last two samples above this limit, and the velocity from the next two samples.
    """
    early = motion.part(motion.t <= until)
    t, slips = early.t, slip(body, early)
    last = _last(slips > STOP_SPEED_FRACTION * slips[0])
    time = _extrapolated(t, slips, last)
    first = min(last + 1, len(t) - 1)
    velocity = early.velocity[first]
    if first + 1 < len(t):
        velocity = velocity + (time - t[first]) * (early.velocity[first + 1] - velocity) / (t[first + 1] - t[first])
    return Rolling(time, velocity)


def rest(body: Touching, motion: Trajectory, struck: tuple[Impact, ...], gravity: float) -> float:
    """The instant (s) at which a body comes to rest; if it still moves at the last instant, the last instant.

    The body rests when the speed of its kinetic energy (see `_speeds`) stays below `STOP_SPEED_FRACTION` of the largest speed.
    A spin about the normal does not count for a sphere without torsional friction, since nothing brakes it. The instant is
    extrapolated from the last two
    samples above this limit, or from the last bounce that is seen; for a sliding body it is not later than the next sample. It
    is exact for a body that slides or bounces as a rigid body.
    """
    speeds = _speeds(body, motion)
    last = _last(speeds > STOP_SPEED_FRACTION * float(np.fmax.reduce(speeds)))
    if last == len(motion) - 1:
        return float(motion.t[-1])
    hits = [hit for hit in struck if hit.seen]
    fall = gravity * body.normal[2]
    if not hits or not fall or not hits[-1].after < hits[-1].before:
        return _extrapolated(motion.t, speeds, last)
    ratio = hits[-1].after / hits[-1].before
    settled = hits[-1].time + 2 * hits[-1].after / fall / (1 - ratio)
    # Bounces with speeds below the fraction continue for the remainder of the geometric series.
    slack = 2 * STOP_SPEED_FRACTION * float(np.fmax.reduce(speeds)) / fall / (1 - ratio)
    return float(np.clip(settled, motion.t[last], motion.t[last + 1] + slack))


def stays(body: Touching, motion: Trajectory, error: Array) -> NDArray[np.bool_]:
    """Return at which instants (n,) a body has finally ceased to move along the normal. error: (n,) of its velocity (m/s)."""
    still = np.abs(motion.velocity @ np.array(body.normal)) <= error
    return np.asarray(np.logical_and.accumulate(still[::-1])[::-1])


def rests(motion: Trajectory, error: Array) -> NDArray[np.bool_]:
    """Return at which instants (n,) the centre of mass has finally come to rest. error: (n,) of its velocity (m/s)."""
    still = np.sqrt(dot(motion.velocity, motion.velocity)) <= error
    return np.asarray(np.logical_and.accumulate(still[::-1])[::-1])


def crept(motion: Trajectory, body: Touching, start: float) -> float | None:
    """Return the mean speed (m/s) of the centre of mass along the plane from `start` (s) on; None for less than two samples."""
    later = np.flatnonzero(motion.t >= start)
    if len(later) < 2:
        return None
    way = motion.position[-1] - motion.position[later[0]]
    normal = np.array(body.normal)
    along = way - (way @ normal) * normal
    return float(np.linalg.norm(along)) / float(motion.t[-1] - motion.t[later[0]])


def work(push: Push, motion: Trajectory) -> Array:
    """Work (n,), J, that a push has done on a body up to each instant.

    It is the scalar product of the force and the displacement of its point of application.
    """
    arm = rotate(motion.quaternion, np.tile(np.array(push.point), (len(motion), 1)))
    spin = rotate(motion.quaternion, motion.angular_velocity)
    way = (motion.position + arm) @ np.array(push.force)
    rate = (motion.velocity + np.cross(spin, arm)) @ np.array(push.force)
    first, last = (_at(motion.t, way, rate, time) for time in (push.start, push.end))
    return np.where(motion.t <= push.start, 0.0, np.where(motion.t >= push.end, last, way) - first)


def _at(t: Array, values: Array, rates: Array, time: float) -> float:
    """A quantity at a time (s), from its values and rates (n,) at instants t (n,), s; beyond these its first or last value.

    It is exact if the second derivative is constant on either side of this time.
    """
    if time <= t[0] or len(t) == 1:
        return float(values[0])
    if time >= t[-1]:
        return float(values[-1])
    index = int(np.searchsorted(t, time, side="right")) - 1
    before, after, step = time - t[index], t[index + 1] - time, t[index + 1] - t[index]
    bent = (rates[index + 1] - rates[index]) * before * after / (2 * step)
    return float(values[index] + (values[index + 1] - values[index]) * before / step - bent)


def _speeds(body: Touching, motion: Trajectory) -> Array:
    """The speed (n,), m/s, at which a body would have its kinetic energy without rotation.

    The spin of a sphere about the normal does not count if nothing brakes it.
    """
    turning = motion.angular_velocity
    if isinstance(body.shape, Sphere) and body.pivots_freely:
        down = into_plane(body, motion)
        turning = turning - dot(turning, down)[:, None] * down
    return np.asarray(np.sqrt(dot(motion.velocity, motion.velocity) + dot(turning @ body.tensor, turning) / body.mass))


def _last(moving: NDArray[np.bool_]) -> int:
    """The index of the last sample that is true; -1 if none is true."""
    indices = np.flatnonzero(moving)
    return int(indices[-1]) if len(indices) else -1


def _extrapolated(t: Array, speeds: Array, last: int) -> float:
    """The instant (s) at which speeds (n,) that decrease linearly reach zero, at most that of the sample after `last`.

    last: index of the last sample that moves.
    """
    index = min(last + 1, len(t) - 1)
    time = float(t[index])
    if 0 < last < len(t) - 1 and speeds[last - 1] > speeds[last]:
        slowing = (speeds[last - 1] - speeds[last]) / (t[last] - t[last - 1])
        time = min(float(t[last] + speeds[last] / slowing), time)
    return time if math.isfinite(time) else float(t[index])
