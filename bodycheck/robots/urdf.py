"""Read a URDF as its specification says, and report the violations of the specification.

Reading goes on if the file still has a meaning in spite of a fault: an unreadable number has its default, or is 0 if it has no
default, and the first of several elements counts if only one is allowed. `urdf_parts` reads links and joints; this module reads
how they are connected.
"""

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from bodycheck.errors import BadInput
from bodycheck.reference.exact.numbers import MP, Real, Vector3, wide
from bodycheck.reference.exact.rotations import matrix
from bodycheck.reference.robots.model import RobotJoint, RobotLink, RobotModel, Wide
from bodycheck.robots import elements, urdf_parts
from bodycheck.robots.elements import Element, quoted
from bodycheck.robots.faults import About, FileReading
from bodycheck.robots.orientations import normed
from bodycheck.robots.urdf_parts import JointPart, LinkPart

#: Most links and joints of a model, and most characters of a name. The memory for Jacobians of all links at many states grows
#: with the square of their number, and every table repeats the names many times.
MAX_LINKS = 500
MAX_NAME = 500

#: The versions of URDF, and the first one in which an attitude can be a quaternion.
VERSION = re.compile(r"1\.([0-2])")
WITH_QUATERNIONS = 1

#: The fault of a macro.
MACRO = "is a macro of xacro, which is not expanded here; expand the file first"

#: Types of joints whose one coordinate another joint can follow.
FOLLOWED = ("revolute", "prismatic")


@dataclass(frozen=True, eq=False)
class Parts:
    """The links and joints of a URDF, in its order, which form a tree.

    Attributes
    ----------
    links, joints
        The links and joints.
    root
        The name of the link that no joint moves.
    """

    links: tuple[LinkPart, ...]
    joints: tuple[JointPart, ...]
    root: str


def read(content: bytes, file: str) -> FileReading:
    """Return a URDF as its specification says, in the widest type of NumPy.

    Parameters
    ----------
    content
        The content of the file.
    file
        Its name, for the texts of faults.

    Raises
    ------
    BadInput
        If it is not XML, has a document type definition, is nested too deep, has too many elements, links or joints, or its
        root is not <robot>.
    """
    root = elements.parsed(content, file)
    if root.tag != "robot":
        elements.refuse(root, None, "is no URDF; allowed: <robot>")
    about = about_file(root)
    _check_head(about, root)
    read_parts = parts(root, about)
    model = None if read_parts is None else _model(root.attributes.get("name", ""), read_parts)
    return FileReading(model, tuple(about.faults))


def about_file(root: Element) -> About:
    """Return what the readers of links and joints need to know about a file, with an empty list of faults."""
    version = VERSION.fullmatch(root.attributes.get("version", "1.0"))
    return About("model", quaternions=version is not None and int(version[1]) >= WITH_QUATERNIONS)


def _check_head(about: About, root: Element) -> None:
    """Add the faults of <robot> itself, and of unexpanded macros."""
    written = root.attributes.get("version", "1.0")
    if not VERSION.fullmatch(written):
        about.add("", root, "version", f"read {quoted(written)}; allowed: 1.0, 1.1 or 1.2")
    if "name" not in root.attributes:
        about.add("", root, "name", "is missing; allowed: the name of the robot")
    for element in macros(root):
        about.add("", element, None, MACRO)


def macros(root: Element) -> Iterator[Element]:
    """Yield the unexpanded macros of xacro in a file."""
    return (element for element in root.everything() if element.tag.startswith("xacro:"))


def parts(root: Element, about: About) -> Parts | None:
    """Return the links and joints of a URDF; None and at least one fault if they do not form a tree.

    Raises `BadInput` if there are too many of them.
    """
    counts = Counter(element.tag for element in root.children)
    for tag in ("link", "joint"):
        if counts[tag] > MAX_LINKS:
            raise BadInput(f"{root.file}: has {counts[tag]} {tag}s; allowed: at most {MAX_LINKS}")
    links, joints = _named(about, root, "link"), _named(about, root, "joint")
    if counts["link"] == 0:
        about.add("parent", root, None, "has no <link>")
    link_parts = [LinkPart(name, child, urdf_parts.mass_properties(about.of(name), child)) for name, child in links or ()]
    joint_parts = [urdf_parts.joint(about.of(name), child) for name, child in joints or ()]
    sound = [joint for joint in joint_parts if joint is not None]
    if not links or joints is None or len(sound) < len(joint_parts):
        return None
    root_name = _root(about, root, dict(links), sound)
    return None if root_name is None else Parts(tuple(link_parts), tuple(_following(about, sound)), root_name)


