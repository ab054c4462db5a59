"""Trees of links on hinges and sliders, and their inverse dynamics in any arithmetic.

The inverse dynamics gives the efforts at the joints that a motion needs. They are polynomials of velocities, accelerations, and
sines and cosines of coordinates, so that they can be computed with balls, with power series of balls, and with derivatives.
Numbers that are exactly 0, 1 or -1 are integers, and take no time.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from flint import arb

from bodycheck.reference.mechanisms.coordinates import places as layout
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism, breadth_first
from bodycheck.reference.proof.balls import (
    UNIT,
    Matrix,
    Triple,
    about,
    applied,
    ball,
    cross,
    product,
    transposed,
    triple,
    vector_sum,
)
from bodycheck.reference.proof.bodies import as_ball, attitude, inertia, length
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.mass import centre_of, mass_of

#: A number of any arithmetic, or one of the integers 0, 1 and -1.
Number = Any
Vector = Sequence[Number]
Rows = Sequence[Sequence[Number]]

#: The elements of the types of joints: whether each slides, and its axis, None for the axis of the joint.
ELEMENTS: dict[str, tuple[tuple[bool, tuple[float, float, float] | None], ...]] = {
    "revolute": ((False, None),),
    "prismatic": ((True, None),),
    "universal": ((False, (1.0, 0.0, 0.0)), (False, (0.0, 1.0, 0.0))),
    "planar": ((True, (1.0, 0.0, 0.0)), (True, (0.0, 1.0, 0.0)), (False, (0.0, 0.0, 1.0))),
}


@dataclass(frozen=True, eq=False)
class Link:
    """A link that turns about z of its frame, or slides along it, from its parent.

    Attributes
    ----------
    parent
        The index of the parent, -1 for the world.
    slides
        Whether it slides.
    turn, offset
        The attitude of its frame in that of the parent where its coordinate is zero, and the origin of its frame there (m).
    mass, moment, tensor
        The mass (kg), the mass times the centre of mass (kg m), and the inertia tensor about the origin (kg m^2) of all bodies
        on the link, in its frame.
    armature, damping, stiffness, rest, effort
        As in `Joint`.
    start, velocity
        The exact coordinate and its velocity at t = 0.
    """

    parent: int
    slides: bool
    turn: Rows
    offset: Vector
    armature: Number
    damping: Number
    stiffness: Number
    rest: Number
    effort: Number
    start: Fraction
    velocity: Fraction
    mass: Number = 0
    moment: Vector = (0, 0, 0)
    tensor: Rows = ((0, 0, 0), (0, 0, 0), (0, 0, 0))


@dataclass(frozen=True, eq=False)
class Placed:
    """A body of a mechanism on a link (-1: at rest): its attitude and centre of mass (m) in the frame of the link."""

    link: int
    turn: Matrix
    centre: Triple


@dataclass(eq=False)
class Tree:
    """The links of a mechanism, each after its parent, its bodies in their order, and gravity (m/s^2).

    columns: the column of each link's coordinate in the layout of `coordinates`.
    """

    gravity: Number
    links: list[Link] = field(default_factory=list)
    columns: list[int] = field(default_factory=list)
    bodies: dict[int, Placed] = field(default_factory=dict)


def tree_of(mechanism: Mechanism) -> Tree:
    """Return a mechanism as a tree of links. Raises `NotEnclosed` if it is no such tree, or its motion is not smooth."""
    for kind, there in (
        ("a loop", mechanism.loops),
        ("a plane", mechanism.plane is not None),
        ("pushes", mechanism.pushes),
        ("a controller in a tree", mechanism.controllers),
        ("stops in a tree", any(joint.stops is not None for joint in mechanism.joints)),
        ("dry friction in a tree", any(joint.friction for joint in mechanism.joints)),
        ("joints that follow others", any(joint.mimic for joint in mechanism.joints)),
    ):
        if there:
            raise NotEnclosed(kind)
    tree = Tree(simple(ball(mechanism.gravity)))
    columns = layout(mechanism)
    places: dict[int, tuple[int, Matrix, Triple]] = {WORLD: (-1, UNIT, (arb(0), arb(0), arb(0)))}
    for index in breadth_first(mechanism):
        joint = mechanism.joint_of[index]
        if joint is None or joint.type not in (*ELEMENTS, "fixed"):
            raise NotEnclosed("a free body in a mechanism" if joint is None else f"a {joint.type} joint")
        before = len(tree.links)
        places[index] = _jointed(tree, joint, *places[joint.parent])
        first = columns[mechanism.joints.index(joint)][0].start
        tree.columns += range(first, first + len(tree.links) - before)
        _put(tree, index, mechanism.bodies[index], *places[index])
    return tree


def _jointed(tree: Tree, joint: Joint, link: int, turn: Matrix, origin: Triple) -> tuple[int, Matrix, Triple]:
    """Append the links of a joint, and return the place of its child: its link, attitude and origin there."""
    offset = applied(turn, triple(joint.position))
    origin = (origin[0] + offset[0], origin[1] + offset[1], origin[2] + offset[2])
    turn = product(turn, attitude(joint.attitude))
    for number, (slides, fixed_axis) in enumerate(ELEMENTS.get(joint.type, ())):
        back = _from_z(joint.axis if fixed_axis is None else fixed_axis)
        armature, damping, stiffness, rest, effort = (
            simple(ball(value)) for value in (joint.armature, joint.damping, joint.stiffness, joint.rest, joint.effort)
        )
        start = Fraction(joint.start[number] if joint.start else 0.0)
        velocity = Fraction(joint.start_velocity[number] if joint.start_velocity else 0.0)
        rows = [[simple(entry) for entry in row] for row in product(turn, back)]
        where = [simple(entry) for entry in origin]
        tree.links.append(Link(link, slides, rows, where, armature, damping, stiffness, rest, effort, start, velocity))
        link, turn, origin = len(tree.links) - 1, transposed(back), (arb(0), arb(0), arb(0))
    return link, turn, origin


def _from_z(axis: tuple[float, float, float]) -> Matrix:
    """A rotation that takes z to an axis: of few entries if it is a coordinate axis."""
    x, y, z = map(Fraction, axis)
    if not (y or z):
        return about(1, arb(1 if x > 0 else -1), arb(0))
    if not (x or z):
        return about(0, arb(-1 if y > 0 else 1), arb(0))
    if not (x or y):
        return UNIT if z > 0 else about(0, arb(0), arb(-1))
    size = length(triple((x, y, z)))
    across = ball(x * x + y * y).sqrt()
    return product(about(2, ball(y) / across, ball(x) / across), about(1, across / size, ball(z) / size))


def _put(tree: Tree, index: int, body: JointedBody, link: int, turn: Matrix, origin: Triple) -> None:
    """Put a body on its link."""
    in_body = triple(centre_of(body))
    centre = applied(turn, in_body)
    centre = (origin[0] + centre[0], origin[1] + centre[1], origin[2] + centre[2])
    tree.bodies[index] = Placed(link, turn, centre)
    if link < 0:
        return
    mass, rows = ball(mass_of(body)), [[as_ball(value) for value in row] for row in inertia(body.inertia)]
    turned = product(product(turn, (tuple(rows[0]), tuple(rows[1]), tuple(rows[2]))), transposed(turn))
    square = sum((value * value for value in centre), arb(0))
    old = tree.links[link]
    tensor = [
        [
            simple(as_number(old.tensor[i][j]) + turned[i][j] + mass * ((square if i == j else 0) - centre[i] * centre[j]))
            for j in range(3)
        ]
        for i in range(3)
    ]
    moment = [simple(as_number(value) + mass * part) for value, part in zip(old.moment, centre, strict=True)]
    changed = {"mass": simple(as_number(old.mass) + mass), "moment": moment, "tensor": tensor}
    tree.links[link] = Link(**(vars(old) | changed))


def simple(value: Any) -> Number:
    """Return a ball, or an integer if it is exactly 0, 1 or -1."""
    if value.is_exact() and value.is_integer() and abs(value) <= 1:
        return int(value.mid().unique_fmpz())
    return value


def as_number(value: Number) -> Any:
    """Return a ball for an integer."""
    return arb(value) if isinstance(value, int) else value


def times(a: Number, b: Number) -> Number:
    """Return a product, which takes no time if a factor is exactly 0, 1 or -1."""
    for one, other in ((a, b), (b, a)):
        if type(one) is int:
            return 0 if one == 0 else other if one == 1 else -other if one == -1 else one * other
    return a * b


def plus(*terms: Number) -> Number:
    """Return a sum, without terms that are exactly 0."""
    whole: Number = 0
    for term in terms:
        if type(term) is int and term == 0:
            continue
        whole = term if type(whole) is int and whole == 0 else whole + term
    return whole


def negative(value: Number) -> Number:
    """Return the negative of a number."""
    return -value


def crossed(a: Vector, b: Vector) -> list[Number]:
    """Return the cross product of two vectors."""
    return [
        plus(times(a[1], b[2]), negative(times(a[2], b[1]))),
        plus(times(a[2], b[0]), negative(times(a[0], b[2]))),
        plus(times(a[0], b[1]), negative(times(a[1], b[0]))),
    ]


def turned(rows: Rows, v: Vector) -> list[Number]:
    """Return the product of a matrix and a vector."""
    return [plus(*(times(entry, part) for entry, part in zip(row, v, strict=True))) for row in rows]


def back(rows: Rows, v: Vector) -> list[Number]:
    """Return the product of the transpose of a matrix and a vector."""
    return [plus(*(times(rows[i][j], v[i]) for i in range(3))) for j in range(3)]


def added(*vectors: Vector) -> list[Number]:
    """Return the sum of vectors."""
    return [plus(*parts) for parts in zip(*vectors, strict=True)]


def in_child(link: Link, sine: Number, cosine: Number, v: Vector) -> list[Number]:
    """Return the components of a vector in the frame of a link from those in the frame of its parent."""
    x, y, z = back(link.turn, v)
    if link.slides:
        return [x, y, z]
    return [plus(times(cosine, x), times(sine, y)), plus(times(cosine, y), negative(times(sine, x))), z]


def in_parent(link: Link, sine: Number, cosine: Number, v: Vector) -> list[Number]:
    """Return the components of a vector in the frame of the parent from those in the frame of a link."""
    x, y, z = v
    if not link.slides:
        x, y = plus(times(cosine, x), negative(times(sine, y))), plus(times(sine, x), times(cosine, y))
    return turned(link.turn, [x, y, z])


def efforts(tree: Tree, q: Vector, v: Vector, a: Vector, sines: Vector, cosines: Vector) -> list[Number]:
    """Return the efforts that a motion needs at all joints, less those of springs, dampers and constant forces.

    They are zero for the motion of the tree. q, v, a: coordinates, velocities and accelerations; sines and cosines of q.
    """
    forces: list[list[Number]] = []
    moments: list[list[Number]] = []
    still, up = [0, 0, 0], [0, 0, tree.gravity]
    rates: list[tuple[list[Number], list[Number], list[Number]]] = []
    for i, link in enumerate(tree.links):
        w, e, acc = rates[link.parent] if link.parent >= 0 else (still, still, up)
        acc = added(acc, crossed(e, link.offset), crossed(w, crossed(w, link.offset)))
        w, e, acc = (in_child(link, sines[i], cosines[i], each) for each in (w, e, acc))
        if link.slides:
            out, speed = [0, 0, q[i]], [0, 0, v[i]]
            acc = added(acc, crossed(e, out), crossed(w, crossed(w, out)), [0, 0, a[i]])
            coriolis = crossed(w, speed)
            acc = added(acc, coriolis, coriolis)
        else:
            e = added(e, crossed(w, [0, 0, v[i]]), [0, 0, a[i]])
            w = added(w, [0, 0, v[i]])
        rates.append((w, e, acc))
        moment = link.moment
        forces.append(added([times(link.mass, part) for part in acc], crossed(e, moment), crossed(w, crossed(w, moment))))
        moments.append(added(turned(link.tensor, e), crossed(w, turned(link.tensor, w)), crossed(moment, acc)))
    needed: list[Number] = [0] * len(tree.links)
    for i in range(len(tree.links) - 1, -1, -1):
        link = tree.links[i]
        force, moment = forces[i], moments[i]
        needed[i] = plus(
            (force if link.slides else moment)[2],
            times(link.armature, a[i]),
            times(link.damping, v[i]),
            times(link.stiffness, plus(q[i], negative(link.rest))),
            negative(link.effort),
        )
        if link.parent >= 0:
            if link.slides:
                moment = added(moment, crossed([0, 0, q[i]], force))
            force, moment = (in_parent(link, sines[i], cosines[i], each) for each in (force, moment))
            forces[link.parent] = added(forces[link.parent], force)
            moments[link.parent] = added(moments[link.parent], moment, crossed(link.offset, force))
    return needed


def poses(tree: Tree, q: Sequence[Any], v: Sequence[Any]) -> list[tuple[Triple, Matrix, Triple, Triple]]:
    """Return the position of the centre of mass, the attitude, the velocity and the angular velocity of each body, in balls.

    The angular velocity is along the axes of the body.
    """
    zero = arb(0)
    frames: list[tuple[Matrix, Triple, Triple, Triple]] = []  # attitude, origin, velocity of the origin, spin in the world
    world: tuple[Matrix, Triple, Triple, Triple] = (UNIT, (zero, zero, zero), (zero, zero, zero), (zero, zero, zero))
    for i, link in enumerate(tree.links):
        turn, origin, velocity, spin = frames[link.parent] if link.parent >= 0 else world
        arm = applied(turn, _balls(link.offset))
        now = product(turn, (_balls(link.turn[0]), _balls(link.turn[1]), _balls(link.turn[2])))
        axis = (now[0][2], now[1][2], now[2][2])
        velocity = vector_sum(velocity, cross(spin, arm))
        origin = vector_sum(origin, arm)
        if link.slides:
            out: Triple = (axis[0] * q[i], axis[1] * q[i], axis[2] * q[i])
            velocity = vector_sum(vector_sum(velocity, cross(spin, out)), (axis[0] * v[i], axis[1] * v[i], axis[2] * v[i]))
            origin = vector_sum(origin, out)
        else:
            now = product(now, about(2, *q[i].sin_cos()))
            spin = vector_sum(spin, (axis[0] * v[i], axis[1] * v[i], axis[2] * v[i]))
        frames.append((now, origin, velocity, spin))
    states = []
    for _, body in sorted(tree.bodies.items()):
        turn, origin, velocity, spin = frames[body.link] if body.link >= 0 else world
        arm, now = applied(turn, body.centre), product(turn, body.turn)
        states.append((vector_sum(origin, arm), now, vector_sum(velocity, cross(spin, arm)), applied(transposed(now), spin)))
    return states


def _balls(values: Vector) -> Triple:
    x, y, z = map(as_number, values)
    return x, y, z
