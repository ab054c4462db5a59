"""Studies that were killed go on where they stopped: nothing is lost, and nothing done twice."""

import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from bodycheck.adapters.method import Method
from bodycheck.judging import frames, judgement
from bodycheck.results import journal, store, trajectory_files
from bodycheck.running import campaign
from bodycheck.running.plan import Task
from tests.support import MINIATURES
from tests.support.campaigns import TIMINGS, header
from tests.support.cases import STEADY_SPIN, a_case, shortened
from tests.support.commands import bodycheck
from tests.support.processes import calls_here

ENGINES = ("exact", "drifting", "not-a-number", "raising")
TASKS = [Task(STEADY_SPIN, engine, Method.parse("closed-form", step)) for step in (0.1, 0.05) for engine in ENGINES]

#: The number of runs that end by an exception of the engine.
CRASHED = sum(task.engine == "raising" for task in TASKS)


#: The runs and their truths, one for each time step.
UNITS = len(TASKS) + len({task.method.timestep for task in TASKS})


@dataclass
class Study:
    """A study in a folder, what its progress told, and the runs that were counted: those done before, and all."""

    folder: Path

    def run(self, tasks: list[Task] = TASKS, **options: Any) -> pd.DataFrame:
        self.done: list[str] = []
        self.already = self.counted = 0
        with calls_here(), campaign.results(tasks, self.folder, header(*ENGINES), progress=self._advance, **options) as results:
            assert results.complete
            table = frames.table(judgement.judge(results))
        return table.drop(columns=TIMINGS)

    def _advance(self, done: str, count: int = 1, /) -> None:
        self.counted += count
        if done:
            self.done.append(done)
        else:
            self.already += count

    @property
    def records(self) -> Path:
        return self.folder / store.RECORDS

    def lines(self) -> list[bytes]:
        return self.records.read_bytes().splitlines(keepends=True)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Path, pd.DataFrame]]:
    """A study that nothing disturbed, and its table."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(MINIATURES)
        study = Study(tmp_path_factory.mktemp("whole") / "out")
        table = study.run()
        assert len(table) == len(TASKS)
        yield study.folder, table


@pytest.fixture
def interrupted(whole: tuple[Path, pd.DataFrame], miniatures: Path, tmp_path: Path) -> Callable[[int], Study]:
    """A copy of that study as it was after so many records and half a further one."""

    def interrupt(count: int) -> Study:
        study = Study(tmp_path / str(count))
        shutil.copytree(whole[0], study.folder)
        lines = study.lines()
        study.records.write_bytes(b"".join(lines[: 1 + count]) + lines[1 + count][:-9])
        return study

    return interrupt


@pytest.mark.parametrize("count", [0, 1, 5, UNITS])
def test_an_interrupted_study_goes_on(
    whole: tuple[Path, pd.DataFrame], interrupted: Callable[[int], Study], capfd: pytest.CaptureFixture[str], count: int
) -> None:
    study = interrupted(count)
    before = measured(study.lines()[: 1 + count])  # what crashed is done again
    kept = len(before) - 1
    pd.testing.assert_frame_equal(study.run(), whole[1], check_exact=True)
    assert (study.counted, len(study.done)) == (len(TASKS), UNITS - kept)
    after = study.lines()
    assert after[: 1 + kept] == before
    assert len(after) == 1 + UNITS + 1
    told = f"bodycheck: resuming the interrupted run in {study.folder}: {study.already} of {len(TASKS)} are done\n"
    assert capfd.readouterr().err.count(told) == (count > 0)


def test_a_complete_study_is_done_anew(interrupted: Callable[[int], Study], whole: tuple[Path, pd.DataFrame]) -> None:
    study = interrupted(3)
    study.run()
    pd.testing.assert_frame_equal(study.run(), whole[1], check_exact=True)
    assert (study.already, len(study.done)) == (0, UNITS)


@pytest.mark.parametrize("difference", ["a task less", "another order", "another case", "another limit"])
def test_other_work_is_begun_anew(interrupted: Callable[[int], Study], difference: str) -> None:
    study = interrupted(5)
    case = shortened(STEADY_SPIN, 0.5, 6)
    tasks: dict[str, list[Task]] = {
        "a task less": TASKS[1:],
        "another order": TASKS[::-1],
        "another case": [Task(case, task.engine, task.method) for task in TASKS],
    }
    chosen = tasks.get(difference, TASKS)
    study.run(chosen, **({"limit": 100.0} if difference == "another limit" else {}))
    assert (study.already, study.counted) == (0, len(chosen))
    assert len(list(study.folder.rglob("*.parquet"))) == sum('"reason"' not in str(line) for line in study.lines()[1:-1])


@pytest.mark.parametrize("damage", ["removed", "cut", "emptied"])
def test_what_has_lost_its_trajectory_is_done_again(
    whole: tuple[Path, pd.DataFrame], interrupted: Callable[[int], Study], damage: str
) -> None:
    study = interrupted(UNITS)
    lost = sorted((study.folder / trajectory_files.TRAJECTORIES).rglob("*.parquet"))[::2]
    for path in lost:
        content = path.read_bytes()
        path.unlink() if damage == "removed" else path.write_bytes(content[: len(content) // 2] if damage == "cut" else b"")
    pd.testing.assert_frame_equal(study.run(), whole[1], check_exact=True)
    assert len(study.done) == len(lost) + CRASHED > 2


def test_what_was_written_and_never_told_of_is_removed(interrupted: Callable[[int], Study]) -> None:
    study = interrupted(2)
    half, untold = (
        study.folder / trajectory_files.TRAJECTORIES / STEADY_SPIN.name / name for name in ("exact.part", "exact.parquet")
    )
    half.write_bytes(b"PAR1")
    untold.write_bytes(b"PAR1")
    study.run()
    assert not half.exists()
    assert not untold.exists()


def test_what_is_made_of_results_belongs_to_the_run(miniatures: Path, tmp_path: Path) -> None:
    """Whoever was killed while the report was being written goes on with the report."""
    with calls_here(), pytest.raises(ZeroDivisionError), campaign.results(TASKS, tmp_path / "out", header(*ENGINES)):
        raise ZeroDivisionError
    assert not store.read(tmp_path / "out").complete
    study = Study(tmp_path / "out")
    study.run()
    assert (study.already, len(study.done)) == (len(TASKS) - CRASHED, CRASHED)
    assert store.read(tmp_path / "out").complete


def test_what_crashed_or_took_too_long_is_done_again_when_the_work_goes_on(miniatures: Path, tmp_path: Path) -> None:
    """The cause may have been what interrupted the work, such as a lack of memory."""
    tasks = [Task(STEADY_SPIN, "exact", Method.parse("closed-form", step)) for step in (0.1, 0.05, 0.025)]
    study = Study(tmp_path / "out")
    study.run(tasks)
    header, *records, _ = [json.loads(line) for line in study.lines()]
    for record, why in zip([one for one in records if one["record"] == "run"], ("crashed", "timeout", ""), strict=True):
        if why:
            lost = {key: record[key] for key in ("record", "place", "case", "engine", "version", "integrator", "timestep")}
            record.clear()
            record.update(lost | {"status": why, "contact_law": None})
            record |= {"limit": 300.0} if why == "timeout" else {"reason": "its process died of signal SIGKILL"}
    truth = next(one for one in records if one["record"] == "truth")
    entries = {key: truth[key] for key in ("record", "case", "timestep")}
    truth.clear()
    truth.update(entries | {"reason": "the reference: it ran out of memory", "limit": None, "crashed": True})
    study.records.write_bytes(
        b"".join(journal._line({k: v for k, v in one.items() if k != "check"}) for one in (header, *records))
    )
    table = study.run(tasks)
    assert list(table.status) == ["ok"] * 3
    assert len(study.done) == 3
    assert b"SIGKILL" not in study.records.read_bytes()


def test_the_command_goes_on_too(calls_here: None, tmp_path: Path) -> None:
    case, out = tmp_path / "short.case.toml", tmp_path / "out"
    case.write_text(a_case("short"))
    command = ("run", case, "--engine", "mujoco", "--out", out)
    assert bodycheck(*command).returncode == 0
    undisturbed = pd.read_csv(out / "results.csv")
    records = out / store.RECORDS
    lines = records.read_bytes().splitlines(keepends=True)
    records.write_bytes(b"".join(lines[:4]))
    # How many processes there are, and in what words it is asked for, changes nothing.
    done = bodycheck(*command, "--jobs", 1)
    assert done.returncode == 0
    assert re.search(
        rf"resuming the interrupted run in {re.escape(str(out))}: \d of {len(undisturbed)} are done\n", done.stderr
    )
    assert "short · " not in done.stderr  # stderr is no terminal: no line a run
    assert "nterrupted" not in (out / "report.md").read_text()
    resumed = pd.read_csv(out / "results.csv")
    pd.testing.assert_frame_equal(resumed.drop(columns=TIMINGS), undisturbed.drop(columns=TIMINGS), check_exact=True)


STUDY = """
import random
import sys
from pathlib import Path
from bodycheck.running import campaign
from bodycheck import load
from bodycheck.adapters import registry
from bodycheck.running.plan import plan
names = sys.argv[2:]
records = {name: registry.load(name).engine for name in names}
steps = (0.1, 0.05, 0.04, 0.02)
tasks = plan([load("osrf-boxes-simple")], records, (), steps)
tasks = [task for task in tasks if task.engine != "segfaulting" or task.method.timestep == steps[0]]
random.Random(1).shuffle(tasks)
head = campaign.header([], records, {})
with campaign.results(tasks, Path(sys.argv[1]), head, jobs=2):
    pass
