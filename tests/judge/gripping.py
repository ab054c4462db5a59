"""A body between two fingers, step by step in fifty digits.

Forces, places and speeds are power series in time, of which the first change of a sign ends a step: that of what friction still
bears while the body is held, and that of the slip or of the turning while it is not.
"""

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

from tests.judge.numerals import (
    IDENTITY,
    ONE,
    ZERO,
    Matrix,
    Vector,
    about,
    applied,
    attitude,
    cross,
    dot,
    exact,
    minus,
    plus,
    product,
    sine_cosine,
    times,
    transposed,
    unit,
)
from tests.judge.series import Series, Tape, at, first_root
from tests.judge.signals import Signal
from tests.judge.solids import inertia_of
from tests.judge.states import Motion, State

#: Steps after which a motion is given up.
STEPS = 20_000

#: The size of a term, relative to others, that is rounding, and of the time (s) between two different instants.
ROUNDED, SAME = Decimal("1e-40"), Decimal("1e-44")


@dataclass(frozen=True)
class Held:
    """The numbers that the judge reads in a case file: directions, masses, arms and laws, as the names say."""

    normal: Vector
    along: Vector
    mass: Decimal
    borne: Decimal | None
    moment: Decimal
    gravity: Decimal
    press: Signal
    effort: Signal
    friction: Decimal
    torsional: Decimal
    one: bool
    arm: tuple[Decimal, Decimal]
    speed: Decimal
    carried: Decimal

    @property
    def bearing(self) -> Decimal:
        """The load that the contacts bear for a force of 1 N."""
        lever = abs(self.arm[1])
        if not lever:
            return 2 * self.friction
        if not self.friction or not self.torsional:
            return ZERO
        if self.one:
            return 2 / ((1 / self.friction) ** 2 + (lever / self.torsional) ** 2).sqrt()
        return min(2 * self.friction, 2 * self.torsional / lever)

    @property
    def turns(self) -> bool:
        """True if the body turns when it is no longer held."""
        return bool(self.friction) and self.torsional < self.friction * abs(self.arm[1])


class Line:
    """The equations along the line, of a body that is held (0) or slips (1 and -1): place and speed of body and carriage."""

    def __init__(self, held: Held, sense: int) -> None:
        self.tape = Tape()
        x, v, s, w, elapsed = (self.tape.state() for _ in range(5))
        press, effort = held.press.series(self.tape, elapsed), held.effort.series(self.tape, elapsed)
        if held.borne is None:
            carriage: Any = ZERO
            load: Any = -held.mass * held.gravity
        else:
            carriage = effort / (held.mass + held.borne) + held.gravity
            load = effort * held.mass / (held.mass + held.borne)
        body: Any = carriage
        self.tests: list[Any] = [press * held.bearing - load, press * held.bearing + load]
        if sense:
            force = press * (-2 * sense * held.friction)
            body = force / held.mass + held.gravity
            carriage = ZERO if held.borne is None else (effort - force) / held.borne + held.gravity
            self.tests = [(v - w) * Decimal(sense)]
        for state, rate in ((x, v), (v, body), (s, w), (w, carriage), (elapsed, ONE)):
            self.tape.rate(state, rate)


class Swing:
    """The equations of a body that turns about its contacts in a sense: its angle and its rate."""

    def __init__(self, held: Held, sense: int) -> None:
        self.tape = Tape()
        angle, rate, elapsed = (self.tape.state() for _ in range(3))
        press = held.press.series(self.tape, elapsed)
        sine, cosine = angle.sine_cosine()
        along, across = (-part for part in held.arm)
        inertia = held.moment + held.mass * (along * along + across * across)
        moment = (sine * along + cosine * across) * (-held.mass * held.gravity) - press * (2 * sense * held.torsional)
        self.tests: list[Any] = [rate * Decimal(sense)]
        for state, change in ((angle, rate), (rate, moment / inertia), (elapsed, ONE)):
            self.tape.rate(state, change)


