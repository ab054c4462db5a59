"""Estimate the error of a run from runs with smaller time steps: pure functions of the differences between the runs.

The *levels* of a refinement are runs of one scene with one method and the time steps h, h/2, h/4, …, the largest first. If the
error of a level is C h^p, each difference between neighbours is 2^p times as large as the next one. The levels count as
asymptotic if the orders that two consecutive pairs of differences show are at least `LEAST_ORDER` and differ by at most
`MOST_CHANGE`, and no finer level contradicts them. The error of the finest such level, the *reference*, is its last difference
divided by 2^p - 1 (Richardson), and the error of every other level is its difference from the reference plus this error.

An observed order well above the one that the engine claims means that a term of higher order is still the larger one. The error
of the claimed order is hidden behind it, and the interval of such a *loose* reference is wider.

If no levels are asymptotic, as in soft contact, where the differences become small without falling evenly, the finest level is
an *uneven* reference, whose error is taken as `UNEVEN` times the largest of its last differences. Only levels whose difference
from it is at least `CLEAR` times as large have an estimate then.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

#: The least order that counts as convergence, and the largest difference of consecutive orders.
LEAST_ORDER, MOST_CHANGE = 0.6, 0.35

#: The upper end of the interval of an error that is due to rounding, in terms of the differences that rounding makes.
ROUNDED = 10.0

#: The effect of rounding in a run of n steps is that of one rounding at its start times 1 plus this times sqrt(n).
ACCUMULATED = 0.1

#: The fewest levels from which an error is estimated.
FEWEST_LEVELS = 4

#: The part of an estimate that its interval has at least on each side: the differences of a curved error.
LEAST_WIDTH = 0.01

#: The ratio of a difference from a finer level to the one that the estimate expects from which on it contradicts the estimate.
CONTRADICTION = 1.9

#: The excess of an observed order over the claimed one from which on a reference is loose, and the factor of its interval: a
#: hidden error of the claimed order may be as large as the difference allows and have the opposite sign.
EXCESS, LOOSE = 0.5, 2.0

#: A difference that is this part of the next finer one, where errors would fall, shows that both are due to rounding.
RISING = 0.7

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
    kind
        "even" if the levels are asymptotic, "uneven" if they are not, and "rounding" if all differences are due to rounding.
    reason
        Why the levels are not asymptotic, in words.
    loose
        The factor by which the interval of its error is wider than that of other references; 1 if it is not loose.
    borrowed
        Whether the error is the largest over time, and stands for that at one instant, which is at most as large and may have
        another sign.
    """

    level: int
    error: float
    order: float
    kind: Literal["even", "uneven", "rounding"] = "even"
    reason: str = ""
    loose: float = 1.0
    borrowed: bool = False


@dataclass(frozen=True)
class Interval:
    """The estimate of an error, and its interval."""

    estimate: float
    low: float
    high: float


#: The differences between levels by the indices of the coarser and of the finer one.
Differences = Mapping[tuple[int, int], float]


def accumulated(nudge: float, steps: int) -> float:
    """Return the effect of rounding in a run of some steps. nudge: the difference that one rounding at the start makes."""
    return nudge * (1 + ACCUMULATED * math.sqrt(steps))


def before_rounding(differences: Differences, levels: int, nudge: float, steps: int) -> int:
    """Return the number of levels, the coarsest first, whose differences are not due to rounding alone.

    The differences of the finest levels are due to rounding if they no longer fall and are as small as rounding makes them. So
    are those that fall again after they have risen: with more steps, roundings that are alike in all steps add up, and the
    differences between such runs may be of any order.

    Parameters
    ----------
    differences, levels
        The differences between all levels, and their number.
    nudge
        The difference that one rounding at the start makes.
    steps
        The number of steps of the finest run.
    """
    most = min(DEPENDENT * nudge * steps, MOST_ROUNDING)
    neighbours = [differences[index, index + 1] for index in range(levels - 1)]
    for index, (coarse, fine) in enumerate(pairwise(neighbours)):
        if coarse < RISING * fine and max(neighbours[index:]) <= most:
            levels = index + 2
            break
    while levels > 1:
        fine = differences[levels - 2, levels - 1]
        falls = levels > 2 and order(differences[levels - 3, levels - 2], fine) >= LEAST_ORDER
        if fine > most or (falls and fine > nudge):
            break
        levels -= 1
    return levels


def order(coarse: float, fine: float, ratio: float = 2.0) -> float:
    """Return the order that a difference and the next finer one show; infinite if the finer one is zero, nan if both are."""
    if fine == 0:
        return math.inf if coarse > 0 else math.nan
    return math.log(coarse / fine) / math.log(ratio) if coarse > 0 else -math.inf


