"""Trees of links on hinges, sliders and balls, from mechanisms.

Numbers that are exactly 0, 1 or -1 are integers, and take no time in products and sums.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from flint import arb

from bodycheck.reference.mechanisms.control import Controller, Signal
from bodycheck.reference.mechanisms.coordinates import places as layout
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES, ElementaryMotion, MotionKind
from bodycheck.reference.mechanisms.mechanism import WORLD, BodyStart, Joint, JointedBody, Mechanism, breadth_first
from bodycheck.reference.proof.balls import (
    UNIT,
    Ball,
    Matrix,
    Triple,
    about,
    applied,
    ball,
    product,
    transposed,
    triple,
    vector_sum,
)
from bodycheck.reference.proof.bodies import as_ball, attitude, inertia, length
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.mass import centre_of, mass_of
from bodycheck.reference.scene import EulerRates

#: A number of any arithmetic, or one of the integers 0, 1 and -1.
Number = Any
Vector = Sequence[Number]
Rows = Sequence[Sequence[Number]]

#: The coordinates and velocities at t = 0 of an elementary motion.
States = tuple[tuple[Ball, ...], tuple[Ball, ...]]

#: A link (-1: the world), and the attitude and the origin (m) of a frame in that of the link.
Place = tuple[int, Matrix, Triple]

#: The armature, damping, stiffness, coordinate at rest and constant effort of a joint.
Passive = tuple[Number, Number, Number, Number, Number]

#: The place of the world.
STILL: Place = (-1, UNIT, (arb(0), arb(0), arb(0)))

#: The axes of elementary motions in the frame of the joint.
AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


@dataclass(frozen=True, eq=False)
class Link:
    """A link that turns about z of its frame, slides along it, or turns about any axis, from its parent.

    Attributes
    ----------
    parent
        The index of the parent, -1 for the world.
    kind
        Its motion.
    first
        The index of its coordinate among those of the tree, or of the first of its four.
    turn, offset
        The attitude of its frame in that of the parent where its coordinate is zero, and the origin of its frame there (m).
    mass, moment, tensor
        The mass (kg), the mass times the centre of mass (kg m), and the inertia tensor about the origin (kg m^2) of all bodies
        on the link, in its frame.
    armature, damping, stiffness, rest, effort
        As in `Joint`.
    start, velocity
        The coordinates and their velocities at t = 0; for a ball a quaternion and its rate.
    """

    parent: int
    kind: MotionKind
    first: int
    turn: Rows
    offset: Vector
    armature: Number
    damping: Number
    stiffness: Number
    rest: Number
    effort: Number
    start: tuple[Ball, ...]
    velocity: tuple[Ball, ...]
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

    columns: the column of each coordinate of the tree in the layout of `coordinates`, after which free bodies have seven
    coordinates each: the position of the centre of mass and the quaternion of the attitude.
    """

    gravity: Number
    links: list[Link] = field(default_factory=list)
    columns: list[int] = field(default_factory=list)
    bodies: dict[int, Placed] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """The number of coordinates."""
        return self.links[-1].first + len(self.links[-1].start) if self.links else 0

    @property
    def turning(self) -> list[int]:
        """The indices of the angles of hinges among the coordinates."""
        return [link.first for link in self.links if link.kind == "turn"]


def tree_of(mechanism: Mechanism) -> Tree:
    """Return a mechanism as a tree of links. Raises `NotEnclosed` if it is no such tree, or its motion is not smooth."""
    for kind, there in (
        ("a loop", mechanism.loops),
        ("a plane", mechanism.plane is not None),
        ("contacts", mechanism.contacts),
        ("pushes", mechanism.pushes),
        (
            "a law in a tree that is sampled, limited, integrates or follows a signal",
            any(not is_linear(c) for c in mechanism.controllers),
        ),
        ("stops in a tree", any(joint.stops is not None for joint in mechanism.joints)),
        ("dry friction in a tree", any(joint.friction for joint in mechanism.joints)),
        ("joints that follow others", any(joint.mimic for joint in mechanism.joints)),
    ):
        if there:
            raise NotEnclosed(kind)
    tree = Tree(simple(ball(mechanism.gravity)))
    columns = layout(mechanism)
    free = columns[-1][0].stop if columns else 0
    places = {WORLD: STILL}
    for index in breadth_first(mechanism):
        joint, body = mechanism.joint_of[index], mechanism.bodies[index]
        if joint is None:
            places[index] = _freed(tree, body)
            free, first = free + 7, free
        else:
            number = mechanism.joints.index(joint)
            laws = [each for each in mechanism.controllers if each.joint == number]
            places[index] = _jointed(tree, joint, laws, places[joint.parent])
            first = columns[number][0].start
        tree.columns += range(first, first + tree.size - len(tree.columns))
        _put(tree, index, body, *places[index])
    return tree


