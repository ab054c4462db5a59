"""What stepping costs: methods timed in turn in one process, with the spread of the repeats."""

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

#: Repeats of each timing.
ROUNDS = 9

#: Seconds of stepping in one timing. A longer run is timed from its start for about that long, a shorter one repeatedly.
LONG_ENOUGH = 0.02

MOST_REPEATS = 10


#: From a number of steps to the seconds that they take from the start of the scene.
Timer = Callable[[int], float]


@dataclass(frozen=True)
class Cost:
    """The median of repeats, the least and the most of them: seconds a step, or a ratio of such."""

    median: float
    low: float
    high: float


@dataclass(frozen=True)
class Stretch:
    """Stepping to be timed. steps: those of a run from the start of the scene that is known to complete."""

    scene: Scene
    engine: str
    method: Method
    steps: int


def measure(stretches: Sequence[Stretch], rounds: int = ROUNDS) -> Array:
    """Seconds a step (n, rounds) of each stretch, all timed in turn, so that what disturbs the machine disturbs all alike.

    Set-up is not timed, and every timing begins at the start of the scene. Raises what the engines raise.
    """
    times = np.empty((len(stretches), rounds))
    timers = [_timer(stretch) for stretch in stretches]
    sizes = [_size(timer, stretch.steps) for timer, stretch in zip(timers, stretches, strict=True)]
    for turn in range(rounds):
        # Every other round goes backwards: none always follows the same other one.
        for place in range(len(stretches))[:: 1 if turn % 2 == 0 else -1]:
            steps, repeats = sizes[place]
            times[place, turn] = sum(timers[place](steps) for _ in range(repeats)) / (steps * repeats)
    return times


def summarise(times: Array) -> list[Cost]:
    """The cost of each row of repeats (n, rounds)."""
    columns = np.median(times, axis=1), times.min(axis=1), times.max(axis=1)
    return [Cost(*map(float, row)) for row in zip(*columns, strict=True)]


def _size(timer: Timer, most: int) -> tuple[int, int]:
    """How many steps, and how often, make a timing that is long enough."""
    steps = min(most, 16)
    while (taken := timer(steps)) < LONG_ENOUGH and steps < most:
        steps = min(most, math.ceil(steps * min(16.0, max(1.5, LONG_ENOUGH / taken))))
    return steps, max(1, min(MOST_REPEATS, round(LONG_ENOUGH / taken)))


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
