"""Mechanisms with loops by Newton and Euler in the coordinates of every body, with constraint forces at joints and loops.

Each body has a position, a quaternion, a velocity and an angular velocity along its own axes. Joints and loops are constraints
on their accelerations; states are not projected onto the constraints, so that the drift shows the error. This is the witness of
`joint_space`, with which it shares numerical tools only. The start is computed with a hundred digits from the mechanism.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import MP, Quaternion4, Vector3, Wide, vector, wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.exact.rotations import IDENTITY, ORIGIN, conjugate, matrix, minus, multiply, plus, scaled, turned, unit
from bodycheck.reference.exact.rotations import cross as exact_cross
from bodycheck.reference.kinematics import cross, dot
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.kinematics import from_the_root
from bodycheck.reference.mechanisms.loops.vectors import rounded
from bodycheck.reference.mechanisms.mechanism import WORLD, BodyStart, Joint, Mechanism

#: The numbers of coordinates and of velocities of a body.
_HELD, _MOVING = 7, 6


@dataclass(frozen=True, eq=False)
class Place:
    """The frame of a body at the start, with a hundred digits, along the axes of the world.

    It has an attitude, an origin (m), the velocity of the origin (m/s) and an angular velocity (rad/s).
    """

    attitude: Quaternion4
    origin: Vector3
    velocity: Vector3
    spin: Vector3


@dataclass(frozen=True, eq=False)
class Side:
    """A frame fixed in a body: the body's index, the frame's axes (3, 3), and its origin (3,) from the centre of mass (m)."""

    body: int
    axes: WideArray
    arm: WideArray


@dataclass(frozen=True, eq=False)
class Link:
    """The constraints between two bodies: origins that coincide along directions, and directions that stay perpendicular.

    Attributes
    ----------
    one, other
        The frames of the joint in the parent and in the child, or of the ends of a loop.
    along
        (k, 3) directions, in the first frame, along which the distance of the two origins stays zero.
    across
        Pairs of directions (3,), one in each frame, that stay perpendicular.
    joint
        The joint; None for a loop.
    axis
        (3,) the axis of a revolute or prismatic joint in both frames.
    """

    one: Side
    other: Side
    along: WideArray
    across: tuple[tuple[WideArray, WideArray], ...]
    joint: Joint | None
    axis: WideArray


@dataclass(frozen=True, eq=False)
class System:
    """The bodies and their links; mass (b,), tensor (b, 3, 3) along the bodies' axes, and gravity (m/s^2)."""

    mass: WideArray
    tensor: WideArray
    links: tuple[Link, ...]
    gravity: np.longdouble


def system(mechanism: Mechanism) -> System:
    """The bodies and links of a mechanism. Raises `NotModelled` if it has dry friction or a point mass that turns."""
    if any(joint.friction for joint in mechanism.joints):
        raise NotModelled("dry friction in a mechanism with loops", "dry friction")
    inertias = [exact.inertia(body) for body in mechanism.bodies]
    tensors = [
        [[wide(inertia.tensor[part]) for part in row] for row in ((0, 3, 4), (3, 1, 5), (4, 5, 2))] for inertia in inertias
    ]
    return System(
        np.array([wide(inertia.mass) for inertia in inertias], dtype=Wide),
        np.array(tensors, dtype=Wide),
        (*(_joint(mechanism, joint) for joint in mechanism.joints), *_loops(mechanism)),
        Wide(mechanism.gravity),
    )


def _side(mechanism: Mechanism, body: int, position: Any, axes: WideArray) -> Side:
    arm = vector(position)
    if body != WORLD:
        x, y, z = exact.inertia(mechanism.bodies[body]).centre
        arm = (arm[0] - x, arm[1] - y, arm[2] - z)
    return Side(body, axes, rounded(list(arm)))


def _joint(mechanism: Mechanism, joint: Joint) -> Link:
    """The constraints of a joint."""
    turn = rounded([list(row) for row in matrix(exact.turn(joint.attitude))])
    here = np.eye(3, dtype=Wide)
    one, other = _side(mechanism, joint.parent, joint.position, turn), _side(mechanism, joint.child, (0.0, 0.0, 0.0), here)
    axis = rounded(list(exact.unit_axis(joint))) if joint.type in ("revolute", "prismatic") else here[2]
    # Two directions perpendicular to the axis.
    first: WideArray = cross(axis, here[int(np.argmin(np.abs(axis)))])
    first = first / np.sqrt(dot(first, first))
    second: WideArray = cross(axis, first)
    aligned = ((first, axis), (second, axis))
    fixed = (*aligned, (first, second))
    nothing = here[:0]
    along, across = {
        "revolute": (here, aligned),
        "prismatic": (np.array([first, second]), fixed),
        "spherical": (here, ()),
        "fixed": (here, fixed),
        "planar": (here[2:], ((here[0], here[2]), (here[1], here[2]))),
        "universal": (here, ((here[0], here[1]),)),
        "free": (nothing, ()),
    }[joint.type]
    return Link(one, other, along, across, joint, axis)


