"""Campaigns with miniature engines that fail on purpose: each failure is told of, and none harms another run."""

import random
import time
from pathlib import Path

import pandas as pd
import pytest

from bodycheck import load
from bodycheck.judging import frames, judgement
from bodycheck.results import journal, store
from bodycheck.results.store import Results
from bodycheck.running.plan import plan
from tests.support import campaigns
from tests.support.campaigns import TIMINGS, records, run_all
from tests.support.cases import STEADY_SPIN, shortened
from tests.support.processes import stopped_when_last

#: Bytes a call, far less than any machine has: the engine that allocates without end soon comes to it.
MEMORY = 512 << 20

#: Seconds a call, by a clock that stands still until only the call that hangs is left.
LIMIT = 15.0

STEPS = (0.1, 0.05)
INNOCENT = ("exact", "drifting", "printing", "forking", "meddling", "mujoco")
AT_FAULT = "the adapter of {} 1.0 is at fault in the case osrf-boxes-simple"

#: These run in this process as they do elsewhere, and the others move as `exact` does.
TAME = ("exact", "drifting", "printing", "mujoco")

#: These end their process, hang in it, or leave it so that it cannot be used again.
DEADLY = {
    "segfaulting": ("crashed", "its process died of signal SIGSEGV"),
    "hanging": ("timeout", f"stopped after {LIMIT:g} s"),
    "dying": ("crashed", "its process exited with code 3"),
    "vanishing": ("crashed", "its process exited with code 0"),
    "exiting": ("crashed", "SystemExit: the miniature engine has had enough"),
    "allocating": ("crashed", "it ran out of its memory of 0.5 GiB: Unable to allocate 16.0 MiB"),
    "scribbling": ("crashed", "something other than bodycheck wrote into the channel of its process"),
    "rounding": ("crashed", "it changed how its process rounds floating-point numbers"),
}

#: These fail in a process that stays as it was.
FAILING = {
    "raising": ("crashed", "RuntimeError: the miniature engine gives up"),
    "shapeless": ("crashed", f"{AT_FAULT.format('shapeless')}: its states have the shape (1, 11, 1, 12), not (1, 11, 1, 13)"),
    "unnormalised": ("crashed", f"{AT_FAULT.format('unnormalised')}: its quaternion has the norm 1.5, not 1, at t = 0.5 s"),
    "not-a-number": ("diverged", "not a number at t = 0.5 s"),
    "exploding": ("diverged", "kinetic energy "),
    "frozen": ("diverged", "the state never changes although the body moves"),
}


def table_of(results: Results) -> pd.DataFrame:
    return frames.table(judgement.judge(results))


def study(engines: tuple[str, ...], folder: Path, jobs: int = 0) -> pd.DataFrame:
    """The table of a study whose tasks were shuffled. jobs: the number of worker processes, 0 for none."""
    everything = plan([STEADY_SPIN], records(*engines), (), STEPS)
    tasks = [task for task in everything if task.engine in INNOCENT or task.method.timestep == STEPS[0]]
    random.Random(1).shuffle(tasks)
    # Only the call that hangs meets its limit; where no call hangs, no call is left for which the clock may go on.
    calls = len(tasks) + len(STEPS) + ("hanging" not in engines)  # a truth for each step too
    with stopped_when_last(calls) as clock:
        # A truth advances the count of runs by none, and is a call all the same.
        each = {"jobs": jobs, "limit": LIMIT, "memory": MEMORY, "progress": lambda done, count=1: clock.advance(done)}
        results = campaigns.results(tasks, folder, **each)
    assert results.complete
    table = table_of(results)
    methods = [(task.engine, task.method.name, task.method.timestep) for task in tasks]
    assert list(zip(table.engine, table.integrator, table.timestep, strict=True)) == methods
    return table.sort_values(["engine", "integrator", "timestep"]).reset_index(drop=True)


