"""The articulated-body recursion (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 7) in any arithmetic.

Numbers are floats, arrays of any type, or expressions of heyoka, which drops terms that are multiplied by zero. So the
recursion of a plane chain contains only the operations of plane motion. All vectors are along the axes of the frames of links
(see `tree`). Accelerations refer to the origin of such a frame, angular before linear, and so do forces, torque before force.

The first pass computes the acceleration that each link would have if no joint accelerated, and the force that this requires.
The second pass goes from the tips to the root: it computes the inertia of each link with all links that hang from it,
eliminates one coordinate after another, and passes the remaining inertia and force to the parent. The third pass computes the
joints' accelerations from the root to the tips. Only angular velocities are needed, not the velocities of origins.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from bodycheck.reference.mechanisms.articulation.coupling import Shared
from bodycheck.reference.mechanisms.articulation.spatial import (
    ZERO,
    AboutZ,
    Number,
    Rotation,
    Rows,
    Vec,
    cross,
    dot,
    mirrored,
    plus,
    plus_rows,
    quaternion_rows,
    square,
    transposed,
)

#: The kinds of elementary joints.
Kind = Literal["revolute", "prismatic", "ball", "free"]

#: Which components of a link's acceleration along its own axes each kind of joint leaves free, in the order of elimination.
FREEDOMS: dict[Kind, tuple[int, ...]] = {
    "revolute": (2,),
    "prismatic": (5,),
    "ball": (0, 1, 2),
    "free": (3, 4, 5, 0, 1, 2),
}


@dataclass(frozen=True, eq=False)
class Accelerations:
    """The derivatives of the rates of each link; of a free link the acceleration (6,), without gravity, along its own axes.

    strains: for each link with one coordinate, minus the force that would keep the joint from accelerating. pivots: of the mass
    matrix, for the coordinates of each link.
    """

    rates: list[Vec]
    strains: list[Number]
    pivots: list[Vec]


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
    ratio, shift
        Of a link that follows another one: its coordinate is `ratio` times that of the other link plus `shift`. Otherwise 0.
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
    ratio: Number
    shift: Number
    moves: Number


@dataclass(frozen=True, eq=False)
class Link:
    """A link in any arithmetic: its kind, the index of its parent (-1: the fixed base), its constants and its state.

    coordinates: q of a revolute or prismatic joint, else the quaternion w, x, y, z from the link's axes to the joint's axes.
    rates: v of a revolute or prismatic joint, else the angular velocity (3,) relative to the joint, along the link's axes.
    leader, share: of a link that follows another one, or is followed, the index of the link that leads, and the derivative of
    its coordinate with respect to the coordinate of that link.
    """

    kind: Kind
    parent: int
    constants: Constants
    coordinates: Sequence[Number]
    rates: Sequence[Number]
    leader: int | None = None
    share: Number = 1


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


#: The torque and the force (6,) that unit accelerations of leaders require, by the indices of their links.
Responses = dict[int, Vec]


@dataclass(frozen=True, eq=False)
class _Load:
    """A link with all links that hang from it: its inertia (6, 6), the force (6,) that its motion requires, and `Responses`."""

    inertia: Rows
    force: Vec
    answers: Responses


@dataclass(frozen=True, eq=False)
class _Step:
    """The numbers from which the acceleration along an eliminated coordinate follows.

    component: the index of the coordinate among the six. The acceleration is `given` - `ratio` . a - `answers` . b, where
    a (6,) is the acceleration of the link without this coordinate, and b are the accelerations of the leaders: `given` is due
    to the forces. weight: the inertia along the coordinate. moves: as in `Constants`.
    """

    component: int
    ratio: Vec
    given: Number
    answers: dict[int, Number]
    weight: Number
    moves: Number


def accelerations(links: Sequence[Link], gravity: Sequence[Number], functions: Any) -> Accelerations:
    """The accelerations of all links.

    Parameters
    ----------
    links
        The links, each after its parent.
    gravity
        (3,) gravitational acceleration along the axes of the fixed base (m/s^2). A free link is followed relative to free fall.
    functions
        A module or object with the functions `sin` and `cos` of the arithmetic.
    """
    motions, forces = _outward(links, gravity, functions)
    inertias = [_rigid(link.constants) for link in links]
    shared = Shared(link.leader for link in links if link.leader is not None)
    answers: list[Responses] = [{} for _ in links]
    eliminated: list[list[_Step]] = []
    for index in reversed(range(len(links))):
        link, motion, load = links[index], motions[index], _Load(inertias[index], forces[index], answers[index])
        steps = []
        for k, effort in zip(FREEDOMS[link.kind], _efforts(link), strict=True):
            if link.leader is None:
                load, step = _eliminate(load, k, effort, link.constants, shared)
                steps.append(step)
            else:
                load = _held(load, k, effort, link, shared)
        eliminated.append(steps)
        if link.parent >= 0:
            passed = _passed(load, link.constants, motion)
            inertias[link.parent] = plus_rows(inertias[link.parent], passed.inertia)
            forces[link.parent] = plus(forces[link.parent], passed.force)
            answers[link.parent] = _together(answers[link.parent], passed.answers)
    leading, pivots = shared.accelerations()
    solution = _solved(links, motions, eliminated[::-1], leading)
    for leader, pivot in pivots.items():
        solution.pivots[leader].append(pivot)
    return solution


def _outward(links: Sequence[Link], gravity: Sequence[Number], functions: Any) -> tuple[list[_Motion], list[Vec]]:
    still, falling = (_Motion(ZERO, [ZERO] * 3, ZERO, pull, Rotation([]), ZERO) for pull in ([-part for part in gravity], ZERO))
    motions: list[_Motion] = []
    for link in links:
        parent = motions[link.parent] if link.parent >= 0 else falling if link.kind == "free" else still
        motions.append(_moved(link, parent, functions))
    return motions, [_inertial_force(link.constants, motion) for link, motion in zip(links, motions, strict=True)]


def _moved(link: Link, parent: _Motion, functions: Any) -> _Motion:
    """The motion of a link if its joint does not accelerate. parent: the motion of its parent."""
    turn, offset = Rotation(square(link.constants.turn)), list(link.constants.offset)
    spin, angular = turn.out(parent.spin), turn.out(parent.angular)
    at_joint = plus(parent.linear, [dot(row, offset) for row in parent.squares])
    linear = turn.out(plus(at_joint, cross(parent.angular, offset)))
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
    spin, angular = plus(carried, relative), plus(rotation.out(angular), cross(carried, relative))
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
    torque = plus([dot(row, motion.angular) for row in rows], cross(moment, motion.linear))
    swung = plus([dot(row, moment) for row in motion.squares], cross(motion.angular, moment))
    return [*plus(torque, gyroscopic), *plus([constants.mass * part for part in motion.linear], swung)]


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


def _eliminate(load: _Load, k: int, effort: Number, constants: Constants, shared: Shared) -> tuple[_Load, _Step]:
    """Return a load without the coordinate along component k, and the numbers that determine the acceleration of the latter."""
    armature, moves = constants.armature, constants.moves
    column = [row[k] for row in load.inertia]
    weight = column[k] + armature
    inverse = 1 / weight
    ratio = [entry * inverse for entry in column]
    released, need = [entry * moves for entry in ratio], effort - load.force[k]
    left = mirrored(lambda i, j: load.inertia[i][j] - column[i] * released[j], 6)
    rest = [part + share * need for part, share in zip(load.force, released, strict=True)]
    # Along the coordinate itself only the armature remains, or the whole inertia if it is held; these terms do not cancel.
    kept = (armature + (1 - moves) * column[k]) * inverse
    for j in range(6):
        left[k][j] = left[j][k] = column[j] * kept
    if _absent(armature) and not _absent(moves) and isinstance(moves, int):
        rest[k] = effort
    along = {leader: answer[k] for leader, answer in load.answers.items()}
    shared.release(moves * inverse, need, along)
    answers = {}
    for leader, answer in load.answers.items():
        answers[leader] = [part - share * answer[k] for part, share in zip(answer, released, strict=True)]
        answers[leader][k] = answer[k] * kept
    step = _Step(k, ratio, need * inverse, {leader: part * inverse for leader, part in along.items()}, weight, moves)
    return _Load(left, rest, answers), step


def _held(load: _Load, k: int, effort: Number, link: Link, shared: Shared) -> _Load:
    """Return a load of which a leader determines the coordinate along component k."""
    assert link.leader is not None
    column = [row[k] for row in load.inertia]
    along = {leader: answer[k] for leader, answer in load.answers.items()}
    shared.hold(link.leader, link.share, column[k] + link.constants.armature, effort - load.force[k], along)
    return _Load(load.inertia, load.force, _together(load.answers, {link.leader: [link.share * part for part in column]}))


def _together(one: Responses, other: Responses) -> Responses:
    """The sums of forces for the accelerations of leaders."""
    return {**one, **{leader: plus(one[leader], force) if leader in one else force for leader, force in other.items()}}


def _passed(load: _Load, constants: Constants, motion: _Motion) -> _Load:
    """Convert the load of a link to the axes and the origin of its parent."""
    inertia, force, answers = load.inertia, load.force, load.answers
    turned, moved = (motion.rotation, motion.displacement), (Rotation(square(constants.turn)), list(constants.offset))
    for rotation, shift in (turned, moved):
        blocks = [[row[:3] for row in inertia[:3]], [row[3:] for row in inertia[:3]], [row[3:] for row in inertia[3:]]]
        angular, mixed, linear = (rotation.block(block, k != 1) for k, block in enumerate(blocks))
        inertia, force = _shifted(angular, mixed, linear, shift), _moved_force(force, rotation, shift)
        answers = {leader: _moved_force(answer, rotation, shift) for leader, answer in answers.items()}
    return _Load(inertia, force, answers)


def _moved_force(force: Vec, rotation: Rotation, shift: Vec) -> Vec:
    """Convert a torque and a force (6,) to other axes and to a point from which the present point is at `shift`."""
    torque, push = rotation.back(force[:3]), rotation.back(force[3:])
    return [*plus(torque, cross(shift, push)), *push]


def _shifted(angular: Rows, mixed: Rows, linear: Rows, shift: Vec) -> Rows:
    """The inertia (6, 6) about a new point, from which the present point is at `shift`."""
    added = transposed([cross(shift, row) for row in linear])
    after = plus_rows(mixed, added)
    before, beyond = [cross(shift, row) for row in mixed], [cross(shift, row) for row in after]
    partial = mirrored(lambda i, j: angular[i][j] + before[i][j] + beyond[j][i])
    return [
        *(a + b for a, b in zip(partial, after, strict=True)),
        *(a + b for a, b in zip(transposed(after), linear, strict=True)),
    ]


def _solved(
    links: Sequence[Link], motions: list[_Motion], eliminated: list[list[_Step]], leading: Mapping[int, Number]
) -> Accelerations:
    """The accelerations of the joints, from the root to the tips. leading: those of the leaders, by their links' indices."""
    extra: list[Vec] = []
    rates: list[Vec] = []
    strains: list[Number] = []
    for link, motion, steps in zip(links, motions, eliminated, strict=True):
        if link.parent >= 0:
            angular, linear = extra[link.parent][:3], extra[link.parent][3:]
            for rotation, shift in (
                (Rotation(square(link.constants.turn)), list(link.constants.offset)),
                (motion.rotation, motion.displacement),
            ):
                # The displacement is along the axes before the rotation, which do not differ from those after it for a slider.
                linear = rotation.out(plus(linear, cross(angular, shift)))
                angular = rotation.out(angular)
            whole = [*angular, *linear]
        else:
            whole = [0] * 6
        along: dict[int, Number] = {}
        strain: Number = 0
        if link.leader is not None:
            (k,) = FREEDOMS[link.kind]
            along[k] = link.share * leading[link.leader]
            whole[k] = whole[k] + along[k]
        for step in reversed(steps):
            k, released = step.component, step.given - dot(step.ratio, whole)
            for leader, answer in step.answers.items():
                released = released - answer * leading[leader]
            along[k], strain = step.moves * released, step.weight * released
            whole[k] = whole[k] + along[k]
        extra.append(whole)
        rates.append([along[k] for k in sorted(along)])
        strains.append(strain)
    return Accelerations(rates, strains, [[step.weight for step in steps] for steps in eliminated])


def _absent(value: Number) -> bool:
    return isinstance(value, int) and value == 0
