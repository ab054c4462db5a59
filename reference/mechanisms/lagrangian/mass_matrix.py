"""The mass matrix of a mechanism, M = d2T/du2, and the solution of its equations.

If an element moves together with all elements that it carries as one rigid body, the kinetic energy is a quadratic form in the
motion of the element's frame: its coefficients are a mass, a first moment and an inertia tensor about the origin. They are
added from the leaves of the tree to its root, since T is a sum over bodies, and the motion of a child's frame is linear in the
motion of its parent's frame. The momenta for a unit value of one velocity are then transformed to the frames towards the root;
their components along the velocities there are entries of M.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from bodycheck.reference.mechanisms.lagrangian.border import Kind
from bodycheck.reference.mechanisms.lagrangian.differentiation import Node, Tape, cross, plus

#: A vector, and rows of a matrix.
Vector = list[Node]
Rows = list[Vector]

#: The entries (i, j) of a mass matrix with j = i, or with j on the way from i to the root. All other entries are symmetric to
#: these, or 0.
Entries = dict[tuple[int, int], Node]


@dataclass(frozen=True, eq=False)
class Frame:
    """The frame of an element in the frame of its parent. At coordinates of zero it coincides with the zero frame.

    turned: rows of the matrix from the frame of the parent to the zero frame. origin: of the zero frame, in the frame of the
    parent. axes: of the element, in the zero frame. slid: the origin of the element in the zero frame.
    """

    turned: Rows
    origin: Vector
    axes: Rows
    slid: Vector


@dataclass(frozen=True, eq=False)
class Solid:
    """An element, its armature, and the mass, centre and inertia (XX, YY, ZZ, XY, XZ, YZ) about it of the bodies it carries."""

    kind: Kind
    frame: Frame
    mass: Node
    centre: Vector
    tensor: Vector
    armature: Node


@dataclass(frozen=True, eq=False)
class _Inertia:
    """Mass, first moment, and inertia tensor about the origin of a frame."""

    mass: Node
    moment: Vector
    tensor: Rows

    def shifted(self, tape: Tape, origin: Vector) -> "_Inertia":
        """Convert to a parallel frame. origin: the origin of this frame in that frame."""
        moved = plus(tape, self.moment, [tape.multiply(self.mass, part) for part in origin])
        both = tape.add(tape.dot(origin, self.moment), tape.dot(origin, moved))

        def entry(i: int, j: int) -> Node:
            crossed = tape.add(tape.multiply(origin[i], self.moment[j]), tape.multiply(moved[i], origin[j]))
            return tape.add(self.tensor[i][j], tape.subtract(both if i == j else tape.zero, crossed))

        return _Inertia(self.mass, moved, _symmetric(entry))

    def turned(self, tape: Tape, rows: Rows) -> "_Inertia":
        """Convert to a turned frame. rows: of the matrix from this frame to that frame."""
        half = [[tape.dot(row, column) for column in self.tensor] for row in rows]
        return _Inertia(
            self.mass,
            [tape.dot(row, self.moment) for row in rows],
            _symmetric(lambda i, j: tape.dot(half[i], rows[j])),
        )

    def plus(self, tape: Tape, other: "_Inertia") -> "_Inertia":
        """The sum of two inertias in the same frame."""
        rows = [plus(tape, one, two) for one, two in zip(self.tensor, other.tensor, strict=True)]
        return _Inertia(tape.add(self.mass, other.mass), plus(tape, self.moment, other.moment), rows)

    def momenta(self, tape: Tape, omega: Vector, velocity: Vector) -> tuple[Vector, Vector]:
        """The angular momentum about the origin and the linear momentum, for an angular velocity and velocity of the frame."""
        linear = plus(tape, [tape.multiply(self.mass, part) for part in velocity], cross(tape, omega, self.moment))
        turning = [tape.dot(row, omega) for row in self.tensor]
        return plus(tape, turning, cross(tape, self.moment, velocity)), linear


def mass_matrix(
    tape: Tape, parents: Sequence[int | None], places: Sequence[tuple[slice, slice]], solids: Sequence[Solid]
) -> Entries:
    """The entries of M. places: the slices of the coordinates and velocities of each element."""
    whole = [_about_origin(tape, solid) for solid in solids]
    for index in reversed(range(len(solids))):
        if (parent := parents[index]) is not None:
            frame = solids[index].frame
            at_zero = whole[index].turned(tape, _transposed(frame.axes)).shifted(tape, frame.slid)
            whole[parent] = whole[parent].plus(
                tape, at_zero.turned(tape, _transposed(frame.turned)).shifted(tape, frame.origin)
            )
    entries: Entries = {}
    for index, solid in enumerate(solids):
        first = places[index][1].start
        motions = _motions(tape, solid)
        for k, (omega, velocity) in enumerate(motions):
            turning, linear = whole[index].momenta(tape, omega, velocity)
            for j, motion in enumerate(motions[: k + 1]):
                entries[first + k, first + j] = _along(tape, motion, turning, linear)
            if solid.kind in ("turn", "slide"):
                entries[first, first] = tape.add(entries[first, first], solid.armature)
            for step, (angular, straight) in _towards_the_root(tape, parents, solids, index, (turning, linear)):
                for j, motion in enumerate(_motions(tape, solids[step])):
                    entries[first + k, places[step][1].start + j] = _along(tape, motion, angular, straight)
    return entries


def _towards_the_root(
    tape: Tape, parents: Sequence[int | None], solids: Sequence[Solid], index: int, momenta: tuple[Vector, Vector]
) -> Iterator[tuple[int, tuple[Vector, Vector]]]:
    """Yield the index of each element on the way to the root, and momenta in its frame, about its origin.

    momenta: the angular and the linear momentum in the frame of the element `index`.
    """
    turning, linear = momenta
    while (parent := parents[index]) is not None:
        frame = solids[index].frame
        for rows, origin in ((frame.axes, frame.slid), (frame.turned, frame.origin)):
            turning, linear = ([tape.dot(row, vector) for row in _transposed(rows)] for vector in (turning, linear))
            turning = plus(tape, turning, cross(tape, origin, linear))
        index = parent
        yield index, (turning, linear)


def _about_origin(tape: Tape, solid: Solid) -> _Inertia:
    """The inertia of the bodies that an element carries, about its origin."""
    xx, yy, zz, xy, xz, yz = solid.tensor
    central = _Inertia(solid.mass, [tape.zero] * 3, [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return central.shifted(tape, solid.centre)


def _motions(tape: Tape, solid: Solid) -> list[tuple[Vector, Vector]]:
    """The angular velocity and velocity of the origin, in an element's frame, for a unit value of each of its velocities."""
    none = [tape.zero] * 3
    unit = [[tape.one if i == j else tape.zero for j in range(3)] for i in range(3)]
    spins = [(axis, none) for axis in unit]
    match solid.kind:
        case "turn":
            return [(unit[2], none)]
        case "slide":
            return [(none, unit[2])]
        case "ball":
            return spins
        case "free":
            return [*((none, column) for column in _transposed(solid.frame.axes)), *spins]


