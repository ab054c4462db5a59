"""Measure the share of a simulation's time that is spent in calls of the engine, and not in the Python loop around them."""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from statistics import median
from typing import Any

from bodycheck.adapters.contract import Adapter, Calls

#: Number of pairs of measurements, one without and one with watched calls.
ROUNDS = 5

#: Number of calls of a function that does nothing, from which the time that a wrapper adds to a call is determined.
IDLE_CALLS = 20_000


@dataclass
class Watch:
    """The number of watched calls and the time (s) spent in them."""

    calls: int = 0
    seconds: float = 0.0


def share(adapter: Adapter, seconds: Callable[[], float]) -> float | None:
    """Return the share, from 0 to 1, of a simulation's time that is spent in calls of the engine.

    Each call is timed by a wrapper. The time that the wrapper itself adds to the measured time is subtracted. The result is the
    median of several measurements, each divided by the time of a simulation without wrappers.

    Parameters
    ----------
    adapter
        The adapter of the engine. If it does not name the engine's calls, the result is None.
    seconds
        A function that runs the simulation and returns the time (s) that its steps took.
    """
    if not isinstance(adapter, Calls):
        return None
    unwatched = _time_of_watching()
    shares = []
    for _ in range(ROUNDS):
        whole = seconds()
        with watched(adapter.calls) as watch:
            seconds()
        shares.append((watch.seconds - unwatched * watch.calls) / whole)
    return min(1.0, max(0.0, median(shares)))


@contextmanager
def watched(calls: Sequence[tuple[Any, str]]) -> Iterator[Watch]:
    """Count and time the calls of functions within the context; the provided `Watch` has the sums.

    calls: pairs of a module or a class, and the name of a function in it.
    """
    watch = Watch()
    with ExitStack() as stack:
        for owner, name in calls:
            plain = getattr(owner, name)
            setattr(owner, name, _timed(plain, watch))
            stack.callback(setattr, owner, name, plain)
        yield watch


def _timed(function: Callable[..., Any], watch: Watch) -> Callable[..., Any]:
    clock = time.perf_counter

    def call(*arguments: Any, **options: Any) -> Any:
        start = clock()
        try:
            return function(*arguments, **options)
        finally:
            watch.seconds += clock() - start
            watch.calls += 1

    return call


def _time_of_watching() -> float:
    """Return the time (s) that a wrapper adds to the measured time of one call."""
    watch = Watch()
    idle = _timed(_nothing, watch)
    for _ in range(IDLE_CALLS):
        idle()
    return watch.seconds / watch.calls


def _nothing() -> None:
    pass
