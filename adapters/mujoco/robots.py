"""Robot models in MuJoCo, which reads URDF and MJCF by its compiler.

A body of MuJoCo has the frame of its link. MuJoCo keeps inertia along principal axes about the centre of mass; it is rotated
back to the link's frame here. From a URDF, MuJoCo joins links that are welded, and drops links that are welded to the world,
unless the file itself has an element `<mujoco><compiler fusestatic="false"/></mujoco>`.

Terms are those of `mj_forward` and `mj_inverse`, without contacts, limits, equality constraints and actuators. Dry friction, a
constraint in MuJoCo, stays enabled, and the passive force contains it.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import mujoco
import numpy as np

from bodycheck.adapters.mujoco.robot_joints import Joint, body_name, coordinates, effort_limit, joints_of, limits, mimics
from bodycheck.adapters.mujoco.robot_model import model_of
from bodycheck.adapters.mujoco.robot_terms import terms_of
from bodycheck.adapters.mujoco.stepping import quiet
from bodycheck.adapters.quiet import no_stderr, refusal
from bodycheck.adapters.robot_numbers import along, components, matrix, vector
from bodycheck.adapters.robot_reading import JointStates, ModelRefused, ReadBody, ReadJoint, RobotFile, RobotReading
from bodycheck.reference.robots.model import RobotModel
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array

#: The relative error of inertias in releases before 3.14, which find principal axes to a millionth or so at each weld.
ROUNDING, EXACT_SINCE = 3e-5, (3, 14)

#: The flags of MuJoCo that are disabled. What the compiler makes of joints stays, as limits and equality constraints.
OFF = ("CONTACT", "ACTUATION", "GRAVITY")


def read_robot(file: RobotFile, states: Sequence[RobotState], gravity: Vector) -> RobotReading:
    """Return how MuJoCo reads a file, as `RobotModels.read_robot` does. Raises `ModelRefused`."""
    model = loaded(file.path)
    reading = described(model, model, file.format)
    with quiet():
        return replace(reading, terms=terms_of(model, joints_of(model, file.format), states, gravity))


def described(model: mujoco.MjModel, kept: Any, format: str) -> RobotReading:
    """Return the reading of a compiled model, without terms.

    Parameters
    ----------
    model
        The model, with its names.
    kept
        An object with the numbers of the bodies and joints, as arrays with MuJoCo's names: the model itself, or the numbers
        that another engine has kept.
    format
        The format of the file.
    """
    return RobotReading(
        bodies=bodies(model, kept),
        joints=read_joints(model, kept, joints_of(model, format)),
        links=tuple(body_name(model, body) for body in range(1, model.nbody)),
        velocities=int(model.nv),
        gravity=default_gravity(model),
        terms=(),
        rounding=ROUNDING if release() < EXACT_SINCE else 0.0,
        notes=notes(model, format),
    )


def release() -> tuple[int, ...]:
    """Return the first two numbers of MuJoCo's release."""
    return tuple(int(number) for number in mujoco.mj_versionString().split(".")[:2])


def compiled(path: str) -> RobotModel:
    """Return the compiled model of an MJCF file as a robot model, as `robot_model.model_of` does. Raises `ModelRefused`."""
    model = loaded(path)
    return model_of(model, default_gravity(model))


def loaded(path: str) -> mujoco.MjModel:
    """Return the compiled model of a file. Raises `ModelRefused`."""
    try:
        with quiet(), no_stderr():
            return mujoco.MjModel.from_xml_path(path)
    except (ValueError, mujoco.FatalError) as error:
        raise ModelRefused(refusal(path, str(error))) from error


def default_gravity(model: mujoco.MjModel) -> Vector:
    """Return the gravity that a model has if its user sets none (m/s^2)."""
    off = model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_GRAVITY)
    return (0.0, 0.0, 0.0) if off else vector(model.opt.gravity)


