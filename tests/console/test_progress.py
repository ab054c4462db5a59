"""Progress where stderr is no terminal: a line from time to time, not one a run."""

import io
import threading
from contextlib import redirect_stderr

import pytest

from bodycheck.console import progress
from bodycheck.console.progress import Count


def test_a_line_says_how_much_is_done_after_how_long() -> None:
    now = [100.0]
    count = Count("running", 6, lambda: now[0])
    assert count.text == "running: 0 of 6 after 0 s"
    now[0] = 112.4
    count.advance("flip · mujoco Euler 0.002 s")
    assert count.text == "running: 1 of 6 after 12 s, about 62 s left, last flip · mujoco Euler 0.002 s"


def test_the_remaining_time_does_not_count_what_was_done_before() -> None:
    now = [0.0]
    count = Count("running", 6, lambda: now[0])
    count.advance("", 3)
    now[0] = 10.0
    assert count.text == "running: 3 of 6 after 10 s"
    count.advance("a run")
    assert count.text == "running: 4 of 6 after 10 s, about 20 s left, last a run"


def test_a_line_is_printed_at_least_every_5_s() -> None:
    assert progress.INTERVAL_S < 5.0  # the thread that prints may be a little late


def test_runs_print_nothing_by_themselves_and_time_does(monkeypatch: pytest.MonkeyPatch) -> None:
    with redirect_stderr(io.StringIO()) as stream, progress.progress("running", 500) as advance:
        for _ in range(500):
            advance("a run")
    assert stream.getvalue() == ""
    written = threading.Event()

    class Told(io.StringIO):
        def write(self, text: str) -> int:
            written.set()
            return super().write(text)

    monkeypatch.setattr(progress, "INTERVAL_S", 1e-3)
    with redirect_stderr(Told()) as told, progress.progress("running", 500) as advance:
        advance("a run")
        assert written.wait(60)  # long, so that it says nothing of the machine's speed
    assert told.getvalue().startswith("running: ")
    with redirect_stderr(io.StringIO()) as stream, progress.progress("running", 500, quiet=True) as advance:
        advance("a run")
    assert stream.getvalue() == ""
