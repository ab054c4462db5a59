"""The data that every way for touching bodies returns: states, their error bounds, and events."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import WideArray

#: What happens at an instant: bodies hit each other or the plane; a body that slips begins to roll; one that rolls or rests
#: begins to slip; one comes to rest; one that stands begins to tip.
EventKind = Literal["impact", "roll", "slip", "rest", "tip"]


@dataclass(frozen=True)
class Event:
    """An instant at which the motion of a body changes its kind.

    Attributes
    ----------
    kind
        What happens.
    time, error
        The instant, and the bound of its error (s).
    body
        The place of the body.
    position, velocity, spin
        Position (m) and velocity (m/s) of its centre of mass and its angular velocity (rad/s) just after, world frame.
    normal_speed
        Speed towards the plane just before an impact (m/s); 0 for anything else.
    """

    kind: EventKind
    time: float
    error: float
    body: int
    position: Vector
    velocity: Vector
    spin: Vector
    normal_speed: float = 0.0


@dataclass(frozen=True)
class Interface:
    """Two bodies, or a body and the plane (`WORLD`), by their places, and the normal force (N) between them while all rest."""

    bodies: tuple[int, int]
    load: float


@dataclass(frozen=True, eq=False)
class ContactMotion:
    """The motion of b bodies at n instants, along the axes of the plane.

    Attributes
    ----------
    position, velocity
        (b, n, 3) of the centres of mass (m, m/s). They, and all other states and bounds, are NaN where mechanics gives
        inequalities alone and no motion: there, no errors are computed.
    quaternion
        (b, n, 4) attitudes w, x, y, z, body to plane.
    spin
        (b, n, 3) angular velocities along the axes of the bodies (rad/s).
    errors
        (n,) bounds of the errors of these in any body, by the names of `bounds.STATES`, without the rounding to doubles.
    events
        What happens within the instants, ascending. Its vectors are along the axes of the plane.
    model, reason
        The equations that were solved, and why they are exact for the scene.
    friction
        The smallest coefficient with which nothing slips along a motion without slip; 0 where something slips, or where any
        does.
    interfaces
        Where bodies bear each other while all of them rest for the whole motion; empty where any moves.
    witness
        The independent solution that the bounds rely on; empty where there is none.
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


def known_at(motion: ContactMotion, known: NDArray[np.bool_]) -> ContactMotion:
    """A motion whose states and bounds are NaN at those of its instants (n,) at which it is not known."""
    states = motion.position, motion.velocity, motion.quaternion, motion.spin
    position, velocity, quaternion, spin = (np.where(known[:, None], rows, np.longdouble(math.nan)) for rows in states)
    errors = {name: np.where(known, bound, math.nan) for name, bound in motion.errors.items()}
    return replace(motion, position=position, velocity=velocity, quaternion=quaternion, spin=spin, errors=errors)
