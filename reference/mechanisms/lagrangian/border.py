"""A mechanism as a chain of elements, with a hundred digits, from which the Lagrangian and the start of the motion are formed.

Every joint becomes one or more elements: turns about an axis, slides along an axis, balls, and free elements. An element has a
frame that moves with it. Every turn is about, and every slide is along, the z axis of this frame. A planar joint is two slides
and a turn, a universal joint two turns. A fixed joint moves the body into the frame of the element that carries it. Only the
last element of a joint carries bodies.

A tree that hangs on the world by a free joint, and a free body, are described in a frame that falls with them: it starts at the
origin of the element with its velocity. There is no gravity in that frame, and large positions do not cost digits.

This code starts from the mechanism and is independent of the truth: it shares nothing with `exact` and the recursion.
"""

import functools
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Literal

from bodycheck.reference.independent.border import (
    MP,
    ONE,
    ZERO,
    Matrix,
    Number,
    Triple,
    attitude,
    euler_velocity,
    times,
)
from bodycheck.reference.independent.inertia import mass_and_tensor
from bodycheck.reference.mechanisms.control import Controller, Stops
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism
from bodycheck.reference.scene import Definition, EulerRates, Solid, Tensor

Kind = Literal["turn", "slide", "ball", "free"]

#: The numbers of coordinates and of velocities of an element.
SIZES: dict[Kind, tuple[int, int]] = {"turn": (1, 1), "slide": (1, 1), "ball": (4, 3), "free": (7, 6)}

#: Entries of rotations that are closer than this to 0 or 1 differ from it only by rounding, and are replaced by it.
ROUNDED = MP.mpf(10) ** -80

UNIT: Matrix = [[ONE, ZERO, ZERO], [ZERO, ONE, ZERO], [ZERO, ZERO, ONE]]
NONE: Triple = [ZERO, ZERO, ZERO]


@dataclass(frozen=True, eq=False)
class Carried:
    """A body in the frame of an element.

    Attributes
    ----------
    body
        The index of the body in the mechanism.
    mass
        Mass (kg).
    centre
        Centre of mass in the frame of the element (m).
    tensor
        Rows of the inertia tensor about the centre of mass along the axes of the element's frame (kg m^2).
    axes
        Rows of the matrix that takes components in the frame of the body to components in the frame of the element.
    """

    body: int
    mass: Number
    centre: Triple
    tensor: Matrix
    axes: Matrix


@dataclass(frozen=True, eq=False)
class Element:
    """An element.

    Attributes
    ----------
    kind
        The kind of motion that it allows.
    parent
        The index of the element on which it moves; None for the world.
    joint
        The index of its joint; None for a free body.
    turned
        Rows of the matrix that takes components in the frame of the parent to components in the zero frame, which is the frame
        of this element if its coordinates are zero.
    origin
        The origin of the zero frame in the frame of the parent (m).
    start, velocity
        Initial coordinates and velocities: of a ball the quaternion and the angular velocity in its frame; of a free element
        first x, y, z in the zero frame, or the velocity there.
    falls
        Whether the element, with all elements that it carries, is described in a falling frame.
    fallen
        Position (m) and velocity (m/s) of its origin at t = 0 in the zero frame; both are 0 in the falling frame.
    carried
        The bodies that move with it.
    armature, damping, stiffness, rest, friction, effort
        As in `mechanism.Joint`.
    rule
        The joint whose coordinate determines that of this element, a factor of the coordinate, and a term; None if the element
        moves by itself.
    stops, controller
        The stops and the controller of its joint; None if it has none.
    """

    kind: Kind
    parent: int | None
    joint: int | None
    turned: Matrix
    origin: Triple
    start: list[Number]
    velocity: list[Number]
    falls: bool = False
    fallen: tuple[Triple, Triple] = (NONE, NONE)
    carried: tuple[Carried, ...] = ()
    armature: float = 0.0
    damping: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0
    friction: float = 0.0
    effort: float = 0.0
    rule: tuple[int, Number, Number] | None = None
    stops: Stops | None = None
    controller: Controller | None = None


