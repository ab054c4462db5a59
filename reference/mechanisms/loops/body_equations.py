"""The equations of `body_space`: Newton and Euler for every body, with the constraints of links on accelerations."""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.kinematics import cross, dot
from bodycheck.reference.mechanisms.loops.body_space import Side, System
from bodycheck.reference.mechanisms.loops.minimum_norm import solved
from bodycheck.reference.mechanisms.loops.vectors import apply, matrices, turning
from bodycheck.reference.mechanisms.mechanism import WORLD


@dataclass(frozen=True, eq=False)
class Bodies:
    """The states (s, b, ...) of b bodies at s instants, in the world, but rates along the bodies' axes; axes are columns."""

    position: WideArray
    quaternion: WideArray
    axes: WideArray
    velocity: WideArray
    rates: WideArray
    spin: WideArray


@dataclass(frozen=True, eq=False)
class _Frame:
    """A side of a link at s instants, in the world: the index of its body, its axes (s, 3, 3), and vectors (s, 3).

    arm: from the centre of mass of the body to its origin (m). position, velocity: of its origin (m, m/s). spin: angular
    velocity (rad/s).
    """

    body: int
    axes: WideArray
    arm: WideArray
    position: WideArray
    velocity: WideArray
    spin: WideArray


#: A row (s, 6 b) of the Jacobian of constraints, and the part (s,) of the constraint's second derivative without accelerations.
_Row = tuple[WideArray, WideArray]


def unpacked(system: System, states: WideArray) -> Bodies:
    """The states of the bodies from states (s, 13 b + j) of the equations; j: revolute and prismatic joints."""
    count, bodies = len(states), len(system.mass)
    held = states[:, : 7 * bodies].reshape(count, bodies, 7)
    moving = states[:, 7 * bodies : 13 * bodies].reshape(count, bodies, 6)
    quaternion, rates = held[:, :, 3:], moving[:, :, 3:]
    axes = matrices(quaternion.reshape(-1, 4)).reshape(count, bodies, 3, 3)
    return Bodies(held[:, :, :3], quaternion, axes, moving[:, :, :3], rates, apply(axes, rates))


def derivatives(system: System, states: WideArray) -> WideArray:
    """The derivatives (s, 13 b + j) of states (s, 13 b + j)."""
    count, bodies = len(states), len(system.mass)
    now = unpacked(system, states)
    mass, force = _free_motion(system, now)
    rows: list[_Row] = []
    single = states[:, 13 * bodies :]
    speeds = np.zeros_like(single)
    index = 0
    for link in system.links:
        one, other = _frame(now, link.one), _frame(now, link.other)
        link_rows = [_along(bodies, one, other, apply(one.axes, direction)) for direction in link.along]
        link_rows += [_across(bodies, one, other, apply(one.axes, a), apply(other.axes, b)) for a, b in link.across]
        rows += [row[:2] for row in link_rows]
        joint = link.joint
        if joint is None:
            continue
        if joint.type == "spherical" and joint.damping:
            torque = Wide(joint.damping) * (other.spin - one.spin)
            _twist(force, one, torque)
            _twist(force, other, -torque)
        if joint.type in ("revolute", "prismatic"):
            axis = apply(one.axes, link.axis)
            row, bias, speed = (_about if joint.type == "revolute" else _along)(bodies, one, other, axis)
            pull = Wide(joint.stiffness) * (single[:, index] - Wide(joint.rest)) + Wide(joint.damping) * speed
            effort = Wide(joint.effort) - pull - Wide(joint.armature) * bias
            force += row * effort[:, None]
            if joint.armature:
                mass += Wide(joint.armature) * row[:, :, None] * row[:, None, :]
            speeds[:, index], index = speed, index + 1
    jacobian = np.stack([row for row, _ in rows], axis=1) if rows else np.zeros((count, 0, 6 * bodies), dtype=Wide)
    target = -np.stack([bias for _, bias in rows], axis=1) if rows else np.zeros((count, 0), dtype=Wide)
    accelerations, _ = solved(mass, jacobian, force, target)
    made_of = accelerations.reshape(count, bodies, 6)
    turned = turning(now.quaternion.reshape(-1, 4), now.rates.reshape(-1, 3)).reshape(count, bodies, 4)
    held = np.concatenate([now.velocity, turned], axis=2)
    moving = np.concatenate([made_of[:, :, :3], apply(np.swapaxes(now.axes, 2, 3), made_of[:, :, 3:])], axis=2)
    return np.hstack([held.reshape(count, -1), moving.reshape(count, -1), speeds])


