"""Step mechanisms in MuJoCo Warp, whose model is that of the adapter of MuJoCo.

Poses and velocities of bodies are computed by MuJoCo from the coordinates after a step.
"""

from typing import Any

import mujoco
import mujoco_warp as mjw
import numpy as np

from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.mujoco.compiling import compiled_model
from bodycheck.adapters.mujoco.mechanism_xml import document
from bodycheck.adapters.mujoco.mechanisms import begin, states_of
from bodycheck.adapters.mujoco_warp import graphs
from bodycheck.adapters.stepping import Loop
from bodycheck.reference.mechanisms.mechanism import Mechanism


def prepare(mechanism: Mechanism, method: Method) -> Loop[Any]:
    """Return the simulation of a mechanism, as `Adapter.prepare` does. Raises `SceneUnsupported`."""
    compiled = compiled_model(document(mechanism, method.timestep, method.integrator, dict(method.options)))
    start = mujoco.MjData(compiled)
    begin(compiled, start, mechanism)
    mujoco.mj_forward(compiled, start)  # so that the data have room for its constraints
    try:
        model = mjw.put_model(compiled)
    except NotImplementedError as error:
        raise SceneUnsupported(f"MuJoCo Warp refuses the model: {error}") from error
    data = mjw.put_data(compiled, start)
    qpos, qvel = data.qpos.numpy(), data.qvel.numpy()  # views of the arrays that are stepped
    graph = graphs.record(lambda: mjw.step(model, data))
    rows = states_of(compiled, [body.name for body in mechanism.bodies])
    return Loop(graph, graphs.replay, lambda _: np.concatenate([qpos[0], qvel[0]]), rows)
