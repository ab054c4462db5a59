"""Robot models in MuJoCo Warp, which takes the model that MuJoCo's compiler makes of a file.

The numbers of bodies and joints are those that MuJoCo Warp keeps. All states are worlds that are computed together. Contacts,
limits, equality constraints and actuators are left out, as in the adapter of MuJoCo.

MuJoCo computes moments of inertia about the centre of mass of a whole tree. In single precision the error of the mass matrix is
therefore larger than rounding for a light link far from this centre, such as a finger of a humanoid.
"""

from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import mujoco
import mujoco_warp as mjw
import numpy as np
import warp as wp

from bodycheck.adapters.mujoco.robot_joints import body_name, columns, joints_of
from bodycheck.adapters.mujoco.robot_terms import leave_out_what_is_not_asked, mass_matrix
from bodycheck.adapters.mujoco.robots import described, joint_states, loaded, state_of, steppable
from bodycheck.adapters.mujoco_warp import graphs
from bodycheck.adapters.robot_numbers import pose
from bodycheck.adapters.robot_reading import JointStates, ModelRefused, RobotFile, RobotReading
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.robots.terms import Terms
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array

#: The numbers of bodies and joints that a reading has, by MuJoCo's names.
KEPT = (
    *("body_mass", "body_ipos", "body_iquat", "body_inertia", "jnt_axis", "jnt_stiffness"),
    *("dof_armature", "dof_damping", "dof_frictionloss"),
)

#: The number of rounding errors of a moment of inertia that the error of a mass matrix may contain.
ROUNDINGS = 8


def read_robot(file: RobotFile, states: Sequence[RobotState], gravity: Vector) -> RobotReading:
    """Return how MuJoCo Warp reads a file, as `RobotModels.read_robot` does. Raises `ModelRefused`."""
    compiled = loaded(file.path)
    reading = described(compiled, compiled, file.format)
    leave_out_what_is_not_asked(compiled)
    try:
        model = mjw.put_model(compiled)
    except NotImplementedError as error:
        raise ModelRefused(f"MuJoCo Warp refuses the model: {error}") from error
    worlds = mjw.put_data(compiled, mujoco.MjData(compiled), nworld=max(1, len(states)))
    # The first axis of these arrays is the axis of worlds, which all have the same numbers.
    kept_by_warp = described(compiled, SimpleNamespace(**{name: getattr(model, name).numpy()[0] for name in KEPT}), file.format)
    reading = replace(reading, bodies=kept_by_warp.bodies, joints=kept_by_warp.joints)
    if not states or not compiled.nv:
        return replace(reading, terms=tuple(Terms() for _ in states))
    columns_of_states = columns(compiled, file.format, states)
    terms = terms_of(compiled, model, worlds, columns_of_states, gravity)
    return replace(reading, terms=terms, rounding=rounding(compiled, columns_of_states[0]))


def step_robot(file: RobotFile, starts: Sequence[JointStates], timestep: float, steps: int) -> list[JointStates]:
    """Return the states after steps of MuJoCo Warp, as `RobotSteps.step_robot` does. All starts are worlds of one model."""
    compiled = steppable(file, timestep)
    joints, model = joints_of(compiled, file.format), mjw.put_model(compiled)
    worlds = mjw.put_data(compiled, mujoco.MjData(compiled), nworld=len(starts))
    qpos, qvel, _, _ = columns(compiled, file.format, [state_of(start) for start in starts])
    worlds.qpos.assign(qpos)
    worlds.qvel.assign(qvel)
    graph = graphs.record(lambda: mjw.step(model, worlds))
    for _ in range(steps):
        graphs.replay(graph)
    ends = zip(doubles(worlds.qpos), doubles(worlds.qvel), strict=True)
    return [joint_states(joints, *end) for end in ends]


