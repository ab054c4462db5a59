"""The motion of bodies on hinges and sliders with dry friction, from the text of their case file on.

The equations are Newton's and Euler's, projected on the velocities that each joint alone would give the bodies (Jourdain's
principle), in the frames of the bodies. Their solutions are power series in time from one change of sticking and slipping to
the next. At a change, the accelerations of the joints at rest are those that agree with Coulomb's law: a joint sticks where at
most its friction holds it, and begins to slip against its friction otherwise. The mass matrix is positive definite, so that
exactly one choice agrees.
"""

import itertools
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property
from typing import Any

from tests.judge.numerals import (
    IDENTITY,
    ZERO,
    Matrix,
    Vector,
    about,
    applied,
    attitude,
    cross,
    dot,
    exact,
    plus,
    product,
    sine_cosine,
    solved,
    times,
    transposed,
    unit,
)
from tests.judge.series import ORDER, Series, Tape, at, first_root
from tests.judge.solids import Inertia, inertia_of
from tests.judge.states import State

#: A joint whose velocity is below this, relative to one m/s or rad/s, has stopped: what an event leaves of it is rounding.
STOPPED = Decimal("1e-32")

#: Loads that differ from the friction by less of it are equal to it: they are rounding and terms that a series leaves out.
EQUAL = Decimal("1e-30")

#: The joints that stick, and the friction forces of the others.
Phase = tuple[frozenset[int], dict[int, Decimal]]

#: Changes between sticking and slipping after which a motion is given up.
CHANGES = 400


#: Further forces on joints: a function of a tape, the coordinates and the velocities of the joints.
Forces = Callable[[Tape, dict[int, Any], dict[int, Any]], dict[int, Any]]


class Undecided(Exception):
    """The motion cannot be decided in these digits; the text says why."""


@dataclass(frozen=True)
class Link:
    """A body with the joint on which it moves; the parent is the index of a link before it, or None for the world."""

    name: str
    inertia: Inertia
    joint: str
    parent: int | None
    revolute: bool
    position: Vector
    turn: Matrix
    axis: Vector
    terms: dict[str, Decimal]
    start: tuple[Decimal, Decimal]


@dataclass(frozen=True)
class Instant:
    """The coordinates and velocities of the joints, by name, and the states of the bodies, by name."""

    joints: dict[str, tuple[Decimal, Decimal]]
    bodies: dict[str, State]


def links_of(text: str) -> tuple[list[Link], Decimal]:
    """Return the links of a case file, parents first, and its gravity."""
    document = tomllib.loads(text)
    bodies = {table["name"]: table for table in document["bodies"]}
    links: list[Link] = []
    names: list[str] = []
    left = list(document["joints"])
    while left:
        table = next(each for each in left if each.get("parent", "world") in ("world", *names))
        left.remove(table)
        parent = table.get("parent", "world")
        start = table.get("initial", {})
        links.append(
            Link(
                table["child"],
                inertia_of(bodies[table["child"]]),
                table["name"],
                None if parent == "world" else names.index(parent),
                table["type"] == "revolute",
                exact(table.get("position", (0, 0, 0))),
                attitude(table),
                unit(exact(table["axis"])),
                {key: exact(table.get(key, 0)) for key in ("armature", "damping", "stiffness", "rest", "friction", "effort")},
                (exact(start.get("position", 0)), exact(start.get("velocity", 0))),
            )
        )
        names.append(table["child"])
    return links, exact(document.get("scene", {}).get("gravity", 0))


@dataclass(frozen=True)
class _Moving:
    """What moves a body in its own frame: velocities for each joint, and accelerations without those of the joints."""

    turning: dict[int, Vector]
    carrying: dict[int, Vector]
    spin: Vector
    bias_spin: Vector
    bias: Vector


