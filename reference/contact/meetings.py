"""The impacts of two bodies on each other, and what bodies exchange in impacts, measured from sampled states.

The formulas are the same for the truth and for every engine.

Between impacts, the velocity of two free bodies relative to each other changes only by a plane. The samples between which it
changes by more, while the bodies are near each other, are a contact. Its instant is the one at which the straight lines on
which the centres move relative to each other, before and after, are nearest to each other. For rigid bodies in space it is
exact except for rounding.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.contact.impacts import ROUNDED, Impact, contacts_of
from bodycheck.reference.kinematics import dot
from bodycheck.reference.trajectory import Array, Trajectory


@dataclass(frozen=True)
class Meeting:
    """An impact of two bodies on each other.

    Attributes
    ----------
    time
        Its instant (s).
    start, end
        The instants (s) of the last sample before the contact and of the first sample after it.
    """

    time: float
    start: float
    end: float


def meetings(one: Trajectory, other: Trajectory, reach: float, unseen: float) -> tuple[Meeting, ...]:
    """The impacts of two bodies on each other, in ascending order of time.

    Parameters
    ----------
    one, other
        The states (n, ...) of the bodies.
    reach
        The distance of their centres at which they touch (m).
    unseen
        The largest change of their relative velocity that a plane can cause in a second (m/s^2).
    """
    t, apart, parting = one.t, other.position - one.position, other.velocity - one.velocity
    if len(t) < 2:
        return ()
    fastest = float(np.fmax.reduce(np.linalg.norm(np.concatenate([one.velocity, other.velocity]), axis=-1)))
    steps, changes = np.diff(t), np.linalg.norm(np.diff(parting, axis=0), axis=-1)
    off = ~(changes <= unseen * steps + ROUNDED * fastest) & _near(apart, parting, steps, reach)
    hits = []
    for first, last in contacts_of(off):
        if last < len(t) - 1 and not np.isnan(parting[last]).any():
            hits.append(Meeting(_nearest(t, apart, parting, first, last), float(t[first]), float(t[last])))
    return tuple(hits)


def _near(apart: Array, parting: Array, steps: Array, reach: float) -> NDArray[np.bool_]:
    """Return in which intervals (n - 1,) bodies are so near that they can touch."""
    gaps, speeds = np.linalg.norm(apart, axis=-1) - reach, np.linalg.norm(parting, axis=-1)
    return np.asarray(np.minimum(gaps[1:], gaps[:-1]) <= (speeds[1:] + speeds[:-1]) * steps)


def _nearest(t: Array, apart: Array, parting: Array, first: int, last: int) -> float:
    """The instant (s) at which the lines before the sample `first` and after the sample `last` are nearest to each other."""
    change = parting[last] - parting[first]
    beside = apart[last] - apart[first] - parting[last] * (t[last] - t[first])
    since = -float(beside @ change) / float(change @ change)
    return float(t[first] + np.clip(since, 0.0, t[last] - t[first]))


@dataclass(frozen=True)
class Exchange:
    """The energy and momentum that bodies exchange in an impact, relative to those that they have just before.

    Attributes
    ----------
    energy
        The change of their mechanical energy, relative to their kinetic energy.
    momentum
        (k, 3) the impulses on the k bodies, without those of gravity, relative to the sum of the sizes of their momenta.
    """

    energy: float
    momentum: Array


@dataclass(frozen=True, eq=False)
class Partner:
    """A body in an impact: mass (kg), inertia tensor (3, 3), states (n, ...), and the acceleration (3,) without the impact."""

    mass: float
    tensor: Array
    motion: Trajectory
    pull: Array


def exchange(partners: Sequence[Partner], hit: Meeting | Impact) -> Exchange:
    """The exchange of bodies in an impact, from the samples just before and after their contact.

    Energy and momentum without gravity do not change in a flight, so that both are those of the impact alone.
    """
    change, before, size, impulses = 0.0, 0.0, 0.0, []
    for partner in partners:
        motion, mass, pull = partner.motion, partner.mass, partner.pull
        first, last = (int(np.searchsorted(motion.t, time)) for time in (hit.start, hit.end))
        velocities, spins = motion.velocity[[first, last]], motion.angular_velocity[[first, last]]
        turning = dot(spins @ partner.tensor, spins) / 2
        arriving = velocities[0] + pull * (hit.time - hit.start)
        kinetic = mass * dot(velocities, velocities) / 2 + turning
        change += kinetic[1] - kinetic[0] - mass * float(pull @ (motion.position[last] - motion.position[first]))
        before += mass * float(arriving @ arriving) / 2 + turning[0]
        size += mass * float(np.linalg.norm(arriving))
        impulses.append(mass * (velocities[1] - velocities[0] - pull * (hit.end - hit.start)))
    return Exchange(float(change / (before or 1.0)), np.array(impulses) / (size or 1.0))
