"""Estimate the error of a run from runs with smaller time steps: pure functions of the differences between the runs.

The *levels* of a refinement are runs of one scene with one method and the time steps h, h/2, h/4, …, the largest first. If the
error of a level is C h^p, each difference between neighbours is 2^p times as large as the next one. The levels count as
asymptotic if the orders that two consecutive pairs of differences show are at least `LEAST_ORDER` and differ by at most
`MOST_CHANGE`, and no finer level contradicts them. The error of the finest such level, the *reference*, is its last difference
divided by 2^p - 1 (Richardson), and the error of every other level is its difference from the reference plus this error.

If no levels are asymptotic, as in soft contact, where the differences become small without falling evenly, the finest level is
an *uneven* reference, whose error is taken as `UNEVEN` times the largest of its last differences. Only levels whose difference
from it is at least `CLEAR` times as large have an estimate then.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

#: The least order that counts as convergence, and the largest difference of consecutive orders.
LEAST_ORDER, MOST_CHANGE = 0.6, 0.5

#: The fewest levels from which an error is estimated.
FEWEST_LEVELS = 4

#: The part of an estimate that its interval has at least on each side: the differences of a curved error.
LEAST_WIDTH = 0.01

#: The ratio of a difference from a finer level to the one that the estimate allows from which on it contradicts the estimate.
CONTRADICTION = 1.5

#: The error of an uneven reference in terms of its last differences, and the least difference from it, in terms of this error.
UNEVEN, CLEAR = 2.0, 5.0

#: The effect of rounding in a run of n steps is at most this number times n times that of one rounding at its start, and at
#: most the second number (rad, m, or relative): larger differences that do not fall have another cause.
DEPENDENT, MOST_ROUNDING = 10.0, 1e-7


@dataclass(frozen=True)
class Reference:
    """The level from which the errors of all levels are estimated.

    Attributes
    ----------
    level
        Its index among the levels.
    error
        Its own error.
    order
        The order of the differences; nan if it is not known.
    even
        Whether the levels are asymptotic.
    reason
        Why they are not, in words.
    """

    level: int
    error: float
    order: float
    even: bool = True
    reason: str = ""


@dataclass(frozen=True)
class Interval:
    """The estimate of an error, and its interval."""

    estimate: float
    low: float
    high: float


#: The differences between levels by the indices of the coarser and of the finer one.
Differences = Mapping[tuple[int, int], float]


def effect_of_rounding(differences: Differences, levels: int, nudge: float, steps: int) -> float:
    """Return the effect of rounding on the differences between some levels.

    It is that of one rounding, or the size of the finest differences if these no longer fall and may be rounding.

    Parameters
    ----------
    differences, levels
        The differences between all levels, and their number.
    nudge
        The difference that one rounding at the start makes.
    steps
        The number of steps of the finest run.
    """
    effect, most = nudge, min(DEPENDENT * nudge * steps, MOST_ROUNDING)
    for level in range(levels - 2, 0, -1):
        coarse, fine = differences[level - 1, level], differences[level, level + 1]
        if fine > most or order(coarse, fine) >= LEAST_ORDER:
            break
        effect = max(effect, fine)
    return effect


def order(coarse: float, fine: float, ratio: float = 2.0) -> float:
    """Return the order that a difference and the next finer one show; infinite if the finer one is zero, nan if both are."""
    if fine == 0:
        return math.inf if coarse > 0 else math.nan
    return math.log(coarse / fine) / math.log(ratio) if coarse > 0 else -math.inf


def reference(differences: Differences, levels: int, rounding: float, factor: float) -> Reference | str:
    """Return the reference of some levels, or the reason in words why there is none.

    Parameters
    ----------
    differences
        The differences between all levels.
    levels
        The number of levels, the coarsest first.
    rounding
        The effect of rounding on a difference; smaller differences are zero.
    factor
        The safety factor of the interval.
    """
    if levels < FEWEST_LEVELS:
        return f"fewer than {FEWEST_LEVELS} time steps could be compared"
    if all(differences[index, index + 1] <= rounding for index in range(levels - 1)):
        return Reference(levels - 1, 0.0, math.nan)
    for level in range(levels - 1, FEWEST_LEVELS - 2, -1):
        known = _asymptotic(differences, level, rounding)
        if known is not None and _agrees(known, differences, levels, rounding, factor):
            return known
    last = [differences[index, index + 1] for index in range(levels - FEWEST_LEVELS, levels - 1)]
    return Reference(levels - 1, UNEVEN * max(last), math.nan, even=False, reason=_why(last, rounding))


def _agrees(known: Reference, differences: Differences, levels: int, rounding: float, factor: float) -> bool:
    """Return whether the differences of a reference from finer levels are of the size that its error makes them."""
    most = CONTRADICTION * factor
    for finer in range(known.level + 1, levels):
        expected = known.error * (1 - 2.0 ** (-known.order * (finer - known.level)))
        if not expected / most - rounding <= differences[known.level, finer] <= expected * most + rounding:
            return False
    return True


def _asymptotic(differences: Differences, level: int, rounding: float) -> Reference | None:
    """Return a level as the reference; None if the three differences above it do not fall as they should."""
    first, second, third = (differences[index, index + 1] for index in range(level - 3, level))
    if third <= rounding:
        # The last difference is rounding alone: the two before it show the order.
        if second > rounding and order(first, second) >= LEAST_ORDER:
            return Reference(level, rounding, order(first, second))
        return None
    orders = order(first, second), order(second, third)
    if min(orders) < LEAST_ORDER or abs(orders[0] - orders[1]) > MOST_CHANGE:
        return None
    return Reference(level, third / (2 ** orders[1] - 1), orders[1])


def _why(last: Sequence[float], rounding: float) -> str:
    """Return in words how the last differences do not fall as they should."""
    numbers = ", ".join(f"{value:.2g}" for value in last)
    if last[-1] <= rounding:
        return f"the differences between refinements reach rounding ({numbers}) before they fall evenly"
    return f"the differences between refinements do not fall evenly ({numbers})"


def interval(known: Reference, differences: Differences, level: int, rounding: float, factor: float) -> Interval | None:
    """Return the estimate of the error of a level, and its interval; None if the reference is too uneven for it.

    Parameters
    ----------
    known, differences
        The reference, and the differences between all levels.
    level
        The index of the level.
    rounding
        The effect of rounding on the error of the level.
    factor
        The safety factor: the ratio of the ends of the interval of the reference to its estimate.
    """
    if not known.even:
        apart = differences[level, known.level] if level < known.level else 0.0
        if apart < CLEAR * known.error:
            return None
        width = max(known.error, LEAST_WIDTH * apart)
        return Interval(apart, apart - width, apart + width)
    if level > known.level:
        smaller = known.error * 2.0 ** (-known.order * (level - known.level)) if known.error else 0.0
        low = max(0.0, smaller / factor - 2 * rounding)
        return Interval(max(smaller, rounding), low, factor * smaller + 2 * rounding)
    apart = differences[level, known.level] if level < known.level else 0.0
    return around(apart, known.error, rounding, factor)


def around(apart: float, error: float, rounding: float, factor: float) -> Interval:
    """Return the interval of the error of a run from its difference to a finer one, whose own error is given."""
    estimate = apart + error
    if estimate <= rounding:
        return Interval(max(estimate, rounding / 2), 0.0, estimate + 2 * rounding)
    width = max((factor - 1) * error, LEAST_WIDTH * estimate)
    return Interval(estimate, max(0.0, estimate / (1 + width / estimate) - rounding), estimate + width + rounding)
