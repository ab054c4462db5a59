"""The motion of a gripped body along a line as phases between events: it is held, or slips on its fingers.

The body, of mass m, and the carriage with the fingers, of mass M, obey m x'' = m g + f and M s'' = M g + F - f. Held, both
have one acceleration, and the contacts bear the load f = m F/(m + M), or -m g if the fingers are on the world. The body is
held while |f| is at most the bearing of the contacts. Slipping along sigma, f = -2 sigma mu N. All forces are polynomials of
the time and sines, and so are all motions within a phase.
"""

from dataclasses import dataclass

from bodycheck.reference.contact.gripping.grip import Grip
from bodycheck.reference.contact.gripping.waves import Wave, breaks, constant, first_negative, piece_at
from bodycheck.reference.contact.motion import EventKind
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.exact.numbers import MP, Real

#: The time, relative to the length of a piece of the forces, within which a body that is not held at once begins to slip.
AT_ONCE = MP.mpf(10) ** -30

#: The largest number of phases of a motion.
MOST_PHASES = 20_000


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
    """An event: its kind, its time (s), the place of the body along d (m) and its speed (m/s)."""

    kind: EventKind
    time: Real
    place: Real
    speed: Real


@dataclass(frozen=True, eq=False)
class Course:
    """The phases and events of a motion, and the time (s) at which the body begins to turn; None if it does not."""

    phases: list[Phase]
    changes: list[Change]
    turns_at: Real | None = None


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
    """Return the motion until a time (s), or until the body turns.

    Raises `NotModelled` for fingers that open, and for a body that slips out of them.
    """
    whole = Course([], [])
    now = _Now(MP.zero, (MP.zero, grip.speed), (MP.zero, grip.carried))
    edges = breaks((grip.press, grip.effort), last)
    held = not now.slips
    for _ in range(MOST_PHASES):
        until = min([edge for edge in edges if edge > now.time], default=last) - now.time
        forces = _Forces(*(piece_at(pieces, now.time).from_time(now.time) for pieces in (grip.press, grip.effort)))
        if (opens := first_negative(forces.press, until)) is not None:
            raise NotModelled(f"fingers that open, at t = {float(now.time + opens):.6g} s")
        slips = now.slips or _yields(grip, forces, until)
        if slips and not any(grip.reach):
            raise NotModelled("a sphere that slips between two spheres")
        if slips and grip.turns:
            held_until = _phase(grip, now, forces, 0)
            return Course([*whole.phases, held_until], whole.changes, _turns_at(grip, now))
        if now.time and held != (not slips):
            whole.changes.append(Change("slip" if slips else "rest", now.time, *now.body))
        held = not slips
        phase = _phase(grip, now, forces, slips)
        whole.phases.append(phase)
        ending = _ending(grip, phase, forces, until)
        lasting = until if ending is None else ending
        _inside(grip, phase, lasting)
        now = _after(phase, lasting, stopped=bool(slips) and ending is not None)
        if now.time >= last:
            return whole
    raise OutOfReach(f"a gripped body with more than {MOST_PHASES} changes of its motion")


def _load(grip: Grip, forces: _Forces) -> Wave:
    """The force along d (N) that the contacts exert on a body that is held."""
    if grip.carriage is None:
        return constant(-grip.mass * grip.gravity)
    return forces.effort.times(grip.mass / (grip.mass + grip.borne))


def _margins(grip: Grip, forces: _Forces) -> tuple[Wave, Wave]:
    """How much more (N) the contacts of a body that is held bear, against its load along d and opposite to d."""
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
    moved = [rate.summed(speed).summed(place) for rate, (place, speed) in ((body, now.body), (carriage, now.carriage))]
    return Phase(now.time, moved[0], moved[1], slips)


def _ending(grip: Grip, phase: Phase, forces: _Forces, until: Real) -> Real | None:
    """Return the time (s) after which a body begins to slip or ceases to; None if it does not before `until` (s)."""
    if phase.slips:
        slip = phase.body.plus(phase.carriage.times(MP.mpf(-1))).rate()
        return first_negative(slip.times(MP.mpf(phase.slips)), until)
    endings = [first_negative(margin, until) for margin in _margins(grip, forces)]
    return min((ending for ending in endings if ending is not None), default=None)


def _inside(grip: Grip, phase: Phase, lasting: Real) -> None:
    """Raise `NotModelled` if the contacts leave a face within a time (s)."""
    slid = phase.body.plus(phase.carriage.times(MP.mpf(-1)))
    for sign, end in zip((-1, 1), grip.reach, strict=True):
        if phase.slips and not MP.isinf(end):
            leaves = first_negative(slid.times(MP.mpf(-sign)).plus(constant(sign * end)), lasting)
            if leaves is not None:
                raise NotModelled(f"a body that slips out of its fingers, at t = {float(phase.start + leaves):.6g} s")


def _after(phase: Phase, lasting: Real, *, stopped: bool) -> _Now:
    """Return the state a time (s) after the start of a phase. stopped: whether the slip has just ended."""
    body, carriage = ((wave.at(lasting), wave.rate().at(lasting)) for wave in (phase.body, phase.carriage))
    if stopped or not phase.slips:
        body = body[0], carriage[1]
    return _Now(phase.start + lasting, body, carriage)


def _turns_at(grip: Grip, now: _Now) -> Real:
    """Return the time (s) at which an eccentric body begins to turn without slip."""
    if grip.one:
        raise NotModelled("a body that slips and turns between fingers, as both share one limit")
    if grip.carriage is not None:
        raise NotModelled("a body that turns between fingers on a carriage")
    if now.slips:
        raise NotModelled("a body that slips and turns between fingers at the start")
    return now.time
