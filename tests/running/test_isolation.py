"""Engines that segfault, hang, exit or eat memory, and those that lie: each is told of, and none harms another."""

import ctypes
import os
import random
import signal
import subprocess
import sys
import threading
import time
import types
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bodycheck import load, simulate
from bodycheck.adapters import offers, registry
from bodycheck.judging import judgement
from bodycheck.reference.scene import Scene, State
from bodycheck.running import campaign, pool
from bodycheck.running.outcome import Crashed, TimedOut
from bodycheck.running.plan import plan
from tests.support import ROOT
from tests.support.cases import shortened

#: A spin about one principal axis, which the miniature engines know exactly.
SPIN = shortened(load("osrf-boxes-simple"), 1.0, 11)

#: Bytes a call, far less than any machine has: the engine that allocates without end soon comes to it.
MEMORY = 512 << 20

#: Seconds a call; a hundred times what one takes that does not hang, for machines that are busy with other things.
LIMIT = 15.0

STEPS = (0.1, 0.05)
INNOCENT = ("exact", "drifting", "printing", "mujoco")
GUILTY = {
    "segfaulting": ("crashed", "its process died of signal SIGSEGV"),
    "hanging": ("timeout", f"stopped after {LIMIT:g} s"),
    "dying": ("crashed", "its process exited with code 3"),
    "vanishing": ("crashed", "its process exited with code 0"),
    "exiting": ("crashed", "SystemExit: the miniature engine has had enough"),
    "allocating": ("crashed", "it ran out of its memory of 0.5 GiB: Unable to allocate 16.0 MiB"),
    "raising": ("crashed", "RuntimeError: the miniature engine gives up"),
    "shapeless": ("crashed", "ValueError: its states have the shape (11, 12), not (11, 13)"),
    "not-a-number": ("diverged", "not a number at t = 0.5 s"),
    "frozen": ("diverged", "the state never changes although the body moves"),
}
TIMINGS = ["wall_time", "time_per_step", "realtime_factor"]


def study(engines: tuple[str, ...], folder: Path) -> pd.DataFrame:
    """The table of a study in two processes whose tasks were shuffled, so that all share processes with all."""
    adapters = {name: registry.load(name) for name in engines}
    tasks = [task for task in plan([SPIN], adapters, (), STEPS) if task.engine in INNOCENT or task.method.timestep == STEPS[0]]
    random.Random(1).shuffle(tasks)
    head = campaign.header([], {name: adapter.engine.version for name, adapter in adapters.items()}, {})
    with campaign.results(tasks, folder, head, jobs=2, limit=LIMIT, memory=MEMORY) as results:
        table = judgement.table(judgement.judge(results))
    assert len(table) == len(tasks)
    return table.sort_values(["engine", "integrator", "timestep"]).reset_index(drop=True)


def test_engines_that_fail_take_nothing_with_them(miniatures: Path, tmp_path: Path) -> None:
    undisturbed = study(INNOCENT, tmp_path / "innocent")
    table = study((*INNOCENT, *GUILTY), tmp_path / "all")
    innocent = table[table.engine.isin(INNOCENT)].reset_index(drop=True)
    assert list(innocent.reason) == [""] * len(innocent)
    pd.testing.assert_frame_equal(innocent.drop(columns=TIMINGS), undisturbed.drop(columns=TIMINGS), check_exact=True)
    rows = table.set_index("engine")
    for engine, (status, reason) in GUILTY.items():
        row = rows.loc[engine]
        assert (row.status, row.reason[: len(reason)]) == (status, reason)
        assert row[list(judgement.COLUMNS[8:])].isna().all()


def after_the_call(argument: str) -> str:
    """Poison leaves a thread behind that ends the process while it makes the next call."""
    if argument == "poison":
        threading.Timer(0.3, lambda: os._exit(7)).start()
    else:
        time.sleep(1.0)
    return argument


def test_a_call_does_not_pay_for_an_earlier_one_in_its_process() -> None:
    made = list(pool.call_all(after_the_call, ["poison", "bread", "water"], jobs=1, limit=30.0))
    assert sorted(made) == [("bread", "bread"), ("poison", "poison"), ("water", "water")]


KEPT: list[bytearray] = []


def keeping(size: int) -> int:
    KEPT.append(bytearray(size))
    return size


def test_what_a_call_keeps_of_memory_is_not_missing_to_the_next() -> None:
    size = MEMORY * 3 // 5
    assert list(pool.call_all(keeping, [size] * 3, jobs=1, limit=30.0, memory=MEMORY)) == [(size, size)] * 3
    ((_, result),) = pool.call_all(keeping, [2 * MEMORY], jobs=1, limit=30.0, memory=MEMORY)
    assert result == Crashed("it ran out of its memory of 0.5 GiB")


