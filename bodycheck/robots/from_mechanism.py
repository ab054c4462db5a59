"""Convert a mechanism of a case file to a robot model.

The root of the model is a link without mass, which is the world. A body that is the child of no joint gets a floating joint on
the root. A joint of a type that robot models do not have, such as a universal joint, is written as a chain of joints for its
elementary motions, with massless links between them. These joints and links have the name of the joint and a number, as in
`cross:1`. A robot model has no initial states and no constant forces of joints.
"""

from collections.abc import Collection, Iterator
from dataclasses import replace

import numpy as np

from bodycheck.errors import BadInput
from bodycheck.reference.exact.numbers import Real, wide
from bodycheck.reference.exact.rotations import matrix
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.joint_types import ElementaryMotion, MotionKind
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism
from bodycheck.reference.robots.model import Mimic, RobotJoint, RobotJointType, RobotLink, RobotModel, Wide

#: The axes of the frame of a joint, by their names.
_AXES = dict(zip("xyz", np.eye(3, dtype=np.longdouble), strict=True))

#: The type of the joint of a robot model that makes an elementary motion.
ELEMENTARY: dict[MotionKind, RobotJointType] = {"turn": "revolute", "slide": "prismatic", "ball": "spherical"}


def robot_model(mechanism: Mechanism, name: str) -> RobotModel:
    """Return a mechanism as a robot model with a name. Raises `BadInput` if the mechanism has loops."""
    if mechanism.loops:
        raise BadInput(f"{name} has closed loops; a robot model is a tree")
    root = _unlike("world", {body.name for body in mechanism.bodies})
    links = [_still(root), *(_link(body) for body in mechanism.bodies)]
    joints: list[RobotJoint] = []
    for joint in mechanism.joints:
        joints += _joints(joint, links, _rule(joint, mechanism))
    names = {joint.name for joint in joints}
    for index, parent_joint in enumerate(mechanism.joint_of):
        if parent_joint is None:
            joint_name = _unlike(mechanism.bodies[index].name, names)
            joints.append(
                RobotJoint(
                    *(joint_name, "floating", 0, index + 1),
                    *(np.zeros(3, np.longdouble), np.eye(3, dtype=np.longdouble), np.zeros(3, np.longdouble)),
                )
            )
    return RobotModel(name, tuple(links), tuple(joints), (0.0, 0.0, -mechanism.gravity))


def _unlike(name: str, taken: Collection[str]) -> str:
    """Return a name that is not taken yet: the given name, followed by underscores if needed."""
    while name in taken:
        name += "_"
    return name


def _still(name: str) -> RobotLink:
    return RobotLink(name, 0.0, np.zeros(3, np.longdouble), np.zeros((3, 3), np.longdouble))


def _link(body: JointedBody) -> RobotLink:
    inertia = exact.inertia(body)
    xx, yy, zz, xy, xz, yz = _array(inertia.tensor)
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return RobotLink(body.name, float(inertia.mass), _array(inertia.centre), tensor)


def _rule(joint: Joint, mechanism: Mechanism) -> Mimic | None:
    """Return the rule by which a joint follows another one; None if it moves by itself."""
    rule = joint.mimic
    return None if rule is None else Mimic(mechanism.joints[rule.joint].name, rule.multiplier, rule.offset)


def _joints(joint: Joint, links: list[RobotLink], rule: Mimic | None) -> Iterator[RobotJoint]:
    """Return the joints of a robot model that make a joint; append the massless links between several joints to `links`."""
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
        mimic=rule,
    )
    if joint.form.robot is not None:
        last = joint.form.motions[-1] if joint.form.motions else None
        yield replace(whole, type=joint.form.robot, axis=_axis(joint, last))
        return
    for count, motion in enumerate(joint.form.motions, start=1):
        part = replace(whole, name=f"{joint.name}:{count}", type=ELEMENTARY[motion.kind], axis=_axis(joint, motion))
        if count > 1:
            part = replace(part, parent=len(links) - 1, position=0 * position, rotation=np.eye(3, dtype=np.longdouble))
        if count < len(joint.form.motions):
            links.append(_still(_unlike(part.name, {link.name for link in links})))
            part = replace(part, child=len(links) - 1)
        yield part


def _axis(joint: Joint, motion: ElementaryMotion | None) -> Wide:
    """Return the axis (3,) of an elementary motion in the frame of its joint; zero if it has no axis, as for a ball."""
    if motion is None or motion.kind == "ball":
        return np.zeros(3, np.longdouble)
    return _array(exact.unit_axis(joint)) if motion.axis == "given" else _AXES[motion.axis]


def _array(values: Collection[Real]) -> Wide:
    return np.array([wide(value) for value in values], np.longdouble)
