"""Convert a compiled model of MuJoCo to a robot model, which gives the meaning of an MJCF file.

Coordinates are MuJoCo's. In the pose of the file, the coordinate of a joint is the joint's `ref`. The frame of the joint
belongs to the coordinate zero, and is therefore rotated or shifted back by `ref`. The springs of a joint are slack at its
`springref`.

A joint moves a link without mass, named `BODY/JOINT` and placed at the anchor of the joint, if this anchor is not the origin of
the body, or if the joint is not the last joint of the body. Such a link carries the next joint, or the body itself by a weld.
Bodies without joints are welded.
"""

from collections.abc import Mapping

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from bodycheck.adapters.mujoco.robot_joints import TYPES, body_name, effort_limit, joint_name, limits, mimics
from bodycheck.reference.kinematics import about
from bodycheck.reference.robots.model import Mimic, RobotJoint, RobotLink, RobotModel, Wide
from bodycheck.reference.robots.rotations import matrices
from bodycheck.reference.scene import Vector

NOWHERE, UNTURNED = np.zeros(3, np.longdouble), np.eye(3, dtype=np.longdouble)


def model_of(model: mujoco.MjModel, gravity: Vector) -> RobotModel:
    """Return a compiled model as a robot model with a gravity (m/s^2), in MuJoCo's order of bodies and joints.

    The root of the robot model is the world. Elements that a robot model does not have are left out: tendons, actuators, and
    equality constraints, except those by which a joint follows another one.
    """
    links: list[RobotLink] = []
    joints: list[RobotJoint] = []
    places: dict[int, int] = {}
    followers = mimics(model)
    for body in range(model.nbody):
        if body:
            chain = _chain(model, body, followers, places[int(model.body_parentid[body])], len(links))
            links += [RobotLink(name, 0.0, NOWHERE, np.zeros((3, 3), np.longdouble)) for name, _ in chain[:-1]]
            joints += [joint for _, joint in chain]
        places[body] = len(links)
        links.append(_link(model, body))
    return RobotModel(model_name(model), tuple(links), tuple(joints), gravity)


def model_name(model: mujoco.MjModel) -> str:
    """Return the name of a model, which is the first of MuJoCo's names."""
    return bytes(model.names).split(b"\0", 1)[0].decode()


def _link(model: mujoco.MjModel, body: int) -> RobotLink:
    """Return a body as a link, with the inertia rotated from MuJoCo's principal axes to the axes of the body.

    MuJoCo regards the two frames as the same if they differ by about a nanometre.
    """
    name, mass, moments = body_name(model, body), float(model.body_mass[body]), wide(model.body_inertia[body])
    if model.body_sameframe[body] == int(mujoco.mjtSameFrame.mjSAMEFRAME_BODY):
        return RobotLink(name, mass, NOWHERE, np.diag(moments))
    turn = matrices(wide(model.body_iquat[body])[None])[0]
    return RobotLink(name, mass, wide(model.body_ipos[body]), turn * moments @ turn.T)


def _chain(
    model: mujoco.MjModel, body: int, followers: Mapping[int, Mimic], parent: int, next_place: int
) -> list[tuple[str, RobotJoint]]:
    """Return the links from a body's parent to the body, each as its name and the joint that moves it; the body is the last.

    `parent` is the index of the parent's link, and `next_place` the index of the first of the returned links.
    """
    name = body_name(model, body)
    first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
    start, turn = wide(model.body_pos[body]), matrices(wide(model.body_quat[body])[None])[0]
    chain: list[tuple[str, RobotJoint]] = []
    origin = NOWHERE  # the position of the last link from the origin of the body, along the axes of the body
    for index in range(first, first + count):
        anchor = NOWHERE if TYPES[int(model.jnt_type[index])] == "floating" else wide(model.jnt_pos[index])
        shift, back = _reference(model, index)
        frame = start + turn @ (anchor - origin + shift), turn @ back
        joint = _joint(model, index, followers.get(index), (parent, next_place + len(chain)), frame)
        is_body = index == first + count - 1 and not anchor.any()
        chain.append((name if is_body else f"{name}/{joint.name}", joint))
        parent, origin, start, turn = joint.child, anchor, NOWHERE, UNTURNED
    if not count or origin.any():
        weld = RobotJoint(f"{name}/weld", "fixed", parent, next_place + len(chain), start - turn @ origin, turn, NOWHERE)
        chain.append((name, weld))
    return chain


def _joint(
    model: mujoco.MjModel, index: int, mimic: Mimic | None, links: tuple[int, int], frame: tuple[Wide, Wide]
) -> RobotJoint:
    """Return one of MuJoCo's joints between two links, given by their indices, in a frame given by its origin and its axes."""
    type, dof = TYPES[int(model.jnt_type[index])], int(model.jnt_dofadr[index])
    single = type in ("revolute", "prismatic")
    lower, upper = limits(model, index)
    return RobotJoint(
        joint_name(model, index),
        type,
        *links,
        *frame,
        axis=unit(model.jnt_axis[index]) if single else NOWHERE,
        armature=float(model.dof_armature[dof]),
        damping=float(model.dof_damping[dof]),
        friction=float(model.dof_frictionloss[dof]),
        stiffness=float(model.jnt_stiffness[index]),
        rest=float(model.qpos_spring[model.jnt_qposadr[index]]) if single else 0.0,
        effort_limit=effort_limit(model, index),
        lower=lower,
        upper=upper,
        mimic=mimic,
    )


def _reference(model: mujoco.MjModel, index: int) -> tuple[Wide, Wide]:
    """Return the shift (3,), m, and the rotation (3, 3) of a joint's frame that undo its `ref` in the pose of the file."""
    reference = wide(model.qpos0[[model.jnt_qposadr[index]]])
    type, axis = TYPES[int(model.jnt_type[index])], unit(model.jnt_axis[index])
    if type == "prismatic":
        return -reference * axis, UNTURNED
    if type == "revolute":
        return NOWHERE, matrices(about(axis, -reference))[0]
    return NOWHERE, UNTURNED


def wide(values: ArrayLike) -> Wide:
    """Return numbers in the 80-bit type."""
    return np.array(values, np.longdouble)


def unit(axis: ArrayLike) -> Wide:
    """Return an axis (3,) in the 80-bit type, at unit length."""
    direction = wide(axis)
    return np.asarray(direction / np.sqrt(direction @ direction))
