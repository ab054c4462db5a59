"""The motion of a gripped body along a line as phases between events: it is held, or slips on its fingers.

The body, of mass m, and the carriage with the fingers, of mass M, obey m x'' = m g + f and M s'' = M g + F - f. Held, both
have one acceleration, and the contacts bear the load f = m F/(m + M), or -m g if the fingers are on the world. The body is
held while |f| is at most the bearing of the contacts. Slipping along sigma, f = -2 sigma mu N. All forces are polynomials of
the time and sines, and so are all motions within a phase.
"""

import bisect
from dataclasses import dataclass, replace

from bodycheck.reference.contact.gripping.grip import Grip
from bodycheck.reference.contact.gripping.waves import Wave, breaks, constant, first_negative, piece_at
from bodycheck.reference.contact.motion import EventKind
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.exact.numbers import MP, Real

#: The time, relative to the length of a piece of the forces, within which a body that is not held at once begins to slip.
AT_ONCE = MP.mpf(10) ** -30

#: The largest number of phases of a motion, and the largest angle (rad) by which a sine advances, which take a minute.
MOST_PHASES, MOST_ANGLE = 20_000, 20_000


@dataclass(frozen=True, eq=False)
class Phase:
    """A part of a motion, with functions of the time since its start.

    Attributes
    ----------
    start
        The time at which it begins (s).
    body, carriage
        The displacements (m) along d, since t = 0, of the body and of the carriage.
    slips
        The sign of the slip of the body along d; 0 while it is held.
    """

    start: Real
    body: Wave
    carriage: Wave
    slips: int


@dataclass(frozen=True, eq=False)
class Change:
    """An event: its kind, its time (s), the position of the body along d (m) and its speed (m/s)."""

    kind: EventKind
    time: Real
    position: Real
    speed: Real


@dataclass(frozen=True, eq=False)
class Course:
    """The phases and events of a motion, and the times (s) at which the body begins to turn, and from which on its motion is
    not known; None if it does not turn, or is known until the end.
    """

    phases: list[Phase]
    changes: list[Change]
    turns_at: Real | None = None
    ends_at: Real | None = None


@dataclass(frozen=True, eq=False)
class _Now:
    """The state at the start of a phase: its time (s), and displacement (m) and speed (m/s) along d of body and carriage."""

    time: Real
    body: tuple[Real, Real]
    carriage: tuple[Real, Real]

    @property
    def slips(self) -> int:
        """The sign of the speed of the body relative to its fingers."""
        return int(MP.sign(self.body[1] - self.carriage[1]))


@dataclass(frozen=True, eq=False)
class _Forces:
    """The press of a finger and the effort on the carriage (N), as functions of the time since the start of a phase."""

    press: Wave
    effort: Wave


def course(grip: Grip, last: Real) -> Course:
    """Return the motion until a time (s), until the body turns, or until it is no longer known.

    It is not known from the time on at which the fingers open, the body slips out of them, or it slips and turns at once.
    Raises `NotModelled` if this is so from the start on.
    """
    whole = Course([], [])
    now = _Now(MP.zero, (MP.zero, grip.speed), (MP.zero, grip.carried))
    edges = breaks((grip.press, grip.effort), last)
    fastest = max((abs(w) for pieces in (grip.press, grip.effort) for _, wave in pieces for _, w, _ in wave.sines), default=0)
    if fastest * last > MOST_ANGLE:
        raise OutOfReach(f"a force on fingers with more than {MOST_ANGLE / 6.28:.0f} periods")
    held = not now.slips
    for _ in range(MOST_PHASES):
        following = bisect.bisect_right(edges, now.time)
        until = (edges[following] if following < len(edges) else last) - now.time
        forces = _Forces(*(piece_at(pieces, now.time).from_time(now.time) for pieces in (grip.press, grip.effort)))
        opens = first_negative(forces.press, until)
        if opens is not None and opens <= AT_ONCE * until:
            return _ended(whole, now.time, "fingers that open")
        slips = now.slips or _yields(grip, forces, until)
        if slips and (reason := _unknown(grip, now)):
            return _ended(whole, now.time, reason)
        phase = _phase(grip, now, forces, 0 if grip.turns else slips)
        whole.phases.append(phase)
        if slips and grip.turns:
            return replace(whole, turns_at=now.time)
        if now.time and held != (not slips):
            whole.changes.append(Change("slip" if slips else "rest", now.time, *now.body))
        held = not slips
        until = until if opens is None else opens
        ending = _ending(grip, phase, forces, until)
        lasting = until if ending is None else ending
        leaves = _leaves(grip, phase, lasting)
        if leaves is not None:
            return _ended(whole, phase.start + leaves, "a body that slips out of its fingers")
        if opens is not None and ending is None:
            return _ended(whole, phase.start + opens, "fingers that open")
        now = _after(phase, lasting, stopped=bool(slips) and ending is not None)
        if now.time >= last:
            return whole
    raise OutOfReach(f"a gripped body with more than {MOST_PHASES} changes of its motion")


