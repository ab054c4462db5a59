"""Robot models in Pinocchio, which reads URDF and MJCF.

A body consists of the link that a joint moves and all links that are welded to this link. Its inertia is the inertia of
Pinocchio's joint, in the frame of the link that the joint moves. Pinocchio keeps the frames of all other links, which have
poses and Jacobians too.

Pinocchio's dynamics have neither damping nor dry friction nor springs: Pinocchio keeps the damping and the friction of a file,
and leaves their forces to its users. By default, mimic joints move independently.
"""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np
import pinocchio as pin

from bodycheck.adapters.pinocchio.robot_joints import Coordinates, Joint, coordinates, joints_of
from bodycheck.adapters.quiet import overheard, refusal
from bodycheck.adapters.robot_numbers import components, finite, vector
from bodycheck.adapters.robot_reading import FormatUnknown, ModelRefused, ReadBody, ReadJoint, RobotFile, RobotReading
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.robots.terms import Terms
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array


def read_robot(file: RobotFile, states: Sequence[RobotState], gravity: Vector) -> RobotReading:
    """Return how Pinocchio reads a file, as `RobotModels.read_robot` does. Raises `ModelRefused`, `FormatUnknown`."""
    model = loaded(file)
    joints, standard, frames = joints_of(model, file), vector(model.gravity.linear), links(model)
    carrier = carried(model, frames)
    return RobotReading(
        bodies=bodies(model, carrier),
        joints=read_joints(model, carrier, joints),
        links=tuple(str(frame.name) for frame in frames.values()),
        velocities=int(model.nv),
        gravity=standard,
        terms=terms_of(model, {index: str(frame.name) for index, frame in frames.items()}, joints, states, gravity),
        notes=notes(file, joints),
    )


def loaded(file: RobotFile) -> pin.Model:
    """Return Pinocchio's model of a file. Raises `ModelRefused`, and `FormatUnknown` if the release has no reader of MJCF."""
    if file.format == "mjcf" and not hasattr(pin, "buildModelFromMJCF"):
        raise FormatUnknown(f"pinocchio {pin.__version__} has no reader of MJCF")
    read = pin.buildModelFromUrdf if file.format == "urdf" else pin.buildModelFromMJCF
    try:
        with overheard() as said:
            return read(file.path)
    except (ValueError, RuntimeError, IndexError, KeyError) as error:
        reasons = [line.strip() for line in said if line.startswith("Error")]
        raise ModelRefused(refusal(file.path, " ".join([str(error), *reasons]))) from error


def links(model: pin.Model) -> dict[int, pin.Frame]:
    """Return the frames of links, keyed by their indices, in Pinocchio's order."""
    return {index: frame for index, frame in enumerate(model.frames) if frame.type == pin.FrameType.BODY}


def bodies(model: pin.Model, carrier: Mapping[int, pin.Frame]) -> tuple[ReadBody, ...]:
    """Return the bodies: first the body that does not move, then the bodies that joints move.

    `carrier` has the frames of the links that joints move, as `carried` returns them.
    """
    read = []
    for joint in range(model.njoints):
        frame, inertia = carrier.get(joint), model.inertias[joint]
        if frame is not None:
            inertia = frame.placement.actInv(inertia)
        parent = carrier.get(int(model.parents[joint])) if joint else None
        read.append(
            ReadBody(
                name=model.names[joint] if frame is None else frame.name,
                parent=None if not joint else model.names[0] if parent is None else parent.name,
                mass=float(inertia.mass),
                center_of_mass=vector(inertia.lever),
                inertia=components(inertia.inertia),
            )
        )
    return tuple(read)


def carried(model: pin.Model, frames: Mapping[int, pin.Frame]) -> dict[int, pin.Frame]:
    """Return the frames of the links that joints move, keyed by the indices of the joints; the root's frame has the index 0."""
    joint_frames = {int(model.getFrameId(model.names[joint], pin.FrameType.JOINT)): joint for joint in range(1, model.njoints)}
    carriers: dict[int, pin.Frame] = {}
    for frame in frames.values():
        joint = 0 if parent_joint(frame) == 0 else joint_frames.get(parent_frame(frame))
        if joint is not None:
            carriers.setdefault(joint, frame)
    return carriers


def parent_joint(frame: pin.Frame) -> int:
    """Return the index of the joint with which a frame moves."""
    return int(frame.parentJoint if hasattr(frame, "parentJoint") else frame.parent)  # until Pinocchio 2.6


def parent_frame(frame: pin.Frame) -> int:
    """Return the index of the frame to which a frame is fixed."""
    return int(frame.parentFrame if hasattr(frame, "parentFrame") else frame.previousFrame)  # until Pinocchio 2.6


