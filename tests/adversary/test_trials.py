"""What makes trials: a failure of any kind is told with the seed that repeats it, and stops no other trial."""

import select
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.adversary import trials


def test_a_trial_that_dies_or_hangs_or_raises_is_a_failure_that_says_its_seed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Four of these trials fail, each in its own way, and those around them are made all the same."""
    hangs = tmp_path / "hangs"
    monkeypatch.setenv("HANGS", str(hangs))

    def patient(read: Any, write: Any, failed: Any, _patience: float) -> Any:
        # Until the trial that hangs does so, however slow the machine.
        while not (ready := select.select(read, write, failed, 0.01))[0] and not hangs.exists():
            continue
        if not ready[0]:
            hangs.unlink()
        return ready

    monkeypatch.setattr(trials, "select", SimpleNamespace(select=patient))
    found = trials.failures("planted:fails_sometimes", 0, 9)
    assert [failure.seed for failure in found] == [1, 3, 5, 7]
    told = ("ZeroDivisionError", "ended with 3", f"no end after {trials.PATIENCE_S:g} s", "something is wrong")
    for failure, what in zip(found, told, strict=True):
        assert what in str(failure)
        assert f"planted:fails_sometimes {failure.seed} 1" in str(failure)
