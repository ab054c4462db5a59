"""Write a robot model as an MJCF file.

A link is a body, in the body of its parent, with the joint's frame as its place. A root without mass has no body where its name
is `world`, which MuJoCo's world has, or where all that it carries is free. The joints are:

- revolute, prismatic, spherical: a hinge, a slide, a ball.
- floating: a free joint where the parent is the root and the joint's frame is the root's. MuJoCo has free joints on the world
  alone, with velocities along the world's axes, so that the body is then beside that of the root. Any other floating joint is
  three slides and a ball, whose velocities are those of the model.
- planar: two slides along the axes of the plane, and a hinge about its normal.

The parts of a joint have its name and a number, as in `hip:1`. MJCF has no limits of velocity, which are left out.
"""

from collections.abc import Mapping
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from bodycheck.reference.robots.model import RobotJoint, RobotLink, RobotModel, from_the_root
from bodycheck.reference.robots.rotations import plane_axes, quaternion
from bodycheck.robots.written import limits, number, numbers

_X, _Y, _Z = np.eye(3)


def mjcf(model: RobotModel) -> str:
    """Return the text of an MJCF file of a robot model, with all digits of its numbers. Raises `ValueError` as `order` does."""
    root = Element("mujoco", model=model.name)
    # Nothing else differs from MuJoCo's defaults. With inertiafromgeom="false" Pinocchio refuses a body without inertia.
    SubElement(root, "compiler", angle="radian")
    SubElement(root, "option", gravity=numbers(model.gravity))
    world = SubElement(root, "worldbody")
    elements = {model.root: world if _is_world(model) else _add_body(world, model.links[model.root], {})}
    for joint in from_the_root(model):
        free = is_free(model, joint)
        pose = {"pos": numbers(joint.position), "quat": numbers(quaternion(joint.rotation))}
        body = _add_body(world if free else elements[joint.parent], model.links[joint.child], pose)
        elements[joint.child] = body
        _add_joints(body, joint, free)
    _add_mimicry(root, model)
    ElementTree.indent(root)
    return f"{ElementTree.tostring(root, encoding='unicode')}\n"


def is_free(model: RobotModel, joint: RobotJoint) -> bool:
    """Return whether a joint can be a free joint of MuJoCo with the same coordinates and velocities."""
    unturned = np.array_equal(joint.rotation, np.eye(3)) and not joint.position.any()
    return joint.type == "floating" and joint.parent == model.root and unturned


def _is_world(model: RobotModel) -> bool:
    """Return whether the root is the world: it has no mass, and has that name or carries bodies with free joints alone."""
    root, carried = model.links[model.root], [joint for joint in model.joints if joint.parent == model.root]
    free = bool(carried) and all(is_free(model, joint) for joint in carried)
    return not root.mass and not root.inertia.any() and (root.name == "world" or free)


def _add_body(parent: Element, link: RobotLink, pose: Mapping[str, str]) -> Element:
    """Add the body of a link, with its inertia, and return it. pose: its pose in that of its parent."""
    body = SubElement(parent, "body", {"name": link.name, **pose})
    if link.mass or link.inertia.any():
        attributes = {"pos": numbers(link.center_of_mass), "mass": number(link.mass)}
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = link.inertia
        if xy or xz or yz:
            attributes["fullinertia"] = numbers((xx, yy, zz, xy, xz, yz))
        else:
            attributes["diaginertia"] = numbers((xx, yy, zz))
        SubElement(body, "inertial", attributes)
    return body


def _add_joints(body: Element, joint: RobotJoint, free: bool) -> None:
    """Add MuJoCo's joints of a joint to the body of its child."""
    numbers_of_joint = {
        "armature": joint.armature,
        "damping": joint.damping,
        "stiffness": joint.stiffness,
        "springref": joint.rest,
        "frictionloss": joint.friction,
    }
    written = {key: number(value) for key, value in numbers_of_joint.items() if value}
    if joint.type in ("revolute", "prismatic"):
        if (joint.lower, joint.upper) != (None, None):
            written["range"] = numbers(limits(joint))
        if joint.effort_limit is not None:
            written["actuatorfrcrange"] = numbers((-joint.effort_limit, joint.effort_limit))
    parts = [("free", None)] if free else _parts(joint)
    for count, (kind, axis) in enumerate(parts, start=1):
        along = {} if axis is None else {"axis": numbers(axis)}
        name = joint.name if len(parts) == 1 else f"{joint.name}:{count}"
        SubElement(body, "joint", {"name": name, "type": kind, **along, **written})


def _parts(joint: RobotJoint) -> list[tuple[str, np.ndarray | None]]:
    """The kinds and axes of MuJoCo's joints of a joint."""
    match joint.type:
        case "revolute":
            return [("hinge", joint.axis)]
        case "prismatic":
            return [("slide", joint.axis)]
        case "spherical":
            return [("ball", None)]
        case "planar":
            x, y, normal = plane_axes(joint.axis).T
            return [("slide", x), ("slide", y), ("hinge", normal)]
        case "floating":
            return [("slide", _X), ("slide", _Y), ("slide", _Z), ("ball", None)]
        case "fixed":
            return []


def _add_mimicry(root: Element, model: RobotModel) -> None:
    """Add an equality for each joint that follows another one."""
    following = [(joint, joint.mimic) for joint in model.joints if joint.mimic is not None]
    if not following:
        return
    equality = SubElement(root, "equality")
    for joint, mimic in following:
        along = numbers((mimic.offset, mimic.multiplier, 0, 0, 0))
        SubElement(equality, "joint", joint1=joint.name, joint2=mimic.joint, polycoef=along)
