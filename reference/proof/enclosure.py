"""The result of the proof of a printed motion, or the reason why there is none. This module needs no ball arithmetic."""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.trajectory import Array

#: The quantities of a body in which a proof states distances, by the names of the bounds of truths.
QUANTITIES = ("error", "position_error", "velocity_error", "angular_velocity_error")

#: The quantities of all bodies together, which the states have: energy (J) and angular momentum (kg m^2/s).
CONSERVED = ("energy_error", "angular_momentum_error")

#: The quantities of the coordinates of joints: a coordinate (rad or m) and its velocity.
COORDINATES = ("joint_position_error", "joint_velocity_error")


@dataclass(frozen=True)
class Interval:
    """The kind of an event, the index of its body, and the interval in which its instant is (s)."""

    kind: str
    body: int
    begin: float
    end: float

    def distance(self, time: float) -> float:
        """The smallest distance of a time from the instant (s)."""
        return max(self.begin - time, time - self.end, 0.0)


@dataclass(frozen=True, eq=False)
class Enclosure:
    """A proof of how far the printed states of a motion are from the exact states.

    Attributes
    ----------
    way
        The method of the proof.
    bits
        The precision of its arithmetic.
    radius
        The largest radius of a ball (rad, m, rad/s or m/s).
    farthest, nearest
        Upper and lower bounds (n,) of the distances of the printed states from the exact ones, by the names of `QUANTITIES` and
        `CONSERVED`, and (n, c) by those of `COORDINATES` for joints.
    until
        The instant (s) up to which the motion is enclosed; the distances at later instants are NaN. None if all is.
    reason
        Why it ends there, as a noun phrase; empty if all is enclosed.
    seconds
        The processor time of the proof (s).
    events
        The events until then, in ascending order of time; None if the proof has none of them.
    """

    way: str
    bits: int
    radius: float
    farthest: dict[str, Array]
    nearest: dict[str, Array]
    until: float | None
    reason: str
    seconds: float
    events: tuple[Interval, ...] | None = None

    @property
    def distance(self) -> float:
        """The largest distance (rad) of a printed attitude from the exact one."""
        return float(np.nanmax(self.farthest["error"], initial=0.0))


class NotEnclosed(Exception):
    """There is no enclosure of a motion; the text says why, as a noun phrase."""
