"""The states of the bodies of a mechanism from the coordinates and velocities of its joints, and the reverse.

The joint coordinates of the truth and of every engine follow by the same formula from the states of the bodies, since the joint
coordinates that an engine stores may lag by a step. Everything is in double precision. The conventions are those of
`coordinates`.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.kinematics import about, conjugate, dot, multiply, normalise, rotate
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.coordinates import JointMotion, places
from bodycheck.reference.mechanisms.joint_types import ElementaryMotion
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism
from bodycheck.reference.trajectory import Array, Trajectory, stacked

#: The axes of a frame, by their names.
_AXES = dict(zip("xyz", np.eye(3), strict=True))


@dataclass(frozen=True, eq=False)
class _Frame:
    """The motion of a frame at n instants.

    Attributes
    ----------
    origin, velocity
        (n, 3) position (m) and velocity (m/s) of its origin, relative to the world or another outer frame and along its axes.
    turn
        (n, 4) unit quaternions from its axes to the axes of the outer frame.
    rate
        (n, 3) its angular velocity relative to the outer frame, along its own axes (rad/s).
    """

    origin: Array
    turn: Array
    velocity: Array
    rate: Array

    def after(self, parent: "_Frame") -> "_Frame":
        """Convert this motion, which is relative to `parent`, to the frame to which the motion of `parent` is relative."""
        return _Frame(
            parent.origin + rotate(parent.turn, self.origin),
            normalise(multiply(parent.turn, self.turn)),
            parent.velocity + rotate(parent.turn, np.cross(parent.rate, self.origin) + self.velocity),
            rotate(conjugate(self.turn), parent.rate) + self.rate,
        )

    def seen_from(self, parent: "_Frame") -> "_Frame":
        """This motion relative to `parent`, where both are given relative to the same frame. The inverse of `after`."""
        back = conjugate(parent.turn)
        origin, turn = rotate(back, self.origin - parent.origin), normalise(multiply(back, self.turn))
        return _Frame(
            origin,
            turn,
            rotate(back, self.velocity - parent.velocity) - np.cross(parent.rate, origin),
            self.rate - rotate(conjugate(turn), parent.rate),
        )


def bodies(mechanism: Mechanism, joints: JointMotion, free: Trajectory | None = None, t: Array | None = None) -> Trajectory:
    """The states of all bodies from the motion of the joints and of the free bodies.

    Parameters
    ----------
    mechanism
        The mechanism, of b bodies.
    joints
        The motion of its joints at n instants.
    free
        The states (f, n, ...) of the f bodies that are the child of no joint, in the order of the file; None if there are none.
    t
        (n,) instants (s), which are needed if no body is free.

    Raises
    ------
    ValueError
        If both `t` and `free` are None.
    """
    instants = t if t is not None else free.t if free is not None else None
    if instants is None:
        raise ValueError("no instants: a mechanism without free bodies needs `t`")
    held = dict(zip(mechanism.joints, places(mechanism), strict=True))
    frames: dict[int, _Frame] = {WORLD: _at_rest(len(instants))}
    unheld = (index for index, joint in enumerate(mechanism.joint_of) if joint is None)
    for row, index in enumerate(unheld):
        assert free is not None  # required for a mechanism with free bodies
        frames[index] = _frame_of(mechanism.bodies[index], free.body(row))
    for joint in from_the_root(mechanism):
        coordinates, moving = held[joint]
        moved = _moved(joint, joints.position[:, coordinates], joints.velocity[:, moving])
        frames[joint.child] = moved.after(_joint_frame(joint, frames[joint.parent]))
    states = [_state_of(body, frames[index], instants) for index, body in enumerate(mechanism.bodies)]
    return stacked(instants, states)


def joints(mechanism: Mechanism, trajectory: Trajectory) -> JointMotion:
    """The motion of the joints (n instants) from the states (b, n, ...) of the bodies.

    Where the bodies of a joint have come apart, its coordinates are the components of their relative motion that the joint
    allows. Angles continue beyond full turns: from one instant to the next, the mean of both rates predicts the number of full
    turns, and the poses determine the angle within a turn. The angles, and the signs of quaternions, continue from the initial
    values of the mechanism at t = 0.
    """
    pairs = [_coordinates(joint, _relative(mechanism, joint, trajectory), trajectory.t) for joint in mechanism.joints]
    nothing = np.empty((len(trajectory), 0))
    position, velocity = ([nothing, *(one[part] for one in pairs)] for part in (0, 1))
    return JointMotion(np.concatenate(position, axis=1), np.concatenate(velocity, axis=1))


def initial(mechanism: Mechanism) -> Trajectory:
    """The states (b, 1, ...) of the bodies at t = 0."""
    free = [body.start for body in mechanism.bodies if body.start is not None]
    t = np.zeros(1)
    states = Trajectory(
        t,
        np.array([start.position for start in free])[:, None],
        np.array([exact.nearest_turn(start.attitude) for start in free])[:, None],
        np.array([start.velocity for start in free])[:, None],
        np.array([[float(rate) for rate in exact.rates(start.attitude, start.rotation)] for start in free])[:, None],
    )
    return bodies(mechanism, start_of(mechanism), states if free else None, t)


def start_of(mechanism: Mechanism) -> JointMotion:
    """The coordinates (1, c) and velocities (1, u) of the joints at t = 0; quaternions have unit length."""
    position = np.array([value for joint in mechanism.joints for value in _start(joint)], np.float64)
    velocity = np.array([value for joint in mechanism.joints for value in joint.start_velocity], np.float64)
    return JointMotion(position[None], velocity[None])


def gaps(mechanism: Mechanism, trajectory: Trajectory) -> Array:
    """Return the largest distance (n,) that the bodies of a joint, or the points of a loop, have come apart (m).

    For a joint it is the distance of the child's origin from the origin of the joint's frame, without the displacements that
    the joint allows: along the axis of a prismatic joint, in the plane of a planar joint, in any direction for a free joint.
    """
    largest = np.zeros(len(trajectory))
    for joint in mechanism.joints:
        largest = np.maximum(largest, _gap(joint, _relative(mechanism, joint, trajectory).origin))
    for loop in mechanism.loops:
        first, second = (
            frame.origin + rotate(frame.turn, _each(point, len(trajectory)))
            for frame, point in zip((_frame(mechanism, body, trajectory) for body in loop.bodies), loop.points, strict=True)
        )
        largest = np.maximum(largest, np.linalg.norm(first - second, axis=-1))
    return largest


def from_the_root(mechanism: Mechanism) -> Iterator[Joint]:
    """The joints, each after the joint of its parent."""
    above = mechanism.joint_of
    done: set[int] = set()

    def chain(body: int) -> list[Joint]:
        branch: list[Joint] = []
        while body != WORLD and body not in done and (joint := above[body]) is not None:
            done.add(body)
            branch.append(joint)
            body = joint.parent
        return branch[::-1]

    for body in range(len(mechanism.bodies)):
        yield from chain(body)


def _relative(mechanism: Mechanism, joint: Joint, trajectory: Trajectory) -> _Frame:
    """The motion of a joint's child relative to the joint's frame."""
    parent = _joint_frame(joint, _frame(mechanism, joint.parent, trajectory))
    return _frame(mechanism, joint.child, trajectory).seen_from(parent)


def _frame(mechanism: Mechanism, index: int, trajectory: Trajectory) -> _Frame:
    """The motion of the frame of a body or of the world."""
    return _at_rest(len(trajectory)) if index == WORLD else _frame_of(mechanism.bodies[index], trajectory.body(index))


def _at_rest(n: int) -> _Frame:
    return _Frame(np.zeros((n, 3)), np.tile([1.0, 0.0, 0.0, 0.0], (n, 1)), np.zeros((n, 3)), np.zeros((n, 3)))


def _joint_frame(joint: Joint, parent: _Frame) -> _Frame:
    """The motion of a joint's frame, which is fixed in the frame of its parent."""
    n = len(parent.origin)
    fixed = _Frame(_each(joint.position, n), _each(exact.nearest_turn(joint.attitude), n), np.zeros((n, 3)), np.zeros((n, 3)))
    return fixed.after(parent)


