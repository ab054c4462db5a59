"""The equations of motion of a scene at given states: accelerations, and what they require of joints and loops.

A mechanism is in the coordinates of its joints (`mechanisms.loops.joint_space`), a body in flight is a mechanism of one free
body. Joints that follow others share the coordinates of their leaders. A joint at rest with dry friction, or at a rigid stop,
is held if friction and stop can exert the force that this needs; otherwise it begins to move in a direction that they allow.
These complementary conditions have one solution, as the mass matrix is positive definite; it is found by pivots (Murty, Linear
Complementarity, 1988, section 4.2).
"""

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.bodies import BODY
from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.numbers import Wide, real, wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.inertia import inertia_tensor
from bodycheck.reference.kinematics import cross, dot
from bodycheck.reference.mechanisms import kinematics, mimicry
from bodycheck.reference.mechanisms.coordinates import JointMotion, places
from bodycheck.reference.mechanisms.loops import joint_space
from bodycheck.reference.mechanisms.loops.joint_space import Motion, Tree
from bodycheck.reference.mechanisms.loops.minimum_norm import solved
from bodycheck.reference.mechanisms.loops.vectors import apply, matrices
from bodycheck.reference.mechanisms.mechanism import AnyScene, BodyStart, Joint, JointedBody, Mechanism
from bodycheck.reference.scene import Scene, Tensor, valid, vector_of
from bodycheck.reference.trajectory import Array, Trajectory

#: The largest number of pivots, and the part of the forces by which a holding force may exceed friction without motion.
MOST_PIVOTS, SLACK = 2000, 2.0**10 * float(np.finfo(Wide).eps)


@dataclass(frozen=True, eq=False)
class Equations:
    """The constants of the equations of a mechanism with u velocities, of which w are independent.

    Attributes
    ----------
    mechanism, linkage
        The mechanism, and its tree in the coordinates of its joints and free bodies.
    independent, shares
        (w,) the indices of the independent velocities, and (u, w) the velocities for a unit value of each of them.
    friction
        (u,) dry friction along each velocity.
    single
        For each joint with one coordinate, by its index, the index of this coordinate, and of its velocity.
    framed
        Whether places on bodies are relative to the origins of their frames; those of a single body are relative to its centre
        of mass.
    drag
        The coefficient of quadratic drag of a single body (kg/m).
    """

    mechanism: Mechanism
    linkage: Tree
    independent: NDArray[np.intp]
    shares: WideArray
    friction: WideArray
    single: dict[int, tuple[int, int]]
    framed: bool
    drag: float


@dataclass(frozen=True, eq=False)
class Solution:
    """The accelerations at s instants.

    Attributes
    ----------
    states
        (s, c + u) coordinates and velocities of the linkage.
    motion
        The motion of the frames of the linkage.
    accelerations
        (s, u) derivatives of the velocities.
    pulls, closures
        (s, l, 3) forces of loops on the first of their two bodies, world (N), of which the second body has the opposite; and
        (s, 3 l, w) the rows of the gaps of loops for the independent velocities.
    """

    states: WideArray
    motion: Motion
    accelerations: WideArray
    pulls: WideArray
    closures: WideArray


@functools.lru_cache(maxsize=8)
def equations(scene: AnyScene) -> Equations:
    """Return the equations of a mechanism, or of a body in flight."""
    mechanism = scene if isinstance(scene, Mechanism) else in_flight(scene)
    linkage = joint_space.tree(mechanism)
    layout = places(mechanism)
    single = {
        index: (held.start, moving.start)
        for index, (joint, (held, moving)) in enumerate(zip(mechanism.joints, layout, strict=True))
        if joint.type in ("revolute", "prismatic")
    }
    count = len(linkage.inertia)
    friction = np.zeros(count, dtype=Wide)
    for index, (_, moving) in single.items():
        friction[moving] = mechanism.joints[index].friction
    framed, drag = (True, 0.0) if isinstance(scene, Mechanism) else (False, scene.drag)
    return Equations(mechanism, linkage, *_shares(mechanism, single, count), friction, single, framed, drag)


def in_flight(scene: Scene) -> Mechanism:
    """Return a body in flight as a mechanism of one free body."""
    body, definition, start = scene.body, scene.definition, scene.initial
    if definition is not None and valid(scene).inertia:
        inertia = definition.inertia
    else:
        rows = inertia_tensor(body)
        inertia = Tensor(body.mass, (vector_of(rows[0]), vector_of(rows[1]), vector_of(rows[2])))
    free = BodyStart(start.position, start.quaternion, start.velocity, start.angular_velocity)
    return Mechanism((JointedBody(BODY, inertia, start=free),), gravity=scene.gravity)