def reference(
    differences: Differences, levels: int, nudge: float, steps: int, factor: float, claimed: float = math.inf
) -> Reference | str:
    """Return the reference of some levels, or the reason in words why there is none.

    Parameters
    ----------
    differences, levels, nudge, steps
        As those of `before_rounding`.
    factor
        The safety factor of the interval.
    claimed
        The order that the engine claims for the method, above which no order is relied on.
    """
    if levels < FEWEST_LEVELS:
        return f"fewer than {FEWEST_LEVELS} time steps could be compared"
    useful = before_rounding(differences, levels, nudge, steps)
    if useful == 1:
        return Reference(levels - 1, 0.0, math.nan, "rounding")
    for level in range(useful - 1, 1, -1):
        known = _asymptotic(differences, level, useful < levels and level == useful - 1, claimed)
        if known is not None and _agrees(known, differences, useful, nudge):
            return known
    last = [differences[index, index + 1] for index in range(max(0, useful - FEWEST_LEVELS), useful - 1)]
    return Reference(useful - 1, UNEVEN * max(last), math.nan, "uneven", _why(last, useful < levels))


def _agrees(known: Reference, differences: Differences, levels: int, nudge: float) -> bool:
    """Return whether the differences of a reference from finer levels are of the size that its error makes them."""
    most = CONTRADICTION * known.loose
    for finer in range(known.level + 1, levels):
        expected = known.error * (1 - 2.0 ** (-known.order * (finer - known.level)))
        if not expected / most - nudge <= differences[known.level, finer] <= expected * most + nudge:
            return False
    return True


def _asymptotic(differences: Differences, level: int, before_rounding: bool, claimed: float) -> Reference | None:
    """Return a level as the reference; None if the differences above it do not fall as they should.

    Three differences are needed; two are enough for the last level before rounding.
    """
    last = [differences[index, index + 1] for index in range(max(0, level - 3), level)]
    orders = [order(coarse, fine) for coarse, fine in pairwise(last)]
    if len(orders) < 2 and not (before_rounding and orders):
        return None
    if not all(LEAST_ORDER <= one < math.inf for one in orders):
        return None
    if len(orders) == 2 and abs(orders[0] - orders[1]) > MOST_CHANGE * max(1.0, orders[1] / 2):
        return None
    relied = min(orders[-1], claimed)
    hidden = orders[-1] > claimed + EXCESS
    loose = max(LOOSE, (2 ** orders[-1] - 1) / (2**relied - 1)) if hidden else 1.0
    return Reference(level, last[-1] / (2**relied - 1), relied, loose=loose)


def _why(last: Sequence[float], before_rounding: bool) -> str:
    """Return in words how the last differences do not fall as they should."""
    numbers = ", ".join(f"{value:.2g}" for value in last)
    if before_rounding:
        return f"the differences between refinements reach rounding ({numbers}) before they fall evenly"
    return f"the differences between refinements do not fall evenly ({numbers})"


def interval(
    known: Reference, differences: Differences, levels: int, level: int, rounding: float, factor: float
) -> Interval | None:
    """Return the estimate of the error of a level, and its interval; None if the reference is too uneven for it.

    Parameters
    ----------
    known, differences, levels
        The reference, the differences between all levels, and their number.
    level
        The index of the level.
    rounding
        The effect of rounding in its run.
    factor
        The safety factor: the ratio of the ends of the interval of the reference to its estimate.
    """
    if known.kind == "rounding":
        near = [differences[one, one + 1] for one in (level - 1, level) if 0 <= one < levels - 1]
        size = max(rounding, *near)
        largest = max((differences[coarser, level] for coarser in range(level)), default=size)  # errors add up with the steps
        return Interval(max(size, largest), 0.0, max(ROUNDED * size, 2 * largest))
    factor *= known.loose
    apart = differences[min(level, known.level), max(level, known.level)] if level != known.level else 0.0
    if known.kind == "uneven":
        if level > known.level or apart < CLEAR * known.error:
            return None
        width = max(known.error, LEAST_WIDTH * apart)
        return Interval(apart, apart - width, apart + width)
    if known.borrowed:
        finer = max(0, level - known.level)
        return either_way(0.0 if finer else apart, known.error * 2.0 ** (-known.order * finer), rounding, factor)
    if level > known.level:
        smaller = known.error * 2.0 ** (-known.order * (level - known.level))
        rounded = max(rounding, apart - known.error + smaller)
        low = smaller / factor**2 - rounded  # the order below the reference is not observed either
        return Interval(smaller + rounded, max(0.0, low), factor * smaller + ROUNDED * rounded)
    if level >= known.level - 2:
        return around(apart, known.error, rounding, factor)
    return either_way(apart, known.error, rounding, factor)


def either_way(apart: float, error: float, rounding: float, factor: float) -> Interval:
    """Return the interval of the error of a run from its difference to a finer one, whose error may have either sign.

    The parameters are those of `around`.
    """
    width = max(factor * error, LEAST_WIDTH * apart) + rounding
    return Interval(max(apart, error), max(0.0, apart - width), apart + width)


def around(apart: float, error: float, rounding: float, factor: float) -> Interval:
    """Return the interval of the error of a run from its difference to a finer one, whose own error is given.

    Both errors are of one order, so that they add up. rounding: the effect of rounding in the runs.
    """
    estimate = apart + error
    if estimate <= rounding:
        return Interval(rounding, 0.0, ROUNDED * rounding)
    width = max((factor - 1) * error, LEAST_WIDTH * estimate)
    return Interval(estimate, max(0.0, estimate / (1 + width / estimate) - rounding), estimate + width + rounding)