def _frame_of(body: JointedBody, states: Trajectory) -> _Frame:
    """The motion of a body's frame from the states (n, ...) of the body."""
    centre = _each(exact.nearest_inertia(body).centre, len(states))
    turn, rate = states.quaternion, states.angular_velocity
    return _Frame(states.position - rotate(turn, centre), turn, states.velocity - rotate(turn, np.cross(rate, centre)), rate)


def _state_of(body: JointedBody, frame: _Frame, t: Array) -> Trajectory:
    """The states of a body from the motion of its frame: the inverse of `_frame_of`."""
    centre = _each(exact.nearest_inertia(body).centre, len(t))
    position = frame.origin + rotate(frame.turn, centre)
    velocity = frame.velocity + rotate(frame.turn, np.cross(frame.rate, centre))
    return Trajectory(t, position, frame.turn, velocity, frame.rate)


def _each(values: tuple[float, ...], n: int) -> Array:
    return np.tile(values, (n, 1))


def _moved(joint: Joint, q: Array, v: Array) -> _Frame:
    """The motion of a joint's child relative to the joint's frame, from its coordinates (n, c) and velocities (n, u)."""
    still = _at_rest(len(q))
    origin, velocity = still.origin, still.velocity
    for column, slide in enumerate(joint.form.slides):
        axis = _axis(joint, slide)
        origin, velocity = origin + axis * q[:, column, None], velocity + axis * v[:, column, None]
    turn, rate = still.turn, still.rate
    first = len(joint.form.slides)
    match joint.form.turns:
        case (ElementaryMotion("ball"),):
            turn, rate = normalise(q[:, first:]), v[:, first:]
        case (alone,):
            axis = _axis(joint, alone)
            turn, rate = about(axis, q[:, first]), axis * v[:, first:]
        case (about_x, about_y):
            x, y = _axis(joint, about_x), _axis(joint, about_y)
            turn = multiply(about(x, q[:, first]), about(y, q[:, first + 1]))
            rate = _x_seen_behind_y(q[:, first + 1]) * v[:, first, None] + y * v[:, first + 1 :]
    return _Frame(origin, turn, velocity, rate)


