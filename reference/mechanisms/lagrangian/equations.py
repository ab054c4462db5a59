"""The equations of motion of a mechanism, derived from its Lagrangian by differentiation (Boltzmann and Hamel).

L = T - V is written once, from the velocities of the elements in their own frames. A tape differentiates it. With velocities u
that are the rates of the coordinates or, of a ball, the angular velocity in its frame, and with X_i the derivative by the
coordinates in the direction of u_i,

    d/dt (dL/du_i) + (omega x dL/domega)_i - X_i L = Q_i,

where the second term belongs to balls alone. dL/du_i = p_i is linear in u, so that with the mass matrix M = dp/du

    M du/dt = X L - omega x p - (dp/dq) dq/dt + Q.

M is formed by carrying the second derivatives of T from the leaves of the tree to its root; see `mass_matrix`. Damping is the
force Q.

Equations belong to a structure. Numbers are parameters, but for those that are zero, and rotations by right angles, which
simplify the equations.
"""

import functools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from bodycheck.reference.independent.border import MP, Matrix, Number, Triple
from bodycheck.reference.mechanisms.lagrangian.border import NONE, SIZES, Border, Carried, Kind
from bodycheck.reference.mechanisms.lagrangian.differentiation import Node, Tape, along, cross, gradient, needed, plus
from bodycheck.reference.mechanisms.lagrangian.mass_matrix import Frame, Solid, mass_matrix, order, solved

#: What is known of a number when equations are derived: that it is 0, 1 or -1, or None.
Mark = int | None


@dataclass(frozen=True)
class Structure:
    """What the equations of a mechanism depend on besides numbers.

    Attributes
    ----------
    kinds, parents
        The kinds of the elements, and the elements that they move on.
    falls
        Which elements are seen from a falling frame.
    marks
        What is known of the numbers, in the order of `numbers`.
    """

    kinds: tuple[Kind, ...]
    parents: tuple[int | None, ...]
    falls: tuple[bool, ...]
    marks: tuple[Mark, ...]

    @property
    def places(self) -> list[tuple[slice, slice]]:
        """The slices of the coordinates and velocities of each element among all of them."""
        found, first, second = [], 0, 0
        for kind in self.kinds:
            held, moving = SIZES[kind]
            found.append((slice(first, first + held), slice(second, second + moving)))
            first, second = first + held, second + moving
        return found


@dataclass(frozen=True)
class Units:
    """The units of length (m), mass (kg) and time (s) of the equations, powers of two by which nothing is rounded."""

    length: float
    mass: float
    time: float


@dataclass(frozen=True, eq=False)
class Derived:
    """The equations of a structure.

    Attributes
    ----------
    tape
        Where they are written.
    states
        The number of coordinates and velocities.
    rates
        The derivatives of the coordinates and of the velocities by time.
    used
        The places of those parameters that the equations depend on.
    """

    tape: Tape
    states: int
    rates: tuple[Node, ...]
    used: tuple[int, ...]


