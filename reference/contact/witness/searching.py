"""The first place of a step of an integration at which a condition no longer holds."""

from collections.abc import Callable

import numpy as np

from bodycheck.reference.independent.arithmetic import Wide
from bodycheck.reference.integration.collocation import Step
from bodycheck.reference.witness import WideArray

#: A function of states (n, k) whose values (n,) are positive or zero as long as a motion goes on.
Margin = Callable[[WideArray], WideArray]

#: The number of places of a step at which a margin is examined, and how often the interval around its end is divided again.
PLACES, SEARCHES = 33, 14

#: The part of a step over which the rate of a margin is measured.
EARLIER = 1 / 64


def first_negative(step: Step, margin: Margin) -> Wide | None:
    """The first place of a step at which a margin is negative; None if it never is."""
    low, high = step.start, step.end
    for search in range(SEARCHES):
        places = np.linspace(low, high, PLACES, dtype=Wide)
        negative = np.flatnonzero(margin(step.at(places)) < 0)
        if not len(negative):
            return None if search == 0 else high
        first = int(negative[0])
        low, high = places[max(first - 1, 0)], places[first]
    return Wide(high)


def rate_at(step: Step, margin: Margin, instant: Wide) -> float:
    """The rate at which a margin decreases at an instant of a step; at least the smallest double."""
    width = step.size * Wide(EARLIER)
    before, after = margin(step.at(np.array([instant - width, instant + width])))
    return max(float((before - after) / (2 * width)), float(np.finfo(float).tiny))