def gaps(system: System, states: WideArray) -> WideArray:
    """Return the largest violations (s,) of constraints: distances (m), and cosines of angles that must be right angles."""
    now = unpacked(system, states)
    sizes = [np.zeros(len(states), dtype=Wide)]
    for link in system.links:
        one, other = _frame(now, link.one), _frame(now, link.other)
        apart = other.position - one.position
        sizes += [np.abs(dot(apply(one.axes, direction), apart)) for direction in link.along]
        sizes += [np.abs(dot(apply(one.axes, a), apply(other.axes, b))) for a, b in link.across]
    return np.asarray(np.max(sizes, axis=0))


def _free_motion(system: System, now: Bodies) -> tuple[WideArray, WideArray]:
    """The mass matrix (s, 6 b, 6 b) and the forces (s, 6 b) of the bodies without constraints and forces of joints."""
    count, bodies = now.position.shape[:2]
    mass = np.zeros((count, 6 * bodies, 6 * bodies), dtype=Wide)
    force = np.zeros((count, 6 * bodies), dtype=Wide)
    tensors = now.axes @ system.tensor @ np.swapaxes(now.axes, 2, 3)
    for body in range(bodies):
        at = 6 * body
        mass[:, range(at, at + 3), range(at, at + 3)] = system.mass[body]
        mass[:, at + 3 : at + 6, at + 3 : at + 6] = tensors[:, body]
        force[:, at + 2] = -system.mass[body] * system.gravity
        spin = now.spin[:, body]
        force[:, at + 3 : at + 6] = -cross(spin, apply(tensors[:, body], spin))
    return mass, force


def _frame(now: Bodies, side: Side) -> _Frame:
    count = len(now.position)
    if side.body == WORLD:
        still = np.zeros((count, 3), dtype=Wide)
        axes = np.broadcast_to(side.axes, (count, 3, 3))
        return _Frame(WORLD, axes, still, still + side.arm, still, still)
    axes = now.axes[:, side.body]
    arm, spin = apply(axes, side.arm), now.spin[:, side.body]
    velocity = now.velocity[:, side.body] + cross(spin, arm)
    return _Frame(side.body, axes @ side.axes, arm, now.position[:, side.body] + arm, velocity, spin)


def _along(bodies: int, one: _Frame, other: _Frame, n: WideArray) -> tuple[WideArray, WideArray, WideArray]:
    """The distance of the origins of two frames along a direction n (s, 3) that is fixed in the first frame.

    Returns its row (s, 6 b) of the Jacobian, the part (s,) of its second derivative without accelerations, and its rate (s,).
    """
    apart, speed = other.position - one.position, other.velocity - one.velocity
    turned = cross(one.spin, n)
    row = np.zeros((len(n), 6 * bodies), dtype=Wide)
    for frame, sign in ((one, -1), (other, 1)):
        if frame.body != WORLD:
            row[:, 6 * frame.body : 6 * frame.body + 3] += sign * n
            row[:, 6 * frame.body + 3 : 6 * frame.body + 6] += sign * cross(frame.arm, n)
    if one.body != WORLD:
        row[:, 6 * one.body + 3 : 6 * one.body + 6] += cross(n, apart)
    pulled = cross(other.spin, cross(other.spin, other.arm)) - cross(one.spin, cross(one.spin, one.arm))
    bias = dot(n, pulled) + 2 * dot(turned, speed) + dot(cross(one.spin, turned), apart)
    return row, bias, dot(n, speed) + dot(turned, apart)


def _about(bodies: int, one: _Frame, other: _Frame, axis: WideArray) -> tuple[WideArray, WideArray, WideArray]:
    """The angle between two frames about an axis (s, 3) that is fixed in the first frame. Returns the same as `_along`."""
    row = np.zeros((len(axis), 6 * bodies), dtype=Wide)
    _twist(row, other, axis)
    _twist(row, one, -axis)
    apart = other.spin - one.spin
    return row, dot(cross(one.spin, axis), apart), dot(axis, apart)


def _across(bodies: int, one: _Frame, other: _Frame, a: WideArray, b: WideArray) -> tuple[WideArray, WideArray, WideArray]:
    """The cosine of the angle between directions (s, 3), a fixed in the first frame and b in the second. See `_along`."""
    normal = cross(b, a)
    row = np.zeros((len(a), 6 * bodies), dtype=Wide)
    _twist(row, other, normal)
    _twist(row, one, -normal)
    first, second = cross(one.spin, a), cross(other.spin, b)
    bias = dot(cross(one.spin, first), b) + 2 * dot(first, second) + dot(a, cross(other.spin, second))
    return row, bias, dot(other.spin - one.spin, normal)


def _twist(row: WideArray, frame: _Frame, torque: WideArray) -> None:
    """Add a torque (s, 3) on the body of a frame to forces or a row (s, 6 b), unless the body is the world."""
    if frame.body != WORLD:
        row[:, 6 * frame.body + 3 : 6 * frame.body + 6] += torque