def numbers(found: Border, units: Units) -> tuple[Structure, list[Number]]:
    """The structure of a mechanism, and all its numbers, in some units."""
    length, mass, time = MP.mpf(units.length), MP.mpf(units.mass), MP.mpf(units.time)
    values: list[Number] = [MP.mpf(found.gravity) * time**2 / length]
    turns = set()
    for element in found.elements:
        turns |= set(range(len(values), len(values) + 9))
        values += [entry for row in element.turned for entry in row]
        values += [entry / length for entry in element.origin]
        whole, centre, tensor = together(element.carried)
        values += [whole / mass, *(entry / length for entry in centre)]
        values += [tensor[i][j] / (mass * length**2) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
        size = length if element.kind == "slide" else MP.mpf(1)
        inertia = mass if element.kind == "slide" else mass * length**2
        values += [
            element.armature / inertia,
            element.damping * time / inertia,
            element.stiffness * time**2 / inertia,
            element.rest / size,
            element.effort * time**2 / (inertia * size),
        ]
    marks = tuple(_mark(value, place in turns) for place, value in enumerate(values))
    elements = found.elements
    structure = Structure(
        tuple(element.kind for element in elements),
        tuple(element.parent for element in elements),
        tuple(element.falls for element in elements),
        marks,
    )
    return structure, [value for value, mark in zip(values, marks, strict=True) if mark is None]


def together(carried: Sequence[Carried]) -> tuple[Number, Triple, Matrix]:
    """The mass, the centre of mass and the inertia tensor about it of bodies that move as one, in their element's frame."""
    mass = sum((own.mass for own in carried), MP.mpf(0))
    if not mass:
        return mass, NONE, [NONE, NONE, NONE]
    centre = [sum(own.mass * own.centre[axis] for own in carried) / mass for axis in range(3)]
    tensor = [[sum(own.tensor[i][j] for own in carried) for j in range(3)] for i in range(3)]
    for own in carried:
        arm = [a - b for a, b in zip(own.centre, centre, strict=True)]
        square = sum(value * value for value in arm)
        tensor = [[tensor[i][j] + own.mass * ((square if i == j else 0) - arm[i] * arm[j]) for j in range(3)] for i in range(3)]
    return mass, centre, tensor


def _mark(value: Number, turn: bool) -> Mark:
    return int(value) if value == 0 or (turn and abs(value) == 1) else None


@dataclass(frozen=True, eq=False)
class _Moving:
    """How an element moves, along its own axes: angular velocity, velocity of its origin, the vertical; and its height."""

    omega: list[Node]
    velocity: list[Node]
    vertical: list[Node]
    height: Node


@dataclass(frozen=True, eq=False)
class _Read:
    """Where the numbers of a structure are on a tape, one after another."""

    tape: Tape
    nodes: Iterator[Node]

    def some(self, count: int) -> list[Node]:
        return [next(self.nodes) for _ in range(count)]


@dataclass(frozen=True, eq=False)
class Parts:
    """What the equations of a structure are made of, on a tape.

    Attributes
    ----------
    coordinates, velocities
        The variables.
    slopes, momenta
        The derivatives of L by the coordinates and by the velocities.
    forces
        The forces Q of damping along the velocities.
    solids
        What the mass matrix is made of.
    """

    coordinates: list[Node]
    velocities: list[Node]
    slopes: list[Node]
    momenta: list[Node]
    forces: list[Node]
    solids: list[Solid]


def parts_of(tape: Tape, structure: Structure) -> Parts:
    """L and its derivatives. The state is all coordinates, then all velocities."""
    nodes, parameters = [], 0
    for mark in structure.marks:
        nodes.append(tape.parameter(parameters) if mark is None else tape.number(float(mark)))
        parameters += mark is None
    held, moving = structure.places[-1][0].stop, structure.places[-1][1].stop
    q = [tape.variable(index) for index in range(held)]
    u = [tape.variable(held + index) for index in range(moving)]
    lagrangian, forces, solids = _lagrangian(tape, structure, _Read(tape, iter(nodes)), q, u)
    slopes = gradient(tape, lagrangian, [*q, *u])
    return Parts(q, u, slopes[:held], slopes[held:], forces, solids)


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
    matrix = mass_matrix(tape, structure.parents, places, parts.solids)
    found = *rates, *solved(tape, matrix, right, order(structure.parents, places))
    used = sorted(tape.operations[place][1] for place in needed(tape, found) if tape.operations[place][0] == "parameter")
    return Derived(tape, len(q) + len(u), found, tuple(used))


def _lagrangian(
    tape: Tape, structure: Structure, read: _Read, q: list[Node], u: list[Node]
) -> tuple[Node, list[Node], list[Solid]]:
    """L, the forces Q of damping along the velocities, and what the mass matrix is made of."""
    (gravity,) = read.some(1)
    half = tape.number(0.5)
    moving: list[_Moving] = []
    world = _Moving([tape.zero] * 3, [tape.zero] * 3, [tape.zero, tape.zero, tape.one], tape.zero)
    terms, forces, solids = [], [], []
    for kind, parent, falls, (held, moved) in zip(
        structure.kinds, structure.parents, structure.falls, structure.places, strict=True
    ):
        turned, origin = read.some(9), read.some(3)
        own_q, own_u = q[held], u[moved]
        own, frame = _moved(tape, kind, world if parent is None else moving[parent], turned, origin, own_q, own_u)
        moving.append(own)
        (mass,), centre, tensor = read.some(1), read.some(3), read.some(6)
        velocity = plus(tape, own.velocity, cross(tape, own.omega, centre))
        xx, yy, zz, xy, xz, yz = tensor
        spun = [tape.dot(row, own.omega) for row in ([xx, xy, xz], [xy, yy, yz], [xz, yz, zz])]
        doubled = tape.add(tape.multiply(mass, tape.dot(velocity, velocity)), tape.dot(own.omega, spun))
        terms.append(tape.multiply(half, doubled))
        if not falls:
            height = tape.add(own.height, tape.dot(own.vertical, centre))
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
    return tape.total(terms), forces, solids


def _moved(
    tape: Tape, kind: Kind, parent: _Moving, turned: list[Node], origin: list[Node], q: list[Node], u: list[Node]
) -> tuple[_Moving, Frame]:
    """How an element moves, from how its parent moves, and where its frame is in that of the parent."""
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
    """The axes of the frame that a unit quaternion turns, in the frame that it turns it from."""
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
    """By which directions of a quaternion, times 2, the three components of the angular velocity in its frame move it."""
    w, x, y, z = quaternion
    minus = tape.negate
    return [[minus(x), w, z, minus(y)], [minus(y), minus(z), w, x], [minus(z), y, minus(x), w]]


def _rates(tape: Tape, kind: Kind, q: list[Node], u: list[Node]) -> list[Node]:
    """The derivatives of the coordinates of an element by time."""
    if kind in ("turn", "slide"):
        return u
    half = tape.number(0.5)
    directions = _directions(tape, q[-4:])
    turning = [tape.multiply(half, tape.dot(column, u[-3:])) for column in zip(*directions, strict=True)]
    return [*u[:-3], *turning]


def _drives(tape: Tape, kind: Kind, q: list[Node], slopes: list[Node], u: list[Node], momenta: list[Node]) -> list[Node]:
    """X L - omega x p of an element, from the derivatives of L by its coordinates and velocities."""
    if kind in ("turn", "slide"):
        return slopes
    half = tape.number(0.5)
    turning = [tape.multiply(half, tape.dot(direction, slopes[-4:])) for direction in _directions(tape, q[-4:])]
    gyroscopic = cross(tape, u[-3:], momenta[-3:])
    return [*slopes[:-4], *(tape.subtract(own, turn) for own, turn in zip(turning, gyroscopic, strict=True))]
