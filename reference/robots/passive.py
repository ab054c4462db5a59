"""The forces of springs, damping and dry friction in the joints of a robot model."""

from collections.abc import Sequence

import numpy as np

from bodycheck.reference.kinematics import normalise
from bodycheck.reference.robots.model import RobotJoint, RobotModel, Wide
from bodycheck.reference.robots.motion import rows
from bodycheck.reference.robots.rotations import rotation_vector
from bodycheck.reference.robots.state import RobotState


def passive_force(model: RobotModel, states: Sequence[RobotState]) -> Wide:
    """The forces (n, k) p = -stiffness d - damping v - friction sign(v) for all velocities, in the order of the file's joints.

    d is the displacement of a revolute or prismatic joint from its rest. The spring of another joint is slack in the zero
    position: there d is the shift of the child (m), and the rotation vector of its attitude (rad).
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
