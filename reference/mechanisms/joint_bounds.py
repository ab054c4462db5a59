"""Bounds of the errors of the coordinates of joints, which follow from the bounds of the states of bodies.

The angle of a hinge is wrong by at most the errors of the attitudes of both its bodies, and the displacement of a slider by at
most those of their positions and, where its parent turns, of the parent's attitude times their distance. A body that is the
world has no error. The bounds include the rounding of the coordinate itself.
"""

import numpy as np

from bodycheck.reference.bounds import EPS, Bounds
from bodycheck.reference.mechanisms.coordinates import JointMotion, places
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.trajectory import Array, Trajectory


def joint_bounds(mechanism: Mechanism, trajectory: Trajectory, joints: JointMotion, bounds: Bounds) -> tuple[Array, Array]:
    """Return bounds (n, c) and (n, u) of the errors of the coordinates of joints and of their velocities.

    They are infinite for types of joints other than hinges, sliders and balls.
    """
    position, velocity = EPS * np.abs(joints.position), EPS * np.abs(joints.velocity)
    for joint, (held, moving) in zip(mechanism.joints, places(mechanism), strict=True):
        for_position, for_velocity = _of(joint, trajectory, bounds)
        position[:, held] += for_position[:, None]
        velocity[:, moving] += for_velocity[:, None]
    return position, velocity


def _of(joint: Joint, trajectory: Trajectory, bounds: Bounds) -> tuple[Array, Array]:
    """Bounds (n,) of the errors of the coordinates of a joint and of their velocities, without rounding."""
    angle, place, speed, rate = bounds.error, bounds.position_error, bounds.velocity_error, bounds.angular_velocity_error
    if joint.type not in ("revolute", "prismatic", "spherical"):
        return np.full(len(angle), np.inf), np.full(len(angle), np.inf)
    turns = joint.type != "prismatic"
    if joint.parent == WORLD:
        return (angle, rate) if turns else (place, speed)
    parent, child = trajectory.body(joint.parent), trajectory.body(joint.child)
    spin = np.linalg.norm(parent.angular_velocity, axis=-1)
    if turns:
        return 2 * angle, 2 * rate + 2 * angle * spin
    apart = np.linalg.norm(child.position - parent.position, axis=-1)
    parting = np.linalg.norm(child.velocity - parent.velocity, axis=-1)
    return 2 * place + angle * apart, 2 * speed + rate * apart + spin * 2 * place + angle * (parting + spin * apart)
