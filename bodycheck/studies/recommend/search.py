"""Search for the largest time step of a method that keeps a limit: pure functions of the errors that were measured so far.

The answer is the largest measured step such that it and every smaller measured step keep the limit. All steps that the search
proposes have two significant digits. It narrows the bracket until the answer and the smallest step that breaks the limit are
neighbours among these numbers or differ by at most 5 %. The answer is then within 10 % of any larger step that would keep the
limit.

Errors do not always grow with the step. Therefore steps below the answer are also measured, and the errors determine how close
together. Between two measured neighbours, it is assumed that the error rises or falls at most with a power of the step that is
1.5 times the largest power observed below the answer.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

#: Errors by time step (s); infinite for a run that failed.
Errors = Mapping[float, float]

#: Largest ratio of two neighbouring numbers with two significant digits, 11 to 10.
NEIGHBOURS = 1.1

#: Ratio of the smallest step that breaks the limit to the answer, below which the search does not narrow this bracket further.
NEAR = 1.05

#: Ratio of a step at which the method fails to the next, smaller step, and the largest ratio of a next, larger step to the step
#: before.
AFTER_FAILURE, UPWARDS = 4.0, 4.0

#: Smallest ratio of a step to the next smaller step while no step keeps the limit, so that the search does not slow down.
LEAST_DOWNWARDS = 1.5

#: Steps are measured down to the answer divided by this number.
DEPTH = 2.0

#: Ratio of the power of the step that is assumed between measured neighbours to the largest observed power, and the least value
#: that is used for the observed power.
STEEPER, LEAST_STEEPNESS = 1.5, 1.0

#: Order that is assumed of a method whose engine claims none, and the limits to which an observed order is clipped.
UNKNOWN_ORDER, LEAST_ORDER, LARGEST_ORDER = 1.0, 0.5, 12.0

#: The relative error of the last digit of a product or quotient of steps.
ROUNDING = 1e-9

#: Largest number of measured steps of one method.
MOST_STEPS = 60


@dataclass(frozen=True)
class Range:
    """The range of time steps in which the answer for a method is searched for, and the limit that its error should keep.

    Parameters
    ----------
    limit
        The largest allowed error, in the unit of the errors.
    order
        The order that the engine claims for the method; None if it claims none.
    first
        The time step (s) at which the search begins.
    smallest, largest
        The limits of the time step (s), which have two significant digits.
    """

    limit: float
    order: int | None
    first: float
    smallest: float
    largest: float


def answer(errors: Errors, limit: float) -> float | None:
    """Return the largest measured step such that it and all smaller steps keep the limit; None if the smallest does not."""
    kept = None
    for step in sorted(errors):
        if not errors[step] <= limit:
            break
        kept = step
    return kept


def following(errors: Errors, within: Range) -> float | None:
    """Return the step (s) to be measured next; None if the search is done."""
    if not errors:
        return within.first
    if len(errors) >= MOST_STEPS:
        return None
    kept = answer(errors, within.limit)
    if kept is None:
        return _downwards(errors, within)
    broken = min((step for step in errors if step > kept), default=None)
    if broken is None:
        if kept < within.largest:
            return _upwards(errors, kept, within)
    elif (between := _between(errors, kept, broken, within)) is not None:
        return between
    return _below(errors, kept, within)


def rounded_down(step: float) -> float:
    """Return the largest number with two significant digits that is at most a positive number."""
    return _of_rank(_rank(step))


def rounded_up(step: float) -> float:
    """Return the smallest number with two significant digits that is at least a positive number."""
    rank = _rank(step)
    return _of_rank(rank) if _of_rank(rank) == step else _of_rank(rank + 1)


def _of_rank(rank: int) -> float:
    """Return the number of a given rank in the ascending sequence of numbers with two significant digits; 1 has the rank 0."""
    decade, mantissa = divmod(rank, 90)
    return float(f"{mantissa + 10}e{decade - 1}")


def _rank(step: float) -> int:
    """Return the rank (see `_of_rank`) of the largest number with two significant digits that is at most a step."""
    decade = math.floor(math.log10(step))
    rank = 90 * decade + int(step / 10.0 ** (decade - 1)) - 10
    # The logarithm and the quotient may be wrong in their last digit.
    return next(near for near in (rank + 1, rank, rank - 1) if _of_rank(near) <= step)


def _downwards(errors: Errors, within: Range) -> float | None:
    """Return the next step if the smallest measured step does not keep the limit; None if no smaller step is allowed."""
    least = min(errors)
    if least <= within.smallest:
        return None
    ratio = AFTER_FAILURE
    if math.isfinite(errors[least]):
        order = min(_slope(errors, least), _claimed(within))
        ratio = max(LEAST_DOWNWARDS, NEIGHBOURS * (errors[least] / within.limit) ** (1 / order))
    return max(within.smallest, rounded_down(least / ratio))


def _upwards(errors: Errors, kept: float, within: Range) -> float:
    """Return the next step if all measured steps keep the limit. kept: the largest of them."""
    ratio = UPWARDS
    if errors[kept] > 0:
        ratio = max(NEIGHBOURS, min(UPWARDS, NEIGHBOURS * (within.limit / errors[kept]) ** (1 / _claimed(within))))
    return min(within.largest, max(_of_rank(_rank(kept) + 1), rounded_down(kept * ratio)))


def _between(errors: Errors, kept: float, broken: float, within: Range) -> float | None:
    """Return a step between the answer (`kept`) and the smallest step that breaks the limit; None if they are close enough.

    It is the step at which the error is expected to cross the limit, or the geometric mean of both if two measured steps near
    one of them show that this expectation converges slowly.
    """
    low, high = _rank(kept), _rank(rounded_up(broken))
    if high - low <= 1 or broken <= kept * NEAR:
        return None
    width = math.log(broken / kept)
    slow = sum(step > kept * math.exp(-width / 4) for step in errors if step < kept) > 1
    slow |= sum(step < broken * math.exp(width / 4) for step in errors if step > broken) > 1
    expected = math.sqrt(kept * broken) if slow else _crossing(errors, kept, broken, within)
    return _of_rank(min(high - 1, max(low + 1, _rank(expected))))


def _crossing(errors: Errors, kept: float, broken: float, within: Range) -> float:
    """Return the step at which the error is expected to equal the limit."""
    below, above, width = errors[kept], errors[broken], math.log(broken / kept)
    if below <= 0:
        return math.sqrt(kept * broken)
    smaller = max((step for step in errors if step < kept and errors[step] > 0), default=None)
    order = _claimed(within) if smaller is None else max(LEAST_ORDER, _power(errors, smaller, kept))
    if math.isfinite(above):
        order = max(order, math.log(above / below) / width)
    return kept * math.exp(min(width, math.log(within.limit / below) / order))


def _below(errors: Errors, kept: float, within: Range) -> float | None:
    """Return a step below the answer (`kept`) at which the limit might be broken; None if enough such steps were measured."""
    lowest = max(within.smallest, rounded_down(kept / DEPTH))
    if min(errors) > lowest:
        return lowest
    steps = [step for step in sorted(errors) if lowest <= step <= kept]
    steepest = max(LEAST_STEEPNESS, *(abs(_power(errors, *pair)) for pair in pairwise(steps)), 0.0)
    assumed = STEEPER * min(steepest, LARGEST_ORDER)
    for step, larger in reversed(list(pairwise(steps))):
        between, width = _rank(larger) - _rank(step), math.log(larger / step)
        if errors[larger] == 0 or between <= 1 or larger <= step * (NEIGHBOURS + ROUNDING):
            continue
        # Between the two steps the error can rise and then fall. `room` is the logarithm of the ratio by which it may exceed
        # the error at the larger step.
        room, power = math.log(within.limit / errors[larger]), min(_power(errors, step, larger), assumed)
        if (assumed - power) * width / 2 > room:
            apart = max(math.log(NEIGHBOURS), min(width / 2, 2 * room / (assumed - power)))
            return max(_of_rank(_rank(step) + 1), min(_of_rank(_rank(larger) - 1), rounded_up(larger * math.exp(-apart))))
    return None


def _claimed(within: Range) -> float:
    return float(within.order or UNKNOWN_ORDER)


def _slope(errors: Errors, step: float) -> float:
    """Return the order observed between a step and the next larger step with a finite error, clipped to the allowed orders.

    If no order can be observed, return `LARGEST_ORDER`.
    """
    larger = min((other for other in errors if other > step and 0 < errors[other] < math.inf), default=None)
    if larger is None or not errors[step] > 0:
        return LARGEST_ORDER
    return max(LEAST_ORDER, min(LARGEST_ORDER, _power(errors, step, larger)))


def _power(errors: Errors, step: float, larger: float) -> float:
    """Return the power of the step with which the error grows from one step to a larger step; 0 if an error is 0."""
    if errors[step] <= 0 or errors[larger] <= 0:
        return 0.0
    return math.log(errors[larger] / errors[step]) / math.log(larger / step)
