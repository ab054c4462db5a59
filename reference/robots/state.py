"""A state of a robot model, by the names of its joints, at which terms of the equations of motion are compared."""

from collections.abc import Mapping
from dataclasses import dataclass

from bodycheck.reference.robots.model import RobotJointType

#: Numbers of coordinates and of velocities of each type of joint.
COORDINATES: Mapping[RobotJointType, int] = {
    "revolute": 1, "prismatic": 1, "fixed": 0, "floating": 7, "planar": 3, "spherical": 4,
}  # fmt: skip
VELOCITIES: Mapping[RobotJointType, int] = {
    "revolute": 1, "prismatic": 1, "fixed": 0, "floating": 6, "planar": 3, "spherical": 3,
}  # fmt: skip

Values = Mapping[str, tuple[float, ...]]


@dataclass(frozen=True)
class RobotState:
    """A state of all joints that are not fixed, by their names.

    Revolute and prismatic joints have one number each. A planar joint has x and y along two axes of its plane and the angle
    about its normal. A spherical joint has a unit quaternion w, x, y, z from child to joint frame, and the angular velocity in
    the child's frame. A floating joint has the position x, y, z of the child's origin in the joint's frame and the same
    quaternion as a spherical joint, and the velocity vx, vy, vz of the origin along the joint frame's axes and the angular
    velocity wx, wy, wz in the child's frame. Accelerations are the derivatives of these velocities, and efforts are the forces
    and torques whose power is effort times velocity.

    Attributes
    ----------
    positions, velocities
        Positions and velocities (rad, m, and per second).
    accelerations
        Accelerations for the inverse dynamics (per second squared).
    efforts
        Efforts for the forward dynamics (N m or N).
    """

    positions: Values
    velocities: Values
    accelerations: Values
    efforts: Values
