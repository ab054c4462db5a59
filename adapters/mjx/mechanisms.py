"""Step mechanisms in MJX, whose model is that of the adapter of MuJoCo.

Poses and velocities of bodies are computed from MJX's coordinates by MuJoCo, because those in MJX's data are of the start of a
step.
"""

import mujoco
from jax import numpy as jnp

from bodycheck.adapters.contract import Engine, Method
from bodycheck.adapters.mjx.compiled import Compiled, check_precision, strider
from bodycheck.adapters.mjx.simulation import handed_over, stepped
from bodycheck.adapters.mujoco.compiling import compiled_model
from bodycheck.adapters.mujoco.mechanism_xml import document
from bodycheck.adapters.mujoco.mechanisms import begin, states_of
from bodycheck.reference.mechanisms.mechanism import Mechanism

#: Takes strides of a mechanism; compiled once for each structure of a model.
TAKE = strider(stepped, lambda data: jnp.concatenate([data.qpos, data.qvel]))


def prepare_mechanism(engine: Engine, mechanism: Mechanism, method: Method) -> Compiled:
    """Return the simulation of a mechanism, as `Mechanisms.prepare_mechanism` does.

    Raises `SceneUnsupported`, and `RuntimeError` in a process whose precision is not that of the engine.
    """
    check_precision(engine)
    compiled = compiled_model(document(mechanism, method.timestep, method.integrator, dict(method.options)))
    model, data = handed_over(compiled)
    start = mujoco.MjData(compiled)
    begin(compiled, start, mechanism)
    given = {name: jnp.array(getattr(start, name)) for name in ("qpos", "qvel", "qfrc_applied")}
    states = states_of(compiled, [body.name for body in mechanism.bodies])
    return Compiled(TAKE.one, model, data.replace(**given), states, len(mechanism.bodies))
