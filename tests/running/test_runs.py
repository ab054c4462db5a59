"""Running, storing and judging, with miniature engines that fail on purpose."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from bodycheck import Case, compare, load, simulate, truth
from bodycheck.adapters import offers, registry
from bodycheck.adapters.method import Method
from bodycheck.casefile.case import parse
from bodycheck.casefile.expectation import Expectation, Limit
from bodycheck.errors import BadInput
from bodycheck.judging import judgement
from bodycheck.reference.scene import Plane, State
from bodycheck.running import campaign, store
from bodycheck.running.outcome import Completed, Crashed, Diverged, Unsupported
from bodycheck.running.plan import Task, plan
from bodycheck.running.smoke import check
from tests.support.cases import shortened

#: A spin about one principal axis, which the miniature engines know exactly.
SPIN = shortened(load("osrf-boxes-simple"), 1.0, 11)

FAILING = {
    "raising": ("crashed", "RuntimeError: the miniature engine gives up"),
    "dying": ("crashed", "its process exited with code 3"),
    "hanging": ("timeout", "stopped after 4 s"),
    "not-a-number": ("diverged", "not a number at t = 0.5 s"),
    "exploding": ("diverged", "times the most possible at t = "),
}


def run_all(
    case: Case, engines: list[str], folder: Path, jobs: int = 2, timesteps: tuple[float, ...] = (0.1,)
) -> store.Results:
    adapters = {name: registry.load(name) for name in engines}
    head = campaign.header(["test"], {name: adapter.engine.version for name, adapter in adapters.items()}, {})
    with campaign.results(plan([case], adapters, (), timesteps), folder, head, jobs, limit=4.0):
        pass
    return store.read(folder)


def test_each_failure_has_its_own_status_and_harms_no_other_run(miniatures: Path, tmp_path: Path) -> None:
    engines = ["exact", *FAILING, "printing", "drifting"]
    results = run_all(SPIN, engines, tmp_path / "out")
    assert results.complete
    table = judgement.table(judgement.judge(results)).set_index("engine")
    assert list(table.index) == engines
    assert list(table.loc[["exact", "printing", "drifting"], "status"]) == ["ok"] * 3
    for engine, (status, reason) in FAILING.items():
        row = table.loc[engine]
        assert (row.status, row.passed) == (status, False)
        assert reason in row.reason
        # A run that is not ok has empty errors, never numbers.
        assert row[list(judgement.COLUMNS[8:])].isna().all()
    assert table.attitude_error["exact"] < 1e-14
    assert table.rotational_energy_drift["exact"] < 1e-15
    # (1 + 1e-3)^2 - 1, for 1 s of one per mille a second.
    assert table.rotational_energy_drift["drifting"] == pytest.approx(2.001e-3, rel=1e-9)
    assert table.angular_momentum_drift["drifting"] == pytest.approx(1e-3, rel=1e-9)


def test_a_wrong_engine_is_measured_and_an_adapter_like_it_is_found_out(miniatures: Path) -> None:
    maxima = compare(truth(SPIN), simulate(SPIN, "wrong", "closed-form", 0.1)).maxima()
    assert maxima["position_error"] == pytest.approx(1.0, abs=1e-12)
    assert maxima["angular_velocity_error"] == pytest.approx(0.5, abs=1e-12)
    assert check("exact") == []
    assert any("its position is" in fault for fault in check("wrong"))
    assert all("RuntimeError" in fault for fault in check("raising"))


def test_simulate_answers_failures_with_outcomes(miniatures: Path) -> None:
    assert isinstance(simulate(SPIN, "raising", "closed-form", 0.1).outcome, Crashed)
    assert isinstance(simulate(SPIN, "exploding", "closed-form", 0.1).outcome, Diverged)
    with pytest.raises(ValueError, match="no trajectory to compare, its status is crashed"):
        compare(truth(SPIN), simulate(SPIN, "raising", "closed-form", 0.1))
    with pytest.raises(registry.EngineMissing, match=r"there is no engine 'nobody'; there are: .*mujoco"):
        simulate(SPIN, "nobody", "closed-form")


def test_the_number_of_processes_changes_nothing(tmp_path: Path) -> None:
    tables = [
        judgement.table(
            judgement.judge(run_all(shortened(load("free-brick"), 1.0, 11), ["mujoco"], tmp_path / str(jobs), jobs))
        )
        for jobs in (1, 3)
    ]
    one, three = (table.drop(columns=["wall_time", "time_per_step", "realtime_factor"]) for table in tables)
    pd.testing.assert_frame_equal(one, three, check_exact=True)


def test_what_is_stored_is_what_was_run_bit_by_bit(tmp_path: Path) -> None:
    case = shortened(load("free-brick"), 1.0, 11)
    results = run_all(case, ["pinocchio"], tmp_path)
    exact = truth(case, np.arange(11) * 0.1)
    stored = results.truth(case.name, 0.1)
    np.testing.assert_array_equal(stored.error, exact.error)
    np.testing.assert_array_equal(stored.position_error, exact.position_error)
    for name in ("model", "reason", "backend", "witnesses"):
        assert getattr(stored, name) == getattr(exact, name)
    for run in results.runs():
        again = simulate(case, run.engine, run.method.name, run.method.timestep)
        for part in ("t", "position", "quaternion", "velocity", "angular_velocity"):
            np.testing.assert_array_equal(getattr(run.outcome.trajectory, part), getattr(again.outcome.trajectory, part))
            np.testing.assert_array_equal(getattr(stored.trajectory, part), getattr(exact.trajectory, part))


def test_results_files_have_the_promised_columns(tmp_path: Path) -> None:
    verdicts = judgement.judge(run_all(shortened(load("free-brick"), 1.0, 11), ["mujoco"], tmp_path))
    judgement.write(verdicts, tmp_path)
    expected = (
        "case, engine, version, integrator, timestep, status, passed, reason, position_error, velocity_error, attitude_error, "
        "angular_velocity_error, energy_drift, rotational_energy_drift, angular_momentum_drift, truth_error, "
        "steps, wall_time, time_per_step, realtime_factor"
    )
    csv, parquet = pd.read_csv(tmp_path / "results.csv"), pd.read_parquet(tmp_path / "results.parquet")
    assert list(csv.columns) == list(parquet.columns) == expected.split(", ")
    np.testing.assert_array_equal(csv.attitude_error, parquet.attitude_error.astype(float))
    assert (parquet.steps == 10).all()


def test_a_folder_without_its_footer_is_an_interrupted_run(tmp_path: Path) -> None:
    run_all(shortened(load("projectile"), 1.0, 11), ["mujoco"], tmp_path)
    records = tmp_path / store.RECORDS
    lines = records.read_text().splitlines(keepends=True)
    records.write_text("".join(lines[:3]))
    results = store.read(tmp_path)
    assert not results.complete
    assert len(judgement.judge(results)) == sum('"run"' in line for line in lines[:3])


def test_a_line_cut_short_is_where_the_run_was_interrupted(tmp_path: Path) -> None:
    run_all(shortened(load("projectile"), 1.0, 11), ["mujoco"], tmp_path)
    records = tmp_path / store.RECORDS
    lines = records.read_text().splitlines(keepends=True)
    records.write_text("".join(lines[:-2]) + lines[-2][:20])
    results = store.read(tmp_path)
    assert not results.complete
    assert len(results.records) == len(lines) - 3


def test_the_name_of_a_method_leads_nowhere_out_of_the_folder(miniatures: Path, tmp_path: Path) -> None:
    """An engine that takes any options completes under whatever name a stranger's case file gives the method."""
    name = "closed-form:note=/../../../../x"
    case = replace(SPIN, expectations=(Expectation("exact", Method.parse(name, 0.1), (Limit("position_error", None, 1.0),)),))
    tasks = plan([case], {"exact": registry.load("exact")}, (), ())
    with campaign.results(tasks, tmp_path / "deep" / "out", campaign.header([], {"exact": "1"}, {}), 1):
        pass
    results = store.read(tmp_path / "deep" / "out")
    assert {run.method.name: run.outcome.status for run in results.runs()}[name] == "ok"
    files = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert len(files) == 1 + 2 + 2  # the records, two truths, two runs
    assert all(path.is_relative_to(results.folder) for path in files)


