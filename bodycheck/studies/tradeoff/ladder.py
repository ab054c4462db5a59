"""The time steps of a case at which methods are measured."""

import math
from itertools import count

from bodycheck.casefile.case import Case

#: s
LARGEST = 0.02

#: Angle (rad) by which the body may turn in the largest step: with a larger one there is nothing of an order to be seen.
LARGEST_TURN = 0.25

#: Steps of a run with the smallest step, which the Pythonic ones take some seconds for.
MOST_STEPS = 100_000

#: Time steps of a ladder, whatever the number of steps that they take.
FEWEST = 6

MANTISSAS = (5.0, 2.0, 1.0)


def ladder(case: Case) -> tuple[float, ...]:
    """Time steps (s), the largest first: 20, 10, 5, 2, 1 ms and so on where they fit the case, else near these.

    They divide the interval of the case's samples or are its multiples, so that runs with different steps have instants in
    common.
    """
    interval = case.duration / (case.samples - 1)
    spin = math.hypot(*case.scene.initial.angular_velocity)
    largest = min(LARGEST, case.duration / 10, LARGEST_TURN / spin if spin else math.inf)
    steps: list[float] = []
    for decade in count(0):
        for mantissa in MANTISSAS:
            wanted = mantissa * 10.0 ** (math.floor(math.log10(largest)) - decade)
            if wanted > largest * (1 + 1e-9):
                continue
            step = fitted(wanted, interval)
            if case.duration / step > MOST_STEPS * (1 + 1e-9) and len(steps) >= FEWEST:
                return tuple(steps)
            if not steps or step < steps[-1]:
                steps.append(step)
    raise AssertionError("counting does not end")


def fitted(wanted: float, interval: float) -> float:
    """The time step nearest to a wanted one that divides an interval, or is a multiple of it (s)."""
    step = interval / round(interval / wanted) if wanted < interval else interval * round(wanted / interval)
    return float(f"{step:.12g}")
