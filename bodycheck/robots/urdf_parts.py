"""Read one link or one joint of a URDF as the specification says, in exact arithmetic.

https://wiki.ros.org/urdf/XML/link and https://wiki.ros.org/urdf/XML/joint, with the attitudes of version 1.1. Elements without
a meaning for mechanics are not read: shapes, materials, transmissions, calibrations, safety controllers, and all elements that
the specification does not have, in which programs keep their own settings.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from bodycheck.reference.exact.inertia import MassProperties
from bodycheck.reference.exact.numbers import MP, Quaternion4, Vector3, vector
from bodycheck.reference.robots.model import Mimic, RobotJointType
from bodycheck.robots.attributes import SPACE, attitude, number, numbers, position, required
from bodycheck.robots.elements import Element, quoted
from bodycheck.robots.faults import About
from bodycheck.robots.orientations import turned_inertia

#: The types of joints by their names in URDF.
TYPES: Mapping[str, RobotJointType] = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "fixed": "fixed",
    "floating": "floating",
    "planar": "planar",
}

#: A type of joint that the specification does not have, but some engines do.
ADDED_TYPES: Mapping[str, RobotJointType] = {"spherical": "spherical"}

#: The joints with an axis, and with limits that the specification requires.
WITH_AXIS = ("revolute", "continuous", "prismatic", "planar")
LIMITED = ("revolute", "prismatic")

#: The six components of <inertia>, in the order XX, YY, ZZ, XY, XZ, YZ.
COMPONENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")

#: The axis of a joint that states none.
DEFAULT_AXIS = (1.0, 0.0, 0.0)

#: The words that mean no limit.
UNLIMITED = ("inf", "+inf", "-inf", "infinity", "+infinity", "-infinity")


@dataclass(frozen=True)
class Limits:
    """The limits of a joint: force (N m or N), speed (rad/s or m/s) and position (rad or m); None means no limit."""

    effort: float | None = None
    velocity: float | None = None
    lower: float | None = None
    upper: float | None = None


@dataclass(frozen=True, eq=False)
class LinkPart:
    """A link of a URDF: its name, its element, and its mass properties in its own frame."""

    name: str
    element: Element
    mass_properties: MassProperties


@dataclass(frozen=True, eq=False)
class JointPart:
    """A joint of a URDF.

    Attributes
    ----------
    name, type, element
        Its name, type and element.
    parent, child
        The names of the two links.
    origin, attitude
        The pose of the joint's frame in the parent's frame: its origin (m), and the unit quaternion (w, x, y, z) from the axes
        of the joint to the axes of the parent.
    axis
        The axis as it is written, in the joint's frame; 0 if the joint has no axis.
    damping, friction, limits, mimic
        As in `bodycheck.reference.robots.model.RobotJoint`.
    """

    name: str
    type: RobotJointType
    element: Element
    parent: str
    child: str
    origin: Vector3
    attitude: Quaternion4
    axis: Vector3
    damping: float
    friction: float
    limits: Limits
    mimic: Mimic | None


def mass_properties(about: About, link: Element) -> MassProperties:
    """Return the mass properties of a link in its frame: all 0 without <inertial>, as the specification says."""
    inertial = about.only("mass", link, "inertial")
    if inertial is None:
        return MassProperties(MP.mpf(0), vector((0, 0, 0)), (MP.mpf(0),) * 6)
    origin = about.only("center_of_mass", inertial, "origin")
    mass, inertia = about.only("mass", inertial, "mass"), about.only("inertia", inertial, "inertia")
    if mass is None:
        about.add("mass", inertial, None, "has no <mass>, which URDF requires")
    if inertia is None:
        about.add("inertia", inertial, None, "has no <inertia>, which URDF requires")
    components = [0.0 if inertia is None else required(about, "inertia", inertia, key) for key in COMPONENTS]
    return MassProperties(
        MP.mpf(0.0 if mass is None else required(about, "mass", mass, "value")),
        position(about, "center_of_mass", origin),
        turned_inertia(components, attitude(about, "inertia", origin)),
    )


def joint(about: About, element: Element) -> JointPart | None:
    """Return a joint; None and a fault if it has no meaning, because its type, its axis or one of its links is missing."""
    parent, child = _link(about, element, "parent"), _link(about, element, "child")
    written = element.attributes.get("type")
    kind = _type(about, element, written)
    axis = _axis(about, element) if written in WITH_AXIS else vector((0, 0, 0))
    origin, dynamics = about.only("pose", element, "origin"), about.only("damping", element, "dynamics")
    pose = position(about, "pose", origin), attitude(about, "pose", origin)
    damping, friction = (
        0.0 if dynamics is None else number(about, "damping", dynamics, "damping"),
        0.0 if dynamics is None else number(about, "friction", dynamics, "friction"),
    )
    limits, mimic = _limits(about, element, written), _mimic(about, element)
    if parent is None or child is None or kind is None or axis is None:
        return None
    return JointPart(about.subject, kind, element, parent, child, *pose, axis, damping, friction, limits, mimic)


def _link(about: About, joint_element: Element, end: str) -> str | None:
    """Return the name of the parent or child of a joint."""
    element = about.only("parent", joint_element, end)
    name = None if element is None else element.attributes.get("link")
    if name is None:
        about.add("parent", element or joint_element, "link" if element else None, f"{end}: is missing")
    return name


def _type(about: About, element: Element, written: str | None) -> RobotJointType | None:
    if written is not None and written in TYPES:
        return TYPES[written]
    stated = "is missing" if written is None else f"read {quoted(written)}"
    about.add("joint_type", element, "type", f"{stated}; allowed: {', '.join(TYPES)}")
    return ADDED_TYPES.get(written or "")


def _axis(about: About, joint_element: Element) -> Vector3 | None:
    element = about.only("axis", joint_element, "axis")
    if element is None:
        return vector(DEFAULT_AXIS)
    if "xyz" not in element.attributes:
        about.add("axis", element, "xyz", "is missing; allowed: 3 numbers separated by spaces")
    axis = vector(numbers(about, "axis", element, "xyz", DEFAULT_AXIS))
    if not any(axis):
        about.add("axis", element, "xyz", f"joint {quoted(about.subject)}: axis: its length is 0")
    return axis if any(axis) and all(map(MP.isfinite, axis)) else None


def _limits(about: About, joint_element: Element, written: str | None) -> Limits:
    """Return the limits of a joint. Only revolute and prismatic joints have position limits, which are 0 if not stated."""
    element = about.only("effort_limit", joint_element, "limit")
    if element is None:
        if written in LIMITED:
            about.add("effort_limit", joint_element, None, f"has no <limit>, which URDF requires of a {written} joint")
        return Limits()
    effort, velocity = (_limit(about, element, key, required_here=True) for key in ("effort", "velocity"))
    if written not in LIMITED:
        return Limits(effort, velocity)
    lower, upper = (_limit(about, element, key, required_here=False) for key in ("lower", "upper"))
    if lower is not None and upper is not None and lower > upper:
        about.add("effort_limit", element, "lower", f"read {lower!r}, which exceeds upper, {upper!r}")
        return Limits(effort, velocity)
    return Limits(effort, velocity, lower, upper)


def _limit(about: About, element: Element, attribute: str, *, required_here: bool) -> float | None:
    """Return a limit; None if it is infinite, cannot be read, or is required and missing."""
    text = element.attributes.get(attribute)
    if text is None and required_here:
        about.add("effort_limit", element, attribute, "is missing; allowed: one number")
        return None
    if text is not None and text.strip(SPACE).lower() in UNLIMITED:
        return None
    value = number(about, "effort_limit", element, attribute)
    return value if math.isfinite(value) else None


def _mimic(about: About, joint_element: Element) -> Mimic | None:
    element = about.only("joint_type", joint_element, "mimic")
    if element is None:
        return None
    if "joint" not in element.attributes:
        about.add("joint_type", element, "joint", "is missing; allowed: the name of another joint")
        return None
    multiplier = number(about, "joint_type", element, "multiplier", 1.0)
    return Mimic(element.attributes["joint"], multiplier, number(about, "joint_type", element, "offset", 0.0))