def _along(tape: Tape, motion: tuple[Vector, Vector], turning: Vector, linear: Vector) -> Node:
    """The component of an angular and a linear momentum along a motion, a pair from `_motions`."""
    omega, velocity = motion
    return tape.add(tape.dot(omega, turning), tape.dot(velocity, linear))


def _symmetric(entry: Callable[[int, int], Node]) -> Rows:
    upper = {(i, j): entry(i, j) for i in range(3) for j in range(i, 3)}
    return [[upper[min(i, j), max(i, j)] for j in range(3)] for i in range(3)]


def _transposed(rows: Rows) -> Rows:
    return [list(column) for column in zip(*rows, strict=True)]


def reduced(tape: Tape, matrix: Entries, shares: Sequence[tuple[int, Node]]) -> Entries:
    """The mass matrix S^T M S of velocities that determine others.

    shares: for each velocity of M the index of the velocity that determines it, and the factor of the latter, in order.
    """
    entries: Entries = {}
    for (i, j), entry in matrix.items():
        (one, first), (other, second) = shares[i], shares[j]
        part = tape.multiply(tape.multiply(first, second), entry)
        if one == other and i != j:
            part = tape.add(part, part)
        pair = max(one, other), min(one, other)
        entries[pair] = tape.add(entries.get(pair, tape.zero), part)
    return entries


def order(tape: Tape, matrix: Entries, size: int) -> list[int | None]:
    """For each velocity, the next one on the way on which its elimination changes M; None for the last one.

    Without elements that follow others it is the velocity before it on the way to the root. Entries on these ways that are
    absent from M are added to it as zeros.
    """
    changed = [{j for j in range(i) if (i, j) in matrix} for i in range(size)]
    above: list[int | None] = []
    for i in reversed(range(size)):
        above.insert(0, max(changed[i], default=None))
        if changed[i]:
            changed[max(changed[i])] |= changed[i] - {max(changed[i])}
    for i in range(size):
        for j in _path(above, i):
            matrix.setdefault((i, j), tape.zero)
    return above


def _path(above: Sequence[int | None], velocity: int) -> Iterator[int]:
    """The indices of the velocities on the way from a velocity, which is excluded, to the root."""
    step = above[velocity]
    while step is not None:
        yield step
        step = above[step]


def solved(tape: Tape, matrix: Entries, right: list[Node], above: Sequence[int | None]) -> list[Node]:
    """The solution x of M x = b.

    M is factored into L^T D L from the leaves of the tree to its root, so that zeros of M remain zeros (Featherstone, Rigid
    Body Dynamics Algorithms, 2008, section 6.5). above: from `order`.
    """
    h, x = dict(matrix), list(right)
    lower: Entries = {}
    for k in reversed(range(len(x))):
        for i in _path(above, k):
            lower[k, i] = tape.divide(h[k, i], h[k, k])
            for j in (i, *_path(above, i)):
                h[i, j] = tape.subtract(h[i, j], tape.multiply(lower[k, i], h[k, j]))
        for i in _path(above, k):
            x[i] = tape.subtract(x[i], tape.multiply(lower[k, i], x[k]))
    x = [tape.divide(value, h[k, k]) for k, value in enumerate(x)]
    for k in range(len(x)):
        for i in _path(above, k):
            x[k] = tape.subtract(x[k], tape.multiply(lower[k, i], x[i]))
    return x


def clamped(tape: Tape, matrix: Entries, moves: Sequence[Node]) -> Entries:
    """The mass matrix without the entries off the diagonal of velocities that are held. moves: 1, or 0 for a held velocity."""
    entries = dict(matrix)
    for (i, j), entry in matrix.items():
        if i != j:
            entries[i, j] = tape.multiply(tape.multiply(moves[i], moves[j]), entry)
    return entries


def product(tape: Tape, matrix: Entries, vector: Sequence[Node]) -> list[Node]:
    """The product of a mass matrix and a vector."""
    result = [tape.zero] * len(vector)
    for (i, j), entry in matrix.items():
        result[i] = tape.add(result[i], tape.multiply(entry, vector[j]))
        if i != j:
            result[j] = tape.add(result[j], tape.multiply(entry, vector[i]))
    return result
