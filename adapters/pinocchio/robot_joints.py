"""The joints of Pinocchio's model in the terms of robot models, and their states in Pinocchio's coordinates.

The coordinates of a joint that URDF calls continuous are the cosine and the sine of its angle; a planar joint has the same
coordinates of its angle. Quaternions are x, y, z, w. The linear velocity of free-flyer and planar joints is along the rotating
axes of the child, so that its derivative has a term with the angular velocity.

The position of the free joint of a body in MJCF is in the world frame, and only Pinocchio's reference configuration `qpos0`
contains the pose of the body in the file. Several joints of one body in MJCF are one composite joint, whose parts have no names
in Pinocchio. Their names are read from the file.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin

from bodycheck.adapters.robot_numbers import values_of
from bodycheck.adapters.robot_reading import RobotFile
from bodycheck.reference.kinematics import conjugate, multiply, rotate
from bodycheck.reference.robots.state import COORDINATES, RobotState
from bodycheck.reference.trajectory import Array

#: The types of robot models, keyed by the beginnings of the names of Pinocchio's joints.
TYPES = {
    "JointModelR": "revolute",
    "JointModelP": "prismatic",
    "JointModelPlanar": "planar",
    "JointModelFreeFlyer": "floating",
    "JointModelSpherical": "spherical",
}


@dataclass(frozen=True)
class Joint:
    """A joint, or a part of a composite one.

    Attributes
    ----------
    name, type
        The name, and the type: a type of robot models, or Pinocchio's name of a type that robot models do not have.
    index
        The index in the model of the joint, or of the composite joint that it is a part of.
    position, coordinates
        The index of its first coordinate, and the number of its coordinates.
    first, count
        The index of its first velocity, and the number of its velocities.
    frame
        The joint's frame as origin and quaternion w, x, y, z, if Pinocchio's coordinates are in the world frame; else empty.
    """

    name: str
    type: str
    index: int
    position: int
    coordinates: int
    first: int
    count: int
    frame: tuple[float, ...] = ()


def joints_of(model: pin.Model, file: RobotFile) -> list[Joint]:
    """Return the joints of the model of a file, in Pinocchio's order."""
    joints = []
    for index in range(1, model.njoints):
        joint, name = model.joints[index], str(model.names[index])
        if joint.shortname() == "JointModelComposite":
            names = names_of_parts(file, name)
            joints += [_joint(part, part_name, index) for part, part_name in zip(joint.extract().joints, names, strict=True)]
        else:
            joints.append(replace(_joint(joint, name, index), frame=frame_of(model, file, index)))
    return joints


def frame_of(model: pin.Model, file: RobotFile, index: int) -> tuple[float, ...]:
    """Return the frame of a free joint in an MJCF, whose coordinates in Pinocchio are in the world frame; else empty."""
    joint, configurations = model.joints[index], model.referenceConfigurations
    if file.format == "urdf" or joint.nq != COORDINATES["floating"] or "qpos0" not in configurations:
        return ()
    x, y, z, i, j, k, w = np.array(configurations["qpos0"])[joint.idx_q : joint.idx_q + joint.nq].tolist()
    return x, y, z, w, i, j, k


def _joint(joint: pin.JointModel, name: str, index: int) -> Joint:
    return Joint(name, word(joint.shortname()), index, joint.idx_q, joint.nq, joint.idx_v, joint.nv)


def word(kind: str) -> str:
    """Return the type of robot models for a type of Pinocchio, or Pinocchio's name if robot models do not have the type."""
    starts = [start for start in TYPES if kind.startswith(start)]
    return TYPES[max(starts, key=len)] if starts else kind


def names_of_parts(file: RobotFile, composite: str) -> list[str]:
    """Return the names of the parts of a composite joint in a file.

    The name of the composite joint, `composite`, consists of `Composite_` and the name of the first part.
    """
    first = composite.removeprefix("Composite_")
    for body in ElementTree.parse(file.path).getroot().iter("body"):
        names = [joint.get("name", "") for joint in body.findall("joint")]
        if names and names[0] == first:
            return names
    return []


