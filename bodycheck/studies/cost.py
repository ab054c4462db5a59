"""Measure the time per step of methods, in turn and in one process, with the spread of repeated measurements."""

import gc
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

#: Number of repetitions of each measurement.
ROUNDS = 9

#: Duration of one measurement. A longer run is measured for about this time from its start, a shorter one is repeated.
MIN_TIMING_S = 0.02

#: Largest number of repetitions of a short run within one measurement.
MAX_REPEATS = 10

#: A function that returns the time (s) for a number of steps from the start of the scene.
Timer = Callable[[int], float]


@dataclass(frozen=True)
class Cost:
    """The median, the minimum and the maximum of repeated measurements: times per step (s), or ratios of them."""

    median: float
    low: float
    high: float


@dataclass(frozen=True)
class Stretch:
    """A run whose steps are to be timed. `steps` is the number of steps from the start that are known to complete."""

    scene: Scene
    engine: str
    method: Method
    steps: int


def measure(stretches: Sequence[Stretch], rounds: int = ROUNDS) -> Array:
    """Return the times per step (n, rounds), in s, of n stretches.

    All stretches are measured in turn, so that disturbances of the machine affect all of them equally. Set-up is not timed, and
    every measurement begins at the start of the scene. Exceptions of the engines are passed on.
    """
    times = np.empty((len(stretches), rounds))
    timers = [_timer(stretch) for stretch in stretches]
    sizes = [_size(timer, stretch.steps) for timer, stretch in zip(timers, stretches, strict=True)]
    for turn in range(rounds):
        # Every other round is in reverse order, so that no stretch always follows the same other one.
        for place in range(len(stretches))[:: 1 if turn % 2 == 0 else -1]:
            steps, repeats = sizes[place]
            times[place, turn] = sum(timers[place](steps) for _ in range(repeats)) / (steps * repeats)
    return times


def summarise(times: Array) -> list[Cost]:
    """Return the cost of each row of repeated measurements (n, rounds)."""
    columns = np.median(times, axis=1), times.min(axis=1), times.max(axis=1)
    return [Cost(*map(float, row)) for row in zip(*columns, strict=True)]


def _size(timer: Timer, most: int) -> tuple[int, int]:
    """Return the number of steps, at most `most`, and of repetitions for a measurement of sufficient duration."""
    steps = min(most, 16)
    while (taken := timer(steps)) < MIN_TIMING_S and steps < most:
        steps = min(most, math.ceil(steps * min(16.0, max(1.5, MIN_TIMING_S / taken))))
    return steps, max(1, min(MAX_REPEATS, round(MIN_TIMING_S / taken)))


def _timer(stretch: Stretch) -> Timer:
    adapter = registry.load(stretch.engine)

    def seconds(steps: int) -> float:
        simulation = offers.prepare(adapter, [stretch.scene], stretch.method)
        strides = np.array([steps], dtype=np.int64)
        gc.disable()
        try:
            start = time.perf_counter()
            simulation.advance(strides)
            return time.perf_counter() - start
        finally:
            gc.enable()

    return seconds
