"""Calls in worker processes: one that segfaults, hangs, exits or eats memory is told of, and harms no other."""

import os
import random
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from bodycheck.processes import channel, pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.processes.interpreter import Interpreter
from tests.support import ROOT
from tests.support.calls import (
    CHANGES,
    aborting,
    changing,
    hanging_or_not,
    holding_the_interpreter,
    is_running,
    keeping,
    leaving_children,
    misbehaving,
    pids_in,
    poisoned,
    prepared_for,
    preparing,
    warning,
    whose_process,
    without_looking,
)

#: Bytes a call, far less than any machine has: what allocates without end soon comes to it.
MEMORY = 512 << 20

#: Seconds a call, which are for machines that are busy with other things: no call here takes a hundredth of it.
LIMIT = 60.0


def results(function: Any, arguments: Sequence[Any], jobs: int = 1, limit: float = LIMIT, **options: Any) -> list[Any]:
    """Return each argument with the result of a call in a worker process, in the order in which the calls finish."""
    with pool.Workers(function, jobs, limit, **options) as workers:
        return list(workers.map(arguments))


def kept(function: Any, jobs: int = 1, limit: float = LIMIT, **options: Any) -> pool.Workers[Any, Any]:
    """Return workers whose processes are kept from call to call."""
    return pool.Workers(function, jobs, limit, kept=1, **options)


def test_a_call_does_not_pay_for_an_earlier_one_in_its_process() -> None:
    made = results(poisoned, ["poison", "bread", "water"])
    assert sorted(made) == [("bread", "bread"), ("poison", "poison"), ("water", "water")]


def test_what_a_call_keeps_of_memory_is_not_missing_to_the_next() -> None:
    size = MEMORY * 3 // 5
    assert results(keeping, [size] * 3, memory=MEMORY) == [(size, size)] * 3
    ((_, result),) = results(keeping, [2 * MEMORY], memory=MEMORY)
    assert result == Crashed("it ran out of its memory of 0.5 GiB")


@pytest.mark.parametrize(
    ("function", "argument", "reason"),
    [
        (without_looking, MEMORY * 2, "its process died of signal SIGSEGV"),
        (aborting, "SIGABRT", "its process died of signal SIGABRT"),
        (aborting, "SIGKILL", "its process died of signal SIGKILL"),
        (misbehaving, "closes its files", "its process exited with code 1"),
        (misbehaving, "closes its files and goes on", "its process closed its pipe"),
        (misbehaving, "writes into all descriptors", "something other than bodycheck wrote into the channel of its process"),
        (misbehaving, "cannot be sent", "AttributeError: "),
        (misbehaving, "cannot be received", "its result cannot be read: ValueError: "),
        (misbehaving, "speaks in no encoding", r"OSError: \udcff"),
    ],
)
def test_a_call_that_goes_wrong_says_how(monkeypatch: pytest.MonkeyPatch, function: Any, argument: Any, reason: str) -> None:
    if argument == "closes its files and goes on":
        monkeypatch.setattr(pool, "SHUTDOWN_TIMEOUT_S", 0.1)  # seconds for an end that does not come
    ((_, result),) = results(function, [argument], memory=MEMORY)
    assert isinstance(result, Crashed)
    assert result.reason.startswith(reason)
    result.reason.encode("utf-8")


def test_a_call_that_holds_the_interpreter_is_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def monotonic() -> float:
        """An hour later once the call has begun, so that it is not stopped before, however slow the machine."""
        return 3600.0 if (tmp_path / "pids").exists() and (tmp_path / "pids").read_text() else 0.0

    monkeypatch.setattr(pool, "time", SimpleNamespace(monotonic=monotonic, sleep=time.sleep))
    ((_, result),) = results(holding_the_interpreter, [str(tmp_path / "pids")], jobs=1, limit=1.0)
    assert result == TimedOut(1.0)
    (worker,) = pids_in(tmp_path / "pids", 1)
    assert not is_running(worker)


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux kills the children of who was killed")
@pytest.mark.parametrize(("what", "count"), [("holding_the_interpreter", 2), ("partial(leaving_children, 'hangs')", 4)])
def test_workers_and_what_they_start_die_with_their_parent(tmp_path: Path, what: str, count: int) -> None:
    pids = tmp_path / "pids"
    code = (
        "from functools import partial\nfrom bodycheck.processes import pool\n"
        "from tests.support.calls import holding_the_interpreter, leaving_children\n"
        f"list(pool.Workers({what}, jobs=2, limit=600.0).map([{str(pids)!r}] * 2))"
    )
    parent = subprocess.Popen([sys.executable, "-c", code], env=os.environ | {"PYTHONPATH": str(ROOT)})
    workers = pids_in(pids, count)
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
    with pool.Workers(hanging_or_not, jobs=2, limit=600.0) as workers:
        calls = workers.map([str(pids), ""])
        assert next(calls) == ("", None)
        (worker,) = pids_in(pids, 1)
    assert not is_running(worker)


