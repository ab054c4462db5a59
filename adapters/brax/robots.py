"""Robot models in Brax, which reads MJCF: it edits the text, and MuJoCo compiles the result.

The terms are those of the generalized pipeline, without limits and contacts. Brax has no function for the Jacobian of a link.
It converts the axes of hinges to the world frame, but not the axes of slides: the terms of slides are wrong, unless their
frames have the axes of the world. JAX compiles the terms for every robot again, which takes up to a minute.
"""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import jax
import numpy as np
from brax import kinematics
from brax.generalized import dynamics, mass
from brax.generalized.base import State
from brax.io import mjcf
from jax import numpy as jnp

from bodycheck.adapters.mujoco.robot_joints import body_name, columns
from bodycheck.adapters.mujoco.robots import described
from bodycheck.adapters.quiet import overheard, refusal
from bodycheck.adapters.robot_numbers import pose
from bodycheck.adapters.robot_reading import FormatUnknown, ModelRefused, RobotFile, RobotReading
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.robots.terms import Terms
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array


def read_robot(file: RobotFile, states: Sequence[RobotState], gravity: Vector) -> RobotReading:
    """Return how Brax reads a file, as `RobotModels.read_robot` does. Raises `ModelRefused` and `FormatUnknown`."""
    if file.format != "mjcf":
        raise FormatUnknown("Brax reads MJCF only")
    system = loaded(file.path)
    compiled = system.mj_model
    reading = described(compiled, kept(system), file.format)
    if not states:
        return reading
    columns_of_states = [jnp.array(rows) for rows in columns(compiled, file.format, states)]
    names = [body_name(compiled, body) for body in range(1, compiled.nbody)]
    return replace(reading, terms=terms_of(system.replace(mj_model=None), names, columns_of_states, gravity))


def loaded(path: str) -> Any:
    """Return Brax's system of a file. Raises `ModelRefused`."""
    try:
        with overheard(), warnings.catch_warnings():
            # Brax warns at each model that it is no longer developed, and MJX that Brax uses names of older releases.
            warnings.simplefilter("ignore")
            system = mjcf.load(path)
            mjcf.validate_model(system.mj_model)
    except Exception as error:  # Brax edits the text without checks, so any exception may occur
        raise ModelRefused(refusal(path, f"{type(error).__name__}: {error}")) from error
    return system


def kept(system: Any) -> Any:
    """Return the numbers of a system by MuJoCo's names. Brax keeps neither the world's body nor dry friction."""
    inertia, compiled = system.link.inertia, system.mj_model

    def with_world(rows: Any, first: Any) -> Array:
        return np.concatenate([[first], np.asarray(rows, dtype=np.float64)])

    return SimpleNamespace(
        body_mass=with_world(inertia.mass, 0.0),
        body_ipos=with_world(inertia.transform.pos, np.zeros(3)),
        body_iquat=with_world(inertia.transform.rot, np.array([1.0, 0.0, 0.0, 0.0])),
        body_inertia=with_world(np.diagonal(inertia.i, axis1=1, axis2=2), np.zeros(3)),
        jnt_axis=compiled.jnt_axis,
        jnt_stiffness=np.asarray(system.dof.stiffness)[compiled.jnt_dofadr],
        dof_armature=np.asarray(system.dof.armature),
        dof_damping=np.asarray(system.dof.damping),
        dof_frictionloss=np.zeros(compiled.nv),
    )


def terms_of(system: Any, names: Sequence[str], columns_of_states: Sequence[Any], gravity: Vector) -> tuple[Terms, ...]:
    """Return the terms that Brax computes at n states, with gravity (m/s^2).

    `names` are the names of all links. `columns_of_states` are positions, velocities, accelerations and applied forces (n, k).
    """
    down = jnp.array(gravity)
    terms = jax.jit(jax.vmap(computed, in_axes=(None, None, 0, 0, 0, 0)))(system, down, *columns_of_states)
    numbers = {name: np.array(value, dtype=np.float64) for name, value in terms.items()}
    return tuple(_terms(numbers, names, row) for row in range(len(columns_of_states[0])))


def computed(system: Any, gravity: Any, q: Any, qd: Any, qdd: Any, tau: Any) -> Mapping[str, Any]:
    """Return the terms that Brax computes at one state with gravity (3,), keyed by their names."""
    falling, floating = system.replace(gravity=gravity), system.replace(gravity=0 * gravity)
    moving, resting = state_of(system, q, qd), state_of(system, q, 0 * qd)
    matrix, bias = mass.matrix(system, moving), dynamics.inverse(falling, moving)
    free = dynamics.forward(falling, moving, tau)
    return {
        "matrix": matrix,
        "weight": dynamics.inverse(falling, resting),
        "coriolis": dynamics.inverse(floating, moving),
        "passive": free - tau + bias,
        "forward": jnp.linalg.solve(matrix, free),
        "inverse": matrix @ qdd + bias,
        "position": moving.x.pos,
        "quaternion": moving.x.rot,
    }


def state_of(system: Any, q: Any, qd: Any) -> Any:
    """Return the state of Brax's generalized pipeline at coordinates q and velocities qd, without constraints."""
    return dynamics.transform_com(system, State.init(q, qd, *kinematics.forward(system, q, qd)))


def _terms(numbers: Mapping[str, Array], names: Sequence[str], row: int) -> Terms:
    """Return the terms of the state in one row of the numbers that `computed` returned for all states."""
    poses = zip(names, numbers["position"][row], numbers["quaternion"][row], strict=True)
    return Terms(
        poses={name: pose(position, quaternion) for name, position, quaternion in poses},
        mass_matrix=numbers["matrix"][row],
        gravity_force=numbers["weight"][row],
        coriolis_force=numbers["coriolis"][row],
        passive_force=numbers["passive"][row],
        forward_dynamics=numbers["forward"][row],
        inverse_dynamics=numbers["inverse"][row],
    )