def without_looking(size: int) -> None:
    """What C code does that does not look at what malloc answers."""
    libc = ctypes.CDLL(None)
    libc.malloc.restype = ctypes.c_void_p
    libc.malloc.argtypes = (ctypes.c_size_t,)
    ctypes.memset(libc.malloc(size), 1, size)


def aborting(name: str) -> None:
    os.kill(os.getpid(), getattr(signal, name))


class Treacherous:
    """Can be sent, but not received."""

    def __reduce__(self) -> tuple[Any, ...]:
        return int, ("no number",)


def misbehaving(how: str) -> Any:
    if how == "closes its files":
        os.closerange(3, 256)
    if how == "closes its files and goes on":
        os.closerange(3, 256)
        time.sleep(60)
    if how == "cannot be sent":
        return lambda: None
    if how == "cannot be received":
        return Treacherous()
    if how == "speaks in no encoding":
        raise OSError(os.fsdecode(b"\xff"))
    return how


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
    monkeypatch.setattr(pool, "FAREWELL", 2.0)  # seconds: nobody who closes his pipe ends here
    ((_, result),) = pool.call_all(function, [argument], jobs=1, limit=30.0, memory=MEMORY)
    assert isinstance(result, Crashed)
    assert result.reason.startswith(reason)
    result.reason.encode("utf-8")


def holding_the_interpreter(pids: str) -> None:
    """Hangs in C with the lock of the interpreter held, so that no other thread of the process runs."""
    with open(pids, "a") as file:
        file.write(f"{os.getpid()}\n")
    ctypes.PyDLL(None).sleep(600)


def test_a_call_that_holds_the_interpreter_is_stopped(tmp_path: Path) -> None:
    start = time.monotonic()
    ((_, result),) = pool.call_all(holding_the_interpreter, [str(tmp_path / "pids")], jobs=1, limit=1.0)
    assert result == TimedOut(1.0)
    assert time.monotonic() - start < 30


def is_running(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux kills the children of who was killed")
def test_workers_die_with_their_parent(tmp_path: Path) -> None:
    pids = tmp_path / "pids"
    code = (
        "from bodycheck.running import pool\nfrom tests.running.test_isolation import holding_the_interpreter\n"
        f"list(pool.call_all(holding_the_interpreter, [{str(pids)!r}] * 2, jobs=2, limit=600.0))"
    )
    parent = subprocess.Popen([sys.executable, "-c", code], env=os.environ | {"PYTHONPATH": str(ROOT)})
    workers = wait_for(lambda: [int(pid) for pid in pids.read_text().split()] if pids.exists() else [], 2)
    assert all(map(is_running, workers))
    parent.kill()
    parent.wait()
    deadline = time.monotonic() + 10
    while any(map(is_running, workers)) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not any(map(is_running, workers))


def wait_for(look: Any, count: int) -> list[int]:
    deadline = time.monotonic() + 60
    while len(found := look()) < count:
        assert time.monotonic() < deadline
        time.sleep(0.05)
    return found  # type: ignore[no-any-return]


def test_calls_that_nobody_waits_for_are_stopped(tmp_path: Path) -> None:
    pids = tmp_path / "pids"
    calls = pool.call_all(hanging_or_not, [str(pids), ""], jobs=2, limit=600.0)
    assert next(calls) == ("", None)
    (worker,) = wait_for(lambda: [int(pid) for pid in pids.read_text().split()] if pids.exists() else [], 1)
    calls.close()
    assert not is_running(worker)


def hanging_or_not(pids: str) -> None:
    if pids:
        holding_the_interpreter(pids)


def test_where_no_process_can_be_started_it_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    nowhere = types.ModuleType("only_in_this_process")
    exec("def call(argument): return argument", nowhere.__dict__)
    monkeypatch.setitem(sys.modules, nowhere.__name__, nowhere)
    with pytest.raises(RuntimeError, match="no process can be started: its process exited with code 1"):
        list(pool.call_all(nowhere.call, [1], jobs=1, limit=30.0))


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
    case = replace(SPIN, scene=Scene(BRICK.body, initial, **surroundings))
    assert simulate(case, "frozen", "closed-form", 0.1).outcome.status == status


@pytest.mark.parametrize("engine", ["mujoco", "pinocchio"])
def test_bodies_at_rest_and_spheres_that_spin_are_not_frozen(engine: str) -> None:
    sphere = load("projectile").scene.body
    for scene in (Scene(sphere, State()), Scene(sphere, State(angular_velocity=(0.0, 0.0, 5.0))), BRICK):
        for integrator in offers.offered(registry.load(engine).engine, scene):
            assert simulate(replace(SPIN, scene=scene), engine, integrator, 0.1).outcome.status == "ok"
