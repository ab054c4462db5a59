"""Read the links and joints of a URDF as tables of a case file.

The root link is the world, as where engines load a URDF without a free joint. A link without mass that is fixed to another one
is a frame of that one. Limits, geometry, transmissions and what other programs add are no part of the mechanics of a case.
"""

from typing import Any

from bodycheck.casefile.robots import orientations, tables
from bodycheck.casefile.robots.elements import Element, number, numbers, quoted, refuse
from bodycheck.casefile.robots.tables import HERE, Pose, Tables
from bodycheck.casefile.robots.urdf import inertial_of, place_of, refuse_macros

#: The types of joints by their names in URDF.
TYPES = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "fixed": "fixed",
    "floating": "free",
    "planar": "planar",
}


def tree(root: Element, world: str) -> Tables:
    """Return the bodies and joints of a URDF. world: the name of the world.

    Raises `BadInput` for what cannot be read exactly.
    """
    refuse_macros(root)
    links = _named(root, "link")
    joints = _named(root, "joint")
    holder: dict[str, Element] = {}
    for joint in joints.values():
        child = _link(joint, "child", links)
        if child in holder:
            refuse(joint, None, f"the link {quoted(child)} is the child of two joints; allowed: one")
        holder[child] = joint
    if not links:
        refuse(root, None, "has no <link>")
    roots = [name for name in links if name not in holder]
    if len(roots) != 1:
        told = ", ".join(map(quoted, roots[:10])) or "none"
        refuse(root, None, f"links without a parent: {told}; allowed: one, which is the world")
    frames: dict[str, tuple[str, Pose]] = {roots[0]: (world, HERE)}
    made: Tables = {"bodies": [], "joints": []}
    for name in _from_the_root(roots[0], joints, links):
        joint = holder[name]
        parent, pose = frames[_link(joint, "parent", links)]
        pose = pose.then(Pose(place_of(joint.only("origin")), orientations.urdf(joint.only("origin"))))
        inertia = inertial_of(links[name])
        kind = _type(joint)
        if inertia is None:
            if kind != "fixed":
                refuse(links[name], None, "has no mass and moves; only a link that is fixed to another one may have none")
            frames[name] = parent, pose
            continue
        frames[name] = name, HERE
        made["bodies"].append(tables.body(name, inertia))
        made["joints"].append(tables.joint(joint.attributes["name"], kind, parent, name, pose) | _properties(joint, kind))
    if len(frames) < len(links):
        lost = next(name for name in links if name not in frames)
        refuse(links[lost], None, "is in a circle of links, which no root leads to")
    return made


def _named(root: Element, tag: str) -> dict[str, Element]:
    """Return the elements of a file with a tag by their names, in its order."""
    found: dict[str, Element] = {}
    for element in root.all(tag):
        name = element.attributes.get("name")
        if name is None or name in found:
            refuse(element, "name", "is missing" if name is None else f"read {quoted(name)}, which stands twice")
        found[name] = element
    return found


def _link(joint: Element, end: str, links: dict[str, Element]) -> str:
    """Return the name of the parent or child of a joint."""
    element = joint.only(end)
    name = None if element is None else element.attributes.get("link")
    if name is None or name not in links:
        told = "is missing" if name is None else f"there is no link {quoted(name)}"
        refuse(joint if element is None else element, None if element is None else "link", f"{end}: {told}")
    return name


def _from_the_root(root: str, joints: dict[str, Element], links: dict[str, Element]) -> list[str]:
    """Return the names of all links that the root leads to, without it, each behind its parent and in the order of joints."""
    children: dict[str, list[str]] = {}
    for joint in joints.values():
        children.setdefault(_link(joint, "parent", links), []).append(_link(joint, "child", links))
    found = [root]
    for name in found:
        found += children.get(name, ())
    return found[1:]


def _type(joint: Element) -> str:
    kind = joint.attributes.get("type", "")
    if kind not in TYPES:
        refuse(joint, "type", f"read {quoted(kind)}; allowed: {', '.join(TYPES)}")
    if (mimic := joint.only("mimic")) is not None:
        refuse(mimic, None, "couples two joints, which a case cannot say")
    return TYPES[kind]


def _properties(joint: Element, kind: str) -> dict[str, Any]:
    """Return the axis, damping and friction of a joint as keys of its table."""
    axis, dynamics = joint.only("axis"), joint.only("dynamics")
    along = list((1.0, 0.0, 0.0) if axis is None else numbers(axis, "xyz", (3,), (1.0, 0.0, 0.0)))
    damping, friction = (0.0, 0.0) if dynamics is None else (number(dynamics, key, 0.0) for key in ("damping", "friction"))
    if kind in ("revolute", "prismatic"):
        return {"axis": along, "damping": damping, "friction": friction}
    if dynamics is not None and kind != "fixed" and (damping or friction):
        refuse(dynamics, None, f"a joint of the type {joint.attributes['type']} has no damping or friction in a case")
    if kind == "planar" and along != [0.0, 0.0, 1.0]:
        refuse(
            joint if axis is None else axis, None, "the axes x and y of such a plane are not defined; allowed: the axis 0 0 1"
        )
    return {}