def _shares(mechanism: Mechanism, single: dict[int, tuple[int, int]], count: int) -> tuple[NDArray[np.intp], WideArray]:
    """The indices (w,) of the independent velocities, and the velocities (u, w) for a unit value of each of them."""
    shares = np.eye(count, dtype=Wide)
    following = []
    for index, joint in enumerate(mechanism.joints):
        if joint.mimic is not None:
            rule, row = mimicry.rule(mechanism.joints, index), single[index][1]
            shares[row] = 0
            shares[row, single[rule.leader][1]] = wide(real(rule.multiplier))
            following.append(row)
    independent = np.delete(np.arange(count), following)
    return independent, shares[:, independent]


def states_of(written: Equations, trajectory: Trajectory, joints: JointMotion | None = None) -> WideArray:
    """Return the coordinates and velocities (n, c + u) of a mechanism from the states (b, n, ...) of its bodies.

    joints: the motion of its joints; None if it shall follow from the states of the bodies.
    """
    mechanism, linkage = written.mechanism, written.linkage
    joints = joints or kinematics.joints(mechanism, trajectory)
    held, moving = [joints.position.astype(Wide)], [joints.velocity.astype(Wide)]
    for body, joint in enumerate(mechanism.joint_of):
        if joint is not None:
            continue
        turn, rate = trajectory.quaternion[body].astype(Wide), trajectory.angular_velocity[body].astype(Wide)
        axes, centre = matrices(turn), linkage.centre[body]
        held += [trajectory.position[body] - apply(axes, centre), turn]
        moving += [trajectory.velocity[body] - apply(axes, cross(rate, np.broadcast_to(centre, rate.shape))), rate]
    return np.hstack([*held, *moving])


def with_rules(written: Equations, states: WideArray) -> WideArray:
    """Return states (n, c + u) in which joints that follow others have exactly the coordinates and velocities of their rules.

    The doubles of a truth that are nearest to these have roundings of their own.
    """
    ruled, velocities = states.copy(), states[:, written.linkage.coordinates :]
    ruled[:, written.linkage.coordinates :] = velocities[:, written.independent] @ written.shares.T
    for index, joint in enumerate(written.mechanism.joints):
        if joint.mimic is not None:
            rule = mimicry.rule(written.mechanism.joints, index)
            leading = states[:, written.single[rule.leader][0]]
            ruled[:, written.single[index][0]] = wide(real(rule.multiplier)) * leading + wide(real(rule.offset))
    return ruled


def solution(written: Equations, states: WideArray, efforts: Array | WideArray | None = None) -> Solution:
    """The accelerations at states (s, c + u).

    efforts: (s, d) efforts of the controllers of the joints in `Mechanism.driven`, in N m or N; None if there are none.

    Raises `OutOfReach` if no decision about joints at rest agrees with the accelerations.
    """
    linkage = written.linkage
    motion = joint_space.frame_motion(linkage, states)
    mass, force = joint_space.dynamics(linkage, motion, states)
    _, _, bias, rows = joint_space.closures(linkage, motion)
    velocity = states[:, linkage.coordinates :]
    force = force + stop_efforts(written, states) - written.friction * np.sign(velocity)
    if efforts is not None:
        for column, index in enumerate(written.mechanism.driven):
            force[:, written.single[index][1]] += efforts[:, column]
    if written.drag:
        force += _drag(written, motion)
    shares = written.shares
    mass, force, rows = shares.T @ mass @ shares, force @ shares, rows @ shares
    low, high = (limit[:, written.independent] for limit in _holding(written, states))
    independent, multipliers = _accelerations(mass, force, rows, -bias, low, high)
    pulls = -multipliers.reshape(len(states), -1, 3)
    return Solution(states, motion, independent @ shares.T, pulls, rows)


def stop_efforts(written: Equations, states: WideArray) -> WideArray:
    """The efforts (s, u) of elastic stops at states (s, c + u)."""
    linkage = written.linkage
    efforts = np.zeros_like(states[:, linkage.coordinates :])
    for index, (held, moving) in written.single.items():
        stops = written.mechanism.joints[index].stops
        if stops is None or stops.rigid:
            continue
        q, v = states[:, held], states[:, linkage.coordinates + moving]
        for side, limit in ((1, stops.upper), (-1, stops.lower)):
            if limit is not None:
                beyond = side * (q - Wide(limit))
                push = np.maximum(stops.stiffness * beyond + stops.damping * side * v, 0)
                efforts[:, moving] -= np.where(beyond > 0, side * push, 0)
    return efforts