def test_calls_that_another_thread_cancels_are_stopped(tmp_path: Path) -> None:
    pids, cancelled = tmp_path / "pids", threading.Event()
    with kept(hanging_or_not, limit=600.0, cancelled=cancelled) as workers, ThreadPoolExecutor(1) as threads:
        call = threads.submit(workers.call, str(pids))
        (worker,) = pids_in(pids, 1)
        cancelled.set()
        with pytest.raises(pool.Cancelled):
            call.result()
        assert not is_running(worker)


def test_a_warning_of_an_engine_has_no_control_characters_and_no_commands_to_runners(
    capfd: pytest.CaptureFixture[str],
) -> None:
    assert results(warning, ["one\n::error::two\x1b[2J\r\u202e"]) == [("one\n::error::two\x1b[2J\r\u202e", None)]
    lines = capfd.readouterr().err.splitlines()
    assert lines[0].endswith("UserWarning: one")
    assert lines[1] == ":\\u003aerror::two\\x1b[2J\\r\\u202e"


def test_a_process_is_kept_between_calls_and_replaced_when_it_dies() -> None:
    with kept(whose_process) as workers:
        call = workers.call
        first = call("")
        assert call("") == first != os.getpid()
        assert call("die") == Crashed("its process died of signal SIGSEGV")
        second = call("")
        assert isinstance(second, int)
        assert second != first
        # The thread that the first call leaves behind ends the process in the second: that is made again, in a fresh one.
        poisoned = call("poison")
        assert call("late") not in (poisoned, Crashed("its process exited with code 7"))
    with kept(whose_process, limit=1.0) as workers:
        call = workers.call
        assert call("hang") == TimedOut(1.0)


def test_several_processes_of_a_group_are_kept_from_one_map_to_the_next() -> None:
    with pool.Workers(whose_process, 2, LIMIT, kept=2, group=lambda name: name[0]) as workers:
        first, other, again = ({pid for _, pid in workers.map([f"{group}{n}" for n in range(8)])} for group in "aba")
    # A process may take all calls of a map before the other one has started.
    assert first & again
    assert len(first | again) <= 2
    assert not (first | again) & other


def test_calls_without_a_process_say_why_and_harm_no_others(tmp_path: Path) -> None:
    nowhere = pool.Home(Interpreter(tmp_path / "python"))
    homes = {"n": nowhere, "h": pool.Home()}
    calls = ["n1", "h1", "n2", "h2"]
    found = dict(results(whose_process, calls, group=lambda name: name[0], home=lambda group: homes[group]))
    assert {type(found[name]) for name in ("h1", "h2")} == {int}
    assert found["n1"] == found["n2"]
    assert found["n1"].reason.startswith("its process cannot be started: [Errno 2] No such file")
    with kept(whose_process, home=lambda group: nowhere) as workers:
        call = workers.call
        assert call("n1") == found["n1"]


def test_a_process_is_prepared_for_its_group_once_and_keeps_what_that_changes() -> None:
    def home(group: str) -> pool.Home:
        return pool.Home(prepare=preparing, limit=LIMIT)

    calls = [f"{group} {place}" for place in range(3) for group in ("one", "other", "dies", "raises")]
    found = dict(results(prepared_for, calls, jobs=2, group=lambda name: name.split()[0], home=home))
    for group in ("one", "other"):
        ((prepared, times, _),) = {found[f"{group} {place}"] for place in range(3)}  # the last is the process
        assert (prepared, times) == (group, 1)
    for place in range(3):
        assert found[f"dies {place}"] == Crashed("its process exited with code 9")
        assert found[f"raises {place}"] == Crashed("ValueError: raises")


@pytest.mark.parametrize(
    ("how", "answer"), [("makes a copy of the process", "makes a copy of the process"), ("answers twice", "ghost")]
)
def test_an_answer_is_that_of_its_own_call(how: str, answer: str) -> None:
    calls = [how, "bread", "water"]
    assert dict(results(misbehaving, calls)) == {how: answer, "bread": "bread", "water": "water"}


