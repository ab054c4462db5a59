"""Rebounds from a rigid stop that accumulate: infinitely many in a finite time, under a force that presses towards the stop.

The force is constant, or the rebounds are so short that its change is beyond the digits of the arithmetic. With accelerations
towards the stop a while the joint leaves it and b while it returns, which differ by dry friction, and the restitution e, each
velocity is r = e sqrt(b / a) times the one before. A rebound with the velocity v lasts v (1 / a + 1 / sqrt(a b)).
"""

from dataclasses import dataclass
from typing import Any

from bodycheck.reference.exact.numbers import Real
from bodycheck.reference.mechanisms.driven import modes
from bodycheck.reference.mechanisms.driven.decisions import mode_of
from bodycheck.reference.mechanisms.driven.linear import State, value
from bodycheck.reference.mechanisms.driven.modes import ONE, VELOCITY, DrivenJoint, Mode


@dataclass(frozen=True, eq=False)
class Rebounds:
    """Rebounds that accumulate.

    Attributes
    ----------
    stop, side
        The coordinate of the stop (rad or m), and 1 for an upper and -1 for a lower stop.
    speed
        The speed after the first impact (rad/s or m/s).
    leaving, returning
        The accelerations a and b (rad/s^2 or m/s^2).
    ratio, duration
        The ratio r of successive speeds, and the duration of all rebounds (s).
    """

    stop: Real
    side: int
    speed: Real
    leaving: Real
    returning: Real
    ratio: Real
    duration: Real

    @property
    def arc(self) -> Real:
        """The duration of the first rebound (s)."""
        return self.duration * (1 - self.ratio)


def rebounds_of(joint: DrivenJoint, z: State, side: int) -> Rebounds | None:
    """The rebounds from a state just after an impact at the stop of a side, as if the force stayed as it is.

    Returns None if these do not accumulate.
    """
    mp, plant, speed = joint.mp, joint.plant, abs(z[VELOCITY])
    resting = _resting(z)
    closed = mode_of(joint, resting)
    if not speed or closed.contact != "closed":
        return None
    pressed = side * value(mp, modes.pressing(joint, closed), resting)
    leaving, returning = (pressed + plant.friction) / plant.inertia, (pressed - plant.friction) / plant.inertia
    if returning <= 0:
        return None
    ratio = mp.mpf(modes.stops_of(joint).restitution) * mp.sqrt(returning / leaving)
    if ratio >= 1:
        return None
    duration = speed * (1 / leaving + 1 / mp.sqrt(leaving * returning)) / (1 - ratio)
    return Rebounds(modes.place_of(joint, side), side, speed, leaving, returning, ratio, duration)


def accumulate(joint: DrivenJoint, z: State, series: Rebounds, left: Real) -> bool:
    """Return whether rebounds end within a time (s), under a force that stays as it is, before any other event.

    z: the state just after the first impact.
    """
    if series.duration > left:
        return False
    if len(modes.sides(joint)) == 2 and 2 * series.leaving * modes.width(joint) <= series.speed**2:
        return False
    return _constant(joint, mode_of(joint, _resting(z))) or _negligible(joint, z, series.duration)


def before(mp: Any, series: Rebounds, elapsed: Real) -> tuple[Real, Real, Real]:
    """The start of the arc in which an instant during rebounds lies: its time, coordinate and velocity.

    elapsed: the time since the first impact (s), less than the duration. An arc ends where the velocity becomes zero, or at the
    next impact.
    """
    count = max(0, int(mp.floor(mp.log(1 - elapsed / series.duration) / mp.log(series.ratio))))
    begun = series.duration * (1 - series.ratio**count)
    speed = series.speed * series.ratio**count
    rising = speed / series.leaving
    if elapsed <= begun + rising:
        return begun, series.stop, -series.side * speed
    return begun + rising, series.stop - series.side * speed * rising / 2, mp.zero


def _resting(z: State) -> list[Real]:
    resting = [*z]
    resting[VELOCITY] = z[VELOCITY] - z[VELOCITY]
    return resting


def _constant(joint: DrivenJoint, closed: Mode) -> bool:
    """Return whether the force is the same in all states during the rebounds, but for dry friction."""
    steady = {ONE, joint.slots.get("held", ONE)}
    if joint.continuous is not None and (joint.continuous.no_load_speed is not None or not steady.issuperset(modes.law(joint))):
        return False
    return steady.issuperset(modes.pressing(joint, closed))


def _negligible(joint: DrivenJoint, z: State, duration: Real) -> bool:
    """Return whether the force changes by so little during the rebounds that the change is beyond half of the digits."""
    step = modes.phase_of(joint, mode_of(joint, z)).linear.step
    return step is None or bool(duration <= step * joint.mp.mpf(10) ** (-(joint.mp.dps // 3)))
