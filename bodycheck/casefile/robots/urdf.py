"""Read a URDF for a case: one link with the shape of its <collision>, or all links and joints as tables.

In the tables, the root link is the world, as in engines that load a URDF without a free joint. A massless link that is fixed to
another link is only a frame of that link. Limits, geometry, transmissions and additions for other programs are ignored, because
they are no part of the mechanics of a case.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from bodycheck.casefile.robots import tables
from bodycheck.casefile.robots.link import Link, about_centre, chosen, left_out, without_rounding
from bodycheck.casefile.robots.numbers import numbers, positive
from bodycheck.casefile.robots.tables import HERE, Pose, Tables
from bodycheck.errors import BadInput
from bodycheck.reference.exact.inertia import MassProperties
from bodycheck.reference.exact.numbers import MP, Vector3
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES
from bodycheck.reference.robots.physical import rounding
from bodycheck.reference.scene import Brick, Cylinder, Shape, Sphere
from bodycheck.robots import urdf_parts
from bodycheck.robots.attributes import attitude, position
from bodycheck.robots.elements import Element, place, refuse
from bodycheck.robots.faults import About
from bodycheck.robots.urdf import MACRO, about_file, below, macros, parts, rounded
from bodycheck.robots.urdf_parts import JointPart, LinkPart


def link(root: Element, name: str | None) -> Link:
    """Return a link of a URDF; the only link if the name is None.

    The tensor of <inertia> is about the centre of mass, along the axes of the <origin> of <inertial>. Raises `BadInput` if the
    link cannot be read exactly.
    """
    refuse_macros(root)
    links = list(root.all("link"))
    link_element = chosen(root, links, name, "link")
    inertial = link_element.only("inertial")
    if inertial is None:
        refuse(link_element, None, "has no <inertial>: a link without mass is no body that can move by itself")
    about = about_file(root)
    stated, origin = urdf_parts.mass_properties(about, link_element), inertial.first("origin")
    refuse_faults(about)
    mass_properties = without_rounding(stated)
    if mass_properties.mass <= 0:
        refuse(inertial.first("mass") or inertial, "value", f"read {float(mass_properties.mass)!r}; allowed: a positive number")
    shape, shape_from = _shape(about, link_element, mass_properties.centre)
    turned = " turned by its rpy" if origin is not None and "rpy" in origin.attributes else ""
    refuse_faults(about)
    return Link(
        link_element.attributes.get("name", ""),
        mass_properties,
        f"{place(inertial)}{turned}",
        shape,
        shape_from,
        left_out(len(links) - 1),
    )


def refuse_macros(root: Element) -> None:
    """Raise `BadInput` if a file has macros of xacro."""
    for element in macros(root):
        refuse(element, None, MACRO)


def refuse_faults(about: About) -> None:
    """Raise `BadInput` for the first fault of a file, but not for faults of limits, which a case leaves out."""
    for fault in about.faults:
        if fault.quantity != "effort_limit":
            raise BadInput(fault.text)


def _shape(about: About, link_element: Element, centre: Vector3) -> tuple[Shape | None, str]:
    """Return the shape of a link and its place in the file; None and the reason if there is none."""
    collisions = list(link_element.all("collision"))
    if len(collisions) != 1:
        return None, f"the link has {len(collisions) or 'no'} <collision>; a body has one shape"
    geometry, origin = collisions[0].only("geometry"), collisions[0].only("origin")
    solids = [] if geometry is None else geometry.children
    if len(solids) != 1 or solids[0].tag not in ("box", "cylinder", "sphere"):
        return None, f"{place(collisions[0])} is no box, cylinder or sphere"
    shape: Shape
    match solids[0].tag:
        case "box":
            x, y, z = numbers(solids[0], "size", (3,))
            if min(x, y, z) <= 0:
                refuse(solids[0], "size", f"read {x!r} {y!r} {z!r}; allowed: positive lengths")
            shape = Brick((x / 2, y / 2, z / 2))
        case "cylinder":
            shape = Cylinder(positive(solids[0], "radius"), positive(solids[0], "length") / 2)
        case _:
            shape = Sphere(positive(solids[0], "radius"))
    if not about_centre(centre, shape, position(about, "pose", origin), attitude(about, "pose", origin)):
        return None, f"{place(solids[0])} is not about the centre of mass and along the axes of the link"
    return shape, place(solids[0])


#: The types of joints of a case, by the types of a robot model.
TYPES = {form.robot: form.name for form in JOINT_TYPES.values() if form.robot is not None}


def tree(root: Element, world: str) -> Tables:
    """Return the bodies and joints of a URDF. world: the name of the world.

    Raises `BadInput` for what cannot be read exactly.
    """
    refuse_macros(root)
    for joint in root.all("joint"):
        if (mimic := joint.only("mimic")) is not None:
            refuse(mimic, None, "couples two joints, which a case cannot say")
    about = about_file(root)
    read = parts(root, about)
    refuse_faults(about)
    assert read is not None, "what is no tree has faults"
    holder = {joint.child: joint for joint in read.joints}
    links = {link.name: link for link in read.links}
    frames: dict[str, tuple[str, Pose]] = {read.root: (world, HERE)}
    bodies_and_joints: Tables = {"bodies": [], "joints": []}
    for name in below(read.root, read.joints):
        part = holder[name]
        parent, pose = frames[part.parent]
        pose = pose.then(Pose(part.origin, part.attitude))
        inertia = _inertia(links[name], [joint.origin for joint in read.joints if joint.parent == name])
        if inertia is None:
            if part.type != "fixed":
                reason = "has no mass and moves; only a link that is fixed to another one may have none"
                refuse(links[name].element, None, reason)
            frames[name] = parent, pose
            continue
        frames[name] = name, HERE
        bodies_and_joints["bodies"].append(tables.body(name, inertia))
        bodies_and_joints["joints"].append(tables.joint(part.name, TYPES[part.type], parent, name, pose) | _properties(part))
    return bodies_and_joints


def _inertia(link: LinkPart, joints: Sequence[Vector3]) -> MassProperties | None:
    """Return the mass properties of a link; None if it has no mass. Raises `BadInput` for an impossible mass or inertia.

    Moments that are no larger than what rounding leaves of zero are zero. joints: the positions of the joints on the link (m).
    """
    inertial = link.element.only("inertial")
    if inertial is None:
        return None
    if not link.mass_properties.mass:
        if any(link.mass_properties.tensor):
            refuse(inertial, None, "a moment of inertia without mass, which no body has")
        return None
    if link.mass_properties.mass < 0:
        refuse(
            inertial.first("mass") or inertial,
            "value",
            f"read {float(link.mass_properties.mass)!r}; allowed: a positive number",
        )
    mass_properties = without_rounding(link.mass_properties)
    mass, centre = float(mass_properties.mass), rounded(mass_properties.centre)
    if max(map(abs, mass_properties.tensor)) <= rounding(mass, centre, map(rounded, joints)):
        return replace(mass_properties, tensor=(MP.mpf(0),) * 6)
    return mass_properties


def _properties(joint: JointPart) -> dict[str, Any]:
    """Return the axis, damping and friction of a joint as keys of its table."""
    element = joint.element
    along = tables.doubles(joint.axis)
    if joint.type in ("revolute", "prismatic"):
        return {"axis": along, "damping": joint.damping, "friction": joint.friction}
    if joint.type != "fixed" and (joint.damping or joint.friction):
        reason = f"a joint of the type {joint.type} has no damping or friction in a case"
        refuse(element.first("dynamics") or element, None, reason)
    if joint.type == "planar" and along != [0.0, 0.0, 1.0]:
        reason = "the axes x and y of such a plane are not defined; allowed: the axis 0 0 1"
        refuse(element.first("axis") or element, None, reason)
    return {}
