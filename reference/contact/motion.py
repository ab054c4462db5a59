"""The data that every way for touching bodies returns: states, their error bounds, and events."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.mechanisms.mechanism import WORLD
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import Instant, WideArray

#: The kind of an event: bodies hit each other or the plane, or a further part of a body that touches the plane hits it; a body
#: that slips begins to roll; a body that rolls or rests begins to slip, or the plane would have to pull it; a body comes to
#: rest; a body that stands begins to tip. A body between fingers begins to slip on them, comes to rest on them, or begins to
#: turn about them.
EventKind = Literal["impact", "roll", "slip", "rest", "tip", "turn"]


@dataclass(frozen=True)
class Event:
    """An instant at which the motion of a body changes its kind.

    Attributes
    ----------
    kind
        The kind of the event.
    time, error
        The instant, and the bound of its error (s).
    body
        The index of the body.
    position, velocity, spin
        Position (m) and velocity (m/s) of its centre of mass and its angular velocity (rad/s) just after, world frame.
    normal_speed
        Speed (m/s) of the centre of mass towards the plane just before an impact that ends a flight, or towards the centre of
        another body that it hits; 0 for any other event.
    other
        In an impact, the index of what the body hits: another body, or `WORLD` for the plane.
    """

    kind: EventKind
    time: float
    error: float
    body: int
    position: Vector
    velocity: Vector
    spin: Vector
    normal_speed: float = 0.0
    other: int = WORLD

    @property
    def ends_flight(self) -> bool:
        """Return whether the event is an impact on the plane of a body that did not touch anything before."""
        return self.kind == "impact" and self.normal_speed > 0 and self.other == WORLD


@dataclass(frozen=True)
class Interface:
    """The indices of two bodies, or of a body and the plane (`WORLD`), and the normal force (N) between them at rest."""

    bodies: tuple[int, int]
    load: float


@dataclass(frozen=True, eq=False)
class ContactMotion:
    """The motion of b bodies at n instants, along the axes of the plane.

    Attributes
    ----------
    position, velocity
        (b, n, 3) position (m) and velocity (m/s) of the centres of mass. These and all other states and bounds are NaN at
        instants at which mechanics determines only inequalities: no errors are computed there.
    quaternion
        (b, n, 4) attitudes w, x, y, z, body to plane.
    spin
        (b, n, 3) angular velocities along the axes of the bodies (rad/s).
    errors
        (n,) bounds of the errors of the states of any body, by the names of `bounds.STATES`, without the rounding to doubles.
    events
        The events until the last instant, in ascending order of time. Their vectors are along the axes of the plane.
    model, reason
        The equations that were solved, and the reason why they are exact for the scene.
    friction
        The smallest coefficient of friction with which nothing slips along a motion without slip; 0 if something slips, or if
        any coefficient suffices.
    interfaces
        The loads between bodies if all of them rest for the whole motion; empty if any body moves.
    witness
        The independent solution on which the bounds rely; empty if there is none.
    end
        The instant from which on the motion is not known, of the kind `END`, if it is not that of an event.
    """

    position: WideArray
    velocity: WideArray
    quaternion: WideArray
    spin: WideArray
    errors: Mapping[str, Array]
    events: tuple[Event, ...]
    model: str
    reason: str
    friction: float = 0.0
    interfaces: tuple[Interface, ...] = ()
    witness: str = ""
    end: Instant | None = None


def known_at(motion: ContactMotion, known: NDArray[np.bool_]) -> ContactMotion:
    """A motion with NaN for its states and bounds at the instants at which it is not known. known: (n,)."""
    states = motion.position, motion.velocity, motion.quaternion, motion.spin
    position, velocity, quaternion, spin = (np.where(known[:, None], rows, np.longdouble(math.nan)) for rows in states)
    errors = {name: np.where(known, bound, math.nan) for name, bound in motion.errors.items()}
    return replace(motion, position=position, velocity=velocity, quaternion=quaternion, spin=spin, errors=errors)
