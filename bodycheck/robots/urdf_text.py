"""Write a robot model as a URDF.

A URDF can state the damping and dry friction of a joint, but not an armature or a spring. It has no ball joints and no gravity.
A revolute joint without position limits is `continuous`. A prismatic joint must have a `<limit>`, and each `<limit>` must state
the largest effort and velocity; a quantity that the model does not limit is written as `UNLIMITED`.
"""

from collections.abc import Mapping
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from bodycheck.errors import BadInput
from bodycheck.reference.robots.model import RobotJoint, RobotLink, RobotModel, Wide
from bodycheck.robots.written import UNLIMITED, limits, number, numbers


def urdf(model: RobotModel, inertial_axes: Mapping[str, Wide] | None = None) -> str:
    """Return the text of a URDF of a robot model, with all digits of its numbers.

    Parameters
    ----------
    model
        The model.
    inertial_axes
        By the names of links, the rotation (3, 3) from the axes along which the inertia is written to the axes of the link's
        frame. The inertia of other links is written along the axes of their frame.

    Raises
    ------
    BadInput
        If a joint has an armature or a spring, or is a ball, which a URDF cannot state.
    """
    root = Element("robot", name=model.name)
    axes = inertial_axes or {}
    for link in model.links:
        _add_link(root, link, axes.get(link.name))
    for joint in model.joints:
        _add_joint(root, joint, model)
    ElementTree.indent(root)
    return f'<?xml version="1.0"?>\n{ElementTree.tostring(root, encoding="unicode")}\n'


def roll_pitch_yaw(rotation: Wide) -> Wide:
    """Return the angles (3,) in rad about the fixed axes x, y and z, in this order, that make a rotation (3, 3).

    At a pitch of a quarter turn, only the sum or the difference of roll and yaw is determined. The roll is computed from the
    yaw, so that the angles make the exact rotation there too.
    """
    (a, b, c), (d, e, f), (g, _, _) = rotation
    yaw = np.arctan2(d, a)
    cosine, sine = np.cos(yaw), np.sin(yaw)
    pitch = np.arctan2(-g, cosine * a + sine * d)
    roll = np.arctan2(sine * c - cosine * f, cosine * e - sine * b)
    return np.array([roll, pitch, yaw])


def _add_link(root: Element, link: RobotLink, axes: Wide | None) -> None:
    element = SubElement(root, "link", name=link.name)
    if link.mass == 0 and not link.inertia.any():
        return
    rotation = np.eye(3, dtype=np.longdouble) if axes is None else axes
    tensor = link.inertia if axes is None else rotation.T @ link.inertia @ rotation
    inertial = SubElement(element, "inertial")
    SubElement(inertial, "origin", xyz=numbers(link.center_of_mass), rpy=numbers(roll_pitch_yaw(rotation)))
    SubElement(inertial, "mass", value=number(link.mass))
    components = {f"i{'xyz'[i]}{'xyz'[j]}": number(tensor[i, j]) for i in range(3) for j in range(i, 3)}
    SubElement(inertial, "inertia", components)


def _add_joint(root: Element, joint: RobotJoint, model: RobotModel) -> None:
    for what, stands in (("armature", joint.armature), ("a spring", joint.stiffness), ("a ball", joint.type == "spherical")):
        if stands:
            raise BadInput(f"a URDF cannot say that the joint {joint.name!r} has or is {what}; an MJCF file can")
    endless = joint.type == "revolute" and joint.lower is None and joint.upper is None
    element = SubElement(root, "joint", name=joint.name, type="continuous" if endless else joint.type)
    SubElement(element, "parent", link=model.links[joint.parent].name)
    SubElement(element, "child", link=model.links[joint.child].name)
    SubElement(element, "origin", xyz=numbers(joint.position), rpy=numbers(roll_pitch_yaw(joint.rotation)))
    if joint.type in ("revolute", "prismatic", "planar"):
        SubElement(element, "axis", xyz=numbers(joint.axis))
    if limited := _limits(joint, endless):
        SubElement(element, "limit", limited)
    if joint.damping or joint.friction:
        SubElement(element, "dynamics", damping=number(joint.damping), friction=number(joint.friction))
    if (mimic := joint.mimic) is not None:
        factors = {"multiplier": number(mimic.multiplier), "offset": number(mimic.offset)}
        SubElement(element, "mimic", {"joint": mimic.joint, **factors})


def _limits(joint: RobotJoint, endless: bool) -> dict[str, str]:
    """Return the attributes of the `<limit>` of a joint; empty if it needs no limit."""
    largest_values = (joint.effort_limit, joint.velocity_limit)
    if joint.type not in ("revolute", "prismatic") or (endless and largest_values == (None, None)):
        return {}
    largest = dict(zip(("effort", "velocity"), largest_values, strict=True))
    of_position = {} if endless else dict(zip(("lower", "upper"), map(number, limits(joint)), strict=True))
    return of_position | {key: number(UNLIMITED if value is None else value) for key, value in largest.items()}