def _ended(whole: Course, time: Real, reason: str) -> Course:
    """Return a motion that is known until a time (s). Raises `NotModelled`, with a reason, if it is not known at all."""
    if not time:
        raise NotModelled(reason)
    return replace(whole, ends_at=time)


def _unknown(grip: Grip, now: _Now) -> str:
    """Return why the motion of a body that slips or turns is not known; empty if it is."""
    if not any(grip.reach):
        return "a sphere that slips between two spheres"
    if not grip.turns:
        return ""
    if grip.one:
        return "a body that slips and turns between fingers, as both share one limit"
    if grip.carriage is not None:
        return "a body that turns between fingers on a carriage"
    return "a body that slips and turns between fingers at the start" if now.slips else ""


def _load(grip: Grip, forces: _Forces) -> Wave:
    """The force along d (N) that the contacts exert on a body that is held."""
    if grip.carriage is None:
        return constant(-grip.mass * grip.gravity)
    return forces.effort.times(grip.mass / (grip.mass + grip.borne))


def _margins(grip: Grip, forces: _Forces) -> tuple[Wave, Wave]:
    """The excess (N) of what the contacts of a held body bear over its load, along d and opposite to d."""
    bearing, load = forces.press.times(grip.bearing), _load(grip, forces)
    return bearing.plus(load.times(MP.mpf(-1))), bearing.plus(load)


def _yields(grip: Grip, forces: _Forces, until: Real) -> int:
    """Return the sign along d of the slip that begins at once; 0 if the body is held."""
    for sign, margin in zip((-1, 1), _margins(grip, forces), strict=True):
        ending = first_negative(margin, until)
        if ending is not None and ending <= AT_ONCE * until:
            return sign
    return 0


def _phase(grip: Grip, now: _Now, forces: _Forces, slips: int) -> Phase:
    """Return the phase that begins now."""
    gravity = constant(grip.gravity)
    friction = forces.press.times(-2 * slips * grip.friction)
    standing = grip.carriage is None
    if slips:
        body = friction.times(1 / grip.mass).plus(gravity)
        pulled = forces.effort.plus(friction.times(MP.mpf(-1)))
        carriage = constant(MP.zero) if standing else pulled.times(1 / grip.borne).plus(gravity)
    else:
        carriage = constant(MP.zero) if standing else forces.effort.times(1 / (grip.mass + grip.borne)).plus(gravity)
        body = carriage
    moved = [rate.summed(speed).summed(position) for rate, (position, speed) in ((body, now.body), (carriage, now.carriage))]
    return Phase(now.time, moved[0], moved[1], slips)


def _ending(grip: Grip, phase: Phase, forces: _Forces, until: Real) -> Real | None:
    """Return the time (s) after which a body begins to slip or ceases to; None if it does not before `until` (s)."""
    if phase.slips:
        slip = phase.body.plus(phase.carriage.times(MP.mpf(-1))).rate()
        return first_negative(slip.times(MP.mpf(phase.slips)), until)
    endings = [first_negative(margin, until) for margin in _margins(grip, forces)]
    return min((ending for ending in endings if ending is not None), default=None)


def _leaves(grip: Grip, phase: Phase, lasting: Real) -> Real | None:
    """Return the time (s), of a phase that lasts so long, after which a contact leaves a face; None if none does."""
    if not phase.slips:
        return None
    slid = phase.body.plus(phase.carriage.times(MP.mpf(-1)))
    left = [
        first_negative(slid.times(MP.mpf(-sign)).plus(constant(sign * end)), lasting)
        for sign, end in zip((-1, 1), grip.reach, strict=True)
        if not MP.isinf(end)
    ]
    return min((time for time in left if time is not None), default=None)


def _after(phase: Phase, lasting: Real, *, stopped: bool) -> _Now:
    """Return the state a time (s) after the start of a phase. stopped: whether the slip has just ended."""
    body, carriage = ((wave.at(lasting), wave.rate().at(lasting)) for wave in (phase.body, phase.carriage))
    if stopped or not phase.slips:
        body = body[0], carriage[1]
    return _Now(phase.start + lasting, body, carriage)
