"""The motion of trees of bodies on hinges, sliders and welds, free bases included, from the text of their case file on.

The equations are those of Newton and Euler for every body alone, and an equation for every direction in which a joint does not
let its child accelerate, each with a force (maximal coordinates). So a body may have no mass. A joint that follows another one
has its acceleration and its force as further unknowns, and an equation between the accelerations of both. Their solutions are
power series in time. Each body has a frame whose z is the axis of its joint.
"""

import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

from tests.judge.jointed import Instant
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
from tests.judge.series import ORDER, Tape, at
from tests.judge.solids import Inertia, inertia_of
from tests.judge.states import State

#: The directions of accelerations of a body along its axes: of its origin, and of its turning.
DIRECTIONS = range(6)

#: The direction that each type of joint leaves free; a weld leaves none.
FREE = {"prismatic": 2, "revolute": 5, "fixed": None}

ORIGIN: Vector = (ZERO, ZERO, ZERO)
ALONG: Vector = (ZERO, ZERO, ONE)

#: Names of unknowns and of equations, and the coefficients of an equation.
Name = tuple[str, int, int]
Row = dict[Name, Any]


@dataclass(frozen=True)
class Part:
    """A body with its joint.

    axes: rows of the matrix from the body's axes to those of its frame here. turn: of this frame in the frame of the parent if
    the coordinate is zero. position: of the joint in the frame of the parent. inertia: along the axes of the frame. rule: the
    index of the body whose joint is followed, the factor and the term; None for a joint that follows none.
    """

    name: str
    joint: str
    type: str
    parent: int | None
    axes: Matrix
    turn: Matrix
    position: Vector
    inertia: Inertia
    terms: dict[str, Decimal]
    initial: dict[str, Any]
    rule: tuple[int, Decimal, Decimal] | None


def parts_of(text: str) -> tuple[list[Part], Decimal]:
    """Return the bodies of a case file, parents first, and its gravity."""
    document = tomllib.loads(text)
    bodies = {table["name"]: table for table in document["bodies"]}
    held = {table["child"]: table for table in document.get("joints", [])}
    order = [name for name in bodies if name not in held]
    left = [name for name in bodies if name in held]
    while left:
        name = next(each for each in left if held[each].get("parent", "world") in ("world", *order))
        left.remove(name)
        order.append(name)
    children = {table["name"]: order.index(table["child"]) for table in document.get("joints", [])}
    parts: list[Part] = []
    for name in order:
        joint = held.get(name, {"name": "", "type": "free"})
        parent = None if joint.get("parent", "world") == "world" else order.index(joint["parent"])
        above = IDENTITY if parent is None else parts[parent].axes
        axes = _aligned(unit(exact(joint["axis"]))) if "axis" in joint else IDENTITY
        made = inertia_of(bodies[name])
        mimic = joint.get("mimic")
        parts.append(
            Part(
                name,
                joint["name"],
                joint["type"],
                parent,
                axes,
                product(above, product(attitude(joint), transposed(axes))),
                applied(above, exact(joint.get("position", (0, 0, 0)))),
                Inertia(made.mass, applied(axes, made.centre), product(axes, product(made.tensor, transposed(axes)))),
                {key: exact(joint.get(key, 0)) for key in ("armature", "damping", "stiffness", "rest", "effort")},
                bodies[name].get("initial", {}) if joint["type"] == "free" else joint.get("initial", {}),
                None
                if mimic is None
                else (children[mimic["joint"]], exact(mimic.get("multiplier", 1)), exact(mimic.get("offset", 0))),
            )
        )
    return parts, exact(document.get("scene", {}).get("gravity", 0))


def _aligned(axis: Vector) -> Matrix:
    """Rows of a rotation whose last row is a unit axis."""
    least = min(range(3), key=lambda k: abs(axis[k]))
    first = unit(cross(axis, tuple(ONE if k == least else ZERO for k in range(3))))  # type: ignore[arg-type]
    return first, cross(axis, first), axis


@dataclass(frozen=True)
class _Moving:
    """The states of a body: position and velocity of its origin in the world, attitude, spin along its axes, coordinate."""

    position: Vector
    velocity: Vector
    turn: Matrix
    spin: Vector
    coordinate: Any


