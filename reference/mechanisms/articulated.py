"""The articulated-body recursion (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 7) in any arithmetic.

Numbers are floats, arrays of any type, or expressions of heyoka, which drops terms that are multiplied by zero. So the
recursion of a plane chain contains only the operations of plane motion. All vectors are along the axes of the frames of links
(see `tree`). Accelerations refer to the origin of such a frame, angular before linear, and so do forces, torque before force.

The first pass computes the acceleration that each link would have if no joint accelerated, and the force that this requires.
The second pass goes from the tips to the root: it computes the inertia of each link with all links that hang from it,
eliminates one coordinate after another, and passes the remaining inertia and force to the parent. The third pass computes the
joints' accelerations from the root to the tips. Only angular velocities are needed, not the velocities of origins.
"""

import operator
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

#: A number of the arithmetic in use, a vector of three, and the rows of a matrix.
Number = Any
Vec = list[Number]
Rows = list[Vec]

#: The kinds of elementary joints.
Kind = Literal["revolute", "prismatic", "ball", "free"]

#: Which components of a link's acceleration along its own axes each kind of joint leaves free, in the order of elimination.
FREEDOMS: dict[Kind, tuple[int, ...]] = {
    "revolute": (2,),
    "prismatic": (5,),
    "ball": (0, 1, 2),
    "free": (3, 4, 5, 0, 1, 2),
}

ZERO: Vec = [0, 0, 0]


@dataclass(frozen=True, eq=False)
class Accelerations:
    """The derivatives of the rates of each link; of a free link the acceleration (6,), without gravity, along its own axes.

    strains: for each link with one coordinate, minus the force that would keep the joint from accelerating.
    """

    rates: list[Vec]
    strains: list[Number]


@dataclass(frozen=True, eq=False)
class Constants:
    """The constants of a link.

    Attributes
    ----------
    turn, offset
        (9,) rows of the rotation from the axes of the joint to those of the parent, and (3,) the joint's origin in the
        parent's frame (m).
    mass, moment
        Mass (kg), and (3,) mass times the centre of mass (kg m).
    tensor, differences
        (6,) inertia XX, YY, ZZ, XY, XZ, YZ about the origin, and (3,) ZZ - YY, XX - ZZ, YY - XX (kg m^2).
    armature, damping, stiffness, force
        Inertia and force along the joint's own coordinate; the force is `force` - `stiffness` q - `damping` v.
    moves
        1, or 0 for a joint that is held fixed.
    """

    turn: Sequence[Number]
    offset: Sequence[Number]
    mass: Number
    moment: Sequence[Number]
    tensor: Sequence[Number]
    differences: Sequence[Number]
    armature: Number
    damping: Number
    stiffness: Number
    force: Number
    moves: Number


@dataclass(frozen=True, eq=False)
class Link:
    """A link in any arithmetic: its kind, the index of its parent (-1: the fixed base), its constants and its state.

    coordinates: q of a revolute or prismatic joint, else the quaternion w, x, y, z from the link's axes to the joint's axes.
    rates: v of a revolute or prismatic joint, else the angular velocity (3,) relative to the joint, along the link's axes.
    """

    kind: Kind
    parent: int
    constants: Constants
    coordinates: Sequence[Number]
    rates: Sequence[Number]


@dataclass(frozen=True, eq=False)
class _Motion:
    """The results of the outward pass for a link.

    spin: angular velocity. squares: the matrix that maps a point of the link to its centripetal acceleration. angular, linear:
    the acceleration if no joint accelerated. rotation, displacement: the rotation and the displacement of the joint.
    """

    spin: Vec
    squares: Rows
    angular: Vec
    linear: Vec
    rotation: "Rotation"
    displacement: Vec


@dataclass(frozen=True, eq=False)
class _Step:
    """The numbers from which the acceleration along an eliminated coordinate follows.

    component: the index of the coordinate among the six. The acceleration is `given` - `ratio` . a, where a (6,) is the
    acceleration of the link without this coordinate: `given` is due to the forces. weight: the inertia along the coordinate.
    moves: as in `Constants`.
    """

    component: int
    ratio: Vec
    given: Number
    weight: Number
    moves: Number


