"""Compare the cost of stepping MuJoCo through the adapter with that of `mj_step(nstep=n)` on the same model.

Both are timed in one process, alternately. The printed ratios are those of neighbouring turns, so that they do not depend on
a drift of the machine's speed. Run: python benchmarks/mujoco_stepping.py
"""

import statistics
import time

import mujoco
import numpy as np

from bodycheck import load
from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method
from bodycheck.running.simulation import sampling_steps

TURNS = 15
TIMESTEP_S = 0.002


def main() -> None:
    case = load("intermediate-axis-flip")
    adapter = registry.load("mujoco")
    strides = np.diff(sampling_steps(case.instants, TIMESTEP_S), prepend=0)
    steps = int(strides.sum())
    print(
        f"MuJoCo {adapter.engine.version}, {case.name}, {steps} steps, {len(strides)} samples; median of {TURNS} turns, range"
    )
    for integrator in offers.offered(adapter.engine, case.scene):
        ratios, plain_times = [], []
        for _ in range(TURNS):
            simulation = adapter.prepare([case.scene], Method.parse(integrator, TIMESTEP_S))
            data = mujoco.MjData(simulation.model)
            data.qpos, data.qvel = simulation.data.qpos, simulation.data.qvel
            start = time.perf_counter()
            mujoco.mj_step(simulation.model, data, nstep=steps)
            middle = time.perf_counter()
            simulation.advance(strides)
            end = time.perf_counter()
            plain_times.append((middle - start) / steps)
            ratios.append((end - middle) / (middle - start))
        per_step = statistics.median(plain_times) * 1e6
        spread = f"{min(ratios):.3f} - {max(ratios):.3f}"
        print(
            f"{integrator:13} mj_step {per_step:.2f} us per step, adapter / mj_step {statistics.median(ratios):.3f} ({spread})"
        )


if __name__ == "__main__":
    main()