@dataclass(frozen=True)
class _Relation:
    """A relative acceleration of a body: its coefficients, and what it lacks to the sum of these accelerations."""

    row: Row
    bias: Any


class _Elimination:
    """Equations and their unknowns, one of which is eliminated after another by an equation that is named."""

    def __init__(self) -> None:
        self.rows: dict[Name, Row] = {}
        self.right: dict[Name, Any] = {}
        self._done: list[tuple[Name, Row, Any]] = []

    def add(self, name: Name, row: Row, right: Any) -> None:
        """Add terms to an equation."""
        mine = self.rows.setdefault(name, {})
        for unknown, value in row.items():
            mine[unknown] = mine.get(unknown, ZERO) + value
        self.right[name] = self.right.get(name, ZERO) + right

    def eliminate(self, name: Name, unknown: Name) -> None:
        """Solve an equation for an unknown."""
        row, right = self.rows.pop(name), self.right.pop(name)
        pivot = row.pop(unknown)
        if not (isinstance(pivot, Decimal) and pivot == ONE):
            row, right = {other: value / pivot for other, value in row.items() if _any(value)}, right / pivot
        for other, coefficients in self.rows.items():
            if _any(factor := coefficients.pop(unknown, ZERO)):
                self.add(other, {each: -(factor * value) for each, value in row.items() if _any(value)}, -(factor * right))
        self._done.append((unknown, row, right))

    def solution(self) -> dict[Name, Any]:
        """Return the unknowns."""
        values: dict[Name, Any] = {}
        for unknown, row, right in reversed(self._done):
            for other, value in row.items():
                right = right - value * values[other]
            values[unknown] = right
        return values


def _any(value: Any) -> bool:
    return not isinstance(value, Decimal) or bool(value)