def rounding(compiled: mujoco.MjModel, qpos: Array) -> float:
    """Return the relative rounding error of the mass matrices at positions (n, k) in single precision.

    It is the rounding error of the moments of inertia about the centre of mass of the tree, divided by the diagonal of the mass
    matrix.
    """
    data, largest = mujoco.MjData(compiled), 0.0
    for row in qpos:
        data.qpos[:] = row
        mujoco.mj_fwdPosition(compiled, data)
        moments = np.max(data.crb[compiled.dof_bodyid, :3], axis=1) * np.sum(data.cdof[:, :3] ** 2, axis=1)
        largest = max(largest, float(np.max(moments / np.diagonal(mass_matrix(compiled, data)))))
    return ROUNDINGS * float(np.finfo(np.float32).eps) * largest


def terms_of(
    compiled: mujoco.MjModel, model: Any, worlds: Any, columns_of_states: Sequence[Array], gravity: Vector
) -> tuple[Terms, ...]:
    """Return the terms that MuJoCo Warp computes at n states, with gravity (m/s^2).

    `columns_of_states` are positions, velocities, accelerations and applied forces (n, k) of the n worlds.
    """
    qpos, qvel, qacc, applied = columns_of_states
    model.opt.gravity.assign(np.array([gravity]))
    worlds.qpos.assign(qpos)
    worlds.qvel.assign(qvel)
    worlds.qfrc_applied.assign(applied)
    mjw.forward(model, worlds)
    forward, passive = doubles(worlds.qacc), doubles(worlds.qfrc_passive) + doubles(worlds.qfrc_constraint)
    matrices = [matrix_of(compiled, row) for row in doubles(worlds.M)]
    frames = [poses_and_jacobians(compiled, model, worlds, body) for body in range(1, compiled.nbody)]
    worlds.qacc.assign(qacc)
    mjw.inverse(model, worlds)
    inverse = doubles(worlds.qfrc_inverse) + doubles(worlds.qfrc_passive) + doubles(worlds.qfrc_constraint)
    worlds.qvel.zero_()
    mjw.fwd_velocity(model, worlds)
    weight = doubles(worlds.qfrc_bias)
    worlds.qvel.assign(qvel)
    model.opt.gravity.zero_()
    mjw.fwd_velocity(model, worlds)
    coriolis = doubles(worlds.qfrc_bias)
    names = [body_name(compiled, body) for body in range(1, compiled.nbody)]
    return tuple(
        Terms(
            poses={name: places[row] for name, (places, _) in zip(names, frames, strict=True)},
            jacobians={name: jacobians[row] for name, (_, jacobians) in zip(names, frames, strict=True)},
            mass_matrix=matrices[row],
            gravity_force=weight[row],
            coriolis_force=coriolis[row],
            passive_force=passive[row],
            forward_dynamics=forward[row],
            inverse_dynamics=inverse[row],
        )
        for row in range(len(qpos))
    )


def doubles(array: Any) -> Array:
    """Return a copy of an array of Warp in double precision."""
    return np.array(array.numpy(), dtype=np.float64)


def matrix_of(compiled: mujoco.MjModel, entries: Array) -> Array:
    """Return the mass matrix (nv, nv) from its entries in MuJoCo's sparse form, which MuJoCo Warp has computed."""
    data = mujoco.MjData(compiled)
    data.M[:] = entries
    return mass_matrix(compiled, data)


def poses_and_jacobians(compiled: mujoco.MjModel, model: Any, worlds: Any, body: int) -> tuple[Array, Array]:
    """Return the poses (n, 7) and the Jacobians (n, 6, nv) of the frame of a body in n worlds."""
    places, turns = doubles(worlds.xpos)[:, body], doubles(worlds.xquat)[:, body]
    linear, angular = (wp.zeros((len(places), 3, compiled.nv), dtype=float) for _ in range(2))
    points, bodies = wp.array(places, dtype=wp.vec3), wp.array(np.full(len(places), body), dtype=int)
    mjw.jac(model, worlds, linear, angular, points, bodies)
    rows = np.array([pose(*row) for row in zip(places, turns, strict=True)])
    return rows, np.concatenate([doubles(linear), doubles(angular)], axis=1)