class Equations:
    """The equations of a mechanism in which some joints stick, as operations on power series.

    Inputs, in this order: coordinates and velocities of the joints that move, coordinates of those that stick, and the friction
    force with its sign of those that move. The inputs of further forces come after these.
    """

    def __init__(self, links: Sequence[Link], gravity: Decimal, stuck: frozenset[int], further: Forces | None = None) -> None:
        self.tape = tape = Tape()
        self.moving = [k for k in range(len(links)) if k not in stuck]
        self.stuck = sorted(stuck)
        self._links, self._gravity = links, gravity
        coordinates: dict[int, Any] = {k: tape.state() for k in self.moving}
        velocities: dict[int, Any] = {k: tape.state() for k in self.moving}
        coordinates |= {k: tape.parameter() for k in self.stuck}
        frictions = {k: tape.parameter() for k in self.moving}
        everything = velocities | dict.fromkeys(self.stuck, ZERO)
        mass, force = self._projected(coordinates, everything)
        if further is not None:
            force |= {k: force[k] + value for k, value in further(tape, coordinates, everything).items()}
        self.mass, self.force = mass, force
        loads = {k: force[k] + frictions[k] for k in self.moving}
        accelerations = solved({(i, j): mass[i, j] for i in self.moving for j in self.moving}, loads, self.moving)
        self.holding = {k: force[k] - sum((mass[k, j] * accelerations[j] for j in self.moving), ZERO) for k in self.stuck}
        for k in self.moving:
            tape.rate(coordinates[k], velocities[k])
        for k in self.moving:
            tape.rate(velocities[k], accelerations[k])
        for load in self.holding.values():
            tape.watch(load)
        self.coordinates, self.velocities = coordinates, velocities

    def _projected(self, q: dict[int, Any], u: dict[int, Any]) -> tuple[dict[tuple[int, int], Any], dict[int, Any]]:
        """Return the mass matrix, and the forces without dry friction and without those that accelerate."""
        links, moved = self._links, list[_Moving]()
        force: dict[int, Any] = {}
        mass: dict[tuple[int, int], Any] = {(i, j): ZERO for i in range(len(links)) for j in range(len(links))}
        for k, link in enumerate(links):
            terms = link.terms
            force[k] = terms["effort"] - u[k] * terms["damping"] - (q[k] - terms["rest"]) * terms["stiffness"]
            mass[k, k] = terms["armature"]
            moved.append(_carried(link, k, None if link.parent is None else moved[link.parent], q[k], u[k], self._gravity))
        for link, moves in zip(links, moved, strict=True):
            c = link.inertia.centre
            at_centre = {j: plus(moves.carrying[j], cross(moves.turning[j], c)) for j in moves.turning}
            pull = times(
                link.inertia.mass, plus(moves.bias, cross(moves.bias_spin, c), cross(moves.spin, cross(moves.spin, c)))
            )
            tensor = link.inertia.tensor
            twist = plus(applied(tensor, moves.bias_spin), cross(moves.spin, applied(tensor, moves.spin)))
            for i in moves.turning:
                force[i] = force[i] - dot(at_centre[i], pull) - dot(moves.turning[i], twist)
                momentum, swirl = times(link.inertia.mass, at_centre[i]), applied(tensor, moves.turning[i])
                for j in moves.turning:
                    if j <= i:
                        mass[i, j] = mass[i, j] + dot(momentum, at_centre[j]) + dot(swirl, moves.turning[j])
        for i, j in itertools.combinations(range(len(links)), 2):
            mass[i, j] = mass[j, i]
        return mass, force


def _carried(link: Link, k: int, parent: _Moving | None, q: Any, u: Any, gravity: Decimal) -> _Moving:
    """Return what moves a link, whose origin is where its joint is."""
    if parent is None:
        zero = (ZERO, ZERO, ZERO)
        parent = _Moving({}, {}, zero, zero, (ZERO, ZERO, gravity))
    if link.revolute:
        into = transposed(product(link.turn, about(link.axis, *_sine_cosine(q))))
        arm = link.position
    else:
        into = transposed(link.turn)
        arm = plus(link.position, times(q, applied(link.turn, link.axis)))
    turning = {j: applied(into, each) for j, each in parent.turning.items()}
    carrying = {j: applied(into, plus(parent.carrying[j], cross(parent.turning[j], arm))) for j in parent.turning}
    carried_spin = applied(into, parent.spin)
    own = times(u, link.axis)
    bias_spin, spin = applied(into, parent.bias_spin), carried_spin
    bias = applied(into, plus(parent.bias, cross(parent.bias_spin, arm), cross(parent.spin, cross(parent.spin, arm))))
    still = (ZERO, ZERO, ZERO)
    if link.revolute:
        turning[k], carrying[k] = link.axis, still
        spin, bias_spin = plus(spin, own), plus(bias_spin, cross(carried_spin, own))
    else:
        turning[k], carrying[k] = still, link.axis
        bias = plus(bias, times(2, cross(carried_spin, own)))
    return _Moving(turning, carrying, spin, bias_spin, bias)


