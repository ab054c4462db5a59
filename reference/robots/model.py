"""A robot model: the links, joints and gravity that a URDF or MJCF file describes.

Each link has a frame, which coincides with the frame of its joint when the joint's coordinate is zero, as in URDF. The joints
form a tree whose root is the first link without a joint to a parent. The root is welded to the world. A robot that floats has
a joint of the type "floating" between a root without mass and its base.
"""

from dataclasses import dataclass, replace
from typing import Any, Literal

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
        The name, unique in the model.
    mass
        The mass (kg); 0 where the file states none. It may be negative or not a number if the file says so.
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
    """The rule by which a joint follows another joint, `joint`: position = multiplier * (position of `joint`) + offset."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, eq=False)
class RobotJoint:
    """A joint between two links of a robot model.

    Attributes
    ----------
    name, type
        The name, unique in the model, and the type. A continuous joint of URDF is revolute and has no limits.
    parent, child
        The indices of the two links in `RobotModel.links`.
    position, rotation
        The joint's frame in the parent's frame: its origin (3,) (m), and the matrix (3, 3) that takes components along the
        joint's axes to components along the parent's axes.
    axis
        The unit axis (3,) of a revolute or prismatic joint in the joint's frame, or the normal of a planar one; else zeros.
    armature, damping, friction, stiffness
        Inertia added to the inertia of the coordinate (kg m^2 or kg), viscous damping (N m s/rad or N s/m), dry friction (N m
        or N), and stiffness of a spring that pulls towards the coordinate `rest` (N m/rad or N/m).
    rest
        The position at which the spring is slack (rad or m).
    effort_limit, velocity_limit
        Limits of force (N m or N) and speed (rad/s or m/s); None where the file states none.
    lower, upper
        Limits of the position (rad or m); None where the file states none.
    mimic
        The rule by which this joint follows another joint; None where it moves by itself.
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
        The name of the model in the file.
    links, joints
        The links and joints, in the order of the file.
    gravity
        The gravitational acceleration, world frame (m/s^2). A URDF file states none.
    """

    name: str
    links: tuple[RobotLink, ...]
    joints: tuple[RobotJoint, ...]
    gravity: Vector = (0.0, 0.0, -9.81)

    @property
    def joint_of(self) -> tuple[RobotJoint | None, ...]:
        """The joint of each link, whose child the link is; None for the root."""
        by_child = {joint.child: joint for joint in self.joints}
        return tuple(by_child.get(index) for index in range(len(self.links)))

    @property
    def root(self) -> int:
        """The index of the first link that is the child of no joint."""
        return self.joint_of.index(None)


def from_the_root(model: RobotModel) -> tuple[RobotJoint, ...]:
    """The joints from the root on, each followed by all joints below its child; joints of the same parent are in file order.

    Raises `ValueError` if the joints are not a tree: a link is the child of two joints, or the root does not lead to it.
    """
    carried: dict[int, list[RobotJoint]] = {}
    for joint in model.joints:
        carried.setdefault(joint.parent, []).append(joint)
    if len({joint.child for joint in model.joints}) < len(model.joints):
        raise ValueError("a link is the child of two joints")
    ordered: list[RobotJoint] = []
    waiting = carried.get(model.root, [])[::-1]
    while waiting:
        ordered.append(joint := waiting.pop())
        waiting += carried.get(joint.child, [])[::-1]
    if len(ordered) + 1 < len(model.links):
        raise ValueError(f"the joints lead from the root to {len(ordered)} of {len(model.links) - 1} links; allowed: all")
    return tuple(ordered)


def with_link(model: RobotModel, name: str, **changes: Any) -> RobotModel:
    """The model, with the attributes `changes` of the link `name` replaced. Raises `KeyError` if there is no such link."""
    index = _index([link.name for link in model.links], name)
    links = list(model.links)
    links[index] = replace(links[index], **changes)
    return replace(model, links=tuple(links))


def with_joint(model: RobotModel, name: str, **changes: Any) -> RobotModel:
    """The model, with the attributes `changes` of the joint `name` replaced. Raises `KeyError` if there is no such joint."""
    index = _index([joint.name for joint in model.joints], name)
    joints = list(model.joints)
    joints[index] = replace(joints[index], **changes)
    return replace(model, joints=tuple(joints))


def _index(names: list[str], name: str) -> int:
    if name not in names:
        raise KeyError(name)
    return names.index(name)
