"""The pairing of an engine's joints, bodies and velocities with those of the file."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bodycheck.adapters.robot_reading import ReadJoint, RobotReading
from bodycheck.reference.robots.dynamics import velocity_labels
from bodycheck.reference.robots.fusing import fused
from bodycheck.reference.robots.model import RobotJoint, RobotModel
from bodycheck.reference.robots.state import VELOCITIES
from bodycheck.reference.trajectory import Array
from bodycheck.studies.parity.quantities import Quantity
from bodycheck.studies.parity.stacks import Label


@dataclass(frozen=True, eq=False)
class Match:
    """The pairing of an engine's reading with the model of the file.

    Attributes
    ----------
    model
        The model of the file, in which the joints that the engine does not have are fixed.
    bodies
        The same model with only the bodies that the engine keeps; the other bodies are joined to them.
    joints
        The engine's joints by their names in the file.
    lacking
        The joints that move in the file and that the engine does not have.
    otherwise
        The joints with a different number of velocities in the engine and in the file.
    extra
        The engine's joints that the file does not have, such as the joint of a base that the engine leaves free.
    labels
        The n velocities that are compared, in the order of the file. They do not include the velocities of joints that follow
        others without a separate velocity in the engine.
    columns
        The indices (n,) of these velocities among the velocities of the engine.
    expansion
        The matrix (m, n) that gives all m velocities of `model` from the compared velocities.
    """

    model: RobotModel
    bodies: RobotModel
    joints: Mapping[str, ReadJoint]
    lacking: tuple[str, ...]
    otherwise: tuple[str, ...]
    extra: tuple[ReadJoint, ...]
    labels: tuple[Label, ...]
    columns: NDArray[np.intp]
    expansion: Array

    @property
    def reduced(self) -> bool:
        """True if joints that follow others have no separate velocities in the engine."""
        return bool(self.expansion.shape[0] != self.expansion.shape[1])

    def numbers(self, quantity: Quantity) -> Array:
        """Return the file's values of a quantity, such as damping, for the joints of the compared velocities (n,)."""
        joints = {joint.name: joint for joint in self.model.joints}
        return np.array([float(getattr(joints[name], quantity)) for name, _ in self.labels])


def match(model: RobotModel, reading: RobotReading) -> Match:
    """Return the pairing of an engine's reading with the model of a file."""
    named = {joint.name: joint for joint in reading.joints}
    by_child = {joint.child: joint for joint in reading.joints}
    moving = [joint for joint in model.joints if VELOCITIES[joint.type]]
    children = {joint.name: model.links[joint.child].name for joint in moving}
    known = {joint.name for joint in moving}
    joints = {name: joint for name in children if (joint := named.get(name)) is not None}
    for name, child in children.items():  # an engine may rename joints
        other = by_child.get(child)
        if name not in joints and other is not None and other.name not in known:
            joints[name] = other
    joints = {name: joint_read for name, joint_read in joints.items() if joint_read.count or joint_read.mimic is not None}
    lacking = tuple(name for name in children if name not in joints)
    fixed = replace(model, joints=tuple(_fixed(joint) if joint.name in lacking else joint for joint in model.joints))
    used = {id(joint) for joint in joints.values()}
    counts = {joint.name: VELOCITIES[joint.type] for joint in moving}
    follows = {name for name, joint_read in joints.items() if not joint_read.count}
    otherwise = tuple(name for name, joint_read in joints.items() if name not in follows and joint_read.count != counts[name])
    full = velocity_labels(fixed)
    labels = tuple(label for label in full if label[0] not in follows and label[0] not in otherwise)
    columns = np.array([joints[name].first + component for name, component in labels], np.intp)
    kept = {body.name for body in reading.bodies}
    return Match(
        *(fixed, fused(fixed, kept), joints, lacking, otherwise),
        tuple(joint for joint in reading.joints if id(joint) not in used and joint.count),
        *(labels, columns, _expansion(fixed, full, labels)),
    )


def _fixed(joint: RobotJoint) -> RobotJoint:
    return RobotJoint(
        joint.name, "fixed", joint.parent, joint.child, joint.position, joint.rotation, np.zeros(3, np.longdouble)
    )


def _expansion(model: RobotModel, full: tuple[Label, ...], labels: tuple[Label, ...]) -> Array:
    """Return the matrix (m, n) that gives all velocities from the compared ones; followers have multiples of their leaders'."""
    matrix = np.zeros((len(full), len(labels)))
    joints = {joint.name: joint for joint in model.joints}
    for row, (name, component) in enumerate(full):
        factor, passed = 1.0, {name}
        while (name, component) not in labels and (mimic := joints[name].mimic) is not None and mimic.joint not in passed:
            name, factor = mimic.joint, factor * mimic.multiplier
            passed.add(name)
        if (name, component) in labels:
            matrix[row, labels.index((name, component))] = factor
    return matrix