@dataclass(frozen=True, eq=False)
class Coordinates:
    """A state in Pinocchio's coordinates: configuration (nq,), velocity, acceleration and efforts (nv,)."""

    q: Array
    v: Array
    a: Array
    tau: Array


def coordinates(model: pin.Model, joints: Sequence[Joint], state: RobotState) -> Coordinates:
    """Return a state in Pinocchio's coordinates; joints that the state does not have stay in the neutral configuration."""
    in_engine = Coordinates(np.array(pin.neutral(model)), *(np.zeros(model.nv) for _ in range(3)))
    parts = state.velocities, state.accelerations, state.efforts
    for joint in joints:
        if joint.count == joint.coordinates == 1:  # a short path for most joints, because there are many
            places = joint.position, joint.first, joint.first, joint.first
            for part, index, values in zip(
                (in_engine.q, in_engine.v, in_engine.a, in_engine.tau), places, (state.positions, *parts), strict=True
            ):
                if len(numbers := values.get(joint.name, ())) == 1:
                    part[index] = numbers[0]
            continue
        of_joint = slice(joint.first, joint.first + joint.count)
        values_of_joint = [values_of(part, joint.name, joint.count) for part in parts]
        velocity, acceleration, effort = (np.zeros(joint.count) if value is None else value for value in values_of_joint)
        count = next((count for type, count in COORDINATES.items() if type == joint.type), joint.coordinates)
        if (position := values_of(state.positions, joint.name, count)) is not None:
            in_engine.q[joint.position : joint.position + joint.coordinates] = configuration(joint, position)
            if joint.type in ("floating", "planar"):
                velocity, acceleration, effort = in_child(joint.type, position, velocity, acceleration, effort)
        in_engine.v[of_joint], in_engine.a[of_joint], in_engine.tau[of_joint] = velocity, acceleration, effort
    return in_engine


def configuration(joint: Joint, position: Array) -> Array:
    """Return the position of a joint in Pinocchio's coordinates, from its position in the coordinates of robot models."""
    match joint.type:
        case "floating":
            origin, turn = position[:3], position[3:]
            if joint.frame:
                frame = np.array(joint.frame)
                origin, turn = frame[:3] + rotate(frame[3:], origin), multiply(frame[3:], turn)
            return np.concatenate([origin, turn[1:], turn[:1]])
        case "spherical":
            return np.concatenate([position[1:], position[:1]])
        case "planar":
            return np.array([*position[:2], np.cos(position[2]), np.sin(position[2])])
        case _:
            return position if joint.coordinates == 1 else np.array([np.cos(position[0]), np.sin(position[0])])


def in_child(type: str, position: Array, velocity: Array, acceleration: Array, effort: Array) -> tuple[Array, Array, Array]:
    """Return velocity, acceleration and effort of a floating or planar joint along the axes of its child."""
    if type == "floating":
        linear, angular, back = slice(0, 3), slice(3, 6), conjugate(position[3:])
        spin = velocity[angular]
    else:
        linear, angular, half = slice(0, 2), slice(2, 3), -position[2] / 2
        back, spin = np.array([np.cos(half), 0.0, 0.0, np.sin(half)]), np.array([0.0, 0.0, velocity[2]])
    turned = [
        rotate(back, np.append(part[linear], [0.0] * (3 - len(part[linear])))) for part in (velocity, acceleration, effort)
    ]
    # The derivative of a vector's components along rotating axes has this additional term.
    turned[1] = turned[1] - np.cross(spin, turned[0])
    size = linear.stop
    pairs = zip(turned, (velocity, acceleration, effort), strict=True)
    moved = [np.concatenate([vector[:size], part[angular]]) for vector, part in pairs]
    return moved[0], moved[1], moved[2]
