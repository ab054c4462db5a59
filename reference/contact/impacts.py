"""The impacts of bodies on a plane, measured from sampled states by the same formulas for the truth and for every engine.

Between contacts the centre of mass flies along an arc that depends on gravity and constant pushes alone. Two samples belong to
the same arc if the velocity along the normal changes between them by exactly the effect of these forces. The samples between
two arcs are a contact. It is an impact if the body approaches the plane before it, and its instant is the instant at which the
arcs before and after meet. For a rigid body this instant is exact except for rounding, wherever the samples are. A soft contact
lasts for some time, which contains its instant.

An arc after an impact is seen if two samples lie on it. A shorter flight cannot be distinguished from a contact.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.contact.touching import Touching, lowest
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.scene import Push, Sphere
from bodycheck.reference.trajectory import Array, Trajectory

#: The largest difference of a change of velocity from the change along an arc, relative to the latter, and to the largest
#: speed. In engines the changes are equal except for rounding, which may be that of single precision.
ON_ARC, ROUNDED = 1e-3, 1e-6

#: The fraction of the speed before an impact below which a body no longer counts as approaching the plane.
STILL = 1e-3


@dataclass(frozen=True)
class Impact:
    """An impact of a body on the plane.

    Attributes
    ----------
    time
        The instant at which the arcs before and after meet; if no arc is seen after it, the instant at which the body touches
        the plane (s).
    start, end
        The instants (s) of the last sample before the contact and of the first sample after it; if no arc is seen after it, of
        the first sample at which the body no longer approaches the plane.
    before
        Speed towards the plane just before (m/s).
    after
        Speed away from the plane just after (m/s); NaN if no arc is seen after it.
    velocity
        (3,) velocity just after, world frame (m/s); if no arc is seen after it, the velocity at `end`.
    shortest
        The shortest flight after the impact that would have been seen (s); NaN if an arc is seen.
    """

    time: float
    start: float
    end: float
    before: float
    after: float
    velocity: Array
    shortest: float

    @property
    def seen(self) -> bool:
        """True if an arc is seen after it."""
        return not math.isnan(self.after)


def impacts(body: Touching, motion: Trajectory, gravity: float, pushes: tuple[Push, ...]) -> tuple[Impact, ...]:
    """The impacts of a body on the plane, in ascending order of time.

    Parameters
    ----------
    body
        The body.
    motion
        The states (n, ...) of the body.
    gravity
        Gravitational acceleration, along -z (m/s^2).
    pushes
        The forces on the body.
    """
    if len(motion) < 2:
        return ()
    normal = np.array(body.normal)
    pulls = _accelerations(motion.t, gravity, pushes, body.mass)
    speeds, along, steps = motion.velocity @ normal, pulls @ normal, np.diff(motion.t)
    fastest = float(np.fmax.reduce(np.linalg.norm(motion.velocity, axis=-1)))
    allowed = ON_ARC * np.abs(along) * steps + ROUNDED * fastest
    off = ~(np.abs(np.diff(speeds) - along * steps) <= allowed)
    hits = []
    for first, last in contacts_of(off):
        seen = last < len(motion) - 1
        hit = _impact(body, motion, pulls, first, last, seen)
        if hit.before > ROUNDED * fastest + ON_ARC * abs(along[first]) * steps[first]:
            hits.append(hit)
    return tuple(hits)


def _accelerations(times: Array, gravity: float, pushes: tuple[Push, ...], mass: float) -> Array:
    """The accelerations (n - 1, 3), m/s^2, of a body that flies, in the middles of the intervals between times (n,), s."""
    accelerations = np.zeros((len(times) - 1, 3))
    accelerations[:, 2] = -gravity
    middles = (times[1:] + times[:-1]) / 2
    for push in pushes:
        accelerations[(push.start <= middles) & (middles < push.end)] += np.array(push.force) / mass
    return accelerations


def contacts_of(off: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """Yield the indices of the first and the last sample of each contact. off: (n - 1,) whether each interval is on no arc."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], off, [False]]).astype(int)))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        yield int(first), int(last)


def _impact(body: Touching, motion: Trajectory, pulls: Array, first: int, last: int, seen: bool) -> Impact:
    """The impact in the contact between the samples `first` and `last`.

    pulls: (n - 1, 3) accelerations in flight (m/s^2). seen: whether there are samples on an arc after the contact.
    """
    normal, t = np.array(body.normal), motion.t
    height, speed = motion.position @ normal, motion.velocity @ normal
    pull = pulls[max(first - 1, 0)]
    fall = float(pull @ normal)
    if seen:
        length = t[last] - t[first]
        closing = float(speed[first] - speed[last] + fall * length)
        since = float(height[last] - height[first] - speed[last] * length + fall * length**2 / 2) / (closing or math.nan)
        before, after = -float(speed[first] + fall * since), float(speed[last] + fall * (since - length))
        slack = float(t[first + 1] - t[first])
        if -slack <= since <= length + slack and (after > 0 or not isinstance(body.shape, Sphere)):
            velocity = motion.velocity[last] + pull * (since - length)
            return Impact(float(t[first] + since), float(t[first]), float(t[last]), before, after, velocity, math.nan)
    since = _touch(body, motion.part(slice(first, first + 1)), fall)
    before = -float(speed[first] + fall * since)
    turned = np.flatnonzero(speed[first + 1 :] >= -STILL * before)
    later = first + 1 + int(turned[0]) if len(turned) else len(t) - 1
    shortest = 2 * float(np.diff(t[first:])[:3].max())
    return Impact(float(t[first] + since), float(t[first]), float(t[later]), before, math.nan, motion.velocity[later], shortest)


def _touch(body: Touching, motion: Trajectory, fall: float) -> float:
    """Return the time (s) from a sample (1, ...) to the touch of the plane, if the lowest point of the body stays the same.

    fall: acceleration of its centre of mass along the normal (m/s^2).
    """
    normal = np.array(body.normal)
    arm, spin = (rotate(motion.quaternion, each)[0] for each in (lowest(body, motion), motion.angular_velocity))
    gap = float((motion.position[0] + arm) @ normal)
    speed = float((motion.velocity[0] + np.cross(spin, arm)) @ normal)
    bend = fall + float(np.cross(spin, np.cross(spin, arm)) @ normal) if not isinstance(body.shape, Sphere) else fall
    closing = math.sqrt(max(speed**2 - 2 * bend * gap, 0.0)) - speed
    return 2 * gap / closing if closing > 0 else 0.0