def test_other_folders_are_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("irreplaceable")
    with pytest.raises(BadInput, match="has other things in it"):
        run_all(SPIN, ["mujoco"], tmp_path)
    assert (tmp_path / "thesis.txt").read_text() == "irreplaceable"
    with pytest.raises(BadInput, match="no readable results"):
        store.read(tmp_path)


def test_earlier_results_are_replaced(tmp_path: Path) -> None:
    run_all(shortened(load("projectile"), 1.0, 11), ["mujoco"], tmp_path)
    results = run_all(shortened(load("free-brick"), 1.0, 11), ["mujoco"], tmp_path)
    assert list(results.cases) == ["free-brick"]
    assert [path.name for path in (tmp_path / store.TRAJECTORIES).iterdir()] == ["free-brick"]


RK4 = Method.parse("RK4", 0.1)


def expecting(case: Case, **limits: float) -> Case:
    return replace(
        case,
        expectations=(
            Expectation("mujoco", Method.parse("RK4", 0.1), tuple(Limit(name, None, limit) for name, limit in limits.items())),
        ),
    )


def judged(case: Case, integrator: str = "RK4") -> judgement.Verdict:
    return judgement.verdict(case, truth(case, np.arange(11) * 0.1), simulate(case, "mujoco", integrator, 0.1))


