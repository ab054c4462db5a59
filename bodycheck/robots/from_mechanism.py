"""A mechanism of a case file as a robot model.

The root of the model is a link without mass, which is the world. A body that is the child of no joint floats on it. A universal
joint is two revolute joints with a link without mass between them, about x of the joint's frame and the turned y; they have the
name of the joint and a number, as in `cross:1`. Initial states and constant forces of joints are no part of a robot model.
"""

from collections.abc import Collection, Iterator
from dataclasses import replace

import numpy as np

from bodycheck.errors import BadInput
from bodycheck.reference.exact.numbers import Real, wide
from bodycheck.reference.exact.rotations import matrix
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism
from bodycheck.reference.robots.model import RobotJoint, RobotLink, RobotModel, Wide

#: The axes of the frame of a joint.
_X, _Y, _Z = np.eye(3, dtype=np.longdouble)


def robot_model(mechanism: Mechanism, name: str) -> RobotModel:
    """Return a mechanism as a robot model of a name. Raises `BadInput` if the mechanism has loops, which no tree has."""
    if mechanism.loops:
        raise BadInput(f"{name} has closed loops; a robot model is a tree")
    root = _unlike("world", {body.name for body in mechanism.bodies})
    links = [_still(root), *(_link(body) for body in mechanism.bodies)]
    joints: list[RobotJoint] = []
    for joint in mechanism.joints:
        joints += _joints(joint, links)
    names = {joint.name for joint in joints}
    for place, held in enumerate(mechanism.joint_of):
        if held is None:
            own = _unlike(mechanism.bodies[place].name, names)
            joints.append(
                RobotJoint(own, "floating", 0, place + 1, np.zeros(3, np.longdouble), np.eye(3, dtype=np.longdouble), 0 * _Z)
            )
    return RobotModel(name, tuple(links), tuple(joints), (0.0, 0.0, -mechanism.gravity))


def _unlike(name: str, taken: Collection[str]) -> str:
    """Return a name that is not taken yet: this one, or with underscores."""
    while name in taken:
        name += "_"
    return name


def _still(name: str) -> RobotLink:
    return RobotLink(name, 0.0, np.zeros(3, np.longdouble), np.zeros((3, 3), np.longdouble))


def _link(body: JointedBody) -> RobotLink:
    made = exact.inertia(body)
    xx, yy, zz, xy, xz, yz = _array(made.tensor)
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return RobotLink(body.name, float(made.mass), _array(made.centre), tensor)


def _joints(joint: Joint, links: list[RobotLink]) -> Iterator[RobotJoint]:
    """The joints of a robot model that a joint is. The link between those of a universal joint is added to the links."""
    rotation = np.stack([_array(row) for row in matrix(exact.turn(joint.attitude))])
    position = np.array(joint.position, np.longdouble)
    whole = RobotJoint(
        *(joint.name, "fixed", 0 if joint.parent == WORLD else joint.parent + 1, joint.child + 1),
        *(position, rotation, np.zeros(3, np.longdouble)),
        armature=joint.armature,
        damping=joint.damping,
        friction=joint.friction,
        stiffness=joint.stiffness,
        rest=joint.rest,
    )
    match joint.type:
        case "universal":
            links.append(_still(_unlike(f"{joint.name}:1", {link.name for link in links})))
            between = len(links) - 1
            yield replace(whole, name=f"{joint.name}:1", type="revolute", child=between, axis=_X)
            second = replace(whole, name=f"{joint.name}:2", type="revolute", parent=between, axis=_Y)
            yield replace(second, position=0 * position, rotation=np.eye(3, dtype=np.longdouble))
        case "free":
            yield replace(whole, type="floating")
        case "planar":
            yield replace(whole, type="planar", axis=_Z)
        case "revolute" | "prismatic":
            yield replace(whole, type=joint.type, axis=_array(exact.unit_axis(joint)))
        case _:
            yield replace(whole, type=joint.type)


def _array(values: Collection[Real]) -> Wide:
    return np.array([wide(value) for value in values], np.longdouble)
