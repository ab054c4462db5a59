"""The start of a mechanism in the widest type of NumPy: pose and velocity of every body, and the inertia of every coordinate.

These numbers decide whether a mechanism has a motion at all. The truth of the motion is computed elsewhere.
"""

import functools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.exact.numbers import Wide, real, wide
from bodycheck.reference.exact.rotations import matrix
from bodycheck.reference.mechanisms import exact, mimicry
from bodycheck.reference.mechanisms.mechanism import WORLD, BodyStart, Joint, JointedBody, Mechanism, breadth_first
from bodycheck.reference.scene import Attitude

#: An array of the widest type.
WideArray = NDArray[np.longdouble]

#: The axes of a frame, by their names.
AXES = dict(zip("xyz", np.eye(3, dtype=Wide), strict=True))


@dataclass(frozen=True, eq=False)
class Frame:
    """The frame of a body at the start, relative to the world.

    Attributes
    ----------
    turn
        (3, 3) rotation matrix from the axes of the frame to the axes of the world.
    origin, velocity
        (3,) position (m) and velocity (m/s) of its origin.
    spin
        (3,) its angular velocity along the axes of the world (rad/s).
    """

    turn: WideArray
    origin: WideArray
    velocity: WideArray
    spin: WideArray

    def point(self, at: WideArray) -> WideArray:
        """The position (3,) in the world (m) of a point (3,) that is given in the frame (m)."""
        return np.asarray(self.origin + self.turn @ at)

    def speed(self, point: WideArray) -> WideArray:
        """The velocity (3,) in the world (m/s) of a point (3,) that is fixed and given in the frame (m)."""
        return np.asarray(self.velocity + np.cross(self.spin, self.turn @ point))


@dataclass(frozen=True, eq=False)
class Coordinate:
    """The inertia of one coordinate at the start, kg m^2 or kg.

    Attributes
    ----------
    joint
        The index of the joint; None for a free body.
    body
        The index of the body that it moves.
    locked
        The inertia with all joints locked that come after it on the way from the world: a diagonal element of the mass matrix.
    loose
        The inertia with these joints free to move: a pivot of the mass matrix, which is positive definite if all pivots are
        positive.
    """

    joint: int | None
    body: int
    locked: Wide
    loose: Wide


WORLD_FRAME = Frame(np.eye(3, dtype=Wide), np.zeros(3, Wide), np.zeros(3, Wide), np.zeros(3, Wide))


@functools.lru_cache(maxsize=4)
def frames(mechanism: Mechanism) -> dict[int, Frame]:
    """The frames of all bodies at the start, by the indices of the bodies, and the frame of the world at `WORLD`.

    Callers must not change the returned mapping.
    """
    by_body = {WORLD: WORLD_FRAME}
    joint_of = mechanism.joint_of
    for index in breadth_first(mechanism):
        joint, body = joint_of[index], mechanism.bodies[index]
        if joint is None:
            by_body[index] = _of_free(body, body.start or BodyStart())
        else:
            by_body[index] = _of_child(joint, _begin(mechanism, joint), by_body[joint.parent])
    return by_body


def coordinates(mechanism: Mechanism) -> tuple[Coordinate, ...]:
    """The inertia of all coordinates of joints and free bodies at the start, without those of joints that follow others.

    The pivots follow from the articulated-body recursion (Featherstone 2008, chapter 7), from the ends of the chains to the
    world, or, if joints follow others, from the elimination of the mass matrix in the same order. They have rounding errors of
    the widest type.
    """
    at, collected, joint_of = frames(mechanism), list[Coordinate](), mechanism.joint_of
    if any(joint.mimic for joint in mechanism.joints):
        return _coordinates_with_followers(mechanism)
    places = {joint.child: index for index, joint in enumerate(mechanism.joints)}
    loose = {index: _inertia(body, at[index]) for index, body in enumerate(mechanism.bodies)}
    locked = {index: inertia.copy() for index, inertia in loose.items()}
    for index in reversed(breadth_first(mechanism)):
        joint = joint_of[index]
        columns, armature = _columns(mechanism, joint, at), 0.0 if joint is None else joint.armature
        for column in columns[::-1]:
            force = loose[index] @ column
            pivot, whole = column @ force + Wide(armature), column @ locked[index] @ column + Wide(armature)
            collected.append(Coordinate(places.get(index), index, whole, pivot))
            if pivot > 0:
                loose[index] = loose[index] - np.outer(force, force) / pivot
        if joint is not None and joint.parent != WORLD:
            moved = _moved(at[index].origin - at[joint.parent].origin)
            for inertia in (loose, locked):
                inertia[joint.parent] = inertia[joint.parent] + moved.T @ inertia[index] @ moved
    return tuple(collected[::-1])