def test_expectations_are_judged_by_the_largest_value() -> None:
    case = shortened(load("free-brick"), 1.0, 11)
    measured = compare(truth(case), simulate(case, "mujoco", "RK4", 0.1)).maxima()["attitude_error"]
    assert judged(expecting(case, attitude_error=measured)).passed is True
    failed = judged(expecting(case, attitude_error=measured * 0.999, energy_error=1.0))
    assert failed.passed is False
    assert f"attitude_error is {measured:.4g} rad, expected at most" in failed.reason
    assert "energy_error is unknown, expected at most 1; it is not measured in this scene" in failed.reason
    assert judged(expecting(case, attitude_error=measured), "Euler").passed is None


@pytest.mark.parametrize(("expected", "passed"), [(4, True), (2, False)])
def test_an_order_is_expected_of_a_step_its_half_and_its_quarter(tmp_path: Path, expected: float, passed: bool) -> None:
    expectation = f'[[expect]]\nengine = "mujoco"\nintegrator = "RK4"\ntimestep = 0.02\norder = {expected}\n'
    case = parse(load("osrf-boxes-complex").text.partition("[[expect]]")[0] + expectation, "ordered")
    verdicts = judgement.judge(run_all(case, ["mujoco"], tmp_path, timesteps=()))
    asked = {verdict.run.method.timestep: verdict for verdict in verdicts if verdict.run.method.name == "RK4"}
    assert asked.keys() == {0.002, 0.02, 0.01, 0.005}
    assert {step: verdict.passed for step, verdict in asked.items()} == {0.002: None, 0.02: passed, 0.01: None, 0.005: None}
    assert passed or "order is 4" in asked[0.02].reason
    alone = judgement.verdict(case, truth(case, asked[0.02].run.outcome.trajectory.t), asked[0.02].run)
    assert (alone.passed, "finer steps are not there" in alone.reason) == (False, True)


def test_an_expectation_of_a_run_that_is_not_ok_fails() -> None:
    case = expecting(shortened(load("free-brick"), 1.0, 11), attitude_error=1.0)
    unmodelled = replace(case, scene=replace(case.scene, plane=Plane(0.5)))
    run = simulate(unmodelled, "mujoco", "RK4", 0.1)
    verdict = judgement.verdict(unmodelled, Unsupported("the reference does not model contact"), run)
    assert (verdict.passed, verdict.outcome.status) == (False, "unsupported")


def test_a_run_without_a_truth_is_unsupported() -> None:
    case = shortened(load("free-brick"), 1.0, 11)
    verdict = judgement.verdict(case, Unsupported("out of reach"), simulate(case, "mujoco", "RK4", 0.1))
    assert (verdict.passed, verdict.row()["status"], verdict.reason) == (None, "unsupported", "out of reach")
    assert "attitude_error" not in verdict.row()


