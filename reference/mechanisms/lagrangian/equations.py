"""The equations of motion of a mechanism, derived from its Lagrangian by differentiation (Boltzmann and Hamel).

L = T - V is written once, from the velocities of the elements in their own frames, and differentiated on a tape. The velocities
u are the rates of the coordinates or, for the attitude of a ball or a free element, the angular velocity in its frame. With X_i
the derivative with respect to the coordinates in the direction of u_i,

    d/dt (dL/du_i) + (omega x dL/domega)_i - X_i L = Q_i,

where the second term is present for attitudes alone. dL/du_i = p_i is linear in u, so that with the mass matrix M = dp/du

    M du/dt = X L - omega x p - (dp/dq) dq/dt + Q.

M is formed by carrying the second derivatives of T from the leaves of the tree to its root; see `mass_matrix`. Damping and
dry friction are the forces Q.

If an element follows another one, its coordinate in L is a linear function of the coordinate of the latter, with respect to
which L is differentiated, and M becomes S^T M S with the factors S of the functions.

A joint with dry friction slips or sticks: see `friction`. While it sticks, or while a rigid stop holds it, it is left out of
the mass matrix. Continuous controllers and elastic stops are forces Q too, and add variables to the state: the integrals of
their errors, and time. See `laws`. Loops are kept closed by multipliers: see `closing`.
"""

import functools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from bodycheck.reference.mechanisms.lagrangian import closing
from bodycheck.reference.mechanisms.lagrangian.border import Kind
from bodycheck.reference.mechanisms.lagrangian.differentiation import Node, Tape, along, cross, gradient, needed, plus
from bodycheck.reference.mechanisms.lagrangian.laws import Acting, Guard, acting
from bodycheck.reference.mechanisms.lagrangian.mass_matrix import (
    Frame,
    Solid,
    clamped,
    mass_matrix,
    order,
    product,
    reduced,
    solved,
)
from bodycheck.reference.mechanisms.lagrangian.structure import Structure


@dataclass(frozen=True, eq=False)
class Derived:
    """The equations of a structure.

    Attributes
    ----------
    tape
        The tape on which they are written.
    states
        The number of coordinates, velocities and further variables.
    rates
        The time derivatives of the coordinates, of the velocities and of the further variables.
    used
        The indices of the parameters on which the equations and the guards depend.
    strains
        For each element that can be held at rest, the force that holds it in its motion, and its inertia.
    guards
        The guards of all laws.
    """

    tape: Tape
    states: int
    rates: tuple[Node, ...]
    used: tuple[int, ...]
    strains: tuple[tuple[Node, Node], ...]
    guards: tuple[Guard, ...]


@dataclass(frozen=True, eq=False)
class _Moving:
    """The motion of an element: angular velocity, velocity of its origin and the vertical, along its axes; and its height."""

    omega: list[Node]
    velocity: list[Node]
    vertical: list[Node]
    height: Node


@dataclass(frozen=True, eq=False)
class _Read:
    """A reader of the numbers of a structure on a tape, one after another."""

    tape: Tape
    nodes: Iterator[Node]

    def some(self, count: int) -> list[Node]:
        return [next(self.nodes) for _ in range(count)]