def test_engines_that_fail_take_nothing_with_them(miniatures: Path, tmp_path: Path) -> None:
    alone = study(TAME, tmp_path / "innocent")
    others = [alone[alone.engine == "exact"].assign(engine=engine) for engine in INNOCENT if engine not in TAME]
    undisturbed = pd.concat([alone, *others]).sort_values(["engine", "integrator", "timestep"]).reset_index(drop=True)
    table = study((*INNOCENT, *DEADLY), tmp_path / "all", jobs=2)
    innocent = table[table.engine.isin(INNOCENT)].reset_index(drop=True)
    assert list(innocent.reason) == [""] * len(innocent)
    pd.testing.assert_frame_equal(innocent.drop(columns=TIMINGS), undisturbed.drop(columns=TIMINGS), check_exact=True)
    check_failed(table, DEADLY)


def check_failed(table: pd.DataFrame, expected: dict[str, tuple[str, str]]) -> None:
    """That engines have failed with a status and a reason. A run that is not ok has empty errors, never numbers."""
    rows = table.set_index("engine")
    for engine, (status, reason) in expected.items():
        row = rows.loc[engine]
        assert (row.status, row.reason[: len(reason)], row.passed) == (status, reason, False)
        assert row[list(judgement.COLUMNS[8:])].isna().all()


def test_engines_that_fail_have_no_results(miniatures: Path, tmp_path: Path) -> None:
    check_failed(study(tuple(FAILING), tmp_path), FAILING)


@pytest.mark.slow
def test_a_campaign_with_engines_that_fail_takes_no_longer_than_the_limits_of_its_calls(
    miniatures: Path, tmp_path: Path
) -> None:
    """By the clock of the machine, in one process at a time, and what MuJoCo computes is the same in every bit as alone.

    Each run and each truth may take its limit, and nothing else waits. The sum of the limits has room for the starts of
    processes, which are not limited: on an idle machine all calls but the one that hangs take a second or less, and one that
    a busy machine stops at its limit is in the sum as well.
    """
    limit, methods = 5.0, ("mujoco", *DEADLY, *FAILING)
    tasks = plan([STEADY_SPIN], campaigns.records(*methods), (), (STEPS[0],))
    start = time.monotonic()
    results = campaigns.results(tasks, tmp_path / "all", jobs=1, limit=limit, memory=MEMORY)
    taken = time.monotonic() - start
    alone = campaigns.results([task for task in tasks if task.engine == "mujoco"], tmp_path / "alone", jobs=1)
    table, undisturbed = (table_of(each).drop(columns=TIMINGS) for each in (results, alone))
    mujoco = table[table.engine == "mujoco"].reset_index(drop=True)
    pd.testing.assert_frame_equal(mujoco, undisturbed, check_exact=True)
    records = journal.read(tmp_path / "all" / store.RECORDS).records
    stopped = [record for record in records if record.get("status") == "timeout"]
    print(f"{taken:.1f} s for {len(records)} calls, {len(stopped)} of which were stopped after {limit:g} s")
    assert "hanging" in {record["engine"] for record in stopped}
    assert limit * len(stopped) <= taken <= limit * len(records)


def test_engines_whose_error_is_known_are_measured(miniatures: Path, calls_here: None, tmp_path: Path) -> None:
    table = table_of(run_all(STEADY_SPIN, ["exact", "drifting"], tmp_path)).set_index("engine")
    assert table.attitude_error["exact"] < 1e-14
    assert table.rotational_energy_drift["exact"] < 1e-15
    # (1 + 1e-3)^2 - 1, for 1 s of one per mille a second.
    assert table.rotational_energy_drift["drifting"] == pytest.approx(2.001e-3, rel=1e-9)
    assert table.angular_momentum_drift["drifting"] == pytest.approx(1e-3, rel=1e-9)


def test_the_number_of_processes_changes_nothing(tmp_path: Path) -> None:
    """Nor whether there are any, which bears out the tests that make their runs in their own process."""
    case = shortened(load("free-brick"), 1.0, 11)
    none, one, two = (
        table_of(run_all(case, ["mujoco"], tmp_path / str(jobs), jobs=jobs)).drop(columns=TIMINGS) for jobs in (0, 1, 2)
    )
    pd.testing.assert_frame_equal(one, none, check_exact=True)
    pd.testing.assert_frame_equal(one, two, check_exact=True)
