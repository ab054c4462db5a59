"""The terms of the equations of motion of a robot model, by the recursive Newton-Euler and composite-rigid-body algorithms.

See Featherstone, Rigid Body Dynamics Algorithms, 2008, chapters 5 and 6. All components are along the world's axes, and the
motion and the forces of a link refer to the origin of its frame. Numbers are of the 80-bit type where NumPy has it.

The velocities are those of the joints in the order of the file, each with the components that `RobotState` names. A joint that
mimics another joint is treated as independent here; the states set its position, velocity and acceleration accordingly.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.kinematics import cross, normalise
from bodycheck.reference.robots.model import RobotJoint, RobotModel, Wide
from bodycheck.reference.robots.motion import PlacedLink, each, jacobians, placed, poses, rows, velocity_maps
from bodycheck.reference.robots.rotations import rotation_vector
from bodycheck.reference.robots.state import VELOCITIES, RobotState, Values
from bodycheck.reference.robots.terms import Terms
from bodycheck.reference.scene import Vector


def passive_force(model: RobotModel, states: Sequence[RobotState]) -> Wide:
    """The passive forces (n, k) p = -stiffness d - damping v - friction sign(v) at n states, for k velocities in file order.

    For a revolute or prismatic joint, d is the displacement from its `rest`. The spring of any other joint is slack in the zero
    position, and d consists of the shift of the child (m) and the rotation vector of its attitude (rad).
    """
    parts = [np.zeros((len(states), 0), np.longdouble)]
    for joint in model.joints:
        velocity = rows(states, joint, lambda state: state.velocities)
        force: Wide = np.asarray(-joint.damping * velocity - joint.friction * np.sign(velocity), np.longdouble)
        if joint.stiffness:
            force = force - joint.stiffness * _displacement(joint, rows(states, joint, lambda state: state.positions))
        parts.append(force)
    return np.concatenate(parts, axis=1)


def _displacement(joint: RobotJoint, position: Wide) -> Wide:
    match joint.type:
        case "spherical":
            return rotation_vector(normalise(position))
        case "floating":
            return np.concatenate([position[:, :3], rotation_vector(normalise(position[:, 3:]))], axis=1)
        case "planar":
            return position
        case _:
            return position - joint.rest


def solved(matrices: Wide, right: Wide) -> tuple[Wide, NDArray[np.bool_]]:
    """The solutions (n, k) of n systems of linear equations, and whether each matrix is positive definite beyond rounding (n,).

    matrices: (n, k, k), symmetric. right: (n, k), right-hand sides. If a matrix is not positive definite, its solution is
    meaningless.
    """
    rest, solutions = matrices.copy(), right.copy()
    count, size = right.shape
    smallest = size * np.finfo(np.longdouble).eps * np.diagonal(matrices, axis1=1, axis2=2)
    definite = np.ones(count, np.bool_)
    factor = np.zeros_like(matrices)
    for k in range(size):
        enough = rest[:, k, k] > smallest[:, k]
        definite &= enough
        pivot: Any = np.sqrt(np.where(enough, rest[:, k, k], 1))
        factor[:, k:, k] = rest[:, k:, k] / pivot[:, None]
        factor[:, k, k] = pivot
        below = factor[:, k + 1 :, k]
        rest[:, k + 1 :, k + 1 :] -= below[:, :, None] * below[:, None, :]
        solutions[:, k] /= pivot
        solutions[:, k + 1 :] -= below * solutions[:, k, None]
    for k in reversed(range(size)):
        solutions[:, k] /= factor[:, k, k]
        solutions[:, :k] -= factor[:, k, :k] * solutions[:, k, None]
    return solutions, definite


@dataclass(frozen=True, eq=False)
class _Motion:
    """The motion of a link: angular velocity, angular acceleration, and the acceleration of its origin, each (n, 3)."""

    spin: Wide
    angular: Wide
    linear: Wide


def velocity_labels(model: RobotModel) -> tuple[tuple[str, int], ...]:
    """The name of the joint of each velocity, and the index of the velocity among the velocities of that joint."""
    return tuple((joint.name, component) for joint in model.joints for component in range(VELOCITIES[joint.type]))


def terms(model: RobotModel, state: RobotState, gravity: Vector) -> Terms:
    """The terms of the equations of motion of a robot model at a state: see `terms_at`, which is faster for many states."""
    return terms_at(model, [state], gravity)[0]


def terms_at(model: RobotModel, states: Sequence[RobotState], gravity: Vector) -> tuple[Terms, ...]:
    """The terms of the equations of motion of a robot model at each of several states.

    The states are computed together, along a leading axis of all arrays, which takes hardly longer than a single state.

    Parameters
    ----------
    model
        The model. Its masses and inertias may be unphysical; its joints are a tree.
    states
        The states.
    gravity
        The gravitational acceleration, world frame (m/s^2).

    Returns
    -------
    tuple of Terms
        All terms for each state, in `numpy.longdouble`. The Jacobians refer to the origin of each link's frame and to the axes
        of the world. `forward_dynamics` is None where the mass matrix is not positive definite beyond rounding.

    Raises
    ------
    ValueError
        If the joints do not form a tree.
    KeyError
        If a state lacks a joint that is not fixed.
    """
    if not states:
        return ()
    with np.errstate(invalid="ignore", over="ignore"):  # a mass in the file may be infinite or not a number
        return _terms(model, states, np.array(gravity, np.longdouble))


def _terms(model: RobotModel, states: Sequence[RobotState], gravity: Wide) -> tuple[Terms, ...]:
    links, armature = placed(model, states), _armature(model)
    velocity, acceleration, effort = (
        _stacked(model, states, part)
        for part in (lambda state: state.velocities, lambda state: state.accelerations, lambda state: state.efforts)
    )
    rest, weightless = np.zeros_like(velocity), np.zeros(3, np.longdouble)
    maps = velocity_maps(links, len(armature))
    mass = _mass_matrix(links, maps, armature)
    holding = _forces(links, rest, rest, gravity)
    coriolis = _forces(links, velocity, rest, weightless)
    passive = passive_force(model, states)
    inverse = _forces(links, velocity, acceleration, gravity) + armature * acceleration
    forward, definite = solved(mass, effort + passive - coriolis - holding)
    names = [link.name for link in model.links]
    frames, velocities = poses(links, names), jacobians(links, maps, names)
    return tuple(
        Terms(
            poses={name: frames[name][row] for name in names},
            jacobians={name: velocities[name][row] for name in names},
            mass_matrix=mass[row],
            gravity_force=holding[row],
            coriolis_force=coriolis[row],
            passive_force=passive[row],
            forward_dynamics=forward[row] if definite[row] else None,
            inverse_dynamics=inverse[row],
        )
        for row in range(len(states))
    )


def _stacked(model: RobotModel, states: Sequence[RobotState], part: Callable[[RobotState], Values]) -> Wide:
    """The numbers (n, k) of all joints at n states, in the order of the file. part: selects them from a state."""
    nothing = np.zeros((len(states), 0), np.longdouble)
    return np.concatenate([nothing, *(rows(states, joint, part) for joint in model.joints)], axis=1)


def _armature(model: RobotModel) -> Wide:
    """The armature (k,) for each velocity."""
    return np.array([joint.armature for joint in model.joints for _ in range(VELOCITIES[joint.type])], np.longdouble)


def _forces(links: Sequence[PlacedLink], velocity: Wide, acceleration: Wide, gravity: Wide) -> Wide:
    """The efforts (n, k) that a motion requires, without armature, by the recursive Newton-Euler algorithm.

    velocity, acceleration: (n, k). gravity: (3,); it is represented by an acceleration of the root by -gravity.
    """
    zero = np.zeros((len(velocity), 3), np.longdouble)
    motions: list[_Motion] = []
    for link in links:
        before = motions[link.parent] if link.parent >= 0 else _Motion(zero, zero, zero - gravity)
        motions.append(_moved(link, before, velocity[:, link.columns], acceleration[:, link.columns]))
    needed = [_needed(link, motion) for link, motion in zip(links, motions, strict=True)]
    pushes, torques = [push for push, _ in needed], [torque for _, torque in needed]
    efforts = np.zeros_like(velocity)
    for index, link in reversed(list(enumerate(links))):
        push, torque = pushes[index], torques[index]
        efforts[:, link.columns] = each(link.slides, push) + each(link.spins, torque)
        if link.parent >= 0:
            pushes[link.parent] = pushes[link.parent] + push
            torques[link.parent] = torques[link.parent] + torque + cross(link.arm, push)
    return efforts


def _moved(link: PlacedLink, before: _Motion, rate: Wide, change: Wide) -> _Motion:
    """The motion of a link from the motion `before` of its parent. rate, change: velocities, accelerations (n, k) of its joint.

    The formula holds because the joint's part of the angular velocity is fixed in the parent, or in the child, and its part of
    the velocity of the origin is fixed in the parent, apart from `change`.
    """
    spin, slide = _combined(link.spins, rate), _combined(link.slides, rate)
    centripetal = cross(before.spin, cross(before.spin, link.arm) + 2 * slide)
    return _Motion(
        before.spin + spin,
        before.angular + cross(before.spin, spin) + _combined(link.spins, change),
        before.linear + cross(before.angular, link.arm) + centripetal + _combined(link.slides, change),
    )


def _needed(link: PlacedLink, motion: _Motion) -> tuple[Wide, Wide]:
    """The force and the torque about its origin, each (n, 3), that the motion of a link requires."""
    swung = cross(motion.angular, link.centre) + cross(motion.spin, cross(motion.spin, link.centre))
    push = link.mass * (motion.linear + swung)
    gyroscopic = cross(motion.spin, each(link.tensor, motion.spin))
    return push, cross(link.centre, push) + each(link.tensor, motion.angular) + gyroscopic


def _combined(along: Wide, rates: Wide) -> Wide:
    """The sums (n, 3), over k, of velocities (n, k, 3) times rates (n, k)."""
    return np.asarray((rates[:, None, :] @ along)[:, 0])


def _mass_matrix(links: Sequence[PlacedLink], maps: Sequence[tuple[Wide, Wide]], armature: Wide) -> Wide:
    """The mass matrices (n, k, k) with armature, by the composite-rigid-body algorithm. maps: from `velocity_maps`."""
    masses = [link.mass for link in links]
    moments = [link.mass * link.centre for link in links]
    tensors = [link.tensor + link.mass * _squared(link.centre, link.centre) for link in links]
    matrix = np.zeros((len(links[0].turn), len(armature), len(armature)), np.longdouble)
    for index, link in reversed(list(enumerate(links))):
        push, torque = _momentum(link, masses[index], moments[index], tensors[index])
        linear, angular = maps[index]
        # The power of this force and torque per unit of each joint velocity; zero for joints that do not carry the link.
        rows = push @ np.swapaxes(linear, 1, 2) + torque @ np.swapaxes(angular, 1, 2)
        matrix[:, link.columns] += rows
        matrix[:, :, link.columns] += np.swapaxes(rows, 1, 2)
        block = rows[:, :, link.columns]
        matrix[:, link.columns, link.columns] = (block + np.swapaxes(block, 1, 2)) / 2
        if link.parent >= 0:
            arm, moment = link.arm, moments[index]
            shifted = _squared(arm, moment) + _squared(moment, arm) + masses[index] * _squared(arm, arm)
            masses[link.parent] = masses[link.parent] + masses[index]
            moments[link.parent] = moments[link.parent] + moment + masses[index] * arm
            tensors[link.parent] = tensors[link.parent] + tensors[index] + shifted
    return matrix + np.diag(armature)


def _momentum(link: PlacedLink, mass: np.longdouble, moment: Wide, tensor: Wide) -> tuple[Wide, Wide]:
    """The force and the torque, each (n, k, 3), that unit accelerations of a joint require if all links it moves are one body.

    mass, moment, tensor: mass, mass times centre of mass, and inertia of this rigid body, about the origin of the link.
    """
    push = mass * link.slides + cross(link.spins, moment[:, None])
    return push, cross(moment[:, None], link.slides) + link.spins @ tensor


def _squared(a: Wide, b: Wide) -> Wide:
    """The matrices (n, 3, 3) a.b E - a b^T of vectors (n, 3)."""
    identity = np.eye(3, dtype=np.longdouble)
    return np.asarray((a * b).sum(axis=1)[:, None, None] * identity - a[:, :, None] * b[:, None, :])
