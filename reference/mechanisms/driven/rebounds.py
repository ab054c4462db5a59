"""Rebounds from a rigid stop that accumulate: infinitely many in a finite time, under a force that presses towards the stop.

The force is constant, or the rebounds are so short that its change is beyond the digits of the arithmetic. With accelerations
towards the stop a while the joint leaves it and b while it returns, which differ by dry friction, and the restitution e, each
velocity is r = e sqrt(b / a) times the one before. A rebound with the velocity v lasts v (1 / a + 1 / sqrt(a b)).
"""

from dataclasses import dataclass
from typing import Any

from bodycheck.reference.exact.numbers import Real
from bodycheck.reference.mechanisms.driven import modes
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


def accumulating(joint: DrivenJoint, z: State, side: int, left: Real) -> Rebounds | None:
    """The rebounds that follow from a state just after an impact, if they end within a time (s) and no other event interferes.

    side: of the stop. Returns None if there are no such rebounds, or if the force changes noticeably during them.
    """
    mp, plant, speed = joint.mp, joint.plant, abs(z[VELOCITY])
    resting = [*z]
    resting[VELOCITY] = mp.zero
    closed = modes.mode_of(joint, resting)
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
    if duration > left or not (_constant(joint, closed) or _negligible(joint, z, duration)):
        return None
    if len(modes.sides(joint)) == 2 and 2 * leaving * modes.width(joint) <= speed * speed:
        return None
    return Rebounds(modes.place_of(joint, side), side, speed, leaving, returning, ratio, duration)


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


def _constant(joint: DrivenJoint, closed: Mode) -> bool:
    """Return whether the force is the same in all states during the rebounds, but for dry friction."""
    steady = {ONE, joint.slots.get("held", ONE)}
    if joint.continuous is not None and (joint.continuous.no_load_speed is not None or not steady.issuperset(modes.law(joint))):
        return False
    return steady.issuperset(modes.pressing(joint, closed))


def _negligible(joint: DrivenJoint, z: State, duration: Real) -> bool:
    """Return whether the force changes by so little during the rebounds that the change is beyond half of the digits."""
    step = modes.system(joint, modes.mode_of(joint, z)).step
    return step is None or bool(duration <= step * joint.mp.mpf(10) ** (-(joint.mp.dps // 3)))
