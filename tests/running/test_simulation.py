"""One run in this process: what is bad input, and that nothing which an engine raises leaves it."""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bodycheck import compare, load, simulate, truth
from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Engine, Integrator, Method, choice
from bodycheck.errors import BadInput
from bodycheck.processes.failures import Crashed
from bodycheck.reference.scene import Plane, Scene, State
from bodycheck.results.outcome import NO_STEP, Completed, Diverged
from bodycheck.running.plan import plan
from bodycheck.running.simulation import run
from bodycheck.running.smoke import check
from tests.support.cases import STEADY_SPIN, shortened

SLIDE = replace(load("sliding-brick"), samples=3, expectations=())
EVERYTHING = frozenset({"gravity", "translation", "rotation", "contact", "friction", "drag"})
ENGINE = Engine("faulty", "faulty", "1.0", (Integrator("step"),), EVERYTHING)


@dataclass(frozen=True)
class Faulty:
    """An adapter that fails where it is told to."""

    where: str
    error: BaseException
    engine: Engine = ENGINE

    def _do(self, where: str) -> None:
        if where == self.where:
            raise self.error

    def contact_law(self, scene: Scene, method: Method) -> Plane | None:
        self._do("contact_law")
        return None

    def contact_load(self, scene: Scene, method: Method, steps: int) -> None:
        self._do("contact_load")

    def prepare(self, scenes: Sequence[Scene], method: Method) -> Any:
        self._do("prepare")
        return self

    def advance(self, strides: np.ndarray) -> np.ndarray:
        self._do("advance")
        initial = SLIDE.scene.initial
        row = [*initial.position, *initial.quaternion, *initial.velocity, *initial.angular_velocity]
        rows = np.tile(row, (len(strides), 1))
        rows[:, 0] += np.arange(len(strides))
        return rows[None, :, None, :]


