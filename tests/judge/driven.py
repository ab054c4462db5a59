"""The motion of bodies on hinges and sliders with controllers and stops, from the text of their case file on.

To the equations of `jointed` come the efforts of controllers and elastic stops, in modes: a law that is not saturated, a cut or
a line of its saturation; an elastic stop that pushes or not. A mode ends at a root of the functions that decide it, and the
next modes are those of the motion shortly after it. Controllers with a rate exert numbers that are computed at their instants.
A rigid stop gives an impulse that reverses the velocity of its joint; a joint that is pressed against a stop rests there until
what presses it changes its sign.
"""

import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal
from fractions import Fraction
from typing import Any

from tests.judge.jointed import CHANGES, STOPPED, Equations, Instant, Mechanism, Phase, Undecided, change, first_of
from tests.judge.numerals import ONE, ZERO, exact, solved
from tests.judge.series import ORDER, Series, Tape, at, first_root
from tests.judge.signals import Signal

#: The time (s) after an event at which the motion shows its modes, and the number of terms that give the state then.
SHORTLY, FEW = Decimal("1e-12"), 8

#: The distance (m or rad) from a stop up to which an event is at the stop: what an event leaves of it is rounding.
NEAR = Decimal("1e-30")

#: Rebounds of less (m/s or rad/s) are left out: those that follow are over at once, and press on the stop as a joint at rest.
AT_REST = Decimal("1e-20")

#: The number of times that modes are decided at one event.
TRIES = 12

#: The modes of a joint: of its controller, as a word and a sense, and of its elastic stops.
Mode = tuple[str, int, int]
FREE: Mode = ("law", 0, 0)

SIGNALS = ("target", "target_velocity", "effort")


@dataclass(frozen=True)
class Drive:
    """The controller of a joint, and its stops. Numbers that a file does not give are None.

    offset: the index among the instants of the controller from which on its results act.
    """

    gains: tuple[Decimal, Decimal, Decimal]
    signals: dict[str, Signal]
    rate: Fraction | None
    delay: int
    limit: Decimal | None
    speed: Decimal | None
    lower: Decimal | None
    upper: Decimal | None
    restitution: Decimal | None
    elastic: tuple[Decimal, Decimal]

    @property
    def continuous(self) -> bool:
        """Whether the law enters the equations."""
        return bool(self.signals) and self.rate is None

    def raw(self, q: Any, u: Any, integral: Any, target: Any, speed: Any, effort: Any) -> Any:
        """Return the effort before saturation."""
        kp, kd, ki = self.gains
        return (target - q) * kp + (speed - u) * kd + integral * ki + effort

    def cut(self, raw: Decimal, u: Decimal) -> Decimal:
        """Return the effort after saturation."""
        if self.limit is None:
            return raw
        along = self.limit if self.speed is None else self.limit * max(ZERO, ONE - abs(u) / self.speed)
        most, least = (along, -self.limit) if u > 0 else (self.limit, -along if u < 0 else -self.limit)
        return min(max(raw, least), most)

    def mode(self, raw: Decimal, u: Decimal) -> tuple[str, int]:
        """Return the mode of the saturation of a continuous law."""
        cut = self.cut(raw, u)
        if cut == raw:
            return "law", 0
        sense = 1 if raw > cut else -1
        if self.speed is None or u * sense <= 0:
            return "cut", sense
        return ("none", 0) if abs(u) >= self.speed else ("line", sense)


@dataclass
class State:
    """The state of a motion: coordinates, velocities, integrals of errors, exerted numbers, joints at a stop, with its side."""

    q: list[Decimal]
    u: list[Decimal]
    integrals: dict[int, Decimal] = field(default_factory=dict)
    efforts: dict[int, Decimal] = field(default_factory=dict)
    closed: dict[int, int] = field(default_factory=dict)