def test_what_a_call_writes_into_its_channel_harms_no_other_call() -> None:
    calls = ["writes into all descriptors", "bread", "water"]
    made = dict(results(misbehaving, calls))
    assert isinstance(made.pop(calls[0]), Crashed)
    assert made == {"bread": "bread", "water": "water"}


@pytest.mark.parametrize("jobs", [1, 3])
def test_groups_share_no_process(jobs: int) -> None:
    calls = [f"{group}{place}" for place in range(3) for group in "ab"]
    found = dict(results(whose_process, calls, jobs=jobs, group=lambda name: name[0]))
    assert found.keys() == set(calls)
    of_a, of_b = ({pid for name, pid in found.items() if name[0] == group} for group in "ab")
    assert not of_a & of_b
    with kept(whose_process, group=lambda name: name[0]) as workers:
        call = workers.call
        assert call("a1") == call("a2") != call("b1") == call("b2")


def worker_of_a_thread(name: str) -> tuple[object, object, object]:
    """The process that the workers of this thread have before and after a call that kills one, and what became of that call."""
    with kept(whose_process) as workers:
        call = workers.call
        first = call(name)
        assert call(name) == first
        return first, call("die"), call(name)


def test_threads_have_workers_of_their_own_at_the_same_time() -> None:
    with ThreadPoolExecutor(3) as threads:
        found = list(threads.map(worker_of_a_thread, "abc"))
    assert {died for _, died, _ in found} == {Crashed("its process died of signal SIGSEGV")}
    assert len({process for first, _, second in found for process in (first, second)}) == 2 * len(found)


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux finds those that have left the group of their worker")
@pytest.mark.parametrize("how", ["returns", "dies"])
def test_what_a_call_starts_ends_with_its_worker(tmp_path: Path, how: str) -> None:
    results(partial(leaving_children, how), [str(tmp_path / "pids")])
    assert not any(map(is_running, pids_in(tmp_path / "pids", 2)))


def test_a_channel_takes_messages_of_any_size_and_nothing_else() -> None:
    ours, theirs, mark = channel.pair()
    worker = channel.Worker(theirs, mark)
    message = random.Random(1).randbytes(3 << 20)  # more than a socket takes at once
    ours.send(1, message)
    assert ours.busy
    with ThreadPoolExecutor(1) as executor:
        received = executor.submit(worker.receive)
        while not received.done():
            ours.read()
    assert received.result() == (1, message)
    for number in (1, 2):
        worker.send(number, b"answer")
    ours.read()
    assert list(ours.messages()) == [(1, b"answer"), (2, b"answer")]
    theirs.sendall(b"\x00")
    ours.read()
    with pytest.raises(channel.Damaged):
        list(ours.messages())
    worker.close()
    ours.read()
    assert ours.closed
    ours.close()


def test_a_process_that_a_call_has_changed_makes_no_other_call() -> None:
    calls = [*CHANGES, "nothing", "nothing again"]
    found = dict(results(changing, calls))
    assert len({found[what] for what in CHANGES}) == len(CHANGES)
    assert found["nothing"] == found["nothing again"] not in {found[what] for what in CHANGES}


def test_a_process_whose_libraries_have_one_thread_is_kept_after_its_first_other_thread() -> None:
    one_thread = pool.Home(Interpreter(Path(sys.executable), (("OMP_NUM_THREADS", "1"),), apart=False))
    calls = ["thread that ends", "nothing", "nothing again"]
    found = dict(results(changing, calls, home=lambda group: one_thread))
    assert len({found[what] for what in calls}) == 1


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells of threads that Python does not know")
def test_a_process_in_which_a_later_call_leaves_a_thread_makes_no_other_call() -> None:
    calls = ["nothing", "thread in C", "nothing again"]
    found = dict(results(changing, calls))
    assert found["nothing"] == found["thread in C"] != found["nothing again"]
    found = dict(results(changing, calls, home=lambda group: pool.Home(watched=False)))
    assert len(set(found.values())) == 1, "the processes of truths are not watched"


def test_a_kept_process_serves_its_group_and_repeats_what_an_earlier_call_broke() -> None:
    with kept(whose_process, jobs=2, group=lambda name: name[0]) as workers:
        found = dict(workers.map(["a1", "b1", "a2"])) | dict(workers.map(["b2", "a3"]))
        assert found["a1"] == found["a2"] == found["a3"] != found["b1"] == found["b2"]
        assert list(workers.map([])) == []
    with kept(poisoned, jobs=2) as workers:
        assert dict(workers.map(["poison", "bread"])) == {"poison": "poison", "bread": "bread"}
        assert workers.call("water") == "water"
