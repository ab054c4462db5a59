"""Step a robot model in MuJoCo, for what its joints do by motion."""

from collections.abc import Sequence

import mujoco

from bodycheck.adapters.mujoco.robot_joints import Joint, coordinates, joints_of
from bodycheck.adapters.mujoco.robots import loaded
from bodycheck.adapters.mujoco.stepping import quiet
from bodycheck.adapters.robot_reading import JointStates, RobotFile
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.trajectory import Array

#: The flags of MuJoCo that are disabled. What the compiler makes of joints stays, as limits and equality constraints.
OFF = ("CONTACT", "ACTUATION", "GRAVITY")


def step_robot(file: RobotFile, starts: Sequence[JointStates], timestep: float, steps: int) -> list[JointStates]:
    """Return the states after steps of MuJoCo, as `RobotSteps.step_robot` does."""
    model = steppable(file, timestep)
    joints, data = joints_of(model, file.format), mujoco.MjData(model)
    ends = []
    with quiet():
        for start in starts:
            mujoco.mj_resetData(model, data)
            at = coordinates(model, joints, state_of(start))
            data.qpos[:], data.qvel[:] = at.qpos, at.qvel
            mujoco.mj_step(model, data, nstep=steps)
            ends.append(joint_states(joints, data.qpos, data.qvel))
    return ends


def steppable(file: RobotFile, timestep: float) -> mujoco.MjModel:
    """Return the compiled model of a file with a time step (s), without gravity, contacts and actuators."""
    model = loaded(file.path)
    model.opt.timestep = timestep
    for flag in OFF:
        model.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag}"))
    return model


def state_of(start: JointStates) -> RobotState:
    """Return a state of joints with one velocity as a state of a robot model."""
    positions, velocities = ({name: (value,) for name, value in part.items()} for part in (start.positions, start.velocities))
    return RobotState(positions, velocities, {}, {})


def joint_states(joints: Sequence[Joint], qpos: Array, qvel: Array) -> JointStates:
    """Return the states of the joints with one velocity from MuJoCo's positions (nq,) and velocities (nv,)."""
    single = [joint for joint in joints if joint.type in ("revolute", "prismatic")]
    return JointStates(
        {joint.name: float(qpos[joint.qpos]) for joint in single}, {joint.name: float(qvel[joint.dof]) for joint in single}
    )
