"""Old releases of the engines: stepped otherwise where they must be, and each as what it is."""

import json
from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import registry
from bodycheck.adapters.contract import EngineReset, Method, Strides
from bodycheck.adapters.mujoco import stepping as mujoco_stepping
from bodycheck.environments import environments, making
from bodycheck.environments.environments import Unobtainable
from bodycheck.reference.scene import State

CASES = ("osrf-boxes-complex", "football-wobble", "sliding-brick")
MUJOCO = registry.load("mujoco")


def mixed(count: int) -> Strides:
    """Strides of 0 to 4 steps, for which rollouts are taken, with more steps in all than a rollout has."""
    return np.resize([0, 3, 0, 4, 1], count)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("integrator", ["Euler", "RK4"])
def test_steps_are_those_of_rollouts(name: str, integrator: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A simulation that changes from one way to the other takes the same steps too."""
    scene, method = load(name).scene, Method.parse(integrator, 1e-3)
    dense, sparse = mixed(6000), np.array([500, 9000, 1, 700])
    simulation = MUJOCO.prepare([scene], method)
    rolled = [simulation.advance(dense), simulation.advance(sparse), simulation.advance(dense)]
    monkeypatch.setattr(mujoco_stepping, "Rollout", None)
    simulation = MUJOCO.prepare([scene], method)
    assert simulation.pool is None
    stepped = [simulation.advance(strides) for strides in (dense[:5], dense[5:], sparse, dense)]
    np.testing.assert_array_equal(np.concatenate(stepped, axis=1), np.concatenate(rolled, axis=1))


@pytest.mark.parametrize(("stride", "count"), [(50, 200), (4, 2500), (12000, 3)])
def test_steps_stop_at_the_reset_at_which_rollouts_stop(stride: int, count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = replace(load("intermediate-axis-flip").scene, initial=State(angular_velocity=(0.0, 0.1, 300.0)))
    strides = np.full(count, stride)
    signals = []
    for worth in (np.inf, 0):
        monkeypatch.setattr(mujoco_stepping, "STEPS_WORTH_A_CALL", worth)
        with pytest.raises(EngineReset) as signal:
            MUJOCO.prepare([scene], Method.parse("Euler", 2e-3)).advance(strides)
        signals.append(signal.value)
    assert str(signals[0]) == str(signals[1])
    np.testing.assert_array_equal(signals[0].states, signals[1].states)
    assert 0 < signals[0].states.shape[1] < len(strides)


FIGURES = """
import json, sys
from dataclasses import replace
from bodycheck import load, simulate
from bodycheck.adapters import offers, registry
adapter, found = registry.load(sys.argv[1]), {}
for name in sys.argv[2:]:
    case = load(name)
    case = replace(case, duration=1.0, samples=11, expectations=())
    for integrator in offers.offered(adapter.engine, case.scene):
        for method in (integrator, *(model.method for model in adapter.models(case.scene, integrator).values())):
            outcome = simulate(case, sys.argv[1], method, 1e-3).outcome
            found[f"{name} {method}"] = getattr(outcome, "reason", "") or type(outcome).__name__
print(json.dumps([adapter.engine.version, found]))
"""
RELEASES = {
    "mujoco": ("2.3.2", "2.3.7", "3.0.0", "3.1.6", "3.2.0", "3.2.7", "3.3.7", "3.17.0"),
    "pinocchio": ("2.6.18", "2.6.20", "2.7.0", "3.4.0", "3.9.0", "4.0.0"),
}


@pytest.mark.slow
@pytest.mark.parametrize(("engine", "version"), [(engine, version) for engine in RELEASES for version in RELEASES[engine]])
def test_a_release_does_what_it_can_and_says_what_it_cannot(engine: str, version: str) -> None:
    """Each of its methods runs, or is not supported for a reason that names the version."""
    try:
        environment = environments.obtain(engine, version)
    except Unobtainable as error:
        pytest.skip(str(error))
    cases = ("osrf-boxes-complex", "free-brick", "sliding-brick")
    done = making.run(environment.python, ["-c", FIGURES, engine, *cases], None, 600.0)
    assert done.returncode == 0, done.stderr
    said, found = json.loads(done.stdout)
    assert said == version
    assert [name for name, end in found.items() if end != "Completed" and version not in end] == []
    assert "Completed" in {end for name, end in found.items() if name.startswith("sliding-brick")}
