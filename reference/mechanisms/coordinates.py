"""The layout of the coordinates and velocities of joints in arrays.

The coordinates of a mechanism are the coordinates of its joints one after another, in the order of the file; the velocities
likewise.

- revolute: the angle about the axis (rad); its rate.
- prismatic: the displacement along the axis (m); its rate.
- universal: the angle about x of the joint's frame, then the angle about the turned axis y (rad); their rates.
- planar: x and y (m) along x and y of the joint's frame, then the angle about its z (rad); their rates.
- spherical: the quaternion w, x, y, z from the child's frame to the joint's frame; the angular velocity in the child's frame
  (rad/s).
- free: x, y, z (m) of the child's origin in the joint's frame, and the quaternion w, x, y, z from the child's frame to the
  joint's frame; the velocity of the child's origin along the axes of the joint's frame (m/s), and the angular velocity in the
  child's frame (rad/s).
- fixed: none.

A free body, which is the child of no joint, has no coordinates here.
"""

from dataclasses import dataclass
from typing import Any

from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES, JointType
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array

#: The numbers of coordinates and of velocities of each type of joint.
COORDINATES: dict[JointType, int] = {name: len(form.coordinates) for name, form in JOINT_TYPES.items()}
VELOCITIES: dict[JointType, int] = {name: len(form.velocities) for name, form in JOINT_TYPES.items()}


@dataclass(frozen=True, eq=False)
class JointMotion:
    """The coordinates (n, c) and velocities (n, u) of the joints of a mechanism at n instants, in the layout of this module."""

    position: Array
    velocity: Array

    def part(self, rows: Any) -> "JointMotion":
        """The motion at some of the instants, selected by a slice, by indices or by a mask (n,)."""
        return JointMotion(self.position[rows], self.velocity[rows])


def places(mechanism: Mechanism) -> tuple[tuple[slice, slice], ...]:
    """The slices of each joint's coordinates and velocities in the arrays of the mechanism, in the order of the joints."""
    slices, first, second = [], 0, 0
    for joint in mechanism.joints:
        after, beyond = first + COORDINATES[joint.type], second + VELOCITIES[joint.type]
        slices.append((slice(first, after), slice(second, beyond)))
        first, second = after, beyond
    return tuple(slices)


def by_name(mechanism: Mechanism, motion: JointMotion) -> dict[str, dict[str, Array]]:
    """Return the coordinates and velocities of each joint, by its name, under the keys `position` and `velocity`.

    They are arrays (n,) for a joint with one coordinate, and (n, k) for a joint with several.
    """
    pairs = zip(mechanism.joints, places(mechanism), strict=True)
    return {
        joint.name: {"position": _single(motion.position[:, held]), "velocity": _single(motion.velocity[:, moving])}
        for joint, (held, moving) in pairs
    }


def _single(values: Array) -> Array:
    return values[:, 0] if values.shape[1] == 1 else values
