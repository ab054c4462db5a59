"""Batches of the tradeoff study: turned copies of a scene, their errors, and what is told of them."""

import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bodycheck import Case, load, truth
from bodycheck import tradeoff as tradeoff_function
from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method
from bodycheck.commands import saved
from bodycheck.judging import judgement
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.requirements import requirements
from bodycheck.reference.truths import Truth
from bodycheck.results import csv_tables
from bodycheck.results.outcome import Completed, Diverged, Unsupported
from bodycheck.studies import cost
from bodycheck.studies.tradeoff import batch_page, batches
from bodycheck.studies.tradeoff import study as tradeoff
from bodycheck.studies.tradeoff.batches import NOT_TURNED, Batch, errors, turned
from bodycheck.studies.tradeoff.page import present
from bodycheck.studies.tradeoff.rows import ORDERS, RUNS
from tests.support import campaigns
from tests.support.cases import OF_ONE_BODY, TOUCHING, a_case, shortened
from tests.support.commands import bodycheck
from tests.support.processes import calls_here
from tests.support.wording import facts

FLIP = shortened(load("intermediate-axis-flip"), 1.0, 51)


@pytest.fixture(autouse=True)
def _once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each batch is run once: nothing that is said here needs the digits of costs."""
    monkeypatch.setattr(batches, "ENOUGH_S", 0.0)


def truth_of(case: Case) -> Truth:
    found = truth(case)
    assert isinstance(found, Truth)
    return found


def batch(case: Case, engine: str, method: str, scenes: int, timestep: float = 0.01) -> Batch:
    return Batch(case, engine, Method.parse(method, timestep), scenes, truth_of(case).trajectory)


@pytest.mark.parametrize("name", ["football-drag", "free-brick", "curling-brick"])
def test_a_turned_scene_has_the_truth_turned_likewise(name: str) -> None:
    """By the reference itself: of a flight, of one against drag, and of a slide with friction."""
    case = shortened(load(name), 0.5, 6)
    scenes = turned(case.scene, 4)
    truths = [truth_of(replace(case, scene=scene)) for scene in scenes]
    parts = ("position", "quaternion", "velocity", "angular_velocity")
    states = np.array([np.hstack([getattr(one.trajectory, part) for part in parts]) for one in truths])
    position, attitude = errors(states, truths[0].trajectory)
    # A turned start is rounded: some units in the last place of some metres, which the flight does not amplify much.
    assert position.max() < 1e-12
    assert attitude.max() < 1e-12
    assert (position[0] == 0).all()


def test_copies_are_other_scenes_that_require_the_same() -> None:
    for name in set(OF_ONE_BODY) - set(TOUCHING):
        scene = load(name).scene
        first, *copies = turned(scene, 6)
        assert first is scene
        assert all(requirements(copy) == requirements(scene) for copy in copies)
        assert len({copy.initial for copy in copies}) == 5
    assert turned(scene, 3) == turned(scene, 6)[:3]


def test_a_batch_of_bodies_that_touch_is_unsupported_and_says_why() -> None:
    assert batches.run(batch(load("block-rests-on-ramp"), "mujoco", "Euler", 4)).outcome == Unsupported(NOT_TURNED)


@pytest.mark.parametrize("most", [1, 100, batches.MOST_STATES])
def test_errors_are_those_of_each_scene_alone(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """However many states are in memory at a time."""
    monkeypatch.setattr(batches, "MOST_STATES", most)
    ran = batches.run(batch(FLIP, "mujoco", "Euler", 5))
    assert isinstance(ran.outcome, Completed)
    steps = np.diff(np.arange(51) * 2, prepend=0)
    adapter, worst = registry.load("mujoco"), []
    reference = truth_of(FLIP).trajectory
    for scene in turned(FLIP.scene, 5):
        rows = offers.prepare(adapter, [scene], Method.parse("Euler", 0.01)).advance(steps)[0, :, 0]
        own = truth_of(replace(FLIP, scene=scene)).trajectory
        worst.append(float(geodesic_angle(rows[:, 3:7], own.quaternion).max()))
        if scene is FLIP.scene:
            assert np.array_equal(ran.outcome.trajectory.quaternion, rows[:, 3:7])
            assert worst == [pytest.approx(float(geodesic_angle(rows[:, 3:7], reference.quaternion).max()))]
    assert ran.attitude_error == pytest.approx(max(worst), rel=1e-9)  # the roundings of two truths
    assert ran.failed == 0


def test_scenes_that_fail_are_counted_and_leave_the_others(miniatures: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fast(scene: Any, count: int) -> list[Any]:
        copies = turned(scene, count)
        return [
            replace(one, initial=replace(one.initial, velocity=(2e6, 0.0, 0.0))) if k in failing else one
            for k, one in enumerate(copies)
        ]

    monkeypatch.setattr(batches, "turned", fast)
    case = shortened(load("projectile"), 1.0, 11)
    failing = {1, 3}
    ran = batches.run(batch(case, "batching", "euler", 5))
    assert isinstance(ran.outcome, Completed)
    assert ran.failed == 2
    assert ran.position_error == pytest.approx(9.81 * 0.01 / 2, rel=1e-3)  # g t h / 2, for t = 1 s
    failing = {0}
    ran = batches.run(batch(case, "batching", "euler", 3))
    assert ran.outcome == Diverged("it is too fast", "gave up")
    assert ran.failed == 1


def test_a_batch_that_would_take_too_long_is_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(batches, "MOST_S", 0.0)
    monkeypatch.setattr(batches, "MOST_STATES", 20)
    ran = batches.run(batch(FLIP, "mujoco", "Euler", 5))
    assert isinstance(ran.outcome, TimedOut)
    assert ran.times == ()


@dataclass(frozen=True)
class Measured:
    folder: Path
    rows: list[dict[str, Any]]


@pytest.fixture
def measured(tmp_path: Path, miniatures: Path) -> Measured:
    """A study of two engines, of which one steps one scene at a time, with batches."""
    path = tmp_path / "thrown.case.toml"
    path.write_text(a_case("thrown", initial={"velocity": [3.0, 0.0, 4.0]}, scene={"gravity": 9.81}), "utf-8")
    case = load(path)
    engines = campaigns.records("batching", "exact")
    results = campaigns.results(tradeoff.plan([case], engines, (), (0.1, 0.01, 0.002)), tmp_path / "out")
    verdicts = judgement.judge(results)
    with calls_here():
        single = tradeoff.price(results, verdicts, engines)
        planned = batches.plan(results, verdicts, engines, (1, 7), ())
        assert {one.method.timestep for one in planned} == {0.002}
        rows = batches.rows_alike(single, batches.rows(planned, results, engines))
        assert len(batches.plan(results, verdicts, engines, (1, 7), (0.1, 0.01))) == 6
    csv_tables.write(tmp_path / "out", RUNS, rows)
    csv_tables.write(tmp_path / "out", ORDERS, [])
    return Measured(tmp_path / "out", rows)


def test_no_cost_of_a_batch_is_without_its_error(measured: Measured) -> None:
    own = [row for row in measured.rows if row["batch"] is not None]
    assert [(row["engine"], row["batch"]) for row in own] == [("batching", 1), ("batching", 7), ("exact", 1)]
    for row in own:
        assert row["status"] == "ok", row["reason"]
        assert row["time_per_step"] > 0
        assert row["cost"] == pytest.approx(row["time_per_step"] / row["timestep"])
        assert row["wall_time"] == pytest.approx(row["time_per_step"] * row["steps"] * row["batch"])
        assert row["worst_position_error"] >= row["position_error"] * (1 - 1e-9)
        assert (row["device"], row["precision"], row["failed_scenes"]) == ("cpu", "float64", 0)
    assert [list(row) for row in measured.rows] == [list(measured.rows[0])] * len(measured.rows)


def test_a_crash_is_the_status_of_the_batch(monkeypatch: pytest.MonkeyPatch, measured: Measured) -> None:
    results = campaigns.store.read(measured.folder)
    engines = campaigns.records("batching")
    planned = [batch(results.cases["thrown"], "batching", "euler", 4, 0.002)]
    monkeypatch.setattr(batches, "run", lambda one: 1 / 0)
    with calls_here():
        (row,) = batches.rows(planned, results, engines)
    assert row["status"] == Crashed.status
    assert "ZeroDivisionError" in row["reason"]
    assert row["time_per_step"] is row["position_error"] is row["worst_position_error"] is None


def test_the_report_is_written_again_from_the_folder(measured: Measured) -> None:
    results = campaigns.store.read(measured.folder)
    made = present(results.header, measured.rows, [])
    report = saved.read(measured.folder)
    (part,) = report.parts  # type: ignore[union-attr]
    tables = dict(part.tables)
    assert tables["Batches"] == dict(made.parts[0].tables)["Batches"]
    assert [row[5].text for row in tables["Batches"].rows] == ["1", "7", "1"]
    titles = [chart.title for chart in part.charts]
    assert titles[-2:] == ["Time per step and scene in batches", "Position error, the worst of all scenes in batches"]
    drawn = json.dumps(part.charts[-2].specification)
    assert '"scenes": 7' in drawn
    assert ["exact", "one"] in [facts(notice, "exact", "one") for notice in made.notices]
    # The other charts, tables and findings are of single runs alone.
    alone = [row for row in measured.rows if row["batch"] is None]
    assert part.charts[:-2] == present(results.header, alone, []).parts[0].charts


def test_command_and_function_measure_batches(calls_here: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cost, "MIN_TIMING_S", cost.MIN_TIMING_S / 50)
    path = tmp_path / "thrown.case.toml"
    path.write_text(a_case("thrown", initial={"velocity": [3.0, 0.0, 4.0]}, scene={"gravity": 9.81}), "utf-8")
    out, options = tmp_path / "out", ("--engine", "mujoco", "--integrator", "Euler", "--timestep", "0.05")
    done = bodycheck("tradeoff", path, *options, "--batch", "3,1", "--batch", "3", "--out", out)
    assert done.returncode == 0, done.stderr
    assert "the worst of all its turned copies" in done.stdout
    table = pd.read_csv(out / "tradeoff.csv")
    assert table["batch"].fillna(0).tolist() == [0, 1, 3]
    assert "Batches" in (out / "report.md").read_text("utf-8")
    found = tradeoff_function(path, engine="mujoco", integrator="Euler", timestep=0.05, batch=[3, "1"])
    assert [row["batch"] for row in found.rows] == [None, 1, 3]
    worst = [row["worst_position_error"] for row in found.rows]
    np.testing.assert_array_equal(worst[1:], table["worst_position_error"][1:])
    assert found.to_frame().attrs["units"]["worst_position_error"] == "m"


def test_mechanisms_are_named_that_have_no_batches() -> None:
    rows = [{"case": name, "kind": kind} for name, kind in (("top", "turning"), ("chain", "mechanism"), ("chain", "mechanism"))]
    assert facts(batch_page.without(rows), "top", "chain", "no batches") == ["chain", "no batches"]
    assert batch_page.without(rows[:1]) == ""