def _sine_cosine(angle: Any) -> tuple[Any, Any]:
    return angle.sine_cosine() if isinstance(angle, Series) else sine_cosine(angle)


class Mechanism:
    """The mechanism of a case file, with the equations of all choices of sticking joints that came up."""

    def __init__(self, text: str) -> None:
        self.links, self.gravity = links_of(text)
        self.dry = [k for k, link in enumerate(self.links) if link.terms["friction"]]
        self._equations: dict[frozenset[int], Equations] = {}

    def equations(self, stuck: frozenset[int]) -> Equations:
        """Return the equations in which some joints stick."""
        if stuck not in self._equations:
            self._equations[stuck] = Equations(self.links, self.gravity, stuck)
        return self._equations[stuck]

    @cached_property
    def _free(self) -> Equations:
        return self.equations(frozenset())

    def decided(self, q: Sequence[Decimal], u: Sequence[Decimal]) -> Phase:
        """Return the joints that stick, and the friction forces of the others.

        A joint that would stick at its very limit, with a load that grows, slips.
        """
        free, count = self._free, len(self.links)
        free.tape.expand([*q, *u, *([ZERO] * count)], 1)
        mass = {pair: first_of(value) for pair, value in free.mass.items()}
        force = {k: first_of(value) for k, value in free.force.items()}
        given = {k: -self.links[k].terms["friction"].copy_sign(u[k]) for k in self.dry if u[k]}
        while True:
            stuck, frictions = self._agreeing(mass, force, given, [k for k in self.dry if k not in given])
            leaving = {k: sign for k in stuck if (sign := self._leaves(k, q, u, (stuck, frictions)))}
            if not leaving:
                return stuck, frictions
            given |= {k: -sign * self.links[k].terms["friction"] for k, sign in leaving.items()}

    def _agreeing(
        self, mass: dict[tuple[int, int], Decimal], force: dict[int, Decimal], given: dict[int, Decimal], resting: list[int]
    ) -> Phase:
        """Return the choice for joints at rest that agrees with Coulomb's law."""
        for choice in itertools.product((0, 1, -1), repeat=len(resting)):
            stuck = frozenset(k for k, sign in zip(resting, choice, strict=True) if not sign)
            slips = {k: -sign * self.links[k].terms["friction"] for k, sign in zip(resting, choice, strict=True) if sign}
            frictions = {k: (given | slips).get(k, ZERO) for k in range(len(self.links)) if k not in stuck}
            rates = solved(mass, {k: force[k] + friction for k, friction in frictions.items()}, list(frictions))
            loads = {k: force[k] - sum((mass[k, j] * rates[j] for j in frictions), ZERO) for k in stuck}
            if all(rates[k] * slips[k] < 0 for k in slips) and all(
                abs(loads[k]) <= self.links[k].terms["friction"] * (1 + EQUAL) for k in stuck
            ):
                return stuck, frictions
        raise Undecided("no choice of sticking and slipping agrees with Coulomb's law")

    def expanded(self, q: Sequence[Decimal], u: Sequence[Decimal], phase: Phase, order: int) -> Equations:
        """Return the equations of a phase with so many terms of everything."""
        stuck, frictions = phase
        equations = self.equations(stuck)
        moving = equations.moving
        states = [q[k] for k in moving] + [u[k] for k in moving] + [q[k] for k in equations.stuck]
        equations.tape.expand([*states, *(frictions[k] for k in moving)], order)
        return equations

    def _leaves(self, k: int, q: Sequence[Decimal], u: Sequence[Decimal], phase: Phase) -> int:
        """Return the sign of the load of a joint that sticks at its limit if it is about to exceed it; 0 otherwise."""
        friction = self.links[k].terms["friction"]
        load = self.expanded(q, u, phase, 1).holding[k]
        if friction - abs(first_of(load)) > friction * EQUAL or not isinstance(load, Series):
            return 0
        sign = 1 if first_of(load) > 0 else -1
        terms = self.expanded(q, u, phase, 8).holding[k].coefficients[1:]
        growing = next((sign * term for term in terms if abs(term) > friction * EQUAL), ZERO) > 0
        return sign if growing else 0

    def instant(self, q: Sequence[Decimal], u: Sequence[Decimal]) -> Instant:
        """Return the states of joints and bodies, by the velocities of their points in the world."""
        zero = (ZERO, ZERO, ZERO)
        frames: list[tuple[Vector, Matrix, Vector, Vector]] = []
        joints, bodies = {}, {}
        for k, link in enumerate(self.links):
            origin, turn, velocity, spin = frames[link.parent] if link.parent is not None else (zero, IDENTITY, zero, zero)
            arm = applied(turn, link.position)
            turn = product(turn, link.turn)
            axis = applied(turn, link.axis)
            if link.revolute:
                velocity = plus(velocity, cross(spin, arm))
                turn, spin = product(turn, about(link.axis, *sine_cosine(q[k]))), plus(spin, times(u[k], axis))
            else:
                arm = plus(arm, times(q[k], axis))
                velocity = plus(velocity, cross(spin, arm), times(u[k], axis))
            origin = plus(origin, arm)
            frames.append((origin, turn, velocity, spin))
            centre = applied(turn, link.inertia.centre)
            joints[link.joint] = (q[k], u[k])
            bodies[link.name] = State(
                plus(origin, centre), plus(velocity, cross(spin, centre)), turn, applied(transposed(turn), spin)
            )
        return Instant(joints, bodies)