"""


def rows(folder: Path) -> pd.DataFrame:
    return frames.table(judgement.judge(store.read(folder))).drop(columns=TIMINGS)


def check_records(folder: Path, undisturbed: Path) -> None:
    """That everything was done, and nothing twice."""
    done, expected = (
        sorted(
            (record["record"], record.get("engine", ""), record.get("integrator", ""), record["timestep"])
            for record in journal.read(path / store.RECORDS).records
        )
        for path in (folder, undisturbed)
    )
    assert done == expected
    files, whole_files = (sorted(path.name for path in it.rglob("*") if path.is_file()) for it in (folder, undisturbed))
    assert files == whole_files


#: One is slow enough to be killed, and one kills its process.
FAILING = ("dawdling", "exact", "segfaulting", "not-a-number")


def kill_studies(kills: int, seed: int, tmp_path: Path, engines: tuple[str, ...] = FAILING) -> None:
    """Kill studies at random moments, go on with them and kill them again; hold those that end against an undisturbed one."""
    print(f"seed {seed}")
    chance = random.Random(seed)
    undisturbed = tmp_path / "undisturbed"
    duration = end(undisturbed, engines)
    expected = rows(undisturbed)
    finished, after = 0, []
    folder, there = tmp_path / "0", list[bytes]()
    while len(after) < kills or there:
        took = end(folder, engines, chance.uniform(0, duration) if len(after) < kills else None)
        lines = (folder / store.RECORDS).read_bytes().splitlines(keepends=True)
        # What had been measured is still there, in its place.
        assert measured(lines)[: len(measured(there))] == measured(there)
        if not journal.read(folder / store.RECORDS).complete:
            there = [line for line in lines if line.endswith(b"\n")]
            after.append(len(there) - 1)
        else:  # one that was killed all the same was on its way out
            pd.testing.assert_frame_equal(rows(folder), expected, check_exact=True)
            check_records(folder, undisturbed)
            if took is not None and not there:
                duration = min(duration, took)  # the first study may have found the machine cold
            finished += 1
            folder, there = tmp_path / str(finished), []
    print(f"killed after so many records: {after}; {finished} studies came to their end")


def end(folder: Path, engines: tuple[str, ...], limit: float | None = None) -> float | None:
    """Begin a study, or go on with one. How long (s) it took from its first record to its end; None where it was killed, so
    long (s) after that record.
    """
    environment = os.environ | {"PYTHONPATH": str(MINIATURES)}
    there = max(1, count_lines(folder))
    with subprocess.Popen([sys.executable, "-c", STUDY, folder, *engines], env=environment) as process:
        while count_lines(folder) <= there and process.poll() is None:
            time.sleep(0.001)
        start = time.monotonic()
        try:
            assert process.wait(limit) == 0
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
            return None
        return time.monotonic() - start


def measured(lines: list[bytes]) -> list[bytes]:
    """Return the lines of records of which none is of a process that died or took too long."""
    return [line for line in lines if b'"crashed"' not in line and b'"timeout"' not in line]


def count_lines(folder: Path) -> int:
    records = folder / store.RECORDS
    return records.read_bytes().count(b"\n") if records.exists() else 0


def test_a_study_that_is_killed_comes_to_the_same(tmp_path: Path) -> None:
    kill_studies(1, seed=1, tmp_path=tmp_path)


@pytest.mark.slow
def test_studies_that_are_killed_twenty_times_come_to_the_same(tmp_path: Path) -> None:
    """With real engines too; two minutes: `pytest -m slow tests/running/test_resuming.py`."""
    kill_studies(20, seed=2, tmp_path=tmp_path, engines=(*FAILING, "mujoco", "pinocchio"))
