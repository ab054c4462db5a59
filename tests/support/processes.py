"""Worker processes for the tests that are about processes, and none for the others."""

import contextlib
import pickle
import subprocess
import time
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import pytest

from bodycheck.processes import guard, pool
from bodycheck.processes.failures import crash

#: The time that a worker process has to end by itself.
PATIENCE_S = 2.0


@contextmanager
def calls_here() -> Iterator[None]:
    """Make the calls of `bodycheck.processes.pool` in this process, which has imported and compiled what they need already.

    For runs that neither die nor hang: nothing limits their time or memory. Arguments and results are pickled, as for a pipe.
    """

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pool, "Workers", _Here)
        yield


class _Here(pool.Workers[pool.Argument, pool.Result]):
    """Workers without processes. Modules that are imported meanwhile may name its types, as those of what it stands for."""

    def map(self, arguments: Sequence[Any]) -> Generator[tuple[Any, Any], None, None]:
        for argument in arguments:
            try:
                result = self.function(pickle.loads(pickle.dumps(argument)))
            except Exception as error:  # as a worker process does
                result = crash(error)
            yield argument, pickle.loads(pickle.dumps(result))


def ended_by_itself(worker: "pool._Worker") -> None:
    """End a worker process as the end of its parent would, and kill it only if it makes a call that goes on."""
    worker.channel.close()
    with contextlib.suppress(subprocess.TimeoutExpired):
        worker.process.wait(PATIENCE_S)
    guard.stop(worker.process, pool.SHUTDOWN_TIMEOUT_S)


@dataclass
class Countdown:
    """A clock for `bodycheck.processes.pool` that stands still until so many calls are done.

    With it a call that hangs is stopped when it is the last, and no other one is, however slow the machine. The pool asks for
    the time a few times a second: a limit of seconds is over in seconds, and that of the preparation of a process in a minute.
    """

    left: int
    now: float = 0.0

    def advance(self, done: str, count: int = 1, /) -> None:
        """Count what is done; the progress that campaigns and studies report."""
        self.left -= count

    def monotonic(self) -> float:
        """The time (s): half a second later each time that it is asked for when only one call is left."""
        self.now += 0.5 if self.left <= 0 else 0.0
        return self.now


@contextmanager
def stopped_when_last(calls: int) -> Iterator[Countdown]:
    """A clock for so many calls, one of which hangs."""
    clock = Countdown(calls - 1)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pool, "time", SimpleNamespace(monotonic=clock.monotonic, sleep=time.sleep))
        yield clock
