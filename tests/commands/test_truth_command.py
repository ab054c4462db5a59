"""The command `bodycheck truth` while a truth takes long: it ends at Ctrl-C and at its limit, with its process."""

import os
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.support.calls import is_running, pids_in
from tests.support.commands import as_process, bodycheck

#: A truth that never ends and hears no signal, in the place of one that takes minutes.
WITHOUT_END = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)  # what a shell starts in the background ignores it
from bodycheck.running import tasks
from tests.support import calls
tasks.answer = calls.truth_without_end
"""

#: Seconds that a busy machine may take to end two processes.
PATIENCE_S = 60.0

Start = Callable[..., subprocess.Popen[str]]


@pytest.fixture
def pids(tmp_path: Path) -> Path:
    """The file for the process in which a truth hangs."""
    return tmp_path / "pids"


@pytest.fixture
def start(pids: Path) -> Start:
    """Starts the command for a truth that never ends."""

    def start(*options: object) -> subprocess.Popen[str]:
        command = as_process("truth", "free-brick", *options, prelude=WITHOUT_END)
        environment = {**os.environ, "PIDS": str(pids)}
        return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)

    return start


def has_ended(process: int) -> bool:
    deadline = time.monotonic() + PATIENCE_S
    while is_running(process) and time.monotonic() < deadline:
        time.sleep(0.01)
    return not is_running(process)


def test_an_interrupted_truth_ends_at_once(start: Start, pids: Path) -> None:
    with start() as command:
        (worker,) = pids_in(pids, 1)
        command.send_signal(signal.SIGINT)
        told = command.communicate(timeout=PATIENCE_S)
    assert (command.returncode, *told) == (130, "", "bodycheck: interrupted\n")
    assert has_ended(worker)


def test_a_truth_that_takes_too_long_is_given_up(start: Start, pids: Path) -> None:
    with start("--limit", 0.5) as command:
        told = command.communicate(timeout=PATIENCE_S)
    message = "free-brick: its truth takes longer than the limit of 0.5 s; --limit sets another\n"
    assert (command.returncode, *told) == (1, "", message)


@pytest.mark.parametrize("limit", ["0", "-1", "nan"])
def test_a_limit_is_positive(limit: str) -> None:
    done = bodycheck("truth", "free-brick", "--limit", limit)
    assert (done.returncode, done.stderr) == (2, f"--limit {limit}: must be greater than 0 s\n")


def test_what_cannot_be_followed_is_one_message(calls_here: None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("bodycheck.reference.sliding.budget.MAX_SLIDE_STEPS", 10)
    done = bodycheck("truth", "curling-brick")
    told = "curling-brick: the reference cannot follow this motion: the slide "
    assert (done.returncode, done.stdout, done.stderr[: len(told)]) == (1, "", told)
    assert done.stderr.count("\n") == 1