class Equations:
    """The equations of a tree as operations on power series. Inputs: the states of each body in the order of `_Moving`."""

    def __init__(self, parts: Sequence[Part], gravity: Decimal) -> None:
        self.tape = tape = Tape()
        self.parts = parts

        def vector() -> Vector:
            return tape.state(), tape.state(), tape.state()

        self.moving = [
            _Moving(vector(), vector(), (vector(), vector(), vector()), vector(), None if part.type == "free" else tape.state())
            for part in parts
        ]
        coupled = {index for n, part in enumerate(parts) if part.rule for index in (n, part.rule[0])}
        system, measured = _Elimination(), dict[int, _Relation]()
        rates: list[Any] = []
        for index, part in enumerate(parts):
            _add_body(system, index, part, self.moving[index], gravity)
            if part.type == "free":
                rates.append(None)
                continue
            relations, rate = self._relations(index)
            rates.append(rate if FREE[part.type] is not None else ZERO)
            for k in DIRECTIONS:
                if k == FREE[part.type] and index not in coupled:
                    measured[index] = relations[k]
                    continue
                unknown, row = ("force", index, k), dict(relations[k].row)
                if k == FREE[part.type]:
                    row["along", index, 0] = -ONE
                system.add(("joint", index, k), row, relations[k].bias)
                for column, value in row.items():
                    system.add(("balance", *column[1:]) if column[0] == "body" else ("drive", index, 0), {unknown: value}, ZERO)
            if FREE[part.type] is not None:
                self._add_drive(system, index, rate, measured.get(index))
        for index, part in enumerate(parts):
            if part.rule is not None:
                row = {("along", index, 0): ONE, ("along", part.rule[0], 0): -part.rule[1]}
                system.add(("rule", index, 0), row, ZERO)
                for column, value in row.items():
                    system.add(("drive", column[1], 0), {("coupling", index, 0): value}, ZERO)
        for name, unknown in _pivots(parts, coupled):
            system.eliminate(name, unknown)
        self._state_rates(system.solution(), rates)

    def _relations(self, index: int) -> tuple[list[_Relation], Any]:
        """The accelerations of a body relative to the place that its joint carries, in all directions, and the joint's rate."""
        part, own = self.parts[index], self.moving[index]
        free = FREE[part.type]
        still = _Moving(ORIGIN, ORIGIN, IDENTITY, ORIGIN, None)
        above = still if part.parent is None else self.moving[part.parent]
        back = product(transposed(own.turn), above.turn) if part.type == "revolute" else transposed(part.turn)
        arm, axis = part.position, applied(part.turn, ALONG)
        carried = applied(back, above.spin)
        if part.type == "prismatic":
            arm = plus(arm, times(own.coordinate, axis))
            seen = applied(transposed(own.turn), minus(own.velocity, above.velocity))
            rate = seen[2] - applied(back, cross(above.spin, arm))[2]
        else:
            rate = own.spin[2] - carried[2]
        pull = cross(above.spin, cross(above.spin, arm))
        if part.type == "prismatic":
            pull = plus(pull, times(2, cross(above.spin, times(rate, axis))))
        swirl = cross(carried, times(rate, ALONG)) if part.type == "revolute" else ORIGIN
        biases = (*applied(back, pull), *swirl)
        levers = [cross(row, arm) for row in back]  # row . (turning x arm) = turning . (arm x row)
        relations = []
        for k in DIRECTIONS:
            row: Row = {("body", index, k): ONE}
            if part.parent is not None:
                line = back[k % 3]
                for j in range(3):
                    if k < 3:
                        row["body", part.parent, j] = -line[j]
                        row["body", part.parent, 3 + j] = levers[k][j]
                    else:
                        row["body", part.parent, 3 + j] = -line[j]
            relations.append(_Relation({name: value for name, value in row.items() if _any(value)}, biases[k]))
        return relations, rate if free is not None else ZERO

    def _add_drive(self, system: _Elimination, index: int, rate: Any, measured: _Relation | None) -> None:
        """Add the forces along the axis of a joint. measured: its acceleration, which is an unknown if it is None."""
        part, terms = self.parts[index], self.parts[index].terms
        stretch = self.moving[index].coordinate - terms["rest"]
        force = terms["effort"] - rate * terms["damping"] - stretch * terms["stiffness"]
        if measured is None:
            system.add(("drive", index, 0), {("along", index, 0): terms["armature"]}, force)
            return
        for column, value in measured.row.items():
            inertia = {each: terms["armature"] * value * other for each, other in measured.row.items()}
            row = {each: entry for each, entry in inertia.items() if _any(entry)}
            system.add(("balance", *column[1:]), row, value * force + terms["armature"] * (value * measured.bias))
        assert part.type != "fixed"

    def _state_rates(self, accelerations: dict[Name, Any], rates: Sequence[Any]) -> None:
        tape = self.tape
        for index, own in enumerate(self.moving):
            pushed = applied(own.turn, tuple(accelerations["body", index, k] for k in range(3)))  # type: ignore[arg-type]
            for state, rate in zip(own.position, own.velocity, strict=True):
                tape.rate(state, rate)
            for state, rate in zip(own.velocity, pushed, strict=True):
                tape.rate(state, rate)
            for row in own.turn:
                for state, rate in zip(row, cross(row, own.spin), strict=True):
                    tape.rate(state, rate)
            for k in range(3):
                tape.rate(own.spin[k], accelerations["body", index, 3 + k])
            if own.coordinate is not None:
                tape.rate(own.coordinate, rates[index])
        self.rates = rates


def _add_body(system: _Elimination, index: int, part: Part, own: _Moving, gravity: Decimal) -> None:
    """Add Newton's and Euler's equations of a body about its origin, along its axes."""
    mass, centre = part.inertia.mass, part.inertia.centre
    down = times(-gravity, (own.turn[2][0], own.turn[2][1], own.turn[2][2]))
    spun = cross(own.spin, cross(own.spin, centre))
    force = times(mass, minus(down, spun))
    square = dot(centre, centre)
    about_origin = tuple(
        tuple(part.inertia.tensor[i][j] + mass * ((square if i == j else ZERO) - centre[i] * centre[j]) for j in range(3))
        for i in range(3)
    )
    torque = minus(times(mass, cross(centre, down)), cross(own.spin, applied(about_origin, own.spin)))  # type: ignore[arg-type]
    x, y, z = centre
    # Of a turning t the origin's force has mass * (t x centre), and of an acceleration a the torque has mass * (centre x a).
    skew = ((ZERO, z, -y), (-z, ZERO, x), (y, -x, ZERO))
    for i in range(3):
        linear: Row = {("body", index, i): mass} | {("body", index, 3 + j): mass * skew[i][j] for j in range(3)}
        angular: Row = {("body", index, 3 + j): about_origin[i][j] for j in range(3)}
        angular |= {("body", index, j): mass * skew[j][i] for j in range(3)}
        system.add(("balance", index, i), {name: value for name, value in linear.items() if value}, force[i])
        system.add(("balance", index, 3 + i), {name: value for name, value in angular.items() if value}, torque[i])


