"""Compare the cost of stepping MuJoCo through the adapter with that of `mj_step(nstep=stride)` on the same model.

Both take the same strides between the same samples, and copy the state at each sample. They are timed in one process, in turn,
by the time that the processor spends on them, so that other processes disturb little; the printed ratio is that of the faster
halves of the turns. The last column is one call of `mj_step` for all steps, without samples.
Run: python benchmarks/mujoco_stepping.py
"""

import statistics
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import mujoco
import numpy as np

from bodycheck import Case, load
from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Adapter, Method, Strides
from bodycheck.reference.trajectory import Array
from bodycheck.running.instants import sampling_steps

TURNS = 31
TIMESTEPS_S = (0.01, 0.002, 0.0005)


def main() -> None:
    case, adapter = load("intermediate-axis-flip"), registry.load("mujoco")
    print(f"MuJoCo {adapter.engine.version}, {case.name}, {case.samples} samples; medians of the faster half of {TURNS} turns")
    print(f"{'integrator':13} {'step, s':>8} {'stride':>6} {'mj_step by strides':>20} {'adapter':>8} {'mj_step at once':>16}")
    for integrator in offers.offered(adapter.engine, case.scene):
        for timestep in TIMESTEPS_S:
            print_costs(case, adapter, integrator, timestep)


def print_costs(case: Case, adapter: Adapter, integrator: str, timestep: float) -> None:
    """Print the cost of a step (us), and the costs of the adapter and of one call for all steps, relative to it."""
    strides = np.diff(sampling_steps(case.instants, timestep), prepend=0)
    steps = int(strides.sum())
    times: dict[str, list[float]] = {"strides": [], "adapter": [], "at once": []}
    for turn in range(TURNS):
        for way in list(times)[:: 1 if turn % 2 else -1]:
            simulation: Any = adapter.prepare([case.scene], Method.parse(integrator, timestep))
            model, data = simulation.model, mujoco.MjData(simulation.model)
            data.qpos, data.qvel = simulation.data.qpos, simulation.data.qvel
            calls: dict[str, Callable[[], object]] = {
                "strides": partial(by_strides, model, data, strides),
                "adapter": partial(simulation.advance, strides),
                "at once": partial(mujoco.mj_step, model, data, nstep=steps),
            }
            start = time.thread_time()
            calls[way]()
            times[way].append(time.thread_time() - start)
    plain, own, whole = (statistics.median(sorted(found)[: TURNS // 2]) for found in times.values())
    stride = f"{steps / (len(strides) - 1):g}"
    cost = f"{plain / steps * 1e6:.2f} us per step"
    print(f"{integrator:13} {timestep:8g} {stride:>6} {cost:>20} {own / plain:8.3f} {whole / plain:16.3f}")


def by_strides(model: mujoco.MjModel, data: mujoco.MjData, strides: Strides) -> Array:
    """Return the coordinates and velocities after each stride, as a user of MuJoCo would."""
    rows = np.empty((len(strides), model.nq + model.nv))
    for place, stride in enumerate(strides.tolist()):
        if stride:
            mujoco.mj_step(model, data, nstep=stride)
        rows[place, : model.nq], rows[place, model.nq :] = data.qpos, data.qvel
    return rows


if __name__ == "__main__":
    main()