def _axis(joint: Joint, motion: ElementaryMotion) -> Array:
    """The axis (3,) of an elementary motion in the frame of its joint."""
    return np.array(exact.nearest_axis(joint)) if motion.axis == "given" else _AXES[motion.axis]


def _along(joint: Joint, motion: ElementaryMotion, vectors: Array) -> Array:
    """The components (n,) of vectors (n, 3) along the axis of an elementary motion of a joint."""
    return dot(vectors, _axis(joint, motion)) if motion.axis == "given" else vectors[:, "xyz".index(motion.axis)]


def _x_seen_behind_y(angle: Array) -> Array:
    """The components (n, 3) of the axis x along the axes of frames that are turned about y by angles (n,)."""
    return np.stack([np.cos(angle), np.zeros(len(angle)), np.sin(angle)], axis=-1)


def _coordinates(joint: Joint, seen: _Frame, t: Array) -> tuple[Array, Array]:
    """The coordinates (n, c) and velocities (n, u) of a joint from the motion of its child relative to the joint's frame."""
    slides = joint.form.slides
    held, moving = ([_along(joint, slide, vectors)[:, None] for slide in slides] for vectors in (seen.origin, seen.velocity))
    turned, rates = _turning(joint, seen, t, len(slides))
    nothing = np.empty((len(t), 0))
    return np.hstack([nothing, *held, turned]), np.hstack([nothing, *moving, rates])


def _turning(joint: Joint, seen: _Frame, t: Array, first: int) -> tuple[Array, Array]:
    """The coordinates (n, c) and velocities (n, u) of a joint's turns or ball. first: the index of their first column."""
    start, start_rate = joint.start[first:], joint.start_velocity[first:]
    match joint.form.turns:
        case ():
            return np.empty((len(t), 0)), np.empty((len(t), 0))
        case (ElementaryMotion("ball"),):
            return _same_sign(seen.turn, np.array(start)), seen.rate
        case (alone,):
            rate = _along(joint, alone, seen.rate)
            angle = _turned_on(_angle_about(seen.turn, _axis(joint, alone)), rate, t, start[0], start_rate[0])
            return angle[:, None], rate[:, None]
    # Turns about x and y: the turned axis y is in the plane of y and z of the joint's frame, at the first angle; the axis x of
    # the joint's frame is in the plane of x and z of the child, at the second angle.
    turned_y = rotate(seen.turn, _each(tuple(_AXES["y"]), len(t)))
    own_x = rotate(conjugate(seen.turn), _each(tuple(_AXES["x"]), len(t)))
    first_angle, second_angle = np.arctan2(turned_y[:, 2], turned_y[:, 1]), np.arctan2(own_x[:, 2], own_x[:, 0])
    rates = np.column_stack([dot(seen.rate, _x_seen_behind_y(second_angle)), seen.rate[:, 1]])
    given = zip((first_angle, second_angle), rates.T, start, start_rate, strict=True)
    return np.column_stack([_turned_on(raw, rate, t, *begun) for raw, rate, *begun in given]), rates


def _angle_about(turn: Array, axis: Array) -> Array:
    """The angles (n,) of rotations about an axis, in [-2 pi, 2 pi]."""
    return np.asarray(2 * np.arctan2(dot(turn[:, 1:], axis), turn[:, 0]))


def _turned_on(raw: Array, rate: Array, t: Array, start: float, start_rate: float) -> Array:
    """Angles (n,) that continue beyond full turns, from angles `raw` without full turns, rates, and the values at t = 0."""
    angles = np.concatenate([[start], raw])
    rates, instants = np.concatenate([[start_rate], rate]), np.concatenate([[0.0], t])
    predicted = np.diff(instants) * (rates[1:] + rates[:-1]) / 2
    turns = np.cumsum(np.rint((predicted - np.diff(angles)) / (2 * np.pi)))
    return np.asarray(raw + 2 * np.pi * turns)


def _same_sign(turn: Array, start: Array) -> Array:
    """Quaternions (n, 4) with signs such that each is nearest to the quaternion before it, and the first to `start`."""
    before = np.concatenate([start[None], turn])
    signs = np.where(dot(before[1:], before[:-1]) < 0, -1.0, 1.0)
    return np.asarray(turn * np.cumprod(signs)[:, None])


def _start(joint: Joint) -> tuple[float, ...]:
    """The initial coordinates of a joint, with the quaternion scaled to unit length."""
    if not joint.form.has_quaternion:
        return joint.start
    w, x, y, z = joint.start[-4:]
    return (*joint.start[:-4], *exact.nearest_turn((w, x, y, z)))


def _gap(joint: Joint, apart: Array) -> Array:
    """Return the distances (n,) by which the bodies of a joint are apart without the displacements that the joint allows.

    apart: (n, 3) positions of the child's origin in the joint's frame (m).
    """
    left = apart
    for slide in joint.form.slides:
        left = left - _along(joint, slide, apart)[:, None] * _axis(joint, slide)
    return np.asarray(np.linalg.norm(left, axis=-1))