def _pivots(parts: Sequence[Part], coupled: set[int]) -> Iterator[tuple[Name, Name]]:
    """Yield each equation and the unknown for which it is solved, from the tips to the root, and coupled joints last."""
    for index in reversed(range(len(parts))):
        part = parts[index]
        loose = DIRECTIONS if part.type == "free" else [k for k in DIRECTIONS if k == FREE[part.type] and index not in coupled]
        for k in DIRECTIONS:
            if k not in loose:
                yield ("joint", index, k), ("body", index, k)
        for k in DIRECTIONS:
            if k not in loose:
                yield ("balance", index, k), ("force", index, k)
        for k in loose:
            yield ("balance", index, k), ("body", index, k)
    for index, part in enumerate(parts):
        if part.rule is not None:
            yield ("rule", index, 0), ("along", index, 0)
    for index, part in enumerate(parts):
        if part.rule is not None:
            yield ("drive", index, 0), ("coupling", index, 0)
    for index in sorted(coupled):
        if parts[index].rule is None:
            yield ("drive", index, 0), ("along", index, 0)


def _begin(parts: Sequence[Part], index: int) -> tuple[Decimal, Decimal]:
    """Return the coordinate and the rate of a joint at the start."""
    part = parts[index]
    if part.rule is None:
        return exact(part.initial.get("position", 0)), exact(part.initial.get("velocity", 0))
    leader, factor, term = part.rule
    position, velocity = _begin(parts, leader)
    return factor * position + term, factor * velocity


def start_of(parts: Sequence[Part]) -> list[Decimal]:
    """Return the states of all bodies at the start."""
    numbers: list[Decimal] = []
    frames: list[tuple[Vector, Vector, Matrix, Vector]] = []
    for index, part in enumerate(parts):
        if part.type == "free":
            turn, spin = attitude(part.initial), exact(part.initial.get("angular_velocity", (0, 0, 0)))
            arm = applied(turn, part.inertia.centre)
            origin = minus(exact(part.initial.get("position", (0, 0, 0))), arm)
            swung = applied(turn, cross(spin, part.inertia.centre))
            frames.append((origin, minus(exact(part.initial.get("velocity", (0, 0, 0))), swung), turn, spin))
            numbers += [*frames[-1][0], *frames[-1][1], *(each for row in turn for each in row), *spin]
            continue
        origin, velocity, turn, spin = (ORIGIN, ORIGIN, IDENTITY, ORIGIN) if part.parent is None else frames[part.parent]
        coordinate, rate = _begin(parts, index) if FREE[part.type] is not None else (ZERO, ZERO)
        arm, axis = part.position, applied(part.turn, ALONG)
        slid, twist, relative = ORIGIN, part.turn, ORIGIN
        if part.type == "prismatic":
            arm, slid = plus(arm, times(coordinate, axis)), times(rate, axis)
        elif part.type == "revolute":
            twist, relative = product(part.turn, about(ALONG, *sine_cosine(coordinate))), times(rate, ALONG)
        origin = plus(origin, applied(turn, arm))
        velocity = plus(velocity, applied(turn, plus(cross(spin, arm), slid)))
        spin = plus(applied(transposed(twist), spin), relative)
        turn = product(turn, twist)
        frames.append((origin, velocity, turn, spin))
        numbers += [*origin, *velocity, *(each for row in turn for each in row), *spin, coordinate]
    return numbers