@dataclass(frozen=True, eq=False)
class Parts:
    """The parts of the equations of a structure, on a tape.

    Attributes
    ----------
    coordinates, velocities
        The variables of the state.
    slopes, momenta
        The derivatives of L with respect to the coordinates and the velocities.
    forces
        The forces Q of damping, controllers and elastic stops along the velocities.
    dry
        For each velocity, the force of dry friction along it, and 1, or 0 if dry friction holds it.
    shares
        For each velocity of all elements, the index of the velocity of the state that determines it, and the factor.
    solids
        The elements with their inertia, from which the mass matrix is formed.
    gaps
        The components of the gaps of loops.
    further
        The time derivatives of the variables after the coordinates and velocities: the integral of the error of each law that
        has one, and time if a law depends on it.
    guards
        The guards of laws, without those that depend on accelerations.
    """

    coordinates: list[Node]
    velocities: list[Node]
    slopes: list[Node]
    momenta: list[Node]
    forces: list[Node]
    dry: list[tuple[Node, Node]]
    shares: list[tuple[int, Node]]
    solids: list[Solid]
    gaps: list[Node]
    further: list[Node]
    guards: list[Guard]

    def carried(self, tape: Tape, structure: Structure, slopes: list[Node]) -> list[Node]:
        """X_i of a function for each velocity u_i. slopes: its derivatives with respect to the coordinates."""
        q, rates = self.coordinates, list[Node]()
        for kind, (held, _) in zip(structure.kinds, structure.places, strict=True):
            rates += _carried(tape, kind, q[held], slopes[held])
        return rates


def parts_of(tape: Tape, structure: Structure) -> Parts:
    """The derivatives of L and the other parts of the equations. The state is all coordinates, then all velocities."""
    nodes, parameters = [], 0
    for mark in structure.marks:
        nodes.append(tape.parameter(parameters) if mark is None else tape.number(float(mark)))
        parameters += mark is None
    held, moving = structure.places[-1][0].stop, structure.places[-1][1].stop
    q = [tape.variable(index) for index in range(held)]
    u = [tape.variable(held + index) for index in range(moving)]
    read = _Read(tape, iter(nodes))
    followers = sum(leader is not None for leader in structure.follows)
    states, shares = _states(tape, structure, _Read(tape, iter(nodes[len(nodes) - 2 * followers :])), q, u)
    lagrangian, of_all, dry_of_all, solids = _lagrangian(tape, structure, read, states)
    driven, further = _driven(tape, structure, states, held + moving)
    for index, law in driven.items():
        slot = structure.all_places[index][1].start
        of_all[slot] = tape.add(of_all[slot], law.force)
    guards = [Guard(index, name, node) for index, law in driven.items() for name, node in law.guards.items()]
    forces = [tape.zero] * moving
    for force, (index, share) in zip(of_all, shares, strict=True):
        forces[index] = tape.add(forces[index], tape.multiply(share, force))
    dry = [
        each
        for leader, (_, moved) in zip(structure.follows, structure.all_places, strict=True)
        if leader is None
        for each in dry_of_all[moved]
    ]
    slopes = gradient(tape, lagrangian, [*q, *u])
    gaps = []
    for one, other in structure.loops:
        gaps += closing.gap(tape, structure.parents, solids, ((one, read.some(3)), (other, read.some(3))))
    return Parts(q, u, slopes[:held], slopes[held:], forces, dry, shares, solids, gaps, further, guards)


def _driven(
    tape: Tape, structure: Structure, states: Sequence[tuple[list[Node], list[Node]]], first: int
) -> tuple[dict[int, Acting], list[Node]]:
    """The additions of laws to the equations, by the indices of the elements, and `Parts.further`.

    first: the index of the first variable after the coordinates and velocities.
    """
    laws = {index: law for index, law in enumerate(structure.laws) if law is not None}
    integrals = {index: first + count for count, index in enumerate(i for i, law in laws.items() if law.integrates)}
    timed = any(law.timed for law in laws.values())
    clock = tape.variable(first + len(integrals)) if timed else tape.zero
    driven = {}
    for index, law in laws.items():
        numbers = {name: tape.parameter(number) for name, number in structure.law_places[index].items()}
        integral = tape.variable(integrals[index]) if law.integrates else tape.zero
        (q, *_), (u, *_) = states[index]
        driven[index] = acting(tape, law, numbers, (q, u), (integral, clock))
    return driven, [driven[index].error for index in integrals] + [tape.one] * timed