@pytest.mark.parametrize("where", ["contact_law", "prepare", "advance", "contact_load"])
@pytest.mark.parametrize("error", [RuntimeError("no"), SystemExit(3), MemoryError(), KeyError("x")])
def test_nothing_that_an_engine_raises_leaves_simulate(
    where: str, error: BaseException, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(registry, "load", lambda name: Faulty(where, error))
    outcome = simulate(SLIDE, "faulty", "step", 0.1).outcome
    assert isinstance(outcome, Crashed)
    assert outcome.status == "crashed"


def test_an_adapter_that_fails_nowhere_completes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(registry, "load", lambda name: Faulty("nowhere", RuntimeError()))
    assert simulate(SLIDE, "faulty", "step", 0.1).outcome.status == "ok"


def _scaled(by: float) -> Callable[[np.ndarray], object]:
    scale = np.ones(13)
    scale[3:7] = by
    return lambda states: states * scale


@pytest.mark.parametrize(
    ("spoil", "reason"),
    [
        (_scaled(0.0), "its quaternion has the norm 0, not 1, at t = 0 s"),
        (_scaled(1 + 2e-6), "its quaternion has the norm 1.000002, not 1, at t = 0 s"),
        (_scaled(1e200), "its quaternion has the norm 1e+200, not 1, at t = 0 s"),
        (lambda states: states + 0j, "its states are of the type complex128, not real numbers"),
        (lambda states: states.astype(str), "its states are of the type <U32, not real numbers"),
        (lambda states: states.astype(object), "its states are of the type object, not real numbers"),
        (lambda states: np.ma.masked_less(states, -1e9), "its states are a masked array"),
        (lambda states: states[0], "its states have the shape (3, 1, 13), not (1, 3, 1, 13)"),
        (lambda states: states + np.eye(13)[0], "at t = 0 its position is [1.0, 0.0, 0.05], not [0.0, 0.0, 0.05]"),
        (
            lambda states: states[..., [*range(7), 8, 7, *range(9, 13)]],
            "at t = 0 its velocity is [0.0, 2.0, 0.0], not [2.0, 0.0, 0.0]",
        ),
        (
            lambda states: states[..., [0, 1, 2, 4, 5, 6, 3, *range(7, 13)]],
            "at t = 0 its attitude is 3.14 rad from the attitude of the scene",
        ),
    ],
)
def test_states_that_are_none_crash(
    spoil: Callable[[np.ndarray], object], reason: str, monkeypatch: pytest.MonkeyPatch, recwarn: pytest.WarningsRecorder
) -> None:
    class Spoiling(Faulty):
        def advance(self, strides: np.ndarray) -> Any:
            return spoil(super().advance(strides))

    monkeypatch.setattr(registry, "load", lambda name: Spoiling("nowhere", RuntimeError()))
    at_fault = f"the adapter of faulty 1.0 is at fault in the case {SLIDE.name}: "
    assert simulate(SLIDE, "faulty", "step", 0.1).outcome == Crashed(at_fault + reason)
    assert not recwarn.list


def test_a_quaternion_in_single_precision_is_one(monkeypatch: pytest.MonkeyPatch) -> None:
    class Single(Faulty):
        def advance(self, strides: np.ndarray) -> Any:
            return super().advance(strides).astype(np.float32)

    monkeypatch.setattr(registry, "load", lambda name: Single("nowhere", RuntimeError()))
    assert simulate(SLIDE, "faulty", "step", 0.1).outcome.status == "ok"


@pytest.mark.parametrize(
    ("spelling", "words"),
    [
        ("Eulr", "mujoco has no integrator 'Eulr'.*did you mean 'Euler'"),
        ("Euler:cone=elliptc", "read 'elliptc'; allowed: elliptic or pyramidal; did you mean 'elliptic'"),
        ("Euler:con=elliptic", "has no option 'con'; allowed: .*did you mean 'cone'"),
        ("Euler-planar", "is now spelled 'Euler:model=planar'"),
    ],
)
def test_a_misspelled_method_is_bad_input(spelling: str, words: str) -> None:
    with pytest.raises(BadInput, match=words):
        simulate(SLIDE, "mujoco", spelling)


def test_an_adapter_without_its_record_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    class Point:
        name = "halfway"

        def load(self) -> object:
            return object()

    monkeypatch.setattr(registry, "_points", lambda group, name=None: (Point(),))
    with pytest.raises(registry.EngineMissing, match="halfway has no adapter: object lacks `engine` or `prepare`"):
        registry.load("halfway")


@pytest.mark.parametrize("name", ["=cmd()", "e" * 101, "\udc80", "", "::error::x"])
def test_an_entry_point_or_an_integrator_with_such_a_name_is_none(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    class Point:
        def __init__(self, name: str) -> None:
            self.name = name

        def load(self) -> object:
            engine = Engine("fine", "fine", "1.0", (Integrator(name),), frozenset())
            return SimpleNamespace(engine=engine, prepare=len)

    points = (Point("fine"), Point(name))
    monkeypatch.setattr(registry, "_points", lambda group, name=None: tuple(p for p in points if name in (None, p.name)))
    assert "fine" in registry.names()
    assert name not in registry.names()
    with pytest.raises(registry.EngineMissing, match="an integrator is named "):
        registry.load("fine")


def test_a_wrong_engine_is_measured_and_an_adapter_like_it_is_found_out(miniatures: Path) -> None:
    maxima = compare(truth(STEADY_SPIN), simulate(STEADY_SPIN, "wrong", "closed-form", 0.1)).maxima()
    # What the engine spoils is a metre, and twice the speed that it reverses; the rest is rounding.
    assert maxima["position_error"] == pytest.approx(1.0, abs=1e-12)
    assert maxima["angular_velocity_error"] == pytest.approx(1.0, abs=1e-12)
    assert check("exact") == []
    assert any("its position is" in fault for fault in check("wrong"))
    assert all("RuntimeError" in fault for fault in check("raising"))


def test_a_motion_that_an_engine_damps_by_its_own_settings_is_no_fault_of_its_adapter(monkeypatch: pytest.MonkeyPatch) -> None:
    """The motion is that of the scene where nothing is switched on, and the start is that of the scene anyway."""

    class Resting(Faulty):
        def prepare(self, scenes: Sequence[Scene], method: Method) -> Any:
            initial = scenes[0].initial
            row = [*initial.position, *initial.quaternion, *initial.velocity, *initial.angular_velocity]
            return SimpleNamespace(advance=lambda strides: np.tile(row, (1, len(strides), 1, 1)) + self.shift)

        shift = 0.0

    options = {"settings": choice("engine")}
    engine = replace(ENGINE, integrators=(Integrator("step", options=options, kinds=frozenset()),))
    adapter = Resting("nowhere", RuntimeError(), replace(engine, variants={"flight": ("step:settings=engine",)}))
    monkeypatch.setattr(registry, "load", lambda name: adapter)
    assert check("faulty") == []
    monkeypatch.setattr(Resting, "shift", 1.0)
    assert any("at the start its position is" in fault for fault in check("faulty"))
    monkeypatch.setattr(Resting, "shift", 0.0)
    monkeypatch.setattr(registry, "load", lambda name: Resting("nowhere", RuntimeError(), ENGINE))
    assert any("after 0.1 s its position is" in fault for fault in check("faulty"))


def test_simulate_answers_failures_with_outcomes(miniatures: Path) -> None:
    assert isinstance(simulate(STEADY_SPIN, "raising", "closed-form", 0.1).outcome, Crashed)
    assert isinstance(simulate(STEADY_SPIN, "exploding", "closed-form", 0.1).outcome, Diverged)
    with pytest.raises(ValueError, match="no trajectory to compare, its status is crashed"):
        compare(truth(STEADY_SPIN), simulate(STEADY_SPIN, "raising", "closed-form", 0.1))
    with pytest.raises(registry.EngineMissing, match=r"there is no engine 'nobody'; there are: .*mujoco"):
        simulate(STEADY_SPIN, "nobody", "closed-form")


def test_a_run_without_a_step_is_no_result(miniatures: Path) -> None:
    """Commands refuse such time steps. An engine whose own time step is longer than a short case is asked for one."""
    for timestep in (2.5, 1e9):
        done = run(STEADY_SPIN, "exact", Method.parse("closed-form", timestep))
        assert (done.outcome.status, done.outcome) == ("unsupported", NO_STEP)
    assert isinstance(run(STEADY_SPIN, "exact", Method.parse("closed-form", 1.5)).outcome, Completed)


def test_any_time_step_is_sampled_at_its_own_instants() -> None:
    case = shortened(load("free-brick"), 1.0, 11)
    run = simulate(case, "mujoco", "RK4", 0.03)
    assert isinstance(run.outcome, Completed)
    # Half a time step, and rounding.
    assert np.abs(run.outcome.trajectory.t - case.instants).max() <= 0.015 + 1e-12
    # At the wrong instants, up to 15 ms off, it would be wrong by some tenths of a radian.
    assert compare(truth(case), run).maxima()["attitude_error"] < 1e-4
    coarse = simulate(case, "mujoco", "RK4", 0.4).outcome
    assert isinstance(coarse, Completed)
    np.testing.assert_allclose(coarse.trajectory.t, [0.0, 0.4, 0.8])


BRICK = load("resting-brick").scene
AT_REST = BRICK.initial


@pytest.mark.parametrize(
    ("initial", "surroundings", "status"),
    [
        (State(), {}, "ok"),
        (State(), {"gravity": 9.81}, "diverged"),
        (AT_REST, {"gravity": 9.81, "plane": BRICK.plane}, "ok"),
        (replace(AT_REST, velocity=(1.0, 0.0, 0.0)), {"gravity": 9.81, "plane": BRICK.plane}, "diverged"),
        (State(velocity=(0.0, 1e-3, 0.0)), {}, "diverged"),
        (State(velocity=(0.0, 1e-3, 0.0)), {"gravity": 9.81, "drag": 1.0}, "diverged"),
        (State(angular_velocity=(0.0, 0.0, 1e-2)), {}, "diverged"),
        # Two whole turns from sample to sample, after which a quaternion is the same again: nothing can be told.
        (State(angular_velocity=(0.0, 0.0, 40 * np.pi)), {}, "ok"),
        # 0.1 nm in a step, a kilometre away: single precision could not tell.
        (State(position=(1e3, 0.0, 0.0), velocity=(1e-9, 0.0, 0.0)), {}, "ok"),
    ],
)
def test_what_stands_still_is_frozen_only_where_it_ought_to_move(
    miniatures: Path, initial: State, surroundings: dict[str, Any], status: str
) -> None:
    case = replace(STEADY_SPIN, scene=Scene(BRICK.body, initial, **surroundings))
    assert simulate(case, "frozen", "closed-form", 0.1).outcome.status == status


@pytest.mark.parametrize("engine", ["mujoco", "pinocchio"])
def test_bodies_at_rest_and_spheres_that_spin_are_not_frozen(engine: str) -> None:
    sphere = load("projectile").scene.body
    for scene in (Scene(sphere, State()), Scene(sphere, State(angular_velocity=(0.0, 0.0, 5.0))), BRICK):
        for integrator in offers.offered(registry.load(engine).engine, scene):
            assert simulate(replace(STEADY_SPIN, scene=scene), engine, integrator, 0.1).outcome.status == "ok"


@pytest.mark.parametrize(
    ("timestep", "words"),
    [(0.0, "time step 0 s: must be positive"), (-1.0, "time step -1 s"), (math.nan, "time step nan s"), (7.0, "at most its")],
)
def test_a_time_step_that_is_not_possible_is_refused_as_on_the_command_line(timestep: float, words: str) -> None:
    with pytest.raises(BadInput, match=words) as raised:
        simulate(STEADY_SPIN, "mujoco", "Euler", timestep)
    with pytest.raises(BadInput, match=re.escape(str(raised.value))):
        plan([STEADY_SPIN], {"mujoco": registry.load("mujoco").engine}, ["Euler"], [timestep])


@pytest.mark.parametrize(
    ("times", "words"),
    [
        ([0.0, -1.0], "instants must be finite and at least 0 s"),
        ([0.0, math.inf], "instants must be finite and at least 0 s"),
        ([1.0, 0.5], "instants must be in ascending order"),
        ([], "must be a list of at least one"),
        (0.5, "must be a list of at least one"),
    ],
)
def test_instants_that_are_none_are_refused(times: Any, words: str) -> None:
    with pytest.raises(BadInput, match=words):
        truth(STEADY_SPIN, times)


def test_a_name_is_no_case() -> None:
    for call in (lambda: truth("free-brick"), lambda: simulate("free-brick", "mujoco", "Euler")):  # type: ignore[arg-type]
        with pytest.raises(TypeError, match=re.escape("did you mean bodycheck.load('free-brick')?")):
            call()