def test_drifts_of_what_is_zero_are_relative_to_the_kinetic_energy() -> None:
    case = shortened(load("projectile"), 1.0, 11)
    at_rest = replace(case, scene=replace(case.scene, initial=State(), gravity=10.0))
    # From rest at z = 0 the initial energy is 0; after 1 s of fall the kinetic energy is 50 J per kg.
    run = simulate(at_rest, "mujoco", "Euler", 0.1)
    maxima = compare(truth(at_rest), run).maxima()
    position = run.outcome.trajectory.position[-1, 2]
    assert maxima["energy_drift"] == pytest.approx(abs(50 + 10 * position) / 50, rel=1e-12)
    assert maxima["angular_momentum_drift"] == 0
    assert not any(math.isnan(value) for value in maxima.values())


def test_the_plan_is_every_case_engine_integrator_and_step_once() -> None:
    adapters = {name: registry.load(name) for name in ("mujoco", "pinocchio")}
    cases = [shortened(load(name), 1.0, 11) for name in ("free-brick", "projectile")]
    everything = plan(cases, adapters, (), (0.01, 0.02, 0.01))
    integrators = sum(len(offers.offered(adapter.engine, cases[0].scene)) for adapter in adapters.values())
    assert len(everything) == len(set(everything)) == 2 * integrators * 2
    assert {task.method.timestep for task in plan(cases, adapters, (), ())} == {0.002}
    assert {task.engine for task in plan(cases, adapters, ("rk4",), ())} == {"pinocchio"}


def test_what_a_case_expects_is_run_too() -> None:
    method = Method.parse("RK4:model=everything", 0.01)
    expectation = Expectation("mujoco", method, (Limit("position_error", None, 1.0),))
    case = replace(load("projectile"), expectations=(expectation,))
    adapters = {"mujoco": registry.load("mujoco")}
    (task,) = [task for task in plan([case], adapters, (), ()) if task.method.timestep == 0.01]
    assert task == Task(case, "mujoco", method)
    assert not [task for task in plan([case], adapters, ("Euler",), ()) if task.method.timestep == 0.01]


@pytest.mark.parametrize(
    ("spelling", "words"),
    [("RK9", "has no integrator 'RK9'"), ("RK4:cone=elliptc", "read 'elliptc'; allowed: elliptic or pyramidal")],
)
def test_what_a_case_expects_of_a_misspelled_method_is_bad_input(spelling: str, words: str) -> None:
    expectation = Expectation("mujoco", Method.parse(spelling, 0.01), (Limit("position_error", None, 1.0),))
    case = replace(load("projectile"), expectations=(expectation,))
    with pytest.raises(BadInput, match=f"projectile: expect: integrator: .*{words}"):
        plan([case], {"mujoco": registry.load("mujoco")}, (), ())


@pytest.mark.parametrize("timestep", [0.0, -1.0, math.nan, math.inf, 100.0, 1e-12])
def test_time_steps_that_cannot_be_run_are_refused(timestep: float) -> None:
    with pytest.raises(BadInput, match="time step"):
        plan([load("free-brick")], {"mujoco": registry.load("mujoco")}, (), (timestep,))


def test_any_time_step_is_sampled_at_its_own_instants() -> None:
    case = shortened(load("free-brick"), 1.0, 11)
    run = simulate(case, "mujoco", "RK4", 0.03)
    assert isinstance(run.outcome, Completed)
    assert np.abs(run.outcome.trajectory.t - case.instants).max() <= 0.015 + 1e-12
    assert compare(truth(case), run).maxima()["attitude_error"] < 1e-4
    coarse = simulate(case, "mujoco", "RK4", 0.4).outcome
    assert isinstance(coarse, Completed)
    np.testing.assert_allclose(coarse.trajectory.t, [0.0, 0.4, 0.8])


def test_the_header_tells_versions_and_machine(tmp_path: Path) -> None:
    run_all(shortened(load("projectile"), 1.0, 11), ["mujoco"], tmp_path)
    header = json.loads((tmp_path / store.RECORDS).read_text().splitlines()[0])
    assert header["engines"]["mujoco"].count(".") >= 1
    assert header["machine"]["python"]
    assert header["packages"]["numpy"] == np.__version__