def read_joints(model: pin.Model, carrier: Mapping[int, pin.Frame], joints: Sequence[Joint]) -> tuple[ReadJoint, ...]:
    """Return the joints. Their axes are computed from their Jacobians in Pinocchio's neutral configuration."""
    data = model.createData()
    # Pinocchio returns a matrix with a single column as a vector.
    velocities = np.reshape(pin.computeJointJacobians(model, data, pin.neutral(model)), (6, model.nv))
    read = []
    for joint in joints:
        body = carrier.get(joint.index)
        attitude = data.oMi[joint.index].rotation @ (np.eye(3) if body is None else body.placement.rotation)
        moving = velocities[:, joint.first]
        along = {"revolute": moving[3:], "prismatic": moving[:3]}.get(joint.type)
        bounded = joint.type in ("revolute", "prismatic") and joint.coordinates == 1
        read.append(
            ReadJoint(
                name=joint.name,
                type=joint.type,
                child=model.names[joint.index] if body is None else body.name,
                first=joint.first,
                count=joint.count,
                axis=None if along is None else vector(attitude.T @ along),
                armature=value(model, joint.first, "armature"),
                damping=value(model, joint.first, "damping"),
                friction=value(model, joint.first, "upperDryFrictionLimit", "friction"),
                effort_limit=limit(value(model, joint.first, "upperEffortLimit", "effortLimit")),
                lower=limit(float(model.lowerPositionLimit[joint.position])) if bounded else None,
                upper=limit(float(model.upperPositionLimit[joint.position])) if bounded else None,
            )
        )
    return tuple(read)


def value(model: pin.Model, velocity: int, *names: str) -> float | None:
    """Return a property of a velocity under the first of the given names that the release has; None if it has none of them."""
    attribute = next((name for name in names if hasattr(model, name)), None)
    return None if attribute is None else float(getattr(model, attribute)[velocity])


def limit(stated: float | None) -> float | None:
    """Return a limit; None for no limit, which Pinocchio stores as infinity or as the largest double."""
    return None if stated is None else finite(stated, np.finfo(float).max)


def notes(file: RobotFile, joints: Sequence[Joint]) -> tuple[str, ...]:
    """Return notes for users on how Pinocchio reads a file."""
    said = ["Pinocchio's dynamics contain no damping, no dry friction and no springs: its user adds them to the efforts"]
    if file.format == "urdf" and "<mimic" in Path(file.path).read_text("utf-8", "replace"):
        said.append("joints with <mimic> move by themselves, unless buildModelFromUrdf is given mimic=True")
    if any(joint.type == "planar" for joint in joints):
        said.append("the plane of a planar joint is that of x and y of its frame, whichever axis the file has")
    return tuple(said)


#: The indices of the components of a pose in Pinocchio's pose, whose quaternion is x, y, z, w.
POSE = [0, 1, 2, 6, 3, 4, 5]


def terms_of(
    model: pin.Model, links: Mapping[int, str], joints: Sequence[Joint], states: Sequence[RobotState], gravity: Vector
) -> tuple[Terms, ...]:
    """Return the terms that Pinocchio computes at states, with gravity (m/s^2, world). Sets the gravity of the model.

    `links` are the names of links, keyed by the indices of their frames in the model.
    """
    data = model.createData()
    return tuple(_terms(model, data, links, coordinates(model, joints, state), gravity) for state in states)


def _terms(model: pin.Model, data: pin.Data, links: Mapping[int, str], at: Coordinates, gravity: Vector) -> Terms:
    """Return the terms that Pinocchio computes in one state; `links` are as in `terms_of`."""
    rest = np.zeros(model.nv)
    model.gravity = pin.Motion.Zero()
    coriolis = np.array(pin.rnea(model, data, at.q, at.v, rest))
    model.gravity = pin.Motion(np.array(gravity), np.zeros(3))
    poses, jacobians = poses_and_jacobians(model, data, at.q, links.items())
    return Terms(
        poses=poses,
        jacobians=jacobians,
        mass_matrix=mass_matrix(model, data, at.q),
        gravity_force=np.array(pin.computeGeneralizedGravity(model, data, at.q)),
        coriolis_force=coriolis,
        forward_dynamics=np.array(pin.aba(model, data, at.q, at.v, at.tau)),
        inverse_dynamics=np.array(pin.rnea(model, data, at.q, at.v, at.a)),
    )


def mass_matrix(model: pin.Model, data: pin.Data, q: Array) -> Array:
    """Return the mass matrix (nv, nv), of which Pinocchio computes the upper triangle."""
    upper = np.triu(np.reshape(pin.crba(model, data, q), (model.nv, model.nv)))
    return np.asarray(upper + np.triu(upper, 1).T)


def frame_jacobian(model: pin.Model, data: pin.Data, index: int) -> Array:
    """Return the Jacobian (6, nv) of a frame along the world's axes. The Jacobians and frames in `data` must be computed."""
    if not model.nv:  # Pinocchio crashes
        return np.zeros((6, 0))
    jacobian = np.array(pin.getFrameJacobian(model, data, index, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED))
    return jacobian.reshape(6, model.nv)  # with a single column it is a vector


def poses_and_jacobians(
    model: pin.Model, data: pin.Data, q: Array, links: Iterable[tuple[int, str]]
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return the poses (7,) of frames and their Jacobians (6, nv) along the world's axes, keyed by the names of links.

    `links` are pairs of the index of a frame and the name of its link.
    """
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    poses, jacobians = {}, {}
    for index, name in links:
        poses[name] = np.array(pin.SE3ToXYZQUAT(data.oMf[index]))[POSE]
        jacobians[name] = frame_jacobian(model, data, index)
    return poses, jacobians