def _freed(tree: Tree, body: JointedBody) -> Place:
    """Append the links of a free body, the last of which has its origin in the centre of mass, and return its place."""
    start = body.start or BodyStart()
    if isinstance(start.rotation, EulerRates) or not isinstance(start.attitude, tuple):
        raise NotEnclosed("a free body in a mechanism that starts with Euler angles")
    states: list[States] = [((ball(x),), (ball(v),)) for x, v in zip(start.position, start.velocity, strict=True)]
    states.append(_of_ball(start.attitude, start.rotation))
    link, _, _ = _linked(tree, JOINT_TYPES["free"].motions, AXES["z"], states, (0, 0, 0, 0, 0), STILL)
    x, y, z = triple(centre_of(body))
    return link, UNIT, (-x, -y, -z)


def is_linear(controller: Controller) -> bool:
    """Return whether the effort of a controller is a constant, less those of a spring and a damper."""
    signals = (controller.target, controller.target_velocity, controller.effort)
    bounded = controller.rate is not None or controller.effort_limit is not None or controller.no_load_speed is not None
    return not (bounded or controller.ki) and all(isinstance(signal, int | float) for signal in signals)


def _passive(joint: Joint, laws: Sequence[Controller]) -> Passive:
    """The constants of a joint with controllers, see `is_linear`."""
    damping, stiffness, rest, effort = map(Fraction, (joint.damping, joint.stiffness, joint.rest, joint.effort))
    for law in laws:
        kp, kd = (Fraction(law.kp), Fraction(law.kd)) if law.law == "pd" else (Fraction(0), Fraction(0))
        damping, stiffness = damping + kd, stiffness + kp
        effort += kp * (_constant(law.target) - rest) + kd * _constant(law.target_velocity) + _constant(law.effort)
    constants = (Fraction(joint.armature), damping, stiffness, rest, effort)
    armature, damping, stiffness, rest, effort = (simple(ball(value)) for value in constants)
    return armature, damping, stiffness, rest, effort


def _constant(signal: Signal) -> Fraction:
    assert isinstance(signal, int | float)
    return Fraction(signal)


def _jointed(tree: Tree, joint: Joint, laws: Sequence[Controller], socket: Place) -> Place:
    """Append the links of a joint with controllers, in its parent's place `socket`, and return the place of its child."""
    link, turn, origin = socket
    origin = vector_sum(origin, applied(turn, triple(joint.position)))
    motions, states = joint.form.motions, list[States]()
    start, velocity = list(joint.start), list(joint.start_velocity)
    for motion in motions:
        if motion.kind == "ball":
            if joint.armature or joint.stiffness or joint.effort:
                raise NotEnclosed("a ball with armature, a spring or a constant torque")
            states.append(_of_ball(start or (1.0, 0.0, 0.0, 0.0), velocity or (0.0, 0.0, 0.0)))
        else:
            states.append(((ball(start.pop(0) if start else 0.0),), (ball(velocity.pop(0) if velocity else 0.0),)))
    return _linked(
        tree, motions, joint.axis, states, _passive(joint, laws), (link, product(turn, attitude(joint.attitude)), origin)
    )


def _linked(
    tree: Tree,
    motions: Sequence[ElementaryMotion],
    given: tuple[float, float, float],
    states: Sequence[States],
    passive: Passive,
    socket: Place,
) -> Place:
    """Append links of some motions, and return the place on the last one.

    given: the axis that the joint gives. passive: its armature, damping, stiffness, rest and effort. socket: the place of the
    first link where its coordinate is zero.
    """
    link, turn, origin = socket
    for motion, (start, velocity) in zip(motions, states, strict=True):
        back = UNIT if motion.kind == "ball" else _from_z(given if motion.axis == "given" else AXES[motion.axis])
        rows = [[simple(entry) for entry in row] for row in product(turn, back)]
        where = [simple(entry) for entry in origin]
        tree.links.append(Link(link, motion.kind, tree.size, rows, where, *passive, start, velocity))
        link, turn, origin = len(tree.links) - 1, transposed(back), STILL[2]
    return link, turn, origin


def _of_ball(quaternion: Sequence[float], rates: Sequence[float]) -> States:
    """The unit quaternion of an attitude, and its rate at an angular velocity in the frame that turns."""
    w, x, y, z = map(Fraction, quaternion)
    size = ball(w * w + x * x + y * y + z * z).sqrt()
    p, q, r = map(Fraction, rates)
    change = (
        (-x * p - y * q - z * r) / 2,
        (w * p + y * r - z * q) / 2,
        (w * q + z * p - x * r) / 2,
        (w * r + x * q - y * p) / 2,
    )
    return tuple(ball(value) / size for value in (w, x, y, z)), tuple(ball(value) / size for value in change)


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