def motions(text: str, instants: Sequence[Decimal]) -> list[Motion]:
    """Return the motions of all bodies of a case file of format 2."""
    document = tomllib.loads(text)
    held = _read(document)
    numbers, angle = ([ZERO, held.speed, ZERO, held.carried], [ZERO, ZERO])
    found: list[tuple[Sequence[Decimal], Sequence[Decimal]]] = []
    events: list[tuple[str, Decimal]] = []
    equations: dict[tuple[str, int], Any] = {}
    now, mode = ZERO, ""
    edges = sorted(Decimal(time.numerator) / time.denominator for signal in (held.press, held.effort) for time in signal.times)
    last = instants[-1]
    turned = False
    while len(found) < len(instants) and instants[len(found)] <= now:
        found.append((tuple(numbers), tuple(angle)))
    for _ in range(STEPS):
        before = mode
        sense = _sense(held, numbers, angle, now, turned)
        mode = "held" if not sense else "turn" if held.turns else "slip"
        if sense and held.one and held.arm[1]:
            raise ValueError("one cone does not hold the body, and the judge has no motion of it")
        turned = turned or mode == "turn"
        if before and mode != before and now > 0:
            events.append(("rest" if mode == "held" else mode, now))
        key = ("turn" if mode == "turn" else "line", sense)
        if key not in equations:
            equations[key] = (Swing if mode == "turn" else Line)(held, sense)
        use = equations[key]
        inputs = (*held.press.inputs(now), *(() if mode == "turn" else held.effort.inputs(now)))
        use.tape.expand([*(angle if mode == "turn" else numbers), ZERO, *inputs])
        until = min([last, *(edge for edge in edges if edge > now + SAME)]) - now
        step = min(until, use.tape.step() or until)
        tests = [_moment_margin(held, angle[0], now)] if mode == "held" and turned else [_terms(test) for test in use.tests]
        roots = [first_root(test, step) for test in tests]
        lasting = min((root for root in roots if root is not None), default=step)
        states = [_terms(state) for state in use.tape.states[:-1]]
        if mode == "turn":
            _check(held, states, now, lasting)
        while len(found) < len(instants) and instants[len(found)] <= now + lasting:
            values = tuple(at(state, instants[len(found)] - now) for state in states)
            found.append((tuple(numbers), values) if mode == "turn" else (values, tuple(angle)))
        ended = [at(state, lasting) for state in states]
        if mode == "turn":
            angle = [ended[0], ZERO if lasting < step else ended[1]]
        else:
            numbers = ended
            if mode == "held" or lasting < step:
                numbers[1] = numbers[3]
        now += lasting
        if now >= last or len(found) == len(instants):
            return [_motion(document, table, held, found, events) for table in document["bodies"]]
    raise ValueError("too many steps")


def _terms(series: Any) -> list[Decimal]:
    return series.coefficients if isinstance(series, Series) else [series]


def _sense(held: Held, numbers: Sequence[Decimal], angle: Sequence[Decimal], now: Decimal, turned: bool) -> int:
    """Return the sense of the slip, or of the turning, from now on; 0 if the body is held."""
    moving = angle[1] if turned else numbers[1] - numbers[3]
    if abs(moving) > ROUNDED:
        return 1 if moving > 0 else -1
    if turned or held.turns:
        margin = _moment_margin(held, angle[0], now)
        weight = -held.gravity * _across(held, angle[0])
        return (1 if weight > 0 else -1) if _negative(margin) else 0
    use = Line(held, 0)
    use.tape.expand([*numbers, ZERO, *held.press.inputs(now), *held.effort.inputs(now)])
    for sense, test in zip((-1, 1), use.tests, strict=True):
        if _negative(_terms(test)):
            return sense
    return 0


def _negative(terms: Sequence[Decimal]) -> bool:
    """Return whether a series is negative from its start on: its first term that is not zero decides."""
    scale = max(map(abs, terms)) or ONE
    first = next((term for term in terms if abs(term) > ROUNDED * scale), ZERO)
    return first < 0


def _across(held: Held, angle: Decimal) -> Decimal:
    sine, cosine = sine_cosine(angle)
    return -(sine * held.arm[0] + cosine * held.arm[1])


def _moment_margin(held: Held, angle: Decimal, now: Decimal) -> list[Decimal]:
    """Return the series of how much more moment the contacts bear than the weight has."""
    tape = Tape()
    elapsed = tape.state()
    press = held.press.series(tape, elapsed)
    weight = abs(held.mass * held.gravity * _across(held, angle))
    margin = press * (2 * held.torsional) - weight
    tape.rate(elapsed, ONE)
    tape.expand([ZERO, *held.press.inputs(now)])
    return _terms(margin)


