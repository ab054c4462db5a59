"""Read the links and joints of a URDF as tables of a case file.

The root link is the world, as in engines that load a URDF without a free joint, unless the base is free: a joint `free` then
moves it. A massless link that is fixed to another link is only a frame of that link; one that moves is a body without mass.
Links that are fixed to one another become one body where the inertia of one of them alone is impossible; see `rigid`.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from bodycheck.casefile.robot_notes import JointRange
from bodycheck.casefile.robots import tables
from bodycheck.casefile.robots.reading import FIRST_IF_ANY, Choice, Read
from bodycheck.casefile.robots.tables import BASE, HERE, RESERVED, Pose, unique
from bodycheck.casefile.robots.urdf.features import features
from bodycheck.casefile.robots.urdf.rigid import Rigid, placed, prepared, rigid
from bodycheck.errors import BadInput
from bodycheck.reference.exact.inertia import MassProperties, joined
from bodycheck.reference.exact.numbers import MP, vector
from bodycheck.reference.exact.rotations import conjugate
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES
from bodycheck.robots.elements import Element, place
from bodycheck.robots.orientations import from_z
from bodycheck.robots.urdf import MACRO, Parts, about_file, below, macros, parts
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
    rigid
        The links that are read as parts of what carries them.
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

    rigid: Rigid
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
    read = _parts(root, choice)
    links = _Tree(rigid(read, floats=choice.base == "free"))
    by_name, holders = {link.name: link for link in read.links}, {joint.child: joint for joint in read.joints}
    base, root_link = None, by_name[read.root]
    if choice.base == "free":
        base = unique(BASE, {joint.name for joint in read.joints})
        _add(links, root_link, read, tables.joint(base, "free", world, _body_name(read.root, read, links), HERE), HERE)
    else:
        links.frames[read.root] = world, HERE
    for name in below(read.root, read.joints):
        _add_link(links, by_name[name], read, holders[name], choice)
    if links.faults:
        raise BadInput("\n".join(links.faults))
    return Read(
        {"bodies": [tables.body(*each) for each in links.inertias.items()], "joints": links.joints},
        base=base,
        features=features(root, read, choice.ignore, mimics, links.weightless, links.rigid),
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
    if choice.upright:
        faults.append(f"{root.file}: has no gravity, as it is a URDF; leave upright out")
    if read is None or faults:
        raise BadInput("\n".join(faults))
    return read


def _add_link(links: _Tree, link: LinkPart, read: Parts, joint: JointPart, choice: Choice) -> None:
    """Add the link that a joint carries, and the joint, unless the link is a frame of the body that carries it."""
    carrier, pose = links.frames[joint.parent]
    pose = pose.then(Pose(joint.origin, joint.attitude))
    if joint.type == "fixed" and (not link.mass_properties.mass or link.name in links.rigid.carried):
        links.frames[link.name] = carrier, pose
        _carry(links, link, carrier, pose, read)
        return
    turn = HERE
    if joint.type == "planar":  # the plane of a case is across the axis z
        turn = Pose(ORIGIN, from_z(joint.axis))
    table = tables.joint(joint.name, TYPES[joint.type], carrier, _body_name(link.name, read, links), pose.then(turn))
    _add(links, link, read, table | _properties(joint, choice), Pose(ORIGIN, conjugate(turn.turn)))


def _add(links: _Tree, link: LinkPart, read: Parts, joint: dict[str, Any], frame: Pose) -> None:
    """Add the body of a link, and the table of its joint. frame: the frame of the link on the body."""
    name = joint["child"]
    links.inertias[name] = placed(_inertia(links, link, read), frame)
    links.joints.append(joint)
    links.frames[link.name] = name, frame


def _carry(links: _Tree, link: LinkPart, carrier: str, pose: Pose, read: Parts) -> None:
    """Add the mass properties of a link to the body that carries it; none are needed where that is the world."""
    weightless = not link.mass_properties.mass
    if weightless and not any(link.mass_properties.tensor):
        return
    if weightless:
        links.weightless.append(link.element)
    if (inertia := links.inertias.get(carrier)) is None:
        return
    if weightless and not inertia.mass:
        links.faults.append(f"{place(link.element)}: {WITHOUT_MASS}")
    further = link.mass_properties if weightless else prepared(link, read)
    links.inertias[carrier] = joined([inertia, placed(further, pose)])


#: The fault of a link that moves, or is fixed to one that has no mass either.
WITHOUT_MASS = "states a moment of inertia without mass, which no body has"


def _inertia(links: _Tree, link: LinkPart, read: Parts) -> MassProperties:
    """Return the mass properties of a link, and add a fault if its mass is impossible."""
    stated = link.mass_properties
    if not stated.mass:
        if any(stated.tensor):
            links.faults.append(f"{place(link.element)}: {WITHOUT_MASS}")
        return NO_MASS
    if stated.mass < 0:
        element = link.element.first("inertial") or link.element
        text = f"read {float(stated.mass)!r}; allowed: a positive number, or 0 for a frame"
        links.faults.append(f"{place(element.first('mass') or element, 'value')}: {text}")
    return prepared(link, read)


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


def _body_name(link: str, read: Parts, links: _Tree) -> str:
    """Return the name of the body of a link: that of the link, unless no body may have it, or the body has more links."""
    names = {link.name for link in read.links}
    if link in links.rigid.heads:
        return unique(f"{link}:rigid", names)
    return unique(f"{link}:link", names) if link in RESERVED else link