def _drag(written: Equations, motion: Motion) -> WideArray:
    """The forces (s, u) of drag at the centre of mass of a single body."""
    linkage = written.linkage
    position, velocity, _ = joint_space.point_motion(motion, linkage.ends[0], linkage.centre[0])
    drag = -Wide(written.drag) * np.sqrt(dot(velocity, velocity))[:, None] * velocity
    along: WideArray = dot(joint_space.point_rows(linkage, motion, 0, position), drag[:, None])
    return along


def _holding(written: Equations, states: WideArray) -> tuple[WideArray, WideArray]:
    """The smallest and the largest force (s, u) that dry friction and rigid stops can exert on joints at rest; else zero."""
    linkage = written.linkage
    velocity = states[:, linkage.coordinates :]
    high = np.where(velocity == 0, written.friction, 0)
    low = -high
    for index, (held, moving) in written.single.items():
        for side in closed_sides(written.mechanism.joints[index], states[:, held], velocity[:, moving]):
            limit = high if side[0] < 0 else low
            limit[:, moving] = np.where(side[1], -side[0] * np.inf, limit[:, moving])
    return low, high


def closed_sides(joint: Joint, q: WideArray, v: WideArray) -> list[tuple[int, WideArray]]:
    """For each rigid stop of a joint its side, and whether the joint rests at it, of coordinates (s,) and velocities (s,)."""
    stops = joint.stops
    if stops is None or not stops.rigid:
        return []
    return [
        (side, (v == 0) & (side * (q - Wide(limit)) >= 0))
        for side, limit in ((1, stops.upper), (-1, stops.lower))
        if limit is not None
    ]


def _accelerations(
    mass: WideArray, force: WideArray, rows: WideArray, target: WideArray, low: WideArray, high: WideArray
) -> tuple[WideArray, WideArray]:
    """The accelerations (s, w) and multipliers (s, m). low, high: (s, w) the forces with which velocities can be held."""
    resting = (low < 0) | (high > 0)
    # The direction in which each velocity at rest begins to move; 0 if it is held.
    modes = np.where(resting, 0, 1)
    rates, multipliers = _scaled(mass, force, rows, target, resting)
    here = np.flatnonzero(resting.any(axis=1))
    for _ in range(MOST_PIVOTS):
        needed = (mass[here] @ rates[here][:, :, None])[:, :, 0] - force[here]
        forces, sizes = (np.abs(each).max(axis=1, keepdims=True) for each in (needed, rates[here]))
        demanded = np.where(needed > high[here] + SLACK * forces, -1, np.where(needed < low[here] - SLACK * forces, 1, 0))
        free = modes[here] != 0
        demanded = np.where(free, np.where(modes[here] * rates[here] < -SLACK * sizes, 0, modes[here]), demanded)
        changes = (demanded != modes[here]) & resting[here]
        changed = changes.any(axis=1)
        if not changed.any():
            return rates, multipliers
        here, column = here[changed], np.argmax(changes[changed], axis=1)
        modes[here, column] = demanded[changed, column]
        moved, held = resting[here] & (modes[here] != 0), resting[here] & (modes[here] == 0)
        pushed = np.where(moved, np.where(modes[here] > 0, low[here], high[here]), 0)
        rates[here], multipliers[here] = _scaled(mass[here], force[here] + pushed, rows[here], target[here], held)
    raise OutOfReach("rounding leaves undecided which joints stay at rest")


def _scaled(
    mass: WideArray, force: WideArray, rows: WideArray, target: WideArray, held: NDArray[np.bool_]
) -> tuple[WideArray, WideArray]:
    """The accelerations (s, w) and multipliers (s, m) if some velocities are held, with a unit diagonal of the mass matrix."""
    diagonal = np.diagonal(mass, axis1=1, axis2=2)
    scale = np.where(held, 0, 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1)))
    scaled = mass * scale[:, :, None] * scale[:, None]
    scaled[:, range(scale.shape[1]), range(scale.shape[1])] += held
    rates, multipliers = solved(scaled, rows * scale[:, None], force * scale, target)
    return rates * scale, multipliers