def bodies(model: mujoco.MjModel, kept: Any) -> tuple[ReadBody, ...]:
    """Return the bodies of a model, the world first; `kept` has the numbers, as in `described`."""
    return tuple(
        ReadBody(
            name=body_name(model, body),
            parent=body_name(model, int(model.body_parentid[body])) if body else None,
            mass=float(kept.body_mass[body]),
            center_of_mass=vector(kept.body_ipos[body]),
            inertia=components(along(kept.body_inertia[body], matrix(kept.body_iquat[body]))),
        )
        for body in range(model.nbody)
    )


def read_joints(model: mujoco.MjModel, kept: Any, joints: Sequence[Joint]) -> tuple[ReadJoint, ...]:
    """Return the joints of a model; `kept` has the numbers, as in `described`. A planar joint has the axis of its hinge."""
    followers = mimics(model)
    read = []
    for joint in joints:
        last = joint.first + 2 if joint.type == "planar" else joint.first
        single = joint.type in ("revolute", "prismatic")
        lower, upper = limits(model, joint.first) if single else (None, None)
        read.append(
            ReadJoint(
                name=joint.name,
                type=joint.type,
                child=body_name(model, joint.body),
                first=joint.dof,
                count=joint.count,
                axis=vector(kept.jnt_axis[last]) if single or joint.type == "planar" else None,
                armature=float(kept.dof_armature[joint.dof]),
                damping=float(kept.dof_damping[joint.dof]),
                friction=float(kept.dof_frictionloss[joint.dof]),
                stiffness=float(kept.jnt_stiffness[joint.first]),
                effort_limit=effort_limit(model, joint.first),
                lower=lower,
                upper=upper,
                mimic=followers.get(joint.first),
            )
        )
    return tuple(read)


def notes(model: mujoco.MjModel, format: str) -> tuple[str, ...]:
    """Return notes on how MuJoCo treats a model, except its links and joints; `format` is the format of the model's file."""
    said = []
    if format == "urdf":
        said.append(
            "MuJoCo joins links that are welded, and loses those that are welded to the world, "
            'unless <mujoco><compiler fusestatic="false"/></mujoco> in the file says otherwise'
        )
    said += [f"not compared: {text}" for text in (_equalities(model), _tendons(model), _actuators(model)) if text]
    if format == "urdf" and np.any(model.dof_frictionloss):
        said.append(
            "dry friction is a constraint of up to the number of the file, which opposes the velocity that a joint is about "
            "to have"
        )
    heavy = [name for name in ("tendon_armature", "actuator_armature") if np.any(getattr(model, name, 0.0))]
    if heavy:
        said.append(f"the mass matrix contains armature that is not one of joints ({', '.join(heavy)})")
    if np.any(model.body_gravcomp):
        said.append("the passive force contains gravity compensation (gravcomp)")
    if model.opt.density or model.opt.viscosity:
        said.append("the passive force contains that of a fluid (density, viscosity)")
    curved = [name for name in ("jnt_stiffnesspoly", "dof_dampingpoly") if np.any(getattr(model, name, 0.0))]
    if curved:
        said.append(f"springs or damping are not linear ({', '.join(curved)})")
    return tuple(said)


def _equalities(model: mujoco.MjModel) -> str:
    kinds = Counter(mujoco.mjtEq(int(kind)).name.removeprefix("mjEQ_").lower() for kind in model.eq_type)
    return "equality constraints (" + ", ".join(f"{count} {kind}" for kind, count in kinds.items()) + ")" if kinds else ""


def _tendons(model: mujoco.MjModel) -> str:
    names = (str(model.tendon(index).name) or f"tendon{index}" for index in range(model.ntendon))
    return f"tendons ({', '.join(names)})" if model.ntendon else ""


def _actuators(model: mujoco.MjModel) -> str:
    names = (str(model.actuator(index).name) or f"actuator{index}" for index in range(model.nu))
    geared = (f"{name} with gear {gear[0]:g}" for name, gear in zip(names, model.actuator_gear, strict=True))
    return f"actuators ({', '.join(geared)})" if model.nu else ""


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
