"""Compare the cost of scenes in the adapters, alone and a thousand together, with that of scripts for the engines alone.

The scenes are torque-free bricks that differ in initial state, mass and moments of inertia, for 0.5 s at 2 ms and 26 samples.
MuJoCo's script is one rollout of all scenes, each with a model compiled from its own XML before. Pinocchio's script is a loop
of `aba` and `integrate` in Python, as its users write it, for one scene after another. What the adapters need before they step
(`prepare`) is told apart. All are run in turn in one process, and timed by its processor time; the ratios are those of the
medians of the faster halves of the turns. Run: python benchmarks/ensemble_engines.py
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"  # as workers of ensembles have it

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import mujoco
import numpy as np
import pinocchio as pin
from mujoco.rollout import Rollout

from bodycheck import load
from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method
from bodycheck.adapters.mujoco.worlds import FULL
from bodycheck.adapters.pinocchio import schemes
from bodycheck.reference.inertia import principal_moments
from bodycheck.reference.scene import Body, Brick, Scene
from bodycheck.reference.trajectory import Array

TURNS = 5
SCENES = 1000
TIMESTEP_S = 0.002
STRIDES = np.array([0, *[10] * 25])
STEPS = int(STRIDES.sum())

#: Scenes of a script for Pinocchio, whose cost a scene does not depend on their number.
SCRIPTED = 20


def scenes(count: int) -> list[Scene]:
    """Return bricks with other sizes, attitudes and velocities."""
    generator, like = np.random.default_rng(1), load("free-brick").scene
    found = []
    for _ in range(count):
        sizes = 0.1 * generator.uniform(1.0, 3.0, 3)
        mass = float(generator.uniform(0.5, 2.0))
        quaternion = generator.normal(size=4)
        initial = replace(
            like.initial,
            quaternion=tuple((quaternion / np.linalg.norm(quaternion)).tolist()),
            angular_velocity=tuple((3 * generator.normal(size=3)).tolist()),
        )
        shape = Brick(tuple(sizes.tolist()))
        found.append(Scene(Body(mass, principal_moments(shape, mass), shape), initial, like.gravity))
    return found


def costs(ways: dict[str, Callable[[], Callable[[], object]]]) -> dict[str, tuple[float, float]]:
    """Return the processor time (s) of preparing and of carrying out some works, by their names.

    Each way is a function that prepares its work and returns it as a function.
    """
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in ways}
    for turn in range(TURNS):
        for name in list(ways)[:: 1 if turn % 2 else -1]:
            instants = [time.process_time()]
            work = ways[name]()
            instants.append(time.process_time())
            work()
            instants.append(time.process_time())
            times[name].append((instants[1] - instants[0], instants[2] - instants[1]))
    halves = {name: [sorted(part)[: TURNS // 2 + 1] for part in zip(*found, strict=True)] for name, found in times.items()}
    return {name: (statistics.median(before), statistics.median(then)) for name, (before, then) in halves.items()}


def adapter(engine: str, asked: Sequence[Scene], method: Method) -> Callable[[], object]:
    """Prepare scenes in an adapter, and return their flight."""
    return partial(offers.prepare(registry.load(engine), asked, method).advance, STRIDES)


def rollout(models: list[mujoco.MjModel], starts: Array) -> Callable[[], object]:
    """Return the rollout of scenes in MuJoCo alone."""
    pool, data = Rollout(nthread=0), mujoco.MjData(models[0])

    def rolled_out() -> Array:
        states, _ = pool.rollout(models, [data], starts, nstep=STEPS)
        return np.asarray(states[:, np.cumsum(STRIDES) - 1])

    return rolled_out


def print_mujoco(integrator: str) -> None:
    """Print the cost of a step of MuJoCo, that of the adapter relative to it, and that of preparing a scene."""
    method, asked = Method.parse(integrator, TIMESTEP_S), scenes(SCENES)
    alone: list[Any] = [registry.load("mujoco").prepare([one], method) for one in asked]
    models, starts = [one.model for one in alone], np.empty((SCENES, mujoco.mj_stateSize(alone[0].model, FULL)))
    for one, row in zip(alone, starts, strict=True):
        mujoco.mj_getState(one.model, one.data, row, FULL)
    found = costs({"rollout": partial(rollout, models, starts), "together": partial(adapter, "mujoco", asked, method)})
    engine, ours, each = found["rollout"][1], found["together"][1], found["together"][0] / SCENES
    print(
        f"mujoco    {integrator:19} {engine / STEPS / SCENES * 1e6:6.2f} us {ours / engine:9.3f} {'':>9} {each * 1e6:8.1f} us"
    )


def scripted(asked: Sequence[Scene], integrator: str) -> Callable[[], object]:
    """Build models of scenes in Pinocchio, and return their flights in a script."""
    method = Method.parse(integrator, TIMESTEP_S)
    alone: list[Any] = [registry.load("pinocchio").prepare([one], method) for one in asked]
    parts = [one.parts[0] for one in alone]
    built = [(part.model, part.model.createData(), part.q, part.v) for part in parts]

    def flown() -> list[list[Array]]:
        return [flight(integrator, *one) for one in built]

    return flown


def flight(integrator: str, model: pin.Model, data: pin.Data, q: Array, v: Array) -> list[Array]:
    """Return the coordinates and velocities of one scene at the samples, as a script computes them."""
    rows, h, nothing = [], TIMESTEP_S, np.zeros(model.nv)
    if integrator.endswith("euler"):
        for stride in STRIDES:
            for _ in range(stride):
                v = v + h * pin.aba(model, data, q, v, nothing)
                q = pin.integrate(model, q, h * v)
            rows.append(np.concatenate([q, v]))
        return rows

    def acceleration(q: Array, v: Array) -> Any:
        return pin.aba(model, data, q, v, nothing)

    scheme, _ = schemes.SCHEMES[integrator]
    for stride in STRIDES:
        for _ in range(stride):
            q, v = scheme(model, acceleration, q, v, h)
        rows.append(np.concatenate([q, v]))
    return rows


def print_pinocchio(integrator: str) -> None:
    """Print the cost of a step of a script, and those of the adapter relative to it, alone and with all scenes together."""
    method, asked = Method.parse(integrator, TIMESTEP_S), scenes(SCENES)

    def one_by_one() -> Callable[[], object]:
        flights = [adapter("pinocchio", [one], method) for one in asked[:SCRIPTED]]
        return lambda: [fly() for fly in flights]

    found = costs(
        {
            "script": partial(scripted, asked[:SCRIPTED], integrator),
            "alone": one_by_one,
            "together": partial(adapter, "pinocchio", asked, method),
        }
    )
    plain, alone, each = found["script"][1] / SCRIPTED, found["alone"][1] / SCRIPTED, found["together"][0] / SCENES
    ratios = f"{found['together'][1] / SCENES / plain:9.3f} {alone / plain:9.3f}"
    print(f"pinocchio {integrator:19} {plain / STEPS * 1e6:6.2f} us {ratios} {each * 1e6:8.1f} us")


def main() -> None:
    versions = f"MuJoCo {mujoco.__version__}, Pinocchio {pin.__version__}"
    print(f"{versions}; {SCENES} scenes, {STEPS} steps of {TIMESTEP_S} s, {len(STRIDES)} samples; {TURNS} turns, one thread")
    print(f"{'engine':9} {'integrator':19} {'script':>9} {'together':>9} {'alone':>9} {'prepare':>11}")
    for integrator in ("Euler", "RK4"):
        print_mujoco(integrator)
    for integrator in schemes.SCHEMES:
        print_pinocchio(integrator)


if __name__ == "__main__":
    main()