@dataclass(frozen=True, eq=False)
class Border:
    """The elements of a mechanism, each after its parent, and the gravitational acceleration (m/s^2).

    standing: bodies that do not move, in the frame of the world. loops: for each of the two ends of a loop, the index of the
    element that carries the end (None for the world), and the point in its frame (m).
    """

    elements: tuple[Element, ...]
    gravity: float
    standing: tuple[Carried, ...] = ()
    loops: tuple[tuple[tuple[int | None, Triple], tuple[int | None, Triple]], ...] = ()


@dataclass(frozen=True, eq=False)
class _Place:
    """The place of a body: the index of its element (None for the world), and its frame in the frame of the element.

    axes: rows of the matrix from the body's frame to the element's frame. origin: in the element's frame (m). falls: as in
    `Element`.
    """

    element: int | None
    axes: Matrix
    origin: Triple
    falls: bool = False


@functools.lru_cache(maxsize=64)
def border(mechanism: Mechanism) -> Border:
    """The elements of a mechanism."""
    elements: list[Element] = []
    standing: list[Carried] = []
    places = {WORLD: _Place(None, UNIT, NONE)}
    for body in _downwards(mechanism):
        joint = mechanism.joint_of[body]
        if joint is None:
            pose = _free_body(mechanism.bodies[body], elements, any(other.parent == body for other in mechanism.joints))
        else:
            pose = _jointed(mechanism, mechanism.joints.index(joint), places[joint.parent], elements)
        places[body] = pose
        carried = _carried(mechanism.bodies[body], body, pose)
        if pose.element is None:
            standing.append(carried)
        else:
            held = elements[pose.element]
            elements[pose.element] = replace(held, carried=(*held.carried, carried))
    loops = []
    for loop in mechanism.loops:
        one, other = (_end(places[body], point) for body, point in zip(loop.bodies, loop.points, strict=True))
        loops.append((one, other))
    return Border(tuple(elements), mechanism.gravity, tuple(standing), tuple(loops))


def _end(pose: _Place, point: tuple[float, float, float]) -> tuple[int | None, Triple]:
    """The index of the element that carries a body, and a point of the body in the frame of the element (m)."""
    return pose.element, _sum(pose.origin, times(pose.axes, [MP.mpf(value) for value in point]))


def _downwards(mechanism: Mechanism) -> list[int]:
    """The indices of the bodies, each after its parent."""
    children: dict[int, list[int]] = {}
    for body, joint in enumerate(mechanism.joint_of):
        children.setdefault(WORLD if joint is None else joint.parent, []).append(body)
    ordered, waiting = [], list(reversed(children.get(WORLD, [])))
    while waiting:
        body = waiting.pop()
        ordered.append(body)
        waiting += reversed(children.get(body, []))
    return ordered


def _free_body(body: JointedBody, elements: list[Element], carries: bool) -> _Place:
    """Append the element of a free body, with its origin at the centre of mass, and return the place of the body.

    The element is a ball in a falling frame, or a free element if other bodies hang on the body (`carries`).
    """
    start = body.start
    assert start is not None
    rates = (
        euler_velocity(start.attitude, start.rotation)
        if isinstance(start.rotation, EulerRates)
        else [MP.mpf(rate) for rate in start.rotation]
    )
    fallen = [MP.mpf(value) for value in start.position], [MP.mpf(value) for value in start.velocity]
    turned = _quaternion(attitude(start.attitude))
    kind: Kind = "free" if carries else "ball"
    if carries:
        turned, rates = [*NONE, *turned], [*NONE, *rates]
    elements.append(Element(kind, None, None, UNIT, NONE, turned, rates, falls=True, fallen=fallen))
    _, centre, _ = _made_of(body)
    return _Place(len(elements) - 1, UNIT, [-value for value in centre], falls=True)


