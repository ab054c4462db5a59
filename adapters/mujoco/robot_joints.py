"""The joints of a compiled model of MuJoCo in the terms of robot models, and their states in MuJoCo's coordinates.

A joint of a robot model is one joint of MuJoCo. Only a planar joint of a URDF is three joints, which MuJoCo names `NAME_TX`,
`NAME_TY` and `NAME_RZ`.

MuJoCo's free joint has its position and its linear velocity along the world's axes, and an attitude relative to the world. The
angular velocities of free joints and ball joints are along the axes of the body. The frame of a free joint is the pose that the
file gives its body.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from bodycheck.adapters.robot_numbers import values_of
from bodycheck.reference.kinematics import multiply, rotate
from bodycheck.reference.robots.model import Mimic, RobotJointType
from bodycheck.reference.robots.rotations import plane_axes
from bodycheck.reference.robots.state import COORDINATES, VELOCITIES, RobotState, Values
from bodycheck.reference.trajectory import Array

TYPES: dict[int, RobotJointType] = {
    int(mujoco.mjtJoint.mjJNT_FREE): "floating",
    int(mujoco.mjtJoint.mjJNT_BALL): "spherical",
    int(mujoco.mjtJoint.mjJNT_SLIDE): "prismatic",
    int(mujoco.mjtJoint.mjJNT_HINGE): "revolute",
}

#: The endings that MuJoCo appends to the name of a planar joint of a URDF for the three joints that it makes of this joint.
PLANAR = ("_TX", "_TY", "_RZ")


@dataclass(frozen=True)
class Joint:
    """A joint of a robot model in MuJoCo.

    Attributes
    ----------
    name, type
        The name and the type of the joint.
    body
        The index of the body that the joint moves.
    first
        The index of the first of MuJoCo's joints that make up the joint.
    qpos, dof
        The indices of its first position and of its first velocity.
    """

    name: str
    type: RobotJointType
    body: int
    first: int
    qpos: int
    dof: int

    @property
    def count(self) -> int:
        """The number of velocities of the joint."""
        return VELOCITIES[self.type]


def body_name(model: mujoco.MjModel, body: int) -> str:
    """Return the name of a body; a body without a name gets one from its index."""
    return str(model.body(body).name) or f"unnamed body {body}"


def joint_name(model: mujoco.MjModel, joint: int) -> str:
    """Return the name of a joint; a joint without a name gets one from its index."""
    return str(model.joint(joint).name) or f"unnamed joint {joint}"


def joints_of(model: mujoco.MjModel, format: str) -> list[Joint]:
    """Return the joints of a model, in MuJoCo's order; `format` is the format of the file from which it was compiled."""
    names = [joint_name(model, joint) for joint in range(model.njnt)]
    joints, joint = [], 0
    while joint < model.njnt:
        name, type = names[joint], TYPES[int(model.jnt_type[joint])]
        three = names[joint : joint + 3]
        if format == "urdf" and three == [name.removesuffix(PLANAR[0]) + end for end in PLANAR]:
            name, type = name.removesuffix(PLANAR[0]), "planar"
        addresses = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
        joints.append(Joint(name, type, int(model.jnt_bodyid[joint]), joint, *addresses))
        joint += 3 if type == "planar" else 1
    return joints


def limits(model: mujoco.MjModel, joint: int) -> tuple[float | None, float | None]:
    """Return the lower and the upper limit of the position of a hinge or slide (rad or m); None for a limit that is not set."""
    if not model.jnt_limited[joint] or TYPES[int(model.jnt_type[joint])] not in ("revolute", "prismatic"):
        return None, None
    lower, upper = model.jnt_range[joint].tolist()
    return lower, upper


def effort_limit(model: mujoco.MjModel, joint: int) -> float | None:
    """Return the largest force that all actuators together may apply to a joint; None if there is no limit."""
    return float(np.abs(model.jnt_actfrcrange[joint]).max()) if model.jnt_actfrclimited[joint] else None


def mimics(model: mujoco.MjModel) -> dict[int, Mimic]:
    """Return the joints that an equality constraint makes follow another joint linearly, keyed by the indices of the joints."""
    mimics_by_joint = {}
    for equality in range(model.neq):
        joint, followed = int(model.eq_obj1id[equality]), int(model.eq_obj2id[equality])
        offset, ratio, *rest = model.eq_data[equality][:5].tolist()
        if model.eq_type[equality] != mujoco.mjtEq.mjEQ_JOINT or followed < 0 or any(rest):
            continue
        position, followed_position = (float(model.qpos0[model.jnt_qposadr[index]]) for index in (joint, followed))
        mimics_by_joint[joint] = Mimic(joint_name(model, followed), ratio, offset + position - ratio * followed_position)
    return mimics_by_joint


@dataclass(frozen=True, eq=False)
class Coordinates:
    """A state in MuJoCo's coordinates: positions (nq,), and velocities, accelerations and applied forces (nv,)."""

    qpos: Array
    qvel: Array
    qacc: Array
    applied: Array


def coordinates(model: mujoco.MjModel, joints: Sequence[Joint], state: RobotState) -> Coordinates:
    """Return a state in MuJoCo's coordinates; joints that the state does not have keep MuJoCo's default positions."""
    in_engine = Coordinates(np.array(model.qpos0), *(np.zeros(model.nv) for _ in range(3)))
    for joint in joints:
        if (position := values_of(state.positions, joint.name, COORDINATES[joint.type])) is not None:
            in_engine.qpos[joint.qpos : joint.qpos + len(position)] = _position(model, joint, position)
        parts: tuple[tuple[Array, Values], ...] = (
            (in_engine.qvel, state.velocities),
            (in_engine.qacc, state.accelerations),
            (in_engine.applied, state.efforts),
        )
        for part, values in parts:
            if (value := values_of(values, joint.name, joint.count)) is not None:
                part[joint.dof : joint.dof + joint.count] = _velocity(model, joint, value)
    return in_engine


def columns(model: mujoco.MjModel, format: str, states: Sequence[RobotState]) -> list[Array]:
    """Return n states of a model as arrays: positions (n, nq), and velocities, accelerations and applied forces (n, nv).

    `format` is the format of the file from which the model was compiled.
    """
    joints = joints_of(model, format)
    at = [coordinates(model, joints, state) for state in states]
    return [
        np.array(rows)
        for rows in zip(*((in_mujoco.qpos, in_mujoco.qvel, in_mujoco.qacc, in_mujoco.applied) for in_mujoco in at), strict=True)
    ]


def _position(model: mujoco.MjModel, joint: Joint, value: Array) -> Array:
    """Return a joint's positions in MuJoCo's coordinates."""
    if joint.type == "floating":
        turn = model.body_quat[joint.body]
        return np.concatenate([model.body_pos[joint.body] + rotate(turn, value[:3]), multiply(turn, value[3:])])
    return _velocity(model, joint, value)


def _velocity(model: mujoco.MjModel, joint: Joint, value: Array) -> Array:
    """Return a joint's velocities, accelerations or efforts in MuJoCo's coordinates."""
    if joint.type == "floating":
        return np.concatenate([rotate(model.body_quat[joint.body], value[:3]), value[3:]])
    if joint.type == "planar":
        axes = model.jnt_axis[joint.first : joint.first + 3]
        in_plane = plane_axes(axes[2].astype(np.longdouble))[:, :2].astype(float) @ value[:2]
        return np.append(axes[:2] @ in_plane, value[2])
    return value