def _named(about: About, root: Element, tag: str) -> list[tuple[str, Element]] | None:
    """Return the elements with a tag, each with its name; None and a fault if a name is missing, too long or repeated."""
    elements_with_tag = [(element.attributes.get("name", ""), element) for element in root.all(tag)]
    named = [(name, element) for name, element in elements_with_tag if 0 < len(name) <= MAX_NAME]
    for name, element in elements_with_tag:
        if not name:
            about.add("parent", element, "name", "is missing")
        elif len(name) > MAX_NAME:
            about.add("parent", element, "name", f"read {quoted(name)}; allowed: at most {MAX_NAME} characters")
    counts = Counter[str]()
    for name, element in named:
        counts[name] += 1
        if counts[name] == 2:
            about.of(name).add("parent", element, "name", f"read {quoted(name)}, which stands twice")
    return named if len(counts) == len(elements_with_tag) else None


def _root(about: About, root: Element, links: dict[str, Element], joints: list[JointPart]) -> str | None:
    """Return the name of the root of the tree; None and a fault if there is no tree."""
    holder: dict[str, JointPart] = {}
    broken = False
    for joint in joints:
        for end in ("parent", "child"):
            if (name := getattr(joint, end)) not in links:
                broken, element = True, joint.element.first(end) or joint.element
                about.of(joint.name).add("parent", element, "link", f"{end}: there is no link {quoted(name)}")
        if joint.child in holder:
            broken = True
            reason = f"the link {quoted(joint.child)} is the child of two joints; allowed: one"
            about.of(joint.child).add("parent", joint.element, None, reason)
        holder[joint.child] = joint
    if broken:
        return None
    roots = [name for name in links if name not in holder]
    if len(roots) != 1:
        listed = ", ".join(map(quoted, roots[:10])) + (", …" if len(roots) > 10 else "") or "none"
        about.add("parent", root, None, f"links without a parent: {listed}; allowed: one")
        return None
    reached = set(below(roots[0], joints)) | {roots[0]}
    for name in links:
        if name not in reached:
            about.of(name).add("parent", links[name], None, "is in a circle of links, which no root leads to")
            return None
    return roots[0]


def below(root: str, joints: list[JointPart] | tuple[JointPart, ...]) -> list[str]:
    """Return the names of all links below a root, without the root, each after its parent and in the order of joints."""
    children: dict[str, list[str]] = {}
    for joint in joints:
        children.setdefault(joint.parent, []).append(joint.child)
    names = [root]
    for name in names:
        names += children.get(name, ())
    return names[1:]


def _following(about: About, joints: list[JointPart]) -> list[JointPart]:
    """Return the joints without meaningless <mimic> elements: of unknown joints, in circles, or of unsuitable types."""
    by_name = {joint.name: joint for joint in joints}
    following = []
    for joint in joints:
        if joint.mimic is None or joint.type == "fixed":  # a fixed joint has nothing that could follow
            following.append(replace(joint, mimic=None))
            continue
        seen, leader = {joint.name}, by_name.get(joint.mimic.joint)
        while leader is not None and leader.mimic is not None and leader.name not in seen:
            seen.add(leader.name)
            leader = by_name.get(leader.mimic.joint)
        followed = by_name.get(joint.mimic.joint)
        reason = ""
        if followed is None:
            reason = f"there is no joint {quoted(joint.mimic.joint)}"
        elif leader is not None and leader.name in seen:
            reason = "the joints follow one another in a circle"
        elif followed.type not in FOLLOWED or joint.type not in FOLLOWED:
            reason = f"a {joint.type} joint cannot follow a {followed.type} one; allowed: revolute, continuous and prismatic"
        if reason:
            about.of(joint.name).add("joint_type", joint.element.first("mimic") or joint.element, "joint", reason)
        following.append(replace(joint, mimic=None) if reason else joint)
    return following


def _model(name: str, read_parts: Parts) -> RobotModel:
    """Return a model in the widest type of NumPy."""
    places = {link.name: index for index, link in enumerate(read_parts.links)}
    return RobotModel(
        name,
        tuple(_link(link) for link in read_parts.links),
        tuple(_joint(joint, places) for joint in read_parts.joints),
    )


def _link(part: LinkPart) -> RobotLink:
    xx, yy, zz, xy, xz, yz = part.mass_properties.tensor
    inertia = [*map(rounded, ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))]
    return RobotLink(part.name, float(part.mass_properties.mass), rounded(part.mass_properties.centre), np.array(inertia))


def _joint(part: JointPart, places: dict[str, int]) -> RobotJoint:
    return RobotJoint(
        part.name,
        part.type,
        places[part.parent],
        places[part.child],
        rounded(part.origin),
        np.array([rounded(row) for row in matrix(part.attitude)]),
        rounded(normed(part.axis) if any(part.axis) else part.axis),
        damping=part.damping,
        friction=part.friction,
        effort_limit=part.limits.effort,
        velocity_limit=part.limits.velocity,
        lower=part.limits.lower,
        upper=part.limits.upper,
        mimic=part.mimic,
    )


def rounded(values: Vector3) -> Wide:
    """Return exact numbers in the widest type of NumPy."""
    return np.array([_wide(value) for value in values], np.longdouble)


def _wide(value: Real) -> np.longdouble:
    return wide(value) if MP.isfinite(value) else np.longdouble(float(value))