def _coordinates_with_followers(mechanism: Mechanism) -> tuple[Coordinate, ...]:
    """The inertia of all coordinates of a mechanism of which joints follow others."""
    alone, matrix = mass_matrix(mechanism)
    locked, loose = np.diagonal(matrix).copy(), matrix.copy()
    for k in reversed(range(len(alone))):
        if loose[k, k] > 0:
            loose[:k, :k] -= np.outer(loose[:k, k], loose[k, :k]) / loose[k, k]
    return tuple(Coordinate(*each, locked[k], loose[k, k]) for k, each in enumerate(alone))


def mass_matrix(mechanism: Mechanism) -> tuple[tuple[tuple[int | None, int], ...], WideArray]:
    """The mass matrix (n, n) at the start, of the velocities of joints that follow no other and of free bodies (kg m^2, kg).

    Returns also the joint (None for a free body) and the body that each velocity moves, from the world on.
    """
    at, indices = frames(mechanism), {joint.child: index for index, joint in enumerate(mechanism.joints)}
    slots: list[tuple[int | None, int, WideArray]] = [
        (indices.get(body), body, column)
        for body in breadth_first(mechanism)
        for column in _columns(mechanism, mechanism.joint_of[body], at)
    ]
    alone = [row for row, (joint, _, _) in enumerate(slots) if joint is None or mechanism.joints[joint].mimic is None]
    shares = np.zeros((len(slots), len(alone)), Wide)
    for number, row in enumerate(alone):
        shares[row, number] = 1
        for other, (index, _, _) in enumerate(slots):
            if other not in alone and index is not None:
                rule = mimicry.rule(mechanism.joints, index)
                if rule.leader == slots[row][0]:
                    shares[other, number] = wide(real(rule.multiplier))
    return tuple(slots[row][:2] for row in alone), shares.T @ _mass_matrix(mechanism, at, slots) @ shares


def _mass_matrix(mechanism: Mechanism, at: dict[int, Frame], slots: Sequence[tuple[int | None, int, WideArray]]) -> WideArray:
    """The mass matrix of coordinates, each with its joint, the body that it moves, and its twist (6,)."""
    carried = {index: _inertia(body, at[index]) for index, body in enumerate(mechanism.bodies)}
    for index in reversed(breadth_first(mechanism)):
        if (joint := mechanism.joint_of[index]) is not None and joint.parent != WORLD:
            moved = _moved(at[index].origin - at[joint.parent].origin)
            carried[joint.parent] = carried[joint.parent] + moved.T @ carried[index] @ moved
    rows_of: dict[int, list[int]] = {}
    for row, (_, body, _) in enumerate(slots):
        rows_of.setdefault(body, []).append(row)
    matrix = np.zeros((len(slots), len(slots)), Wide)
    for row, (joint_index, start, column) in enumerate(slots):
        matrix[row, row] = Wide(0.0 if joint_index is None else mechanism.joints[joint_index].armature)
        body, force = start, carried[start] @ column
        while True:
            for other in rows_of.get(body, ()):
                if other <= row:
                    matrix[row, other] += force @ slots[other][2]
            joint = mechanism.joint_of[body]
            if joint is None or joint.parent == WORLD:
                break
            force = _moved(at[body].origin - at[joint.parent].origin).T @ force
            body = joint.parent
    return matrix + np.tril(matrix, -1).T


def mass(body: JointedBody) -> Wide:
    """The mass of a body (kg)."""
    return wide(exact.inertia(body).mass)


def centre(body: JointedBody) -> WideArray:
    """The centre of mass (3,) of a body in its frame (m)."""
    return _wide(exact.inertia(body).centre)


def tensor(body: JointedBody) -> WideArray:
    """The inertia tensor (3, 3) of a body about its centre of mass, along the axes of its frame (kg m^2)."""
    xx, yy, zz, xy, xz, yz = _wide(exact.inertia(body).tensor)
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _of_free(body: JointedBody, start: BodyStart) -> Frame:
    turn = _matrix(start.attitude)
    spin, arm = turn @ _wide(exact.rates(start.attitude, start.rotation)), turn @ centre(body)
    return Frame(turn, _wide(start.position) - arm, _wide(start.velocity) - np.cross(spin, arm), spin)