def rows_of(tape: Tape, structure: Structure, parts: Parts) -> list[list[Node]]:
    """The rows of J of `closing`, for the components of gaps that are constraints (`Structure.rows`)."""
    slopes = (gradient(tape, parts.gaps[row], parts.coordinates) for row in structure.rows)
    return [parts.carried(tape, structure, each) for each in slopes]


@functools.lru_cache(maxsize=32)
def derived(structure: Structure) -> Derived:
    """The equations of a structure. The state is all coordinates, then all velocities."""
    tape, places = Tape(), structure.places
    parts = parts_of(tape, structure)
    q, u, momenta = parts.coordinates, parts.velocities, parts.momenta
    rates, drives = [], []
    for kind, (held, moving) in zip(structure.kinds, places, strict=True):
        rates += _rates(tape, kind, q[held], u[moving])
        drives += _drives(tape, kind, q[held], parts.slopes[held], u[moving], momenta[moving])
    changes = along(tape, dict(zip(q, rates, strict=True)), momenta)
    right = [
        tape.add(tape.subtract(drive, change), force)
        for drive, change, force in zip(drives, changes, parts.forces, strict=True)
    ]
    matrix = reduced(tape, mass_matrix(tape, structure.parents, structure.all_places, parts.solids), parts.shares)
    above = order(tape, matrix, len(u))
    moves = [move for _, move in parts.dry]
    driven = [tape.multiply(move, tape.add(force, dry)) for move, force, (dry, _) in zip(moves, right, parts.dry, strict=True)]
    freed = clamped(tape, matrix, moves)
    accelerations = closing.closed(
        tape,
        rows_of(tape, structure, parts),
        u,
        dict(zip(q, rates, strict=True)),
        driven,
        lambda right: solved(tape, freed, right, above),
    )
    inertial = product(tape, matrix, accelerations)
    slots = [places[index][1].start for index in structure.holding]
    strains = tuple((tape.subtract(inertial[slot], right[slot]), matrix[slot, slot]) for slot in slots)
    guards = [*parts.guards, *_holding(tape, structure, [strain for strain, _ in strains], [u[slot] for slot in slots])]
    outputs = *rates, *accelerations, *parts.further
    all_needed = needed(tape, (*outputs, *(guard.node for guard in guards)))
    used = sorted(tape.operations[index][1] for index in all_needed if tape.operations[index][0] == "parameter")
    return Derived(tape, len(outputs), outputs, tuple(used), strains, tuple(guards))


def _holding(tape: Tape, structure: Structure, strains: Sequence[Node], velocities: Sequence[Node]) -> list[Guard]:
    """The guards of elements that can be held: of the force that holds them, and of the velocity against dry friction."""
    guards = []
    for index, strain, velocity in zip(structure.holding, strains, velocities, strict=True):
        numbers = {name: tape.parameter(number) for name, number in structure.law_places[index].items()}
        guards.append(Guard(index, "high", tape.subtract(tape.multiply(numbers["high.share"], strain), numbers["high"])))
        guards.append(Guard(index, "low", tape.subtract(numbers["low"], tape.multiply(numbers["low.share"], strain))))
        law = structure.laws[index]
        if law is not None and law.dry:
            guards.append(Guard(index, "rest", velocity))
    return guards


def _states(
    tape: Tape, structure: Structure, read: _Read, q: list[Node], u: list[Node]
) -> tuple[list[tuple[list[Node], list[Node]]], list[tuple[int, Node]]]:
    """The coordinates and velocities of each element, and `Parts.shares`.

    read: a reader of the factors and terms of elements that follow others. q, u: variables of the state.
    """
    rules = [None if leader is None else (leader, *read.some(2)) for leader in structure.follows]
    states, shares = list[tuple[list[Node], list[Node]]](), list[tuple[int, Node]]()
    for index, (held, moving) in enumerate(structure.places):
        coordinate, rate, (slot, share) = q[held], u[moving], (moving.start, tape.one)
        if rules[index] is not None:
            way = []
            while (rule := rules[index]) is not None:
                way.append(rule)
                index = rule[0]
            held, moving = structure.places[index]
            coordinate, rate, slot = q[held], u[moving], moving.start
            for _, factor, term in reversed(way):
                coordinate = [tape.add(tape.multiply(factor, coordinate[0]), term)]
                rate = [tape.multiply(factor, rate[0])]
                share = tape.multiply(factor, share)
        states.append((coordinate, rate))
        shares += [(slot + k, share) for k in range(len(rate))]
    return states, shares


