"""Judging grows with the number of runs and no faster, and keeps no trajectory."""

import gc
import shutil
import weakref
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bodycheck import load, simulate, truth
from bodycheck.adapters import registry
from bodycheck.adapters.method import Method
from bodycheck.casefile.case import parse
from bodycheck.judging import attribution, comparison, discrepancy, judgement
from bodycheck.reference.trajectory import Trajectory
from bodycheck.results import store, trajectory_files
from bodycheck.results.store import Results
from bodycheck.running import campaign
from bodycheck.running.plan import plan
from tests.support import journals
from tests.support.cases import shortened
from tests.support.processes import calls_here
from tests.support.truths import truth_for_runs

ORDERED = '[[expect]]\nengine = "mujoco"\nintegrator = "RK4"\ntimestep = 0.02\norder = 4.0\n'
SLIDING = "spinning-brick"


def written(folder: Path, *names: str, expectation: str = "") -> Results:
    """Results of MuJoCo's methods on shipped cases, cut short, with an expectation."""
    cases = [parse(shortened(load(name), 1.0, 11).text.partition("[[expect]]")[0] + expectation, name) for name in names]
    records = {"mujoco": registry.load("mujoco").engine}
    head = campaign.header(["test"], {"mujoco": records["mujoco"]}, {})
    tasks = plan(cases, records, ("RK4", "Euler"), () if expectation else (0.02,))
    with calls_here(), campaign.results(tasks, folder, head):
        pass
    return store.read(folder)


@pytest.fixture
def reads(monkeypatch: pytest.MonkeyPatch) -> Counter[Path]:
    """How often each trajectory file is read."""
    found: Counter[Path] = Counter()
    read = trajectory_files._columns

    def counted(file: Path, *more: Any) -> Any:
        found[file] += 1
        return read(file, *more)

    monkeypatch.setattr(trajectory_files, "_columns", counted)
    return found


@pytest.fixture
def alive(monkeypatch: pytest.MonkeyPatch) -> "weakref.WeakSet[Trajectory]":
    """The trajectories that were read from files and are still in memory."""
    found: weakref.WeakSet[Trajectory] = weakref.WeakSet()
    made = trajectory_files._trajectory

    def watched(*columns: Any) -> Trajectory:
        trajectory = made(*columns)
        found.add(trajectory)
        return trajectory

    monkeypatch.setattr(trajectory_files, "_trajectory", watched)
    return found


def test_every_file_is_read_once_where_no_order_is_expected(tmp_path: Path, reads: Counter[Path]) -> None:
    results = written(tmp_path, "free-brick", "projectile")
    reads.clear()
    judgement.judge(results)
    assert len(reads) == 2 * (1 + 2), "a truth and two runs of each case"
    assert set(reads.values()) == {1}


def test_finer_runs_are_read_again_only_for_the_run_whose_order_is_expected(tmp_path: Path, reads: Counter[Path]) -> None:
    results = written(tmp_path, "free-brick", expectation=ORDERED)
    reads.clear()
    judgement.judge(results)
    again = {file.name for file, count in reads.items() if count > 1}
    assert again == {f"mujoco-RK4-{timestep}s.parquet" for timestep in (0.02, 0.01, 0.005)}
    assert max(reads.values()) == 2


def test_looking_up_is_not_scanning(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The records are gone through a fixed number of times, however many look-ups there are."""
    results = written(tmp_path, "free-brick")

    class Watched(tuple[Any, ...]):
        passes = 0

        def __iter__(self) -> Iterator[Any]:
            Watched.passes += 1
            return super().__iter__()

    object.__setattr__(results, "records", Watched(results.records))
    (run, *_) = results.runs()
    passes = []
    for look_ups in (1, 100):
        for _ in range(look_ups):
            results.truth(run.case, run.method.timestep)
            assert results.run(run.key) is run
            results.runs()
        passes.append(Watched.passes)
    assert passes[0] == passes[1]


def test_a_run_is_found_by_its_time_step_to_rounding(tmp_path: Path) -> None:
    results = written(tmp_path, "free-brick", expectation=ORDERED)
    keys = [run.key for run in results.runs() if run.method.name == "RK4"]
    assert len(keys) == 4
    for key in keys:
        step = key.method.timestep
        for near in (step, np.nextafter(step, 0), np.nextafter(step, 1)):
            found = results.run(store.RunKey(key.case, key.engine, key.method.at(float(near))))
            assert found is not None
            assert found.key == key
        assert results.run(store.RunKey(key.case, key.engine, key.method.at(step * 1.001))) is None
    assert results.run(store.RunKey("free-brick", "mujoco", Method.parse("implicit", 0.02))) is None


def test_verdicts_keep_no_trajectory(tmp_path: Path, alive: "weakref.WeakSet[Trajectory]") -> None:
    results = written(tmp_path, "free-brick", "projectile", SLIDING)
    verdicts = judgement.judge(results)
    parts = attribution.attribute(results, verdicts)
    gc.collect()
    assert (len(verdicts), bool(parts)) == (6, True)
    assert len(alive) == 0
    one = verdicts[0].run.outcome.trajectory
    assert len(alive) == 1
    del one
    assert len(alive) == 0


def test_judging_integrates_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The truths, and the stops under the laws of the contacts, are stored with the runs."""
    results = written(tmp_path, SLIDING)

    def integrate(*_: Any) -> None:
        raise AssertionError("a truth is computed")

    monkeypatch.setattr("bodycheck.reference.truth.truth", integrate)
    monkeypatch.setattr("bodycheck.reference.truth.truth", integrate)
    assert attribution.attribute(results, judgement.judge(results))
    laws = {law for _, law in results.stops}
    assert laws == {results.cases[SLIDING].scene.plane} | {run.contact_law for run in results.runs()}


def test_results_without_stops_are_attributed_all_the_same(tmp_path: Path) -> None:
    """Those of earlier versions of bodycheck have no such records."""
    results = written(tmp_path / "now", SLIDING)
    shutil.copytree(tmp_path / "now", tmp_path / "before")
    records = tmp_path / "before" / store.RECORDS
    lines = journals.records(records)
    kept = [line for line in lines if line["record"] != "stop"]
    assert len(kept) == len(lines) - 2
    kept[-1]["records"] = len(kept) - 2
    journals.write_without_checksums(records, kept)
    earlier = store.read(tmp_path / "before")
    assert not earlier.stops
    now, before = (attribution.attribute(one, judgement.judge(one)) for one in (results, earlier))
    assert now == before


def test_a_truth_at_other_instants_is_refused_by_judging_and_computed_by_the_public_function() -> None:
    case = shortened(load("free-brick"), 1.0, 11)
    run = simulate(case, "mujoco", "RK4", 0.03)
    with pytest.raises(ValueError, match="not at the instants of the run"):
        discrepancy.compare(truth(case), run)
    exact = discrepancy.compare(truth_for_runs(case, 0.03), run)
    assert comparison.compare(truth(case), run).maxima() == exact.maxima()