class Rotation:
    """A rotation from a child's axes to its parent's axes, given by a matrix."""

    def __init__(self, rows: Rows) -> None:
        self.rows = rows

    def out(self, v: Vec) -> Vec:
        """Convert a vector from the parent's axes to the child's axes."""
        return [_dot([row[k] for row in self.rows], v) for k in range(3)]

    def back(self, v: Vec) -> Vec:
        """Convert a vector from the child's axes to the parent's axes."""
        return [_dot(row, v) for row in self.rows]

    def block(self, block: Rows, symmetric: bool) -> Rows:
        """Convert a matrix from the child's axes to the parent's axes."""
        half = [[_dot(row, [line[k] for line in block]) for k in range(3)] for row in self.rows]
        if not symmetric:
            return [[_dot(line, row) for row in self.rows] for line in half]
        return _mirrored(lambda i, j: _dot(half[i], self.rows[j]))


class AboutZ(Rotation):
    """A rotation about z, given by its cosine and sine."""

    def __init__(self, cosine: Number, sine: Number) -> None:
        super().__init__([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
        self.cosine, self.sine = cosine, sine

    def block(self, block: Rows, symmetric: bool) -> Rows:
        """Convert a matrix from the child's axes to the parent's axes.

        In the first two rows and columns, the trace and the antisymmetric part do not change, and the remaining part turns by
        twice the angle.
        """
        (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = block
        double_sine, double_cosine = 2 * self.sine * self.cosine, 1 - 2 * self.sine * self.sine
        mean, half = (xx + yy) / 2, (xx - yy) / 2
        across, skew = (xy, 0) if symmetric else ((xy + yx) / 2, (xy - yx) / 2)
        half, across = half * double_cosine - across * double_sine, half * double_sine + across * double_cosine
        right, up, _ = self.back([xz, yz, 0])
        far, near = (right, up) if symmetric else self.back([zx, zy, 0])[:2]
        return [[mean + half, across + skew, right], [across - skew, mean - half, up], [far, near, zz]]


def quaternion_rows(q: Sequence[Number]) -> Rows:
    """The rotation matrix of a unit quaternion w, x, y, z."""
    w, x, y, z = q
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]


def accelerations(links: Sequence[Link], gravity: Sequence[Number], functions: Any) -> Accelerations:
    """The accelerations of all links.

    Parameters
    ----------
    links
        The links, each after its parent.
    gravity
        (3,) gravitational acceleration along the axes of the fixed base (m/s^2).
    functions
        A module or object with the functions `sin` and `cos` of the arithmetic.
    """
    motions, forces = _outward(links, gravity, functions)
    inertias = [_rigid(link.constants) for link in links]
    eliminated: list[list[_Step]] = []
    for index in reversed(range(len(links))):
        link, motion, (inertia, force) = links[index], motions[index], (inertias[index], forces[index])
        steps = []
        for k, effort in zip(FREEDOMS[link.kind], _efforts(link), strict=True):
            inertia, force, step = _eliminate(inertia, force, k, effort, link.constants)
            steps.append(step)
        eliminated.append(steps)
        if link.parent >= 0:
            inertia, force = _passed(inertia, force, link.constants, motion)
            inertias[link.parent] = _sum_rows(inertias[link.parent], inertia)
            forces[link.parent] = _sum(forces[link.parent], force)
    return _solved(links, motions, eliminated[::-1])


def _outward(links: Sequence[Link], gravity: Sequence[Number], functions: Any) -> tuple[list[_Motion], list[Vec]]:
    still = _Motion(ZERO, [ZERO] * 3, ZERO, [-part for part in gravity], Rotation([]), ZERO)
    motions: list[_Motion] = []
    for link in links:
        parent = motions[link.parent] if link.parent >= 0 else still
        motions.append(_moved(link, parent, functions))
    return motions, [_inertial_force(link.constants, motion) for link, motion in zip(links, motions, strict=True)]


def _moved(link: Link, parent: _Motion, functions: Any) -> _Motion:
    """The motion of a link if its joint does not accelerate. parent: the motion of its parent."""
    turn, offset = Rotation(_square(link.constants.turn)), list(link.constants.offset)
    spin, angular = turn.out(parent.spin), turn.out(parent.angular)
    at_joint = _sum(parent.linear, [_dot(row, offset) for row in parent.squares])
    linear = turn.out(_sum(at_joint, _cross(parent.angular, offset)))
    if link.kind == "prismatic":
        (q,), (v,) = link.coordinates, link.rates
        squares = [turn.out(row) for row in parent.squares]
        column = turn.out([row[2] for row in squares])
        linear = [
            linear[0] + column[0] * q + angular[1] * q + 2 * spin[1] * v,
            linear[1] + column[1] * q - angular[0] * q - 2 * spin[0] * v,
            linear[2] + column[2] * q,
        ]
        rotation, relative, displacement = Rotation([[1, 0, 0], [0, 1, 0], [0, 0, 1]]), ZERO, [0, 0, q]
    elif link.kind == "revolute":
        rotation, relative, displacement = AboutZ(*_cosine_sine(link, functions)), [0, 0, link.rates[0]], ZERO
    else:
        rotation, relative, displacement = Rotation(quaternion_rows(link.coordinates)), list(link.rates), ZERO
    carried = rotation.out(spin)
    spin, angular = _sum(carried, relative), _sum(rotation.out(angular), _cross(carried, relative))
    return _Motion(spin, _squares(spin), angular, rotation.out(linear), rotation, displacement)


def _cosine_sine(link: Link, functions: Any) -> tuple[Number, Number]:
    return functions.cos(link.coordinates[0]), functions.sin(link.coordinates[0])


def _squares(spin: Vec) -> Rows:
    x, y, z = spin
    xx, yy, zz, xy, xz, yz = x * x, y * y, z * z, x * y, x * z, y * z
    return [[-(yy + zz), xy, xz], [xy, -(xx + zz), yz], [xz, yz, -(xx + yy)]]


def _inertial_force(constants: Constants, motion: _Motion) -> Vec:
    """The torque and the force (6,) that the motion of a rigid link requires."""
    moment, (xx, yy, zz, xy, xz, yz) = list(constants.moment), constants.tensor
    (x, y, z), (_, (_, _, s_yz), _) = motion.spin, motion.squares
    (_, s_xy, s_xz), (dx, dy, dz) = motion.squares[0], constants.differences
    gyroscopic = [
        dx * s_yz + yz * (y * y - z * z) + xz * s_xy - xy * s_xz,
        dy * s_xz + xz * (z * z - x * x) + xy * s_yz - yz * s_xy,
        dz * s_xy + xy * (x * x - y * y) + yz * s_xz - xz * s_yz,
    ]
    rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    torque = _sum([_dot(row, motion.angular) for row in rows], _cross(moment, motion.linear))
    swung = _sum([_dot(row, moment) for row in motion.squares], _cross(motion.angular, moment))
    return [*_sum(torque, gyroscopic), *_sum([constants.mass * part for part in motion.linear], swung)]


def _rigid(constants: Constants) -> Rows:
    """The inertia (6, 6) of a rigid link about its origin."""
    (xx, yy, zz, xy, xz, yz), (x, y, z), m = constants.tensor, constants.moment, constants.mass
    return [
        [xx, xy, xz, 0, -z, y],
        [xy, yy, yz, z, 0, -x],
        [xz, yz, zz, -y, x, 0],
        [0, z, -y, m, 0, 0],
        [-z, 0, x, 0, m, 0],
        [y, -x, 0, 0, 0, m],
    ]


def _efforts(link: Link) -> list[Number]:
    """The forces of a joint along its degrees of freedom, in the order of `FREEDOMS`."""
    constants = link.constants
    if len(link.coordinates) == 1:
        (q,), (v,) = link.coordinates, link.rates
        return [constants.force - constants.stiffness * q - constants.damping * v]
    if link.kind == "ball":
        return [-constants.damping * rate for rate in link.rates]
    return [0] * 6


def _eliminate(inertia: Rows, force: Vec, k: int, effort: Number, constants: Constants) -> tuple[Rows, Vec, _Step]:
    """Return inertia and force without the coordinate along component k, and the numbers that determine its acceleration."""
    armature, moves = constants.armature, constants.moves
    column = [row[k] for row in inertia]
    weight = column[k] + armature
    inverse = 1 / weight
    ratio = [entry * inverse for entry in column]
    released, need = [entry * moves for entry in ratio], effort - force[k]
    left = _mirrored(lambda i, j: inertia[i][j] - column[i] * released[j], 6)
    rest = [part + share * need for part, share in zip(force, released, strict=True)]
    # Along the coordinate itself only the armature remains, or the whole inertia if it is held; these terms do not cancel.
    kept = (armature + (1 - moves) * column[k]) * inverse
    for j in range(6):
        left[k][j] = left[j][k] = column[j] * kept
    if _absent(armature) and not _absent(moves) and isinstance(moves, int):
        rest[k] = effort
    return left, rest, _Step(k, ratio, need * inverse, weight, moves)


def _passed(inertia: Rows, force: Vec, constants: Constants, motion: _Motion) -> tuple[Rows, Vec]:
    """Convert inertia and force of a link to the axes and the origin of its parent."""
    turned, moved = (motion.rotation, motion.displacement), (Rotation(_square(constants.turn)), list(constants.offset))
    for rotation, shift in (turned, moved):
        blocks = [[row[:3] for row in inertia[:3]], [row[3:] for row in inertia[:3]], [row[3:] for row in inertia[3:]]]
        angular, mixed, linear = (rotation.block(block, k != 1) for k, block in enumerate(blocks))
        torque, push = rotation.back(force[:3]), rotation.back(force[3:])
        inertia = _shifted(angular, mixed, linear, shift)
        force = [*_sum(torque, _cross(shift, push)), *push]
    return inertia, force


def _shifted(angular: Rows, mixed: Rows, linear: Rows, shift: Vec) -> Rows:
    """The inertia (6, 6) about a new point, from which the present point is at `shift`."""
    added = _transposed([_cross(shift, row) for row in linear])
    after = _sum_rows(mixed, added)
    before, beyond = [_cross(shift, row) for row in mixed], [_cross(shift, row) for row in after]
    partial = _mirrored(lambda i, j: angular[i][j] + before[i][j] + beyond[j][i])
    return [
        *(a + b for a, b in zip(partial, after, strict=True)),
        *(a + b for a, b in zip(_transposed(after), linear, strict=True)),
    ]


def _solved(links: Sequence[Link], motions: list[_Motion], eliminated: list[list[_Step]]) -> Accelerations:
    """The accelerations of the joints, from the root to the tips."""
    extra: list[Vec] = []
    rates: list[Vec] = []
    strains: list[Number] = []
    for link, motion, steps in zip(links, motions, eliminated, strict=True):
        if link.parent >= 0:
            angular, linear = extra[link.parent][:3], extra[link.parent][3:]
            for rotation, shift in (
                (Rotation(_square(link.constants.turn)), list(link.constants.offset)),
                (motion.rotation, motion.displacement),
            ):
                # The displacement is along the axes before the rotation, which do not differ from those after it for a slider.
                linear = rotation.out(_sum(linear, _cross(angular, shift)))
                angular = rotation.out(angular)
            whole = [*angular, *linear]
        else:
            whole = [0] * 6
        along: dict[int, Number] = {}
        for step in reversed(steps):
            k, released = step.component, step.given - _dot(step.ratio, whole)
            along[k] = step.moves * released
            whole[k] = whole[k] + along[k]
        extra.append(whole)
        rates.append([along[k] for k in sorted(along)])
        strains.append(step.weight * released)
    return Accelerations(rates, strains)


def _absent(value: Number) -> bool:
    return isinstance(value, int) and value == 0


def _dot(a: Sequence[Number], b: Sequence[Number]) -> Number:
    return sum(map(operator.mul, a, b))


def _cross(a: Vec, b: Vec) -> Vec:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _sum(a: Vec, b: Vec) -> Vec:
    return [one + other for one, other in zip(a, b, strict=True)]


def _sum_rows(a: Rows, b: Rows) -> Rows:
    return [_sum(one, other) for one, other in zip(a, b, strict=True)]


def _transposed(rows: Rows) -> Rows:
    return [list(column) for column in zip(*rows, strict=True)]


def _square(entries: Sequence[Number]) -> Rows:
    return [list(entries[3 * k : 3 * k + 3]) for k in range(3)]


def _mirrored(entry: Any, size: int = 3) -> Rows:
    """The symmetric matrix whose entries on and above the diagonal are entry(i, j)."""
    half = {(i, j): entry(i, j) for i in range(size) for j in range(i, size)}
    return [[half[min(i, j), max(i, j)] for j in range(size)] for i in range(size)]
