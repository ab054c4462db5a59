"""The terms that MuJoCo computes at states of a compiled robot model."""

from collections.abc import Sequence

import mujoco
import numpy as np

from bodycheck.adapters.mujoco.robot_joints import Coordinates, Joint, body_name, coordinates
from bodycheck.adapters.robot_numbers import pose
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.robots.terms import Terms
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array

#: The flags of MuJoCo that are disabled.
OFF = ("CONTACT", "EQUALITY", "LIMIT", "ACTUATION")


def terms_of(
    model: mujoco.MjModel, joints: Sequence[Joint], states: Sequence[RobotState], gravity: Vector
) -> tuple[Terms, ...]:
    """Return the terms that MuJoCo computes at states, with gravity (m/s^2, world). Changes the model's gravity and flags."""
    leave_out_what_is_not_asked(model)
    data = mujoco.MjData(model)
    return tuple(_terms(model, data, coordinates(model, joints, state), gravity) for state in states)


def leave_out_what_is_not_asked(model: mujoco.MjModel) -> None:
    """Disable contacts, limits, equality constraints and actuators, and enable gravity. Dry friction stays."""
    for flag in OFF:
        model.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag}"))
    model.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_GRAVITY)
    # Dry friction is a piecewise linear problem, which Newton's method solves exactly if it is not stopped early.
    model.opt.tolerance = 0.0


def _terms(model: mujoco.MjModel, data: mujoco.MjData, at: Coordinates, gravity: Vector) -> Terms:
    """Return the terms that MuJoCo computes in one state."""
    mujoco.mj_resetData(model, data)
    model.opt.gravity[:] = gravity
    data.qpos[:], data.qvel[:], data.qfrc_applied[:] = at.qpos, at.qvel, at.applied
    mujoco.mj_forward(model, data)
    forward = data.qacc.copy()
    passive = data.qfrc_passive + data.qfrc_constraint
    poses, jacobians = frames(model, data)
    matrix = mass_matrix(model, data)
    data.qacc[:] = at.qacc
    mujoco.mj_inverse(model, data)
    # MuJoCo's inverse dynamics are the efforts that are needed in addition to its passive forces and its constraints.
    inverse = data.qfrc_inverse + data.qfrc_passive + data.qfrc_constraint
    data.qvel[:] = 0.0
    mujoco.mj_fwdVelocity(model, data)
    weight = data.qfrc_bias.copy()
    data.qvel[:], model.opt.gravity[:] = at.qvel, 0.0
    mujoco.mj_fwdVelocity(model, data)
    return Terms(poses, jacobians, matrix, weight, data.qfrc_bias.copy(), passive, forward, inverse)


def frames(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return the poses (7,) and Jacobians (6, nv) of the frames of all bodies but the world, keyed by name.

    The positions in `data` must have been computed.
    """
    poses, jacobians = {}, {}
    for body in range(1, model.nbody):
        name = body_name(model, body)
        poses[name] = pose(data.xpos[body], data.xquat[body])
        jacobian = np.zeros((6, model.nv))
        mujoco.mj_jacBody(model, data, jacobian[:3], jacobian[3:], body)
        jacobians[name] = jacobian
    return poses, jacobians


def mass_matrix(model: mujoco.MjModel, data: mujoco.MjData) -> Array:
    """Return the mass matrix (nv, nv). The positions in `data` must have been computed.

    The matrix is computed as its product with unit vectors, because the arguments of the function that returns it whole differ
    between releases.
    """
    matrix = np.zeros((model.nv, model.nv))
    for row, unit in zip(matrix, np.eye(model.nv), strict=True):
        mujoco.mj_mulM(model, data, row, unit)
    return matrix