def _lagrangian(
    tape: Tape, structure: Structure, read: _Read, states: Sequence[tuple[list[Node], list[Node]]]
) -> tuple[Node, list[Node], list[tuple[Node, Node]], list[Solid]]:
    """L, and of all elements the forces of damping, the pairs of `Parts.dry`, and the elements with their inertia.

    states: the coordinates and velocities of each element.
    """
    (gravity,) = read.some(1)
    half = tape.number(0.5)
    moving: list[_Moving] = []
    world = _Moving([tape.zero] * 3, [tape.zero] * 3, [tape.zero, tape.zero, tape.one], tape.zero)
    terms, forces, dry, solids = [], [], [], []
    for kind, parent, falls, (own_q, own_u) in zip(structure.kinds, structure.parents, structure.falls, states, strict=True):
        turned, origin = read.some(9), read.some(3)
        motion, frame = _moved(tape, kind, world if parent is None else moving[parent], turned, origin, own_q, own_u)
        moving.append(motion)
        (mass,), centre, tensor = read.some(1), read.some(3), read.some(6)
        velocity = plus(tape, motion.velocity, cross(tape, motion.omega, centre))
        xx, yy, zz, xy, xz, yz = tensor
        spun = [tape.dot(row, motion.omega) for row in ([xx, xy, xz], [xy, yy, yz], [xz, yz, zz])]
        doubled = tape.add(tape.multiply(mass, tape.dot(velocity, velocity)), tape.dot(motion.omega, spun))
        terms.append(tape.multiply(half, doubled))
        if not falls:
            height = tape.add(motion.height, tape.dot(motion.vertical, centre))
            terms.append(tape.negate(tape.multiply(tape.multiply(mass, gravity), height)))
        armature, damping, stiffness, rest, effort = read.some(5)
        solids.append(Solid(kind, frame, mass, centre, tensor, armature))
        if kind in ("turn", "slide"):
            terms.append(tape.multiply(tape.multiply(half, armature), tape.multiply(own_u[0], own_u[0])))
            stretch = tape.subtract(own_q[0], rest)
            terms.append(tape.negate(tape.multiply(tape.multiply(half, stiffness), tape.multiply(stretch, stretch))))
            terms.append(tape.multiply(effort, own_q[0]))
        damped = [tape.zero] * 3 + own_u[3:] if kind == "free" else own_u
        forces += [tape.negate(tape.multiply(damping, velocity)) for velocity in damped]
        friction, moves = read.some(2)
        dry += [(friction, moves)] * len(own_u)
    return tape.total(terms), forces, dry, solids