@dataclass(frozen=True)
class Reached:
    """The numbers of the states of all bodies at an instant, and their derivatives with respect to time."""

    numbers: list[Decimal]
    rates: list[Decimal]


def reached(text: str, instants: Sequence[Decimal]) -> tuple[list[Part], Decimal, list[Reached]]:
    """Return the bodies of a tree, its gravity, and what is reached at ascending instants (s) >= 0."""
    parts, gravity = parts_of(text)
    equations, numbers = Equations(parts, gravity), start_of(parts)
    now, sampled = ZERO, list[Reached]()
    inputs = [state for own in equations.moving for state in _flat(own)]
    while True:
        equations.tape.expand(numbers, ORDER)
        step, left = equations.tape.step(), instants[-1] - now
        step = left if step is None else min(step, left)
        while len(sampled) < len(instants) and instants[len(sampled)] <= now + step:
            time = instants[len(sampled)] - now
            slopes = [[k * term for k, term in enumerate(state.coefficients)][1:] for state in inputs]
            sampled.append(Reached([at(each.coefficients, time) for each in inputs], [at(each, time) for each in slopes]))
        if len(sampled) == len(instants):
            return parts, gravity, sampled
        numbers = [at(state.coefficients, step) for state in inputs]
        now += step


def motion(text: str, instants: Sequence[Decimal]) -> list[Instant]:
    """Return the states of a tree at ascending instants (s) >= 0."""
    parts, _, sampled = reached(text, instants)
    return [_instant(parts, each.numbers) for each in sampled]


@dataclass(frozen=True)
class Frame:
    """The frame of a body: position and velocity of its origin, attitude, spin along its axes; or their derivatives."""

    position: Vector
    velocity: Vector
    turn: Matrix
    spin: Vector


def frames_of(parts: Sequence[Part], numbers: Sequence[Decimal]) -> list[tuple[Frame, Decimal | None]]:
    """Return the frame of each body, and the coordinate of its joint, from numbers of the states or of their derivatives."""
    frames, left = [], list(numbers)
    for part in parts:
        position, velocity, *rows, spin = (tuple(left[n : n + 3]) for n in range(0, 18, 3))
        coordinate = None if part.type == "free" else left[18]
        del left[: 18 if coordinate is None else 19]
        frames.append((Frame(position, velocity, tuple(rows), spin), coordinate))  # type: ignore[arg-type]
    return frames


def _flat(own: _Moving) -> list[Any]:
    numbers = [*own.position, *own.velocity, *(each for row in own.turn for each in row), *own.spin]
    return numbers if own.coordinate is None else [*numbers, own.coordinate]


def _instant(parts: Sequence[Part], numbers: Sequence[Decimal]) -> Instant:
    """Return the states of joints and bodies from those of all bodies."""
    joints, bodies, frames = {}, {}, frames_of(parts, numbers)
    for part, (own, coordinate) in zip(parts, frames, strict=True):
        centre = applied(own.turn, part.inertia.centre)
        swung = applied(own.turn, cross(own.spin, part.inertia.centre))
        bodies[part.name] = State(
            plus(own.position, centre),
            plus(own.velocity, swung),
            product(own.turn, part.axes),
            applied(transposed(part.axes), own.spin),
        )
        if coordinate is not None and FREE[part.type] is not None:
            above = Frame(ORIGIN, ORIGIN, IDENTITY, ORIGIN) if part.parent is None else frames[part.parent][0]
            joints[part.joint] = coordinate, _rate(part, own, above, coordinate)
    return Instant(joints, bodies)


def _rate(part: Part, own: Frame, above: Frame, coordinate: Decimal) -> Decimal:
    """Return the rate of a coordinate from the velocities of both bodies."""
    if part.type == "revolute":
        rate: Decimal = own.spin[2] - applied(transposed(own.turn), applied(above.turn, above.spin))[2]
        return rate
    axis = applied(part.turn, ALONG)
    arm = plus(part.position, times(coordinate, axis))
    seen = applied(transposed(above.turn), minus(own.velocity, above.velocity))
    return dot(axis, minus(seen, cross(above.spin, arm)))