def _begin(mechanism: Mechanism, joint: Joint) -> tuple[WideArray, WideArray]:
    """The coordinates and velocities of a joint at the start, which may follow from those of another joint."""
    if joint.mimic is None:
        return _wide(joint.start), _wide(joint.start_velocity)
    position, velocity = mimicry.start(mechanism.joints, mechanism.joints.index(joint))
    return _wide((real(position),)), _wide((real(velocity),))


def _of_child(joint: Joint, begin: tuple[WideArray, WideArray], parent: Frame) -> Frame:
    axes = parent.turn @ _matrix(joint.attitude)
    turn, shift, columns = _pose_and_columns(joint, begin[0])
    twist = begin[1] @ columns if len(begin[1]) else np.zeros(6, Wide)
    arm = parent.turn @ _wide(joint.position) + axes @ shift
    velocity = parent.velocity + np.cross(parent.spin, arm) + axes @ twist[:3]
    return Frame(axes @ turn, parent.origin + arm, velocity, parent.spin + axes @ twist[3:])


def _pose_and_columns(joint: Joint, q: WideArray) -> tuple[WideArray, WideArray, WideArray]:
    """Rotation matrix (3, 3) and origin (3,) of the child's frame in the joint's frame at coordinates q, and its twists (k, 6).

    A twist is the velocity of the child's origin and the child's angular velocity for a unit value of one of the joint's
    velocities, both along the axes of the joint's frame. Slides come before turns, which do not move the origin.
    """
    turn, shift, columns = np.eye(3, dtype=Wide), np.zeros(3, Wide), np.zeros((0, 6), Wide)
    for motion in joint.form.motions:
        if motion.kind == "ball":
            turn = turn @ _matrix(_quaternion(joint.start[-4:]))
            columns = np.concatenate([columns, np.concatenate([np.zeros((3, 3), Wide), turn.T], axis=1)])
            continue
        axis, coordinate = _wide(exact.unit_axis(joint)) if motion.axis == "given" else AXES[motion.axis], q[len(columns)]
        along, none = turn @ axis, np.zeros(3, Wide)
        if motion.kind == "slide":
            shift, column = shift + along * coordinate, (along, none)
        else:
            turn, column = turn @ _about(axis, coordinate), (none, along)
        columns = np.concatenate([columns, np.concatenate(column)[None]])
    return turn, shift, columns


def _columns(mechanism: Mechanism, joint: Joint | None, at: dict[int, Frame]) -> WideArray:
    """The twists (k, 6) that a joint, or none, allows its child, along the world's axes. at: the frames of all bodies."""
    if joint is None:
        return np.eye(6, dtype=Wide)
    axes, twists = at[joint.parent].turn @ _matrix(joint.attitude), _pose_and_columns(joint, _begin(mechanism, joint)[0])[2]
    return np.concatenate([twists[:, :3] @ axes.T, twists[:, 3:] @ axes.T], axis=1)


def _inertia(body: JointedBody, frame: Frame) -> WideArray:
    """The spatial inertia (6, 6) of a body about the origin of its frame, along the axes of the world."""
    own_mass, arm = mass(body), _skew(frame.turn @ centre(body))
    rotated = frame.turn @ tensor(body) @ frame.turn.T
    return np.block([[own_mass * np.eye(3, dtype=Wide), -own_mass * arm], [own_mass * arm, rotated - own_mass * arm @ arm]])


def _moved(arm: WideArray) -> WideArray:
    """The matrix (6, 6) that converts the twist at a point to the twist at another point, at `arm` (3,) from it (m)."""
    one = np.eye(3, dtype=Wide)
    return np.block([[one, -_skew(arm)], [np.zeros((3, 3), Wide), one]])


def _skew(v: WideArray) -> WideArray:
    """The matrix (3, 3) of the cross product v x."""
    x, y, z = v
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]], dtype=Wide)


def _about(axis: WideArray, angle: Wide) -> WideArray:
    """The rotation matrix (3, 3) about a unit axis (3,) by an angle, by Rodrigues' formula."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.asarray(cosine * np.eye(3, dtype=Wide) + sine * _skew(axis) + (1 - cosine) * np.outer(axis, axis))


def _matrix(attitude: Attitude) -> WideArray:
    return np.array([_wide(row) for row in matrix(exact.turn(attitude))])


def _quaternion(values: tuple[float, ...]) -> tuple[float, float, float, float]:
    w, x, y, z = values
    return w, x, y, z


def _wide(values: object) -> WideArray:
    """Numbers of any type in the widest type of NumPy."""
    return np.array(list(_each(values)), dtype=Wide)


def _each(values: object) -> Iterator[Wide]:
    assert isinstance(values, tuple)
    for value in values:
        yield Wide(value) if isinstance(value, float | int) else wide(value)
