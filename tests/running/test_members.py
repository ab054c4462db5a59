"""Many members of an ensemble run with one method, together or one by one."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import offers, registry, stepping
from bodycheck.adapters.contract import Engine, EngineDiverged, Integrator, Method, SceneUnsupported
from bodycheck.adapters.stepping import Normalised
from bodycheck.processes.failures import Crashed
from bodycheck.reference.scene import Scene
from bodycheck.reference.scenes import Scenes, vary
from bodycheck.results.outcome import Completed, Diverged, Run, Unsupported
from bodycheck.running import simulation
from bodycheck.running.members.blocks import Flown, fly
from tests.support.cases import STEADY_SPIN, shortened

FREE = frozenset({"gravity", "translation", "rotation"})
EULER = Method.parse("euler", 0.01)
ENGINE = Engine("planted", "planted", "1.0", (Integrator("euler"),), FREE, batch=2)
TIMES = np.array([0, 5, 20]) * EULER.timestep


def spinning(speeds: Sequence[float]) -> Scenes:
    """Members that spin about a principal axis and fly with some speeds (m/s)."""
    velocity = np.zeros((len(speeds), 3))
    velocity[:, 0] = speeds
    return vary(replace(STEADY_SPIN.scene, plane=None), {"velocity": velocity})


def alone(scenes: Scenes, engine: str, method: Method, times: np.ndarray) -> list[Run]:
    """The runs of members as cases of their own, which are sampled at these times (s) too."""
    case = shortened(STEADY_SPIN, 0.2, 21)
    runs = [simulation.run(replace(case, name=f"one-{k}", scene=scenes.scene(k)), engine, method) for k in range(len(scenes))]
    assert set(times) <= set(simulation.sampling_times(case.instants, method.sampling))
    return runs


def assert_same_ends(flown: Flown, runs: Sequence[Run]) -> None:
    """The members ended as runs did."""
    for place, run in enumerate(runs):
        found = flown.ended.get(place)
        if isinstance(run.outcome, Completed):
            assert found is None
            assert np.isfinite(flown.states[place]).all()
        else:
            assert (type(found), found.reason) == (type(run.outcome), run.outcome.reason)  # type: ignore[union-attr]


def test_a_member_that_is_given_up_leaves_the_others_alone(miniatures: Path) -> None:
    scenes = spinning([1.0, 2e6, 2.0, 3e6])
    flown = fly("batching", EULER, scenes, TIMES)
    assert_same_ends(flown, alone(scenes, "batching", EULER, TIMES))
    assert flown.ended == {place: Diverged("it is too fast", "gave up") for place in (1, 3)}
    assert flown.trajectory(0) is not None
    adapter: Any = registry.load("batching")
    adapter.asked.clear()
    fly("batching", EULER, scenes, TIMES)
    assert adapter.asked == [4]


@pytest.mark.parametrize("engine", ["exact", "exploding", "not-a-number", "raising", "exiting", "shapeless", "unnormalised"])
def test_an_engine_without_batching_runs_each_as_if_it_were_alone(engine: str, miniatures: Path) -> None:
    scenes, method = spinning([1.0, 2.0]), Method.parse("closed-form", 0.1)
    case = shortened(STEADY_SPIN, 1.0, 11)
    runs = [simulation.run(replace(case, name=f"one-{k}", scene=scenes.scene(k)), engine, method) for k in range(2)]
    flown = fly(engine, method, scenes, np.arange(11) * 0.1, ["one-0", "one-1"])
    assert_same_ends(flown, runs)
    assert (len(flown.ended) == 0) == (engine == "exact")
    for place, run in enumerate(runs):
        if isinstance(run.outcome, Completed):
            np.testing.assert_array_equal(flown.states[place, :, 10:], run.outcome.trajectory.angular_velocity)


@dataclass
class Scaled:
    """A simulation that stands still, with quaternions whose norms are off by 1 % of the speed of the scene."""

    scenes: Sequence[Scene]
    error: Exception | None = None

    def advance(self, strides: np.ndarray) -> np.ndarray:
        if self.error is not None:
            raise self.error
        starts = [one.initial for one in self.scenes]
        rows = np.array([(*own.position, *own.quaternion, *own.velocity, *own.angular_velocity) for own in starts])
        rows[:, 3:7] *= 1 + 0.01 * rows[:, 7:8]
        states = np.tile(rows[:, None, None, :], (1, len(strides), 1, 1))
        states[:, 1:, :, 0] += 1.0
        return states


@dataclass
class Planted:
    """An adapter that steps many scenes at once, unless one of them is faster than 10 m/s: then none of them."""

    where: str = "nowhere"
    error: Exception = field(default_factory=lambda: RuntimeError("one is too fast"))
    asked: list[int] = field(default_factory=list)
    engine: Engine = ENGINE

    def prepare(self, scenes: Sequence[Scene], method: Method) -> Normalised:
        self.asked.append(len(scenes))
        fails = any(one.initial.velocity[0] > 10 for one in scenes)
        if fails and self.where == "prepare":
            raise self.error
        return Normalised(Scaled(scenes, self.error if fails and self.where == "advance" else None))


@pytest.fixture
def planted(monkeypatch: pytest.MonkeyPatch) -> Planted:
    adapter = Planted()
    monkeypatch.setattr(registry, "load", lambda name: adapter)
    return adapter


def test_every_member_has_the_norm_error_of_its_own_quaternions(planted: Planted) -> None:
    flown = fly("planted", EULER, spinning([1.0, 3.0, 2.0]), TIMES)
    # The norms are 1.01, 1.03 and 1.02, up to the rounding of a few products.
    np.testing.assert_allclose(flown.norm_error, [0.01, 0.03, 0.02], rtol=1e-12)
    assert planted.asked == [3]
    for place, speed in enumerate((1.0, 3.0, 2.0)):
        single = fly("planted", EULER, spinning([speed]), TIMES)
        assert single.norm_error[0] == flown.norm_error[place]


def test_norm_errors_of_scenes_that_are_advanced_in_turn(planted: Planted) -> None:
    heavier = replace(STEADY_SPIN.scene, body=replace(STEADY_SPIN.scene.body, mass=7.0), plane=None)
    one, other, third = (spinning([1.0, 3.0, 2.0]).scene(place) for place in range(3))
    heavy = replace(heavier, initial=other.initial)
    simulated = offers.prepare(planted, [one, heavy, third], EULER)
    simulated.advance(np.diff(TIMES, prepend=0))
    np.testing.assert_allclose(stepping.norm_errors(simulated, 3), [0.01, 0.03, 0.02], rtol=1e-12)


@pytest.mark.parametrize("where", ["prepare", "advance"])
@pytest.mark.parametrize(
    ("error", "outcome"),
    [
        (RuntimeError("one is too fast"), Crashed("RuntimeError: one is too fast")),
        (SceneUnsupported("too fast"), Unsupported("too fast")),
        (EngineDiverged("too fast"), Diverged("too fast")),
    ],
)
def test_members_that_an_engine_cannot_run_together_are_run_alone(
    planted: Planted, where: str, error: Exception, outcome: object
) -> None:
    planted.where, planted.error = where, error
    flown = fly("planted", EULER, spinning([1.0, 11.0, 2.0]), TIMES)
    assert planted.asked == [3, 1, 1, 1]
    (ended,) = flown.ended.values()
    assert list(flown.ended) == [1]
    assert (type(ended), ended.reason) == (type(outcome), outcome.reason)  # type: ignore[attr-defined]
    assert np.isfinite(flown.states[[0, 2]]).all()


def test_a_method_that_the_engine_does_not_offer_is_unsupported_for_all(planted: Planted) -> None:
    flown = fly("planted", Method.parse("RK4", 0.01), spinning([1.0, 2.0]), TIMES)
    assert planted.asked == []
    assert {type(outcome) for outcome in flown.ended.values()} == {Unsupported}
    assert flown.ended[1].reason == "planted 1.0 has no integrator 'RK4' for this scene"


def test_cases_are_run_one_by_one_at_their_own_instants() -> None:
    slide, flight = shortened(load("sliding-brick"), 0.2, 3), shortened(load("free-brick"), 0.3, 4)
    flown = fly("mujoco", Method.parse("Euler", 0.01), [slide, flight], TIMES)
    outcomes = [flown.ended[0], flown.ended[1]]
    assert [outcome.status for outcome in outcomes] == ["ok", "ok"]
    assert outcomes[0].load is not None  # type: ignore[union-attr]
    lengths = [len(trajectory) for trajectory in map(flown.trajectory, range(2)) if trajectory is not None]
    assert lengths == [3, 4]
