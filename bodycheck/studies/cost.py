"""Measure what a step of a method costs, with the spread of repeated measurements.

Each engine is timed in a separate process, in the environment where it is installed. The methods of all engines are timed in
turn, so that disturbances of the machine affect all of them equally.
"""

import gc
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Efforts, Method
from bodycheck.adapters.scheduling import computed
from bodycheck.casefile.content import Case
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.trajectory import Array
from bodycheck.running.engines import home
from bodycheck.studies.engine_calls import share

#: Number of repetitions of each measurement.
ROUNDS = 9

#: Duration of one measurement. A longer run is measured for about this time from its start, a shorter one is repeated.
MIN_TIMING_S = 0.02

#: Largest number of repetitions of a short run within one measurement.
MAX_REPEATS = 10


@dataclass(frozen=True)
class Cost:
    """The median, the minimum and the maximum of repeated measurements: times per step (s), or ratios of them."""

    median: float
    low: float
    high: float


@dataclass(frozen=True)
class Stretch:
    """A run whose steps are timed. `steps` is the number of steps from the start that are known to complete.

    With error control, these are largest steps, and all of them are timed, since the engine's own steps differ along the run.
    """

    scene: AnyScene
    engine: str
    method: Method
    steps: int


@dataclass(frozen=True)
class Measured:
    """The measurements of a stretch.

    Attributes
    ----------
    times
        The time per step (s) of each round.
    processor_times
        The processor time per step (s) of all threads together, of each round.
    setup
        The time (s) of the first preparation of the simulation in its process, in which some engines compile code.
    engine_share
        The share, from 0 to 1, of the time that is spent in calls of the engine; the rest is spent in the Python loop around
        them. None if the adapter does not name these calls.
    efforts
        When the efforts of driven joints are computed, as the column of this name has it. Costs include the computation.
    """

    times: Array
    processor_times: Array
    setup: float
    engine_share: float | None
    efforts: Efforts = ""


@dataclass(frozen=True)
class _Size:
    """The numbers of steps and of repetitions of a measurement that lasts long enough, the time (s) of the set-up, and when
    efforts are computed.
    """

    steps: int
    repeats: int
    setup: float
    efforts: Efforts


def measure(stretches: Sequence[Stretch], limit: float, rounds: int = ROUNDS) -> list[Measured | Crashed | TimedOut]:
    """Return the measurements of each stretch, or the failure of the call that prevented them, in the order of the stretches.

    Set-up is not timed with the steps, and every measurement begins at the start of the scene.

    Parameters
    ----------
    stretches
        The runs whose steps are timed.
    limit
        The time limit (s) of one measurement.
    rounds
        The number of measurements of each stretch.
    """
    failed: dict[int, Crashed | TimedOut] = {}
    times, processor_times = np.empty((2, len(stretches), rounds))
    with pool.Workers(_apply, 1, limit, group=lambda call: call[1].engine, home=home, kept=1) as workers:

        def measured(index: int, function: Callable[..., Any], *arguments: object) -> Any:
            """Make a call for a stretch, and return its result; None if this call or an earlier call for the stretch failed."""
            if index in failed:
                return None
            answer = workers.call((function, stretches[index], *arguments))
            if isinstance(answer, Crashed | TimedOut):
                failed[index] = answer
                return None
            return answer

        sizes: list[_Size | None] = [measured(index, _size) for index in range(len(stretches))]
        for turn in range(rounds):
            # Every second round is in reverse order, so that a stretch does not always follow the same other stretch.
            for index in range(len(stretches))[:: 1 if turn % 2 == 0 else -1]:
                if (sample := measured(index, _sample, sizes[index])) is not None:
                    times[index, turn], processor_times[index, turn] = sample
        shares = [measured(index, _engine_share, sizes[index]) for index in range(len(stretches))]
    return [
        failed.get(index)
        or Measured(
            *(times[index], processor_times[index], size.setup if size else 0.0, shares[index]), size.efforts if size else ""
        )
        for index, size in enumerate(sizes)
    ]


def stretch_of(case: Case, engine: str, method: Method, steps: int) -> Stretch:
    """Return the stretch of a whole run with a number of steps of fixed size, or with error control."""
    if method.accuracy is not None:
        steps = max(1, math.floor(case.duration / method.timestep * (1 + 1e-12)))
    return Stretch(case.scene, engine, method, steps)


def summarise(times: Array) -> Cost:
    """Return the median, the minimum and the maximum of repeated measurements (rounds,)."""
    return Cost(float(np.median(times)), float(times.min()), float(times.max()))


def _apply(call: tuple[Any, ...]) -> Any:
    function, *arguments = call
    return function(*arguments)


def _size(stretch: Stretch) -> _Size:
    """Prepare a simulation, and return the numbers of steps and of repetitions for a measurement that lasts long enough.

    A measurement has at most the steps of the stretch.
    """
    start = time.perf_counter()
    simulation = offers.prepare(registry.load(stretch.engine), [stretch.scene], stretch.method)
    setup = time.perf_counter() - start
    steps = min(stretch.steps, 16) if stretch.method.accuracy is None else stretch.steps
    while (taken := _seconds(stretch, steps)[0]) < MIN_TIMING_S and steps < stretch.steps:
        steps = min(stretch.steps, math.ceil(steps * min(16.0, max(1.5, MIN_TIMING_S / taken))))
    return _Size(steps, max(1, min(MAX_REPEATS, round(MIN_TIMING_S / taken))), setup, computed(simulation))


def _sample(stretch: Stretch, size: _Size) -> tuple[float, float]:
    """Return the time and the processor time per step (s) of one measurement."""
    taken = np.sum([_seconds(stretch, size.steps) for _ in range(size.repeats)], axis=0) / (size.steps * size.repeats)
    return float(taken[0]), float(taken[1])


def _engine_share(stretch: Stretch, size: _Size) -> float | None:
    return share(registry.load(stretch.engine), lambda: _seconds(stretch, size.steps)[0])


def _seconds(stretch: Stretch, steps: int) -> tuple[float, float]:
    """Simulate a number of steps from the start of the scene, and return their time and their processor time (s)."""
    simulation = offers.prepare(registry.load(stretch.engine), [stretch.scene], stretch.method)
    strides = np.array([steps], dtype=np.int64)
    gc.disable()
    try:
        processor, start = time.process_time(), time.perf_counter()
        simulation.advance(strides)
        return time.perf_counter() - start, time.process_time() - processor
    finally:
        gc.enable()
