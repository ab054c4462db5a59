"""A robot model: the links, joints and gravity that a URDF or MJCF file describes.

Each link has a frame, which is the frame of its joint when the joint's coordinate is zero, as URDF has it. The joints form a
tree whose root is the first link without a joint to a parent. The root is welded to the world. A robot that floats has a joint
of the type "floating" between a root without mass and its base.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.scene import Vector

#: Numbers in the 80-bit type.
Wide = NDArray[np.longdouble]

RobotJointType = Literal["revolute", "prismatic", "fixed", "floating", "planar", "spherical"]


@dataclass(frozen=True, eq=False)
class RobotLink:
    """A link of a robot model.

    Attributes
    ----------
    name
        Its name, unique in the model.
    mass
        Its mass (kg); 0 where the file states none. It may be negative or not a number where the file has it so.
    center_of_mass
        The centre of mass (3,) in the link's frame (m).
    inertia
        The inertia tensor (3, 3) about the centre of mass, along the axes of the link's frame (kg m^2).
    """

    name: str
    mass: float
    center_of_mass: Wide
    inertia: Wide


@dataclass(frozen=True)
class Mimic:
    """A joint whose position follows that of another: multiplier times that position plus offset."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, eq=False)
class RobotJoint:
    """A joint between two links of a robot model.

    Attributes
    ----------
    name, type
        Its name, unique in the model, and its type. A continuous joint of URDF is revolute and has no limits.
    parent, child
        The places of the two links in `RobotModel.links`.
    position, rotation
        The joint's frame in the parent's frame: its origin (3,) (m), and the matrix (3, 3) that takes components along the
        joint's axes to components along those of the parent.
    axis
        The unit axis (3,) of a revolute or prismatic joint in the joint's frame, or the normal of a planar one; else zeros.
    armature, damping, friction, stiffness
        Inertia added to that of the coordinate (kg m^2 or kg), viscous damping (N m s/rad or N s/m), dry friction (N m or N),
        and stiffness towards the coordinate `rest` (N m/rad or N/m).
    rest
        The position at which the spring is slack (rad or m).
    effort_limit, velocity_limit
        Limits of force (N m or N) and speed (rad/s or m/s); None where the file states none.
    lower, upper
        Limits of the position (rad or m); None where there are none.
    mimic
        The joint that this one follows; None where it moves by itself.
    """

    name: str
    type: RobotJointType
    parent: int
    child: int
    position: Wide
    rotation: Wide
    axis: Wide
    armature: float = 0.0
    damping: float = 0.0
    friction: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0
    effort_limit: float | None = None
    velocity_limit: float | None = None
    lower: float | None = None
    upper: float | None = None
    mimic: Mimic | None = None


@dataclass(frozen=True, eq=False)
class RobotModel:
    """A robot model.

    Attributes
    ----------
    name
        The name that the file gives it.
    links, joints
        The links and joints, in the order of the file.
    gravity
        The gravitational acceleration, world frame (m/s^2). A URDF states none.
    """

    name: str
    links: tuple[RobotLink, ...]
    joints: tuple[RobotJoint, ...]
    gravity: Vector = (0.0, 0.0, -9.81)

    @property
    def joint_of(self) -> tuple[RobotJoint | None, ...]:
        """The joint whose child each link is; None for the root."""
        by_child = {joint.child: joint for joint in self.joints}
        return tuple(by_child.get(index) for index in range(len(self.links)))

    @property
    def root(self) -> int:
        """The place of the first link that is the child of no joint."""
        return self.joint_of.index(None)