def _loops(mechanism: Mechanism) -> list[Link]:
    here = np.eye(3, dtype=Wide)
    links = []
    for loop in mechanism.loops:
        one, other = (_side(mechanism, body, point, here) for body, point in zip(loop.bodies, loop.points, strict=True))
        links.append(Link(one, other, here, (), None, here[2]))
    return links


def initial(mechanism: Mechanism) -> WideArray:
    """The state (13 b + j,) at the start.

    It consists of positions and quaternions (7 b), velocities and body rates (6 b), and the coordinates of the j revolute and
    prismatic joints.
    """
    frames = {WORLD: Place(IDENTITY, ORIGIN, ORIGIN, ORIGIN)}
    for body, jointed_body in enumerate(mechanism.bodies):
        if mechanism.joint_of[body] is None:
            frames[body] = _free(jointed_body.start or BodyStart(), exact.inertia(jointed_body).centre)
    for joint in from_the_root(mechanism):
        frames[joint.child] = _child(joint, frames[joint.parent])
    held: list[Any] = []
    moving: list[Any] = []
    for body, jointed_body in enumerate(mechanism.bodies):
        frame = frames[body]
        arm = turned(matrix(frame.attitude), exact.inertia(jointed_body).centre)
        held += [*plus(frame.origin, arm), *frame.attitude]
        spin = turned(matrix(conjugate(frame.attitude)), frame.spin)
        moving += [*plus(frame.velocity, exact_cross(frame.spin, arm)), *spin]
    single = [joint.start[0] for joint in mechanism.joints if joint.type in ("revolute", "prismatic")]
    return np.array([*(wide(value) for value in (*held, *moving)), *(Wide(value) for value in single)], dtype=Wide)


def _free(start: BodyStart, centre: Vector3) -> Place:
    attitude = exact.turn(start.attitude)
    rows = matrix(attitude)
    spin, arm = turned(rows, exact.rates(start.attitude, start.rotation)), turned(rows, centre)
    origin, velocity = vector(start.position), vector(start.velocity)
    return Place(attitude, minus(origin, arm), minus(velocity, exact_cross(spin, arm)), spin)


def _child(joint: Joint, parent: Place) -> Place:
    """The frame of a joint's child at the start. parent: the frame of the joint's parent."""
    rows = matrix(parent.attitude)
    attitude = multiply(parent.attitude, exact.turn(joint.attitude))
    frame = matrix(attitude)
    shift, relative_turn, slides, rate = _relative(joint)
    arm = plus(turned(rows, vector(joint.position)), turned(frame, shift))
    velocity = plus(plus(parent.velocity, exact_cross(parent.spin, arm)), turned(frame, slides))
    return Place(multiply(attitude, relative_turn), plus(parent.origin, arm), velocity, plus(parent.spin, turned(frame, rate)))


def _relative(joint: Joint) -> tuple[Vector3, Quaternion4, Vector3, Vector3]:
    """Position, attitude, velocity and angular velocity of a joint's child relative to the joint's frame, along its axes."""
    q, v = [MP.mpf(value) for value in joint.start], [MP.mpf(value) for value in joint.start_velocity]
    x, y, z = ((MP.mpf(1), *ORIGIN[1:]), (ORIGIN[0], MP.mpf(1), ORIGIN[0]), (*ORIGIN[1:], MP.mpf(1)))
    match joint.type:
        case "revolute":
            axis = exact.unit_axis(joint)
            return ORIGIN, _about(axis, q[0]), ORIGIN, scaled(v[0], axis)
        case "prismatic":
            axis = exact.unit_axis(joint)
            return scaled(q[0], axis), IDENTITY, scaled(v[0], axis), ORIGIN
        case "universal":
            first = _about(x, q[0])
            rate = plus(scaled(v[0], x), scaled(v[1], turned(matrix(first), y)))
            return ORIGIN, multiply(first, _about(y, q[1])), ORIGIN, rate
        case "planar":
            return (q[0], q[1], ORIGIN[0]), _about(z, q[2]), (v[0], v[1], ORIGIN[0]), scaled(v[2], z)
        case "spherical" | "free":
            relative_turn = unit((q[-4], q[-3], q[-2], q[-1]))
            rate = turned(matrix(relative_turn), (v[-3], v[-2], v[-1]))
            if joint.type == "spherical":
                return ORIGIN, relative_turn, ORIGIN, rate
            return (q[0], q[1], q[2]), relative_turn, (v[0], v[1], v[2]), rate
        case _:
            return ORIGIN, IDENTITY, ORIGIN, ORIGIN


def _about(axis: Vector3, angle: Any) -> Quaternion4:
    cosine, sine = MP.cos_sin(angle / 2)
    return cosine, sine * axis[0], sine * axis[1], sine * axis[2]
