"""Make the links and joints of a URDF tables of a case file.

The root link is the world, as where engines load a URDF without a free joint. A link without mass that is fixed to another one
is a frame of that one. Limits, geometry, transmissions and what other programs add are no part of the mechanics of a case.
"""

from typing import Any

from bodycheck.casefile.robots import tables
from bodycheck.casefile.robots.link import without_rounding
from bodycheck.casefile.robots.tables import HERE, Pose, Tables
from bodycheck.casefile.robots.urdf import refuse_faults, refuse_macros
from bodycheck.reference.exact.inertia import MassProperties
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES
from bodycheck.robots import urdf
from bodycheck.robots.elements import Element, refuse
from bodycheck.robots.urdf_parts import JointPart, LinkPart

#: The types of joints of a case by those of a robot model.
TYPES = {form.robot: form.name for form in JOINT_TYPES.values() if form.robot is not None}


def tree(root: Element, world: str) -> Tables:
    """Return the bodies and joints of a URDF. world: the name of the world.

    Raises `BadInput` for what cannot be read exactly.
    """
    refuse_macros(root)
    for joint in root.all("joint"):
        if (mimic := joint.only("mimic")) is not None:
            refuse(mimic, None, "couples two joints, which a case cannot say")
    about = urdf.about_file(root)
    parts = urdf.parts(root, about)
    refuse_faults(about)
    assert parts is not None, "what is no tree has faults"
    holder = {joint.child: joint for joint in parts.joints}
    links = {link.name: link for link in parts.links}
    frames: dict[str, tuple[str, Pose]] = {parts.root: (world, HERE)}
    made: Tables = {"bodies": [], "joints": []}
    for name in urdf.below(parts.root, parts.joints):
        held = holder[name]
        parent, pose = frames[held.parent]
        pose = pose.then(Pose(held.origin, held.attitude))
        inertia = _inertia(links[name])
        if inertia is None:
            if held.type != "fixed":
                told = "has no mass and moves; only a link that is fixed to another one may have none"
                refuse(links[name].element, None, told)
            frames[name] = parent, pose
            continue
        frames[name] = name, HERE
        made["bodies"].append(tables.body(name, inertia))
        made["joints"].append(tables.joint(held.name, TYPES[held.type], parent, name, pose) | _properties(held))
    return made


def _inertia(link: LinkPart) -> MassProperties | None:
    """Return the mass properties of a link; None if it has no mass. Raises `BadInput` for a mass or inertia of no body."""
    inertial = link.element.only("inertial")
    if inertial is None:
        return None
    if not link.made.mass:
        if any(link.made.tensor):
            refuse(inertial, None, "a moment of inertia without mass, which no body has")
        return None
    if link.made.mass < 0:
        refuse(inertial.first("mass") or inertial, "value", f"read {float(link.made.mass)!r}; allowed: a positive number")
    return without_rounding(link.made)


def _properties(joint: JointPart) -> dict[str, Any]:
    """Return the axis, damping and friction of a joint as keys of its table."""
    element = joint.element
    along = tables.doubles(joint.axis)
    if joint.type in ("revolute", "prismatic"):
        return {"axis": along, "damping": joint.damping, "friction": joint.friction}
    if joint.type != "fixed" and (joint.damping or joint.friction):
        told = f"a joint of the type {joint.type} has no damping or friction in a case"
        refuse(element.first("dynamics") or element, None, told)
    if joint.type == "planar" and along != [0.0, 0.0, 1.0]:
        told = "the axes x and y of such a plane are not defined; allowed: the axis 0 0 1"
        refuse(element.first("axis") or element, None, told)
    return {}