def _check(held: Held, states: Sequence[Sequence[Decimal]], now: Decimal, time: Decimal) -> None:
    """Raise an error if contacts slip at the end of a step in which the body turns."""
    angle, rate = (at(state, time) for state in states)
    faster = at([k * term for k, term in enumerate(states[1])][1:], time)
    sine, cosine = sine_cosine(angle)
    along = -(cosine * held.arm[0] - sine * held.arm[1])
    across = _across(held, angle)
    force = -faster * across - rate * rate * along - held.gravity, faster * along - rate * rate * across
    bound = 2 * held.friction * held.press.value(now + time)
    if held.mass * (force[0] * force[0] + force[1] * force[1]).sqrt() > bound * (1 + Decimal("1e-20")):
        raise ValueError("the contacts slip while the body turns")


def _read(document: dict[str, Any]) -> Held:
    """Return the numbers of a case whose first contact is with the finger that presses along its axis."""
    tables = {table["name"]: table for table in document["bodies"]}
    joints = {table["child"]: table for table in document["joints"]}
    controllers = {table["joint"]: table.get("effort", 0.0) for table in document.get("controllers", ())}
    pair = document["scene"]["contacts"][0]
    name, finger = pair["bodies"]
    body, joint = tables[name], joints[finger]
    turn = attitude(joint)
    normal = unit(applied(turn, exact(joint["axis"])))
    start = body.get("initial", {})
    centre, place = exact(start.get("position", (0, 0, 0))), exact(joint.get("position", (0, 0, 0)))
    rail = joints.get(joint.get("parent", ""))
    gravity: Vector = (ZERO, ZERO, -exact(document["scene"].get("gravity", 0)))
    along = unit(exact(rail["axis"])) if rail else unit(gravity if gravity[2] else exact(start["velocity"]))
    across = cross(normal, along)
    arm = ZERO, ZERO
    if tables[finger]["shape"] == "sphere" and body["shape"] == "brick":
        offset = minus(place, centre)
        arm = dot(offset, along), dot(offset, across)
        if abs(arm[1]) < Decimal("1e-14"):
            arm = arm[0], ZERO
    inertia = inertia_of(body)
    own = applied(transposed(attitude(start)), normal)
    borne = sum((exact(tables[child]["mass"]) for child in joints), ZERO) if rail else None
    return Held(
        normal,
        along,
        inertia.mass,
        borne,
        dot(own, applied(inertia.tensor, own)),
        dot(gravity, along),
        Signal(controllers[joint["name"]]),
        Signal(controllers.get(rail["name"], 0.0) if rail else 0.0),
        exact(pair["friction"]),
        exact(pair.get("torsional_friction", 0)),
        pair.get("cone") == "one",
        arm,
        dot(exact(start.get("velocity", (0, 0, 0))), along),
        exact(rail.get("initial", {}).get("velocity", 0)) if rail else ZERO,
    )


def _motion(
    document: dict[str, Any],
    table: dict[str, Any],
    held: Held,
    found: Sequence[tuple[Sequence[Decimal], Sequence[Decimal]]],
    events: list[tuple[str, Decimal]],
) -> Motion:
    """Return the motion of a body from the numbers of all instants."""
    joints = {each["child"]: each for each in document["joints"]}
    gripped = table["name"] not in joints
    start = table.get("initial", {}) if gripped else joints[table["name"]]
    centre, turn = exact(start.get("position", (0, 0, 0))), attitude(start)
    spin: Matrix = IDENTITY
    states = {}
    for index, (line, (angle, rate)) in enumerate(found):
        place, speed = line[:2] if gripped else line[2:]
        moved, fast = times(place, held.along), times(speed, held.along)
        turning: Vector = (ZERO, ZERO, ZERO)
        now = turn
        if gripped and (angle or rate):
            sine, cosine = sine_cosine(angle)
            spin = about(held.normal, sine, cosine)
            arm = plus(times(-held.arm[0], held.along), times(-held.arm[1], cross(held.normal, held.along)))
            swung = applied(spin, arm)
            moved, fast = minus(swung, arm), times(rate, cross(held.normal, swung))
            now, turning = product(spin, turn), applied(transposed(turn), times(rate, held.normal))
        states[index] = State(plus(centre, moved), fast, now, turning)
    return Motion(states, events if gripped else [])