def first_of(value: Any) -> Decimal:
    """Return the number with which a series begins, or a number itself."""
    return value.coefficients[0] if isinstance(value, Series) else value


def motion(text: str, instants: Sequence[Decimal]) -> tuple[list[Instant], int]:
    """Return the states of a mechanism at ascending instants (s) >= 0, and how often joints began to stick or to slip."""
    mechanism = Mechanism(text)
    q, u = [link.start[0] for link in mechanism.links], [link.start[1] for link in mechanism.links]
    now, sampled, changes = ZERO, list[Instant](), 0
    phase = mechanism.decided(q, u)
    while True:
        equations = mechanism.expanded(q, u, phase, ORDER)
        step, left = equations.tape.step(), instants[-1] - now
        step = left if step is None else min(step, left)
        event = change(mechanism, equations, phase[1], equations.stuck, step)
        end = step if event is None else event
        while len(sampled) < len(instants) and instants[len(sampled)] <= now + end:
            sampled.append(mechanism.instant(*_reached(equations, q, u, instants[len(sampled)] - now)))
        if len(sampled) == len(instants):
            return sampled, changes
        q, u = _reached(equations, q, u, end)
        now += end
        if event is not None:
            u = [
                ZERO if link.terms["friction"] and abs(value) < STOPPED else value
                for link, value in zip(mechanism.links, u, strict=True)
            ]
            before, phase = phase, mechanism.decided(q, u)
            changes += phase != before
            if changes > CHANGES or phase == before:
                raise Undecided(f"{changes} changes, the last at {float(now)} s")


def _reached(
    equations: Equations, q: Sequence[Decimal], u: Sequence[Decimal], time: Decimal
) -> tuple[list[Decimal], list[Decimal]]:
    """Return coordinates and velocities at a time within a step."""
    after, velocities = list(q), list(u)
    for k in equations.moving:
        after[k] = at(equations.coordinates[k].coefficients, time)
        velocities[k] = at(equations.velocities[k].coefficients, time)
    return after, velocities


def change(
    mechanism: Mechanism, equations: Equations, frictions: dict[int, Decimal], sticking: Sequence[int], step: Decimal
) -> Decimal | None:
    """Return the first time within a step at which a joint stops or one that sticks is no longer held; None without."""
    roots = [first_root(equations.velocities[k].coefficients, step) for k in equations.moving if frictions[k]]
    for k in sticking:
        if isinstance(load := equations.holding[k], Series):
            friction = mechanism.links[k].terms["friction"]
            for sign in (1, -1):
                margin = [friction + sign * load.coefficients[0], *(sign * term for term in load.coefficients[1:])]
                if abs(margin[0]) <= friction * EQUAL:
                    margin[0] = ZERO
                roots.append(first_root(margin, step))
    return min((root for root in roots if root is not None), default=None)
