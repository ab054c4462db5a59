"""Read the links and joints of a URDF as tables of a case file.

The root link is the world, as in engines that load a URDF without a free joint, unless the base is free: a joint `free` then
moves it. A massless link that is fixed to another link is only a frame of that link; one that moves is a body without mass.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from bodycheck.casefile.robot_notes import JointRange
from bodycheck.casefile.robots import tables
from bodycheck.casefile.robots.link import without_rounding
from bodycheck.casefile.robots.reading import FIRST_IF_ANY, Choice, Read
from bodycheck.casefile.robots.tables import BASE, HERE, RESERVED, Pose, turned, unique
from bodycheck.casefile.robots.urdf.features import features
from bodycheck.errors import BadInput
from bodycheck.reference.exact.inertia import MassProperties
from bodycheck.reference.exact.numbers import MP, Vector3, vector
from bodycheck.reference.exact.rotations import conjugate
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES
from bodycheck.reference.robots.physical import rounding
from bodycheck.robots.elements import Element, place
from bodycheck.robots.orientations import from_z, turned_inertia
from bodycheck.robots.urdf import MACRO, Parts, about_file, below, macros, parts, rounded
from bodycheck.robots.urdf_parts import JointPart, LinkPart

#: The types of joints of a case, by the types of a robot model.
TYPES = {form.robot: form.name for form in JOINT_TYPES.values() if form.robot is not None}

#: The position of a frame that is not moved, and the mass properties of a frame.
ORIGIN = vector((0, 0, 0))
NO_MASS = MassProperties(MP.mpf(0), ORIGIN, (MP.mpf(0),) * 6)


@dataclass(frozen=True, eq=False)
class _Tree:
    """The bodies and joints that have been read so far.

    Attributes
    ----------
    frames
        The body that carries each link, and the frame of the link on it, by the names of the links.
    inertias
        The mass properties of the bodies, by their names.
    joints
        The tables of joints.
    faults
        Sentences on what no body can have.
    weightless
        The elements of links with inertia, but without mass.
    """

    frames: dict[str, tuple[str, Pose]] = field(default_factory=dict)
    inertias: dict[str, MassProperties] = field(default_factory=dict)
    joints: list[dict[str, Any]] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    weightless: list[Element] = field(default_factory=list)


def tree(root: Element, world: str, choice: Choice) -> Read:
    """Return the result of reading a URDF. world: the name of the world.

    Raises `BadInput` with a line for each fault.
    """
    mimics = _without_mimics(root) if "mimic" in choice.ignore else []
    read, links = _parts(root, choice), _Tree()
    by_name, holders = {link.name: link for link in read.links}, {joint.child: joint for joint in read.joints}
    base, root_link = None, by_name[read.root]
    if choice.base == "free":
        base = unique(BASE, {joint.name for joint in read.joints})
        _add(links, root_link, read, tables.joint(base, "free", world, _body_name(read.root, read), HERE), HERE)
    else:
        links.frames[read.root] = world, HERE
    for name in below(read.root, read.joints):
        _add_link(links, by_name[name], read, holders[name], choice)
    if links.faults:
        raise BadInput("\n".join(links.faults))
    return Read(
        {"bodies": [tables.body(*each) for each in links.inertias.items()], "joints": links.joints},
        base=base,
        features=features(root, read.joints, choice.ignore, mimics, links.weightless),
        ranges=tuple(_ranges(read.joints)),
        touching=any(link.element.first("collision") is not None for link in read.links),
        welded=base is None and root_link.mass_properties.mass > 0,
    )


def _without_mimics(root: Element) -> list[Element]:
    """Remove the elements <mimic> of all joints, and return them."""
    mimics = []
    for joint in root.all("joint"):
        mimics += list(joint.all("mimic"))
        joint.children = [child for child in joint.children if child.tag != "mimic"]
    return mimics


def _parts(root: Element, choice: Choice) -> Parts:
    """Return the links and joints of a file. Raises `BadInput` with a line for each fault of the file."""
    if unexpanded := [f"{place(element)}: {MACRO}" for element in macros(root)]:
        raise BadInput("\n".join(unexpanded))
    about = about_file(root)
    read = parts(root, about)
    faults = [fault.text for fault in about.faults if fault.quantity != "effort_limit"]
    if choice.keyframe not in (None, FIRST_IF_ANY):
        faults.append(f"{root.file}: has no keyframes, as it is a URDF; leave keyframe out")
    if read is None or faults:
        raise BadInput("\n".join(faults))
    return read


def _add_link(links: _Tree, link: LinkPart, read: Parts, joint: JointPart, choice: Choice) -> None:
    """Add the link that a joint carries, and the joint, unless the link is a frame of the body that carries it."""
    carrier, pose = links.frames[joint.parent]
    pose = pose.then(Pose(joint.origin, joint.attitude))
    if joint.type == "fixed" and not link.mass_properties.mass:
        links.frames[link.name] = carrier, pose
        _carry(links, link, carrier, pose)
        return
    turn = HERE
    if joint.type == "planar":  # the plane of a case is across the axis z
        turn = Pose(ORIGIN, from_z(joint.axis))
    table = tables.joint(joint.name, TYPES[joint.type], carrier, _body_name(link.name, read), pose.then(turn))
    _add(links, link, read, table | _properties(joint, choice), Pose(ORIGIN, conjugate(turn.turn)))


def _add(links: _Tree, link: LinkPart, read: Parts, joint: dict[str, Any], frame: Pose) -> None:
    """Add the body of a link, and the table of its joint. frame: the frame of the link on the body."""
    name = joint["child"]
    inertia = _inertia(links, link, [joint.origin for joint in read.joints if joint.parent == link.name])
    links.inertias[name] = MassProperties(
        inertia.mass, turned(frame.turn, inertia.centre), turned_inertia(inertia.tensor, frame.turn)
    )
    links.joints.append(joint)
    links.frames[link.name] = name, frame


def _carry(links: _Tree, link: LinkPart, carrier: str, pose: Pose) -> None:
    """Add the inertia of a link without mass to the body that carries it; none is needed where that is the world."""
    if not any(link.mass_properties.tensor):
        return
    links.weightless.append(link.element)
    if (inertia := links.inertias.get(carrier)) is None:
        return
    if not inertia.mass:
        links.faults.append(f"{place(link.element)}: {WITHOUT_MASS}")
    further = turned_inertia(link.mass_properties.tensor, pose.turn)
    links.inertias[carrier] = replace(inertia, tensor=tuple(a + b for a, b in zip(inertia.tensor, further, strict=True)))


#: The fault of a link that moves, or is fixed to one that has no mass either.
WITHOUT_MASS = "states a moment of inertia without mass, which no body has"


def _inertia(links: _Tree, link: LinkPart, joints: Sequence[Vector3]) -> MassProperties:
    """Return the mass properties of a link, and add a fault if its mass is impossible.

    Moments that are no larger than what rounding leaves of zero are zero. joints: the positions of the joints on the link (m).
    """
    stated = link.mass_properties
    if not stated.mass:
        if any(stated.tensor):
            links.faults.append(f"{place(link.element)}: {WITHOUT_MASS}")
        return NO_MASS
    if stated.mass < 0:
        element = link.element.first("inertial") or link.element
        text = f"read {float(stated.mass)!r}; allowed: a positive number, or 0 for a frame"
        links.faults.append(f"{place(element.first('mass') or element, 'value')}: {text}")
    mass_properties = without_rounding(stated)
    mass, centre = float(mass_properties.mass), rounded(mass_properties.centre)
    if max(map(abs, mass_properties.tensor)) <= rounding(mass, centre, map(rounded, joints)):
        return replace(mass_properties, tensor=NO_MASS.tensor)
    return mass_properties


def _properties(joint: JointPart, choice: Choice) -> dict[str, Any]:
    """Return the axis, damping, friction and rule of a joint with one coordinate as keys of its table; none of other joints."""
    if joint.type not in ("revolute", "prismatic"):
        return {}
    properties: dict[str, Any] = {"axis": tables.doubles(joint.axis)}
    properties |= {key: getattr(joint, key) for key in ("damping", "friction") if key not in choice.ignore}
    if (rule := joint.mimic) is not None:
        properties["mimic"] = {"joint": rule.joint, "multiplier": rule.multiplier, "offset": rule.offset}
    return properties


def _ranges(joints: Sequence[JointPart]) -> Iterator[JointRange]:
    """Yield the limits of the joints that have any."""
    for joint in joints:
        if joint.limits.lower is not None or joint.limits.upper is not None:
            yield JointRange(joint.name, joint.limits.lower, joint.limits.upper)


def _body_name(link: str, read: Parts) -> str:
    """Return the name of the body of a link: that of the link, unless no body may have it."""
    return unique(f"{link}:link", {link.name for link in read.links}) if link in RESERVED else link
