"""Calls in worker processes: one that segfaults, hangs, exits or eats memory is told of, and harms no other."""

import os
import subprocess
import sys
import time
import types
from pathlib import Path
from typing import Any

import pytest

from bodycheck.running import pool
from bodycheck.running.outcome import Crashed, TimedOut
from tests.support import ROOT
from tests.support.calls import (
    aborting,
    hanging_or_not,
    holding_the_interpreter,
    is_running,
    keeping,
    misbehaving,
    pids_in,
    poisoned,
    whose_process,
    without_looking,
)

#: Bytes a call, far less than any machine has: what allocates without end soon comes to it.
MEMORY = 512 << 20

#: Seconds a call, which are for machines that are busy with other things: no call here takes a hundredth of it.
LIMIT = 60.0


def test_a_call_does_not_pay_for_an_earlier_one_in_its_process() -> None:
    made = list(pool.call_all(poisoned, ["poison", "bread", "water"], jobs=1, limit=LIMIT))
    assert sorted(made) == [("bread", "bread"), ("poison", "poison"), ("water", "water")]


def test_what_a_call_keeps_of_memory_is_not_missing_to_the_next() -> None:
    size = MEMORY * 3 // 5
    assert list(pool.call_all(keeping, [size] * 3, jobs=1, limit=LIMIT, memory=MEMORY)) == [(size, size)] * 3
    ((_, result),) = pool.call_all(keeping, [2 * MEMORY], jobs=1, limit=LIMIT, memory=MEMORY)
    assert result == Crashed("it ran out of its memory of 0.5 GiB")


@pytest.mark.parametrize(
    ("function", "argument", "reason"),
    [
        (without_looking, MEMORY * 2, "its process died of signal SIGSEGV"),
        (aborting, "SIGABRT", "its process died of signal SIGABRT"),
        (aborting, "SIGKILL", "its process died of signal SIGKILL"),
        (misbehaving, "closes its files", "its process exited with code 1"),
        (misbehaving, "closes its files and goes on", "its process closed its pipe"),
        (misbehaving, "cannot be sent", "AttributeError: "),
        (misbehaving, "cannot be received", "its result cannot be read: ValueError: "),
        (misbehaving, "speaks in no encoding", r"OSError: \udcff"),
    ],
)
def test_a_call_that_goes_wrong_says_how(monkeypatch: pytest.MonkeyPatch, function: Any, argument: Any, reason: str) -> None:
    if argument == "closes its files and goes on":
        monkeypatch.setattr(pool, "SHUTDOWN_TIMEOUT_S", 0.1)  # seconds for an end that does not come
    ((_, result),) = pool.call_all(function, [argument], jobs=1, limit=LIMIT, memory=MEMORY)
    assert isinstance(result, Crashed)
    assert result.reason.startswith(reason)
    result.reason.encode("utf-8")


def test_a_call_that_holds_the_interpreter_is_stopped(tmp_path: Path) -> None:
    ((_, result),) = pool.call_all(holding_the_interpreter, [str(tmp_path / "pids")], jobs=1, limit=1.0)
    assert result == TimedOut(1.0)
    (worker,) = pids_in(tmp_path / "pids", 1)
    assert not is_running(worker)


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux kills the children of who was killed")
def test_workers_die_with_their_parent(tmp_path: Path) -> None:
    pids = tmp_path / "pids"
    code = (
        "from bodycheck.running import pool\nfrom tests.support.calls import holding_the_interpreter\n"
        f"list(pool.call_all(holding_the_interpreter, [{str(pids)!r}] * 2, jobs=2, limit=600.0))"
    )
    parent = subprocess.Popen([sys.executable, "-c", code], env=os.environ | {"PYTHONPATH": str(ROOT)})
    workers = pids_in(pids, 2)
    assert all(map(is_running, workers))
    parent.kill()
    parent.wait()
    # They sleep for ten minutes unless they are killed; the minute is for machines that are busy.
    deadline = time.monotonic() + 60
    while any(map(is_running, workers)) and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not any(map(is_running, workers))


def test_calls_that_nobody_waits_for_are_stopped(tmp_path: Path) -> None:
    pids = tmp_path / "pids"
    calls = pool.call_all(hanging_or_not, [str(pids), ""], jobs=2, limit=600.0)
    assert next(calls) == ("", None)
    (worker,) = pids_in(pids, 1)
    calls.close()
    assert not is_running(worker)


def test_a_process_is_kept_between_calls_and_replaced_when_it_dies() -> None:
    with pool.caller(whose_process, limit=LIMIT) as call:
        first = call("")
        assert call("") == first != os.getpid()
        assert call("die") == Crashed("its process died of signal SIGSEGV")
        second = call("")
        assert isinstance(second, int)
        assert second != first
        # The thread that the first call leaves behind ends the process in the second: that is made again, in a fresh one.
        poisoned = call("poison")
        assert call("late") not in (poisoned, Crashed("its process exited with code 7"))
    with pool.caller(whose_process, limit=1.0) as call:
        assert call("hang") == TimedOut(1.0)


def test_where_no_process_can_be_started_it_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    nowhere = types.ModuleType("only_in_this_process")
    exec("def call(argument): return argument", nowhere.__dict__)
    monkeypatch.setitem(sys.modules, nowhere.__name__, nowhere)
    with pytest.raises(RuntimeError, match="no process can be started: its process exited with code 1"):
        list(pool.call_all(nowhere.call, [1], jobs=1, limit=LIMIT))