def _jointed(mechanism: Mechanism, number: int, parent: _Place, elements: list[Element]) -> _Place:
    """Append the elements of a joint, which is given by its index, and return the place of its child."""
    joint = mechanism.joints[number]
    frame = _transposed(attitude(joint.attitude))
    position = [MP.mpf(value) for value in joint.position]
    origin = _sum(parent.origin, times(parent.axes, position))
    to_joint = _product(frame, _transposed(parent.axes))
    if joint.type == "fixed":
        return _Place(parent.element, _transposed(to_joint), origin, parent.falls)
    above, falls = parent.element, parent.falls
    mimic = joint.mimic
    rule = None if mimic is None else (mimic.joint, MP.mpf(mimic.multiplier), MP.mpf(mimic.offset))
    controller = next((each for each in mechanism.controllers if each.joint == number), None)
    further = *_along_axis(joint), rule, joint.stops, controller
    for kind, axis, start, velocity in steps(mechanism, joint):
        aligned = _along_z(axis) if axis is not None else UNIT
        turned = _cleaned(_product(_transposed(aligned), to_joint))
        fallen = NONE, NONE
        if kind == "free" and above is None:
            falls, fallen = True, (start[:3], velocity[:3])
            start, velocity = [*NONE, *start[3:]], [*NONE, *velocity[3:]]
        elements.append(Element(kind, above, number, turned, origin, start, velocity, falls, fallen, (), *further))
        above, origin, to_joint = len(elements) - 1, NONE, aligned
    return _Place(above, _transposed(aligned), NONE, falls)


def _along_axis(joint: Joint) -> tuple[float, float, float, float, float, float]:
    return joint.armature, joint.damping, joint.stiffness, joint.rest, joint.friction, joint.effort


def _begins(mechanism: Mechanism, joint: Joint) -> tuple[list[Number], list[Number]]:
    """The initial coordinates and velocities of a joint, which may follow from those of another joint."""
    if joint.mimic is None:
        return [MP.mpf(value) for value in joint.start], [MP.mpf(value) for value in joint.start_velocity]
    q, u = _begins(mechanism, mechanism.joints[joint.mimic.joint])
    return [joint.mimic.multiplier * q[0] + joint.mimic.offset], [joint.mimic.multiplier * u[0]]


def steps(mechanism: Mechanism, joint: Joint) -> list[tuple[Kind, Triple | None, list[Number], list[Number]]]:
    """The elements of a joint: kind, axis in the joint's frame, initial coordinates and velocities."""
    q, u = _begins(mechanism, joint)
    x, y, z = UNIT
    match joint.type:
        case "fixed":
            return []
        case "revolute" | "prismatic":
            axis = [MP.mpf(value) for value in joint.axis]
            length = MP.sqrt(sum(value * value for value in axis))
            return [("turn" if joint.type == "revolute" else "slide", [value / length for value in axis], q, u)]
        case "universal":
            return [("turn", x, q[:1], u[:1]), ("turn", y, q[1:], u[1:])]
        case "planar":
            return [("slide", x, q[:1], u[:1]), ("slide", y, q[1:2], u[1:2]), ("turn", z, q[2:], u[2:])]
        case "spherical":
            return [("ball", None, _normed(q), u)]
        case _:
            return [("free", None, q[:3] + _normed(q[3:]), u)]


def _carried(body: JointedBody, number: int, pose: _Place) -> Carried:
    mass, centre, tensor = _made_of(body)
    axes = _cleaned(pose.axes)
    turned = _product(_product(axes, tensor), _transposed(axes))
    where = NONE if pose.falls and body.start is not None else _sum(pose.origin, times(axes, centre))
    return Carried(number, mass, [_clean(value) for value in where], turned, axes)


