"""Results folders: what is stored is what was run, what was interrupted is seen, and nothing else is touched."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from bodycheck import load, simulate, truth
from bodycheck.adapters import registry
from bodycheck.adapters.method import Method
from bodycheck.casefile.expectation import Expectation, Limit
from bodycheck.errors import BadInput
from bodycheck.judging import judgement, result_set
from bodycheck.reference.bounds import NAMES
from bodycheck.results import store, trajectory_files
from bodycheck.running.plan import plan
from tests.support import campaigns
from tests.support.campaigns import run_all
from tests.support.cases import STEADY_SPIN, shortened

BRICK, FLIGHT = (shortened(load(name), 1.0, 11) for name in ("free-brick", "projectile"))


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The results of a flight with MuJoCo."""
    return run_all(FLIGHT, ["mujoco"], tmp_path_factory.mktemp("flight")).folder


@pytest.fixture
def flight(made: Path, tmp_path: Path) -> Path:
    """A copy of these results."""
    return Path(shutil.copytree(made, tmp_path / "flight"))


def test_what_is_stored_is_what_was_run_bit_by_bit(tmp_path: Path) -> None:
    results = run_all(BRICK, ["pinocchio"], tmp_path, jobs=1)
    exact = truth(BRICK, np.arange(11) * 0.1)
    stored = results.truth(BRICK.name, 0.1)
    for name in NAMES:
        np.testing.assert_array_equal(getattr(stored.bounds, name), getattr(exact.bounds, name))
    for name in ("model", "reason", "backend", "witnesses"):
        assert getattr(stored, name) == getattr(exact, name)
    for run in results.runs():
        again = simulate(BRICK, run.engine, run.method.name, run.method.timestep)
        for part in ("t", "position", "quaternion", "velocity", "angular_velocity"):
            np.testing.assert_array_equal(getattr(run.outcome.trajectory, part), getattr(again.outcome.trajectory, part))
            np.testing.assert_array_equal(getattr(stored.trajectory, part), getattr(exact.trajectory, part))


def test_results_files_have_the_promised_columns(tmp_path: Path) -> None:
    result_set.write([result_set.judged(run_all(BRICK, ["mujoco"], tmp_path))], tmp_path)
    expected = (
        "case, engine, version, integrator, timestep, status, passed, reason, position_error, velocity_error, attitude_error, "
        "angular_velocity_error, energy_drift, rotational_energy_drift, angular_momentum_drift, truth_error, "
        "steps, wall_time, time_per_step, realtime_factor, "
        "truth_position_error, truth_velocity_error, truth_angular_velocity_error, truth_energy_error, "
        "truth_angular_momentum_error, quaternion_norm_error, kind, tags, steps_taken, steps_rejected, evaluations, role"
    )
    csv, parquet = pd.read_csv(tmp_path / "results.csv", dtype=str), pd.read_parquet(tmp_path / "results.parquet")
    assert list(csv.columns) == list(parquet.columns) == expected.split(", ")
    # Python reads the nearest number; not every release of pandas does by itself.
    np.testing.assert_array_equal(csv.attitude_error.map(float), parquet.attitude_error.astype(float))
    assert (parquet.steps == 10).all()


def test_a_folder_without_its_footer_is_an_interrupted_run(flight: Path) -> None:
    records = flight / store.RECORDS
    lines = records.read_text().splitlines(keepends=True)
    records.write_text("".join(lines[:3]))
    results = store.read(flight)
    assert not results.complete
    assert len(judgement.judge(results)) == sum('"record": "run"' in line for line in lines[:3])


def test_a_line_cut_short_is_where_the_run_was_interrupted(flight: Path) -> None:
    records = flight / store.RECORDS
    lines = records.read_text().splitlines(keepends=True)
    records.write_text("".join(lines[:-2]) + lines[-2][:20])
    results = store.read(flight)
    assert not results.complete
    assert len(results.records) == len(lines) - 3


def test_the_name_of_a_method_leads_nowhere_out_of_the_folder(miniatures: Path, tmp_path: Path) -> None:
    """An engine that takes any options completes under whatever name a stranger's case file gives the method."""
    name = "closed-form:note=/../../../../x"
    case = replace(
        STEADY_SPIN, expectations=(Expectation("exact", Method.parse(name, 0.1), (Limit("position_error", None, 1.0),)),)
    )
    tasks = plan([case], {"exact": registry.load("exact").engine}, (), ())
    results = campaigns.results(tasks, tmp_path / "deep" / "out")
    assert {run.method.name: run.outcome.status for run in results.runs()}[name] == "ok"
    files = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert len(files) == 1 + 2 + 2  # the records, two truths, two runs
    assert all(path.is_relative_to(results.folder) for path in files)


def test_other_folders_are_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("irreplaceable")
    with pytest.raises(BadInput, match="contains files that are not results"):
        run_all(STEADY_SPIN, ["mujoco"], tmp_path)
    assert (tmp_path / "thesis.txt").read_text() == "irreplaceable"
    with pytest.raises(BadInput, match="no readable results"):
        store.read(tmp_path)


def test_earlier_results_are_replaced(flight: Path) -> None:
    results = run_all(BRICK, ["mujoco"], flight)
    assert list(results.cases) == ["free-brick"]
    assert [path.name for path in (flight / trajectory_files.TRAJECTORIES).iterdir()] == ["free-brick"]


def test_the_header_tells_versions_and_machine(flight: Path) -> None:
    header = json.loads((flight / store.RECORDS).read_text().splitlines()[0])
    assert header["engines"]["mujoco"].count(".") >= 1
    assert header["machine"]["python"]
    assert header["packages"]["numpy"] == np.__version__