class Driven(Mechanism):
    """The mechanism of a case file with its drives, and its equations for all modes that came up."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        document = tomllib.loads(text)
        controllers = {table["joint"]: table for table in document.get("controllers", [])}
        limits = {table["name"]: table["limits"] for table in document["joints"] if "limits" in table}
        self.drives = {
            k: _drive(controllers.get(link.joint), limits.get(link.joint, {}))
            for k, link in enumerate(self.links)
            if link.joint in controllers or link.joint in limits
        }
        self.integrating = [k for k, drive in self.drives.items() if drive.continuous and drive.gains[2]]
        self.modes: dict[int, Mode] = dict.fromkeys(self.drives, FREE)
        self.time, self.state = ZERO, State([], [])
        self._made: dict[Any, tuple[Equations, list[tuple[int, Any]], dict[int, Any]]] = {}

    def equations(self, stuck: frozenset[int]) -> Equations:
        """Return the equations of the present modes in which some joints stick."""
        return self.made(stuck)[0]

    def made(self, stuck: frozenset[int]) -> tuple[Equations, list[tuple[int, Any]], dict[int, Any]]:
        """Return equations, the functions whose roots end their modes, with their joints, and the integrals."""
        key = (stuck, tuple(self.state.closed), tuple(sorted(self.modes.items())))
        if key not in self._made:
            watched: list[tuple[int, Any]] = []
            integrals: dict[int, Any] = {}

            def forces(tape: Tape, q: dict[int, Any], u: dict[int, Any]) -> dict[int, Any]:
                return self._forces(tape, q, u, watched, integrals)

            self._made[key] = Equations(self.links, self.gravity, stuck, forces), watched, integrals
        return self._made[key]

    def _forces(
        self, tape: Tape, q: dict[int, Any], u: dict[int, Any], watched: list[tuple[int, Any]], integrals: dict[int, Any]
    ) -> dict[int, Any]:
        elapsed = tape.state()
        tape.rate(elapsed, ONE)
        integrals |= {k: tape.state() for k in self.integrating}
        efforts: dict[int, Any] = {}
        for k, drive in self.drives.items():
            word, sense, side = self.modes[k]
            effort: Any = tape.parameter()
            if drive.continuous:
                target, speed, forward = (drive.signals[name].series(tape, elapsed) for name in SIGNALS)
                raw = drive.raw(q[k], u[k], integrals.get(k, ZERO), target, speed, forward)
                if k in integrals:
                    tape.rate(integrals[k], target - q[k])
                effort = effort + self._saturated(k, raw, u[k], word, sense, watched)
            if drive.restitution is None:
                for way, stop in ((1, drive.upper), (-1, drive.lower)):
                    if stop is not None:
                        push = (q[k] - stop) * drive.elastic[0] + u[k] * drive.elastic[1]
                        watched += [(k, q[k] - stop), (k, push)]
                        effort = effort - push if side == way else effort
            elif k not in self.state.closed:
                watched += [(k, q[k] - stop) for stop in (drive.upper, drive.lower) if stop is not None]
            efforts[k] = effort
        return efforts

    def _saturated(self, k: int, raw: Any, u: Any, word: str, sense: int, watched: list[tuple[int, Any]]) -> Any:
        limit, speed = self.drives[k].limit, self.drives[k].speed
        if limit is None:
            return raw
        watched += [(k, raw - limit), (k, raw + limit)]
        if speed is not None:
            watched += [(k, raw - limit + u * (limit / speed)), (k, raw + limit + u * (limit / speed))]
            watched += [(k, raw), (k, u), (k, u - speed), (k, u + speed)]
        match word:
            case "law":
                return raw
            case "cut":
                return sense * limit
            case "line":
                assert speed is not None
                return sense * limit - u * (limit / speed)
            case _:
                return ZERO

    def inputs(self) -> list[Decimal]:
        """Return the numbers of the further forces, at the present time and state."""
        numbers = [ZERO, *(self.state.integrals[k] for k in self.integrating)]
        for k, drive in self.drives.items():
            numbers.append(self.state.efforts.get(k, ZERO))
            if drive.continuous:
                numbers += [number for name in SIGNALS for number in drive.signals[name].inputs(self.time)]
        return numbers

    def expanded(self, q: Sequence[Decimal], u: Sequence[Decimal], phase: Phase, order: int) -> Equations:
        """Return the equations of a phase with so many terms of everything."""
        stuck, frictions = phase
        equations = self.equations(stuck)
        moving = equations.moving
        states = [q[k] for k in moving] + [u[k] for k in moving] + [q[k] for k in equations.stuck]
        equations.tape.expand([*states, *(frictions[k] for k in moving), *self.inputs()], order)
        return equations

    def loads(self, q: Sequence[Decimal], u: Sequence[Decimal]) -> tuple[dict[tuple[int, int], Decimal], dict[int, Decimal]]:
        """Return the mass matrix, and the forces without dry friction."""
        free = self.expanded(q, u, (frozenset(), dict.fromkeys(range(len(self.links)), ZERO)), 1)
        mass = {pair: first_of(value) for pair, value in free.mass.items()}
        return mass, {k: first_of(value) for k, value in free.force.items()}

    def decided(self, q: Sequence[Decimal], u: Sequence[Decimal]) -> Phase:
        """Return the joints that do not move, by friction or at a stop, and the friction forces of the others."""
        mass, force = self.loads(q, u)
        closed = frozenset(self.state.closed)
        given = {k: -self.links[k].terms["friction"].copy_sign(u[k]) for k in self.dry if u[k]}
        while True:
            resting = [k for k in self.dry if k not in given]
            if not resting:
                return closed, {k: given.get(k, ZERO) for k in range(len(self.links)) if k not in closed}
            if closed:
                raise Undecided("dry friction at rest beside a joint at a stop")
            stuck, frictions = self._agreeing(mass, force, given, resting)
            leaving = {k: sign for k in stuck if (sign := self._leaves(k, q, u, (stuck, frictions)))}
            if not leaving:
                return stuck, frictions
            given |= {k: -sign * self.links[k].terms["friction"] for k, sign in leaving.items()}


def _drive(table: dict[str, Any] | None, limits: dict[str, Any]) -> Drive:
    def number(source: dict[str, Any], key: str) -> Any:
        return exact(source[key]) if key in source else None

    given = table or {}
    elastic = "stiffness" in limits
    kp, kd, ki = (exact(given.get(key, 0)) for key in ("kp", "kd", "ki"))
    return Drive(
        (kp, kd, ki),
        {} if table is None else {key: Signal(given.get(key, 0)) for key in SIGNALS},
        Fraction(given["rate"]) if "rate" in given else None,
        given.get("delay", 0),
        number(given, "effort_limit"),
        number(given, "no_load_speed"),
        number(limits, "lower"),
        number(limits, "upper"),
        None if elastic or not limits else exact(limits.get("restitution", 0)),
        (exact(limits.get("stiffness", 0)), exact(limits.get("damping", 0))),
    )


def _decimal(time: Fraction) -> Decimal:
    return Decimal(time.numerator) / Decimal(time.denominator)


def _edges(drive: Drive, until: Fraction) -> Iterator[Fraction]:
    """Yield the times at which the effort of a drive is not smooth."""
    if not drive.signals:
        return
    if drive.rate is None:
        yield from (time for signal in drive.signals.values() for time in signal.times if 0 < time < until)
        return
    yield from (Fraction(k) / drive.rate for k in range(int(until * drive.rate) + 1))


def motion(text: str, instants: Sequence[Decimal]) -> tuple[list[Instant], int]:
    """Return the states of a mechanism at ascending instants (s) >= 0, and the number of events."""
    driven = Driven(text)
    driven.state = State([link.start[0] for link in driven.links], [link.start[1] for link in driven.links])
    driven.state.integrals = dict.fromkeys(driven.integrating, ZERO)
    edges = sorted({edge for drive in driven.drives.values() for edge in _edges(drive, Fraction(instants[-1]))} | {Fraction(0)})
    sampled, events, sums = list[Instant](), 0, dict.fromkeys(driven.drives, ZERO)
    pending: dict[int, list[Decimal]] = {k: [ZERO] * drive.delay for k, drive in driven.drives.items()}
    for edge, after in zip(edges, [*edges[1:], None], strict=True):
        driven.time = _decimal(edge)
        for k, drive in driven.drives.items():
            if drive.rate is not None and (edge * drive.rate).denominator == 1:
                pending[k].append(_sample(driven, k, sums))
                driven.state.efforts[k] = pending[k].pop(0)
        end = instants[-1] if after is None else min(_decimal(after), instants[-1])
        events += _follow(driven, end, instants, sampled, last=after is None, first=edge == 0)
        if events > CHANGES:
            raise Undecided(f"{events} events, the last at {float(driven.time)} s")
    return sampled, events


def _sample(driven: Driven, k: int, sums: dict[int, Decimal]) -> Decimal:
    """Return the result of a controller with a rate at the present time."""
    drive, state = driven.drives[k], driven.state
    assert drive.rate is not None
    target, speed, effort = (drive.signals[name].at_instant(driven.time, 1 / _decimal(drive.rate)) for name in SIGNALS)
    sums[k] += (target - state.q[k]) / _decimal(drive.rate)
    return drive.cut(drive.raw(state.q[k], state.u[k], sums[k], target, speed, effort), state.u[k])


def _follow(driven: Driven, end: Decimal, instants: Sequence[Decimal], sampled: list[Instant], last: bool, first: bool) -> int:
    """Follow the motion to the time `end` without jumps of efforts, append states, and return the number of events."""
    phase, events = _settled(driven, impact=first), 0
    while True:
        state = driven.state
        equations = driven.expanded(state.q, state.u, phase, ORDER)
        step, left = equations.tape.step(), end - driven.time
        step = left if step is None else min(step, left)
        event = _event(driven, equations, phase, step)
        span = step if event is None else event
        while len(sampled) < len(instants) and (
            instants[len(sampled)] < driven.time + span or (last and instants[len(sampled)] <= driven.time + span)
        ):
            reached = _reached(driven, phase, instants[len(sampled)] - driven.time)
            sampled.append(driven.instant(reached.q, reached.u))
        driven.state = _reached(driven, phase, span)
        driven.time += span
        if event is None and step == left:
            driven.time = end
            return events
        if event is not None:
            events += 1
            if events > CHANGES:
                raise Undecided(f"{events} events, the last at {float(driven.time)} s")
            phase = _settled(driven, impact=True)


def _reached(driven: Driven, phase: Phase, time: Decimal) -> State:
    """Return the state at a time within a step, from the present terms."""
    equations, _, integrals = driven.made(phase[0])
    state = driven.state
    q, u = list(state.q), list(state.u)
    for k in equations.moving:
        q[k], u[k] = at(equations.coordinates[k].coefficients, time), at(equations.velocities[k].coefficients, time)
    return replace(state, q=q, u=u, integrals={k: at(each.coefficients, time) for k, each in integrals.items()})


def _event(driven: Driven, equations: Equations, phase: Phase, step: Decimal) -> Decimal | None:
    """Return the first time within a step at which a mode may change; None if there is none."""
    closed = driven.state.closed
    roots = [change(driven, equations, phase[1], [k for k in equations.stuck if k not in closed], step)]
    functions = [function for _, function in driven.made(phase[0])[1]] + [equations.holding[k] for k in closed]
    roots += [first_root(each.coefficients, step) for each in functions if isinstance(each, Series) and not each.steady]
    return min((root for root in roots if root is not None), default=None)


def _settled(driven: Driven, impact: bool) -> Phase:
    """Decide the modes of all joints at the present time. impact: whether a joint may have come to a rigid stop."""
    state = driven.state
    state.u = [
        ZERO if link.terms["friction"] and abs(value) < STOPPED else value
        for link, value in zip(driven.links, state.u, strict=True)
    ]
    if impact:
        _impact(driven)
    state.closed = {k: side for k, side, stop in _rigid(driven) if state.q[k] == stop and not state.u[k]}
    for _ in range(TRIES):
        phase = driven.decided(state.q, state.u)
        equations = driven.expanded(state.q, state.u, phase, FEW)
        loose = [k for k, side in state.closed.items() if side * _shortly(equations.holding[k]) < 0]
        if loose:
            state.closed = {k: side for k, side in state.closed.items() if k not in loose}
            continue
        after = _reached(driven, phase, SHORTLY)
        modes = {k: _mode(driven, k, after) for k in driven.drives}
        if modes == driven.modes:
            return phase
        driven.modes = modes
    raise Undecided("modes alternate")


def _shortly(value: Any) -> Decimal:
    return at(value.coefficients, SHORTLY) if isinstance(value, Series) else value


def _rigid(driven: Driven) -> Iterator[tuple[int, int, Decimal]]:
    """Yield the rigid stops: the joint, the side, the coordinate."""
    for k, drive in driven.drives.items():
        if drive.restitution is not None:
            yield from ((k, side, stop) for side, stop in ((1, drive.upper), (-1, drive.lower)) if stop is not None)


def _mode(driven: Driven, k: int, after: State) -> Mode:
    """Return the mode of a joint in a state shortly after the present time."""
    drive, (q, u), word, sense = driven.drives[k], (after.q[k], after.u[k]), "law", 0
    if drive.continuous:
        signals = (drive.signals[name].value(driven.time + SHORTLY) for name in SIGNALS)
        word, sense = drive.mode(drive.raw(q, u, after.integrals.get(k, ZERO), *signals), u)
    if drive.restitution is None:
        stiffness, damping = drive.elastic
        for side, stop in ((1, drive.upper), (-1, drive.lower)):
            if stop is not None and side * (q - stop) > 0 and side * ((q - stop) * stiffness + u * damping) > 0:
                return word, sense, side
    return word, sense, 0


def _impact(driven: Driven) -> None:
    """Reverse the velocity of the joint that comes to a rigid stop at the present time, if there is one."""
    state = driven.state
    hits = [(k, stop) for k, side, stop in _rigid(driven) if abs(state.q[k] - stop) <= NEAR and side * state.u[k] > STOPPED]
    if len(hits) > 1:
        raise Undecided("impacts of several joints at once")
    for k, stop in hits:
        mass, _ = driven.loads(state.q, state.u)
        free = [j for j in range(len(driven.links)) if j not in state.closed]
        response = solved(mass, {j: ONE if j == k else ZERO for j in free}, free)
        restitution = driven.drives[k].restitution
        assert restitution is not None
        if abs(state.u[k]) < AT_REST:
            restitution = ZERO
        impulse = -(1 + restitution) * state.u[k] / response[k]
        for j, side in state.closed.items():
            if side * sum((mass[j, i] * response[i] * impulse for i in free), ZERO) > 0:
                raise Undecided("an impact pulls another joint off its stop")
        state.u = [speed + impulse * response.get(j, ZERO) for j, speed in enumerate(state.u)]
        state.q[k] = stop
        if not restitution:
            state.u[k] = ZERO
