"""Results and baselines of earlier versions, which spelled some methods otherwise and knew fewer bounds, are still read."""

import csv
import math
import re
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from bodycheck import load
from bodycheck.adapters.method import Method
from bodycheck.casefile.case import CaseFaults, parse, parse_stored
from bodycheck.judging import judgement
from bodycheck.judging.baselines import baseline, difference
from bodycheck.results import store, trajectory_files
from bodycheck.results.header import LATER
from bodycheck.results.outcome import NO_STEP
from bodycheck.running.plan import Task
from tests.support import campaigns, journals
from tests.support.commands import call
from tests.support.processes import calls_here

NEW, OLD = "Euler:model=planar", "Euler-planar"

#: The bounds of a truth's own errors that earlier versions stored.
OLD_BOUNDS = ("truth_error", "truth_position_error")

#: The expectations of the shipped case are replaced by one of the method in question.
TEXT = re.sub("samples = .*", "samples = 11", load("sliding-brick").text.partition("[[expect]]")[0])
EXPECT = '[[expect]]\nengine = "mujoco"\nintegrator = "{}"\ntimestep = 0.002\nposition_error = 1.0\n'


@pytest.fixture
def results(tmp_path: Path) -> store.Results:
    """A results folder with one run, as an earlier version wrote it."""
    case = parse(TEXT + EXPECT.format(NEW), "new")
    folder = campaigns.results([Task(case, "mujoco", Method.parse(NEW, 0.002))], tmp_path / "old").folder
    records = folder / store.RECORDS
    lines = journals.records(records)
    for record in lines:
        if record.get("integrator") == NEW:
            record["integrator"] = OLD
        for later in LATER:
            record.pop(later, None)
        for entry in record.get("cases", ()):
            entry["text"] = TEXT + EXPECT.format(OLD)
    journals.write_without_checksums(records, lines)
    (trajectory,) = (folder / trajectory_files.TRAJECTORIES).rglob("mujoco-*")
    trajectory.rename(trajectory.with_name(f"mujoco-{OLD}-0.002s.parquet"))
    return store.read(folder)


def test_an_old_spelling_in_a_case_is_a_fault_with_the_new_one() -> None:
    with pytest.raises(CaseFaults) as refused:
        parse(TEXT + EXPECT.format(OLD), "old")
    (fault,) = refused.value.faults
    assert fault.key == "expect[1].integrator"
    assert f"{OLD!r} is now spelled {NEW!r}" in fault.message
    (expectation,) = parse_stored(TEXT + EXPECT.format(OLD), "old").expectations
    assert expectation.method == Method.parse(NEW, 0.002)


def test_old_results_are_judged_and_reported_under_the_new_spelling(results: store.Results) -> None:
    (verdict,) = judgement.judge(results)
    assert (verdict.run.method.name, verdict.passed) == (NEW, True)
    assert call("report", results.folder) == 0
    table = (results.folder / "results.csv").read_text("utf-8")
    assert NEW in table
    assert OLD not in table


def test_a_stored_run_without_a_step_is_no_result(results: store.Results) -> None:
    """Earlier versions made runs with a time step longer than the case, and said that they had completed."""
    records = results.folder / store.RECORDS
    lines = journals.records(records)
    for record in lines:
        record |= {"steps": 0} if "steps" in record else {}
    journals.write_without_checksums(records, lines)
    (verdict,) = judgement.judge(store.read(results.folder))
    assert (verdict.outcome, verdict.passed) == (NO_STEP, False)
    assert verdict.reason == f"status is unsupported, expected ok; {NO_STEP.reason}"
    assert call("report", results.folder) == 1


def test_old_baselines_are_compared_under_the_new_spelling(results: store.Results, tmp_path: Path) -> None:
    new, old = tmp_path / "new.parquet", tmp_path / "old.parquet"
    with calls_here():
        baseline.save(new, results, judgement.judge(results), 1)
    table = pq.read_table(new)
    column = table.column_names.index("integrator")
    pq.write_table(table.set_column(column, "integrator", [[OLD]]), old)
    assert difference.diff(baseline.read(old), baseline.read(new)).changes == ()


def test_results_without_the_bounds_of_every_figure_are_reported_without_them(results: store.Results) -> None:
    """Earlier versions stored the bounds of attitude and position alone."""
    (path,) = (results.folder / trajectory_files.TRAJECTORIES).rglob("truth-*")
    table = pq.read_table(path)
    kept = [name for name in table.column_names if not name.startswith("truth_") or name in OLD_BOUNDS]
    assert len(kept) < len(table.column_names)
    pq.write_table(table.select(kept), path)
    assert call("report", results.folder) == 0
    (row,) = csv.DictReader((results.folder / "results.csv").read_text("utf-8").splitlines())
    assert [name for name in row if name.startswith("truth_")] == list(OLD_BOUNDS)
    assert all(float(row[name]) >= 0 for name in (*OLD_BOUNDS, "velocity_error", "energy_error"))
    with calls_here():
        allowed = baseline.rows(results, judgement.judge(results), 1)
    assert all(math.isfinite(value) for name, value in allowed[0].items() if name.endswith(baseline.ALLOWANCE))


def test_baselines_without_the_bounds_of_every_figure_are_compared(results: store.Results, tmp_path: Path) -> None:
    new, old = tmp_path / "new.parquet", tmp_path / "old.parquet"
    with calls_here():
        baseline.save(new, results, judgement.judge(results), 1)
    table = pq.read_table(new)
    further = [name for name in table.column_names if name.startswith("truth_") and not name.startswith(OLD_BOUNDS)]
    assert "truth_energy_error" in further
    pq.write_table(table.drop_columns(further), old)
    assert call("diff", old, new) == call("diff", new, old) == 0
    assert difference.diff(baseline.read(old), baseline.read(new)).changes == ()


def test_an_old_spelling_on_the_command_line_names_the_new_one(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(Exception, match=f"'{OLD}' is now spelled '{NEW}'"):
        call("run", "sliding-brick", "--integrator", OLD)