def _moved(
    tape: Tape, kind: Kind, parent: _Moving, turned: list[Node], origin: list[Node], q: list[Node], u: list[Node]
) -> tuple[_Moving, Frame]:
    """Return the motion of an element from the motion of its parent, and its frame in the frame of the parent."""
    rows = turned[:3], turned[3:6], turned[6:]

    def across(vector: list[Node]) -> list[Node]:
        return [tape.dot(row, vector) for row in rows]

    omega, vertical = across(parent.omega), across(parent.vertical)
    velocity = across(plus(tape, parent.velocity, cross(tape, parent.omega, origin)))
    height = tape.add(parent.height, tape.dot(parent.vertical, origin))
    none = [tape.zero] * 3
    slid, slides, turns = none, none, none
    columns = [[tape.one if i == j else tape.zero for j in range(3)] for i in range(3)]
    match kind:
        case "turn":
            c, s = tape.cosine(q[0]), tape.sine(q[0])
            columns = [[c, s, tape.zero], [tape.negate(s), c, tape.zero], [tape.zero, tape.zero, tape.one]]
            turns = [tape.zero, tape.zero, u[0]]
        case "slide":
            slid, slides = [tape.zero, tape.zero, q[0]], [tape.zero, tape.zero, u[0]]
        case "ball":
            columns, turns = _axes(tape, q), u
        case "free":
            slid, slides, columns, turns = q[:3], u[:3], _axes(tape, q[3:]), u[3:]
    height = tape.add(height, tape.dot(vertical, slid))
    velocity = plus(tape, plus(tape, velocity, cross(tape, omega, slid)), slides)
    omega, velocity, vertical = ([tape.dot(axis, vector) for axis in columns] for vector in (omega, velocity, vertical))
    return _Moving(plus(tape, omega, turns), velocity, vertical, height), Frame(list(rows), origin, columns, slid)


def _axes(tape: Tape, quaternion: list[Node]) -> list[list[Node]]:
    """The columns of the rotation matrix of a unit quaternion."""
    w, x, y, z = quaternion
    two = tape.number(2.0)

    def both(a: Node, b: Node, c: Node, d: Node, sign: int) -> Node:
        first, second = tape.multiply(a, b), tape.multiply(c, d)
        return tape.multiply(two, tape.add(first, second) if sign > 0 else tape.subtract(first, second))

    def diagonal(a: Node, b: Node) -> Node:
        return tape.subtract(tape.one, tape.multiply(two, tape.add(tape.multiply(a, a), tape.multiply(b, b))))

    return [
        [diagonal(y, z), both(x, y, w, z, 1), both(x, z, w, y, -1)],
        [both(x, y, w, z, -1), diagonal(x, z), both(y, z, w, x, 1)],
        [both(x, z, w, y, 1), both(y, z, w, x, -1), diagonal(x, y)],
    ]


def _directions(tape: Tape, quaternion: list[Node]) -> list[list[Node]]:
    """Twice the derivatives of a quaternion for unit values of the three components of the angular velocity in its frame."""
    w, x, y, z = quaternion
    minus = tape.negate
    return [[minus(x), w, z, minus(y)], [minus(y), minus(z), w, x], [minus(z), y, minus(x), w]]


def _rates(tape: Tape, kind: Kind, q: list[Node], u: list[Node]) -> list[Node]:
    """The time derivatives of the coordinates of an element."""
    if kind in ("turn", "slide"):
        return u
    half = tape.number(0.5)
    directions = _directions(tape, q[-4:])
    turning = [tape.multiply(half, tape.dot(column, u[-3:])) for column in zip(*directions, strict=True)]
    return [*u[:-3], *turning]


def _drives(tape: Tape, kind: Kind, q: list[Node], slopes: list[Node], u: list[Node], momenta: list[Node]) -> list[Node]:
    """X L - omega x p of an element. slopes, momenta: the derivatives of L with respect to its coordinates and velocities."""
    drives = _carried(tape, kind, q, slopes)
    if kind in ("turn", "slide"):
        return drives
    gyroscopic = cross(tape, u[-3:], momenta[-3:])
    return [*drives[:-3], *(tape.subtract(drive, turn) for drive, turn in zip(drives[-3:], gyroscopic, strict=True))]


def _carried(tape: Tape, kind: Kind, q: list[Node], slopes: list[Node]) -> list[Node]:
    """X_i of a function for each velocity of an element. slopes: its derivatives with respect to the element's coordinates."""
    if kind in ("turn", "slide"):
        return slopes
    half = tape.number(0.5)
    return [*slopes[:-4], *(tape.multiply(half, tape.dot(each, slopes[-4:])) for each in _directions(tape, q[-4:]))]