def _made_of(body: JointedBody) -> tuple[Number, Triple, Matrix]:
    """Mass (kg), centre of mass (m) and inertia tensor about it (kg m^2) of a body, in its frame."""
    mass, tensor = mass_and_tensor(
        Definition(body.inertia), lambda orientation: [[_fraction(v) for v in row] for row in attitude(orientation)]
    )
    match body.inertia:
        case Tensor():
            centre = [Fraction(value) for value in body.center_of_mass]
        case Solid() as alone:
            centre = [Fraction(value) for value in alone.position]
        case parts:
            moments = [[Fraction(part.mass) * Fraction(part.position[axis]) for part in parts] for axis in range(3)]
            centre = [
                sum(moment, Fraction(0)) / sum((Fraction(part.mass) for part in parts), Fraction(0)) for moment in moments
            ]
    return _number(mass), [_number(value) for value in centre], [[_number(value) for value in row] for row in tensor]


def _along_z(axis: Triple) -> Matrix:
    """A rotation whose third column is a unit axis, from the smallest rotation that takes the nearest frame axis to it."""
    largest = max(range(3), key=lambda k: abs(axis[k]))
    order = [(largest + 1) % 3, (largest + 2) % 3, largest]
    x, y, z = (axis[k] for k in order)
    flip = -1 if z < 0 else 1
    y, z = y * flip, z * flip
    near = [
        [1 - x * x / (1 + z), -x * y / (1 + z), x],
        [-x * y / (1 + z), 1 - y * y / (1 + z), y],
        [-x, -y, z],
    ]
    signs = [1, flip, flip]
    rows: Matrix = [NONE, NONE, NONE]
    for row, (k, sign) in enumerate(zip(order, signs, strict=True)):
        rows[k] = [_clean(sign * value) for value in near[row]]
    return rows


def _quaternion(cosines: Matrix) -> list[Number]:
    """The unit quaternion w, x, y, z of a rotation matrix, computed from its largest component."""
    m = cosines
    squares = [
        1 + m[0][0] + m[1][1] + m[2][2],
        1 + m[0][0] - m[1][1] - m[2][2],
        1 - m[0][0] + m[1][1] - m[2][2],
        1 - m[0][0] - m[1][1] + m[2][2],
    ]
    rows = [
        [squares[0], m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]],
        [m[2][1] - m[1][2], squares[1], m[0][1] + m[1][0], m[0][2] + m[2][0]],
        [m[0][2] - m[2][0], m[0][1] + m[1][0], squares[2], m[1][2] + m[2][1]],
        [m[1][0] - m[0][1], m[0][2] + m[2][0], m[1][2] + m[2][1], squares[3]],
    ]
    return _normed(rows[max(range(4), key=lambda k: squares[k])])


def _normed(values: list[Number]) -> list[Number]:
    length = MP.sqrt(sum(value * value for value in values))
    return [value / length for value in values]


def _clean(value: Number) -> Number:
    """A number whose terms are of the order of 1, replaced by 0 or 1 if it differs from it only by rounding."""
    nearest = MP.nint(value)
    return nearest if abs(value - nearest) < ROUNDED else value


def _cleaned(rows: Matrix) -> Matrix:
    return [[_clean(value) for value in row] for row in rows]


def _transposed(rows: Matrix) -> Matrix:
    return [list(column) for column in zip(*rows, strict=True)]


def _product(one: Matrix, other: Matrix) -> Matrix:
    return [[sum(one[i][k] * other[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def _sum(one: Triple, other: Triple) -> Triple:
    return [a + b for a, b in zip(one, other, strict=True)]


def _number(value: Fraction) -> Number:
    return MP.mpf(value.numerator) / value.denominator


def _fraction(value: Number) -> Fraction:
    """A number of a hundred digits as a fraction, without rounding."""
    sign, mantissa, exponent, _ = value._mpf_
    whole = Fraction(int(mantissa) << max(exponent, 0), 1 << max(-exponent, 0))
    return -whole if sign else whole
