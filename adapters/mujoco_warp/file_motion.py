"""Run a whole scene in MuJoCo Warp, which takes the model that MuJoCo's compiler makes of a file, in single precision.

Memory is reserved for the contacts and the rows of constraints of MuJoCo Warp's own estimate. What acts at each sample, and
the poses of bodies, follow from the coordinates by MuJoCo in double precision.
"""

from dataclasses import replace
from typing import Any

import mujoco
import mujoco_warp as mjw
import numpy as np

from bodycheck.adapters.file_motion import FileFacts, FileMotion, FileRun, MotionRefused, nudged
from bodycheck.adapters.mujoco import file_motion as of_mujoco
from bodycheck.adapters.mujoco import options
from bodycheck.adapters.mujoco.stepping import quiet
from bodycheck.adapters.mujoco_warp import graphs
from bodycheck.adapters.robot_reading import ModelRefused, RobotFile


def methods() -> list[str]:
    """Return the integrators that MuJoCo Warp has, by MuJoCo's names."""
    here = {member.name for member in mjw.IntegratorType}
    return [name for name in options.available() if name.upper() in here]


def file_facts(file: RobotFile) -> FileFacts:
    """Return the contents of a file on which a run depends, as `FileMotions.file_facts` does.

    The kernels that runs need are compiled here, which takes a minute when they are not in Warp's cache.
    """
    compiled = of_mujoco.compiled(file.path)
    # In single precision, a solver cannot be made so strict that its error is seen.
    facts = replace(of_mujoco.facts_of(compiled, methods()), settings={})
    with quiet():
        _stepper(compiled, mujoco.MjData(compiled))
    return facts


def _stepper(compiled: mujoco.MjModel, data: mujoco.MjData) -> tuple[Any, Any]:
    """Return the world of a compiled model at the state of its data, and the graph of a step of it. Raises `ModelRefused`."""
    try:
        model, worlds = mjw.put_model(compiled), mjw.put_data(compiled, data)
    except NotImplementedError as error:
        raise ModelRefused(f"MuJoCo Warp refuses the model: {error}") from error
    return worlds, graphs.record(lambda: mjw.step(model, worlds))


def run_file(file: RobotFile, run: FileRun) -> FileMotion:
    """Return the motion of a scene, as `FileMotions.run_file` does."""
    if run.method.integrator not in methods():
        raise MotionRefused(f"MuJoCo Warp has no integrator {run.method.integrator!r}; there are: {', '.join(methods())}")
    with of_mujoco.chosen(of_mujoco.compiled(file.path), run.method) as compiled, quiet():
        data = of_mujoco.started(compiled, run)
        mujoco.mj_forward(compiled, data)
        worlds, graph = _stepper(compiled, data)
        if run.nudged:  # a change of one rounding in double precision vanishes in single precision
            worlds.qpos.assign(nudged(worlds.qpos.numpy().astype(np.float32)))
            worlds.qvel.assign(nudged(worlds.qvel.numpy().astype(np.float32)))

        def step(count: int) -> None:
            worlds.ctrl.assign(data.ctrl[None].astype(np.float32))
            for _ in range(count):
                graphs.replay(graph)
            data.qpos[:], data.qvel[:] = worlds.qpos.numpy()[0], worlds.qvel.numpy()[0]
            data.act[:] = worlds.act.numpy()[0]
            data.time += count * run.method.timestep

        return of_mujoco.recorded(compiled, data, run, step)
