"""Write a robot model as an MJCF file.

A link becomes a body inside the body of its parent, placed at the frame of its joint. A massless root gets no body if its name
is `world`, as for MuJoCo's world, or if all its children are on free joints. Joints become:

- revolute, prismatic, spherical: a hinge, a slide, a ball.
- floating: a free joint if the parent is the root and the frame of the joint is the frame of the root. MuJoCo has free joints
  on the world only, with velocities along the axes of the world, so the body then stands beside the body of the root. Any other
  floating joint becomes three slides and a ball, whose velocities are the velocities of the model.
- planar: two slides along the axes of the plane, and a hinge about its normal.

If a joint becomes several MuJoCo joints, they have its name and a number, as in `hip:1`. Velocity limits are left out, because
MJCF has none.
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
    """Return whether the root is the world: a massless link that is named `world` or has only free joints on it."""
    root, carried = model.links[model.root], [joint for joint in model.joints if joint.parent == model.root]
    free = bool(carried) and all(is_free(model, joint) for joint in carried)
    return not root.mass and not root.inertia.any() and (root.name == "world" or free)


def _add_body(parent: Element, link: RobotLink, pose: Mapping[str, str]) -> Element:
    """Add the body of a link, with its inertia, and return it. pose: its pose in the frame of its parent."""
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
    """Add the MuJoCo joints that make a joint to the body of its child."""
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
    """Return the kinds and axes of the MuJoCo joints that make a joint."""
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
