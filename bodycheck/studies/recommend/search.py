"""Search for the largest time step of a method that keeps a limit: pure functions of the errors that were measured so far.

A time step is the duration divided by an integer, the number of steps of the run, so that all runs end at the same instant.
This module speaks of numbers of steps only: fewer steps are a larger time step.

The search first finds the *bracket*: the fewest measured steps such that they and all larger measured numbers keep the limit,
and the next smaller number, which breaks it. It narrows the bracket until the two numbers are neighbours or differ by at most
5 %. Errors do not always grow with the time step. Therefore larger numbers are also measured, up to twice the one that keeps
the limit, and the errors determine how close together. Between two measured neighbours, it is assumed that the error rises or
falls at most with a power of the time step that is 1.5 times the largest power observed there.

The answer is the fewest steps whose *neighbours* all lie in the bracket's part that keeps the limit: the numbers whose time
step differs by at most 3 %. All neighbours, or `MOST_NEIGHBOURS` of them, are measured; the largest of their errors is what
the answer can be relied on for. The answer is then within some 10 % of the largest time step that keeps the limit, as far as
integers are so close together.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import pairwise

#: Errors by the number of steps; infinite for a run that failed.
Errors = Mapping[int, float]

#: Largest relative difference of the time steps of neighbours from that of the answer.
NEIGHBOURHOOD = 0.03

#: Largest number of neighbours that are measured, with the answer itself.
MOST_NEIGHBOURS = 13

#: Ratio of the bracket's numbers of steps below which it is not narrowed further.
NEAR = 1.05

#: Ratio of time steps that are close enough together below the answer.
CLOSE = 1.1

#: Ratio of a time step at which the method fails to the next, smaller one, and the largest ratio of a next, larger time step to
#: the one before.
AFTER_FAILURE, UPWARDS = 4.0, 4.0

#: Smallest ratio of a time step to the next smaller one while none keeps the limit, so that the search does not slow down.
LEAST_DOWNWARDS = 1.5

#: Time steps are measured down to the largest that keeps the limit, divided by this number.
DEPTH = 2

#: Ratio of the power of the time step that is assumed between measured neighbours to the largest observed power, and the least
#: value that is used for the observed power.
STEEPER, LEAST_STEEPNESS = 1.5, 1.0

#: Order that is assumed of a method whose engine claims none, and the limits to which an observed order is clipped.
UNKNOWN_ORDER, LEAST_ORDER, LARGEST_ORDER = 1.0, 0.5, 12.0

#: Numbers of measured time steps of a method: after the first, only neighbours are measured, and after the second, nothing.
MANY_RUNS, MOST_RUNS = 60, 120

#: Largest ratio of the error with a smaller time step to that with a larger one that counts as monotone, and the part of the
#: limit below which errors are too small to be compared.
MONOTONE, NEGLIGIBLE = 1.1, 0.01


@dataclass(frozen=True)
class Range:
    """The range of numbers of steps in which the answer for a method is searched for, and the limit that its error should keep.

    Parameters
    ----------
    limit
        The largest allowed error, in the unit of the errors.
    order
        The order that the engine claims for the method; None if it claims none.
    first
        The number of steps at which the search begins.
    fewest, most
        The limits of the number of steps. Neighbours of an answer may be outside of them.
    beyond
        The numbers beyond the fewest that keep the limit up to which errors are measured; None for `DEPTH` times as many.
    """

    limit: float
    order: float | None
    first: int
    fewest: int
    most: int
    beyond: int | None = None


def kept(errors: Errors, limit: float) -> int | None:
    """Return the fewest measured steps such that they and all larger measured numbers keep the limit; None if none do."""
    fewest = None
    for steps in sorted(errors, reverse=True):
        if not errors[steps] <= limit:
            break
        fewest = steps
    return fewest


def neighbours(steps: int) -> tuple[int, ...]:
    """Return the numbers of steps whose errors show how reliable an answer is, in ascending order, with the answer itself.

    These are all numbers whose time step differs by at most 3 %, or an even selection of them, and at least the next numbers on
    both sides, of which 1 is the least.
    """
    fewest = max(1, min(steps - 1, math.ceil(steps / (1 + NEIGHBOURHOOD))))
    most = max(steps + 1, math.floor(steps / (1 - NEIGHBOURHOOD)))
    if most - fewest < MOST_NEIGHBOURS:
        return tuple(range(fewest, most + 1))
    nearest = {steps - 1, steps, steps + 1}
    intervals = MOST_NEIGHBOURS - len(nearest) - 1
    return tuple(sorted(nearest | {fewest + round(index * (most - fewest) / intervals) for index in range(intervals + 1)}))


def answer(errors: Errors, within: Range) -> int | None:
    """Return the fewest steps whose neighbours were measured, such that these and all larger numbers keep the limit.

    None if there is no such number, or if its neighbours were not measured.
    """
    steps = _candidate(errors, within)
    return None if steps is None or _unmeasured(errors, neighbours(steps)) else steps


def following(errors: Errors, within: Range) -> tuple[int, ...]:
    """Return the numbers of steps to be measured next; none if the search is done."""
    if not errors:
        return (within.first,)
    if len(errors) < MANY_RUNS and (steps := _next(errors, within)) is not None:
        return (steps,)
    candidate = _candidate(errors, within)
    if candidate is None or len(errors) >= MOST_RUNS:
        return ()
    return _unmeasured(errors, neighbours(candidate))


def reversal(errors: Errors, limit: float) -> tuple[int, int] | None:
    """Return two numbers of steps that show that the error is not monotone: the one with more steps has the larger error.

    With fewer steps, the limit is kept or, if no run keeps it, the error is the smallest. Differences between errors below a
    hundredth of the limit do not count, and neither do those of at most 10 %. Of several such pairs, return the one with the
    largest ratio of errors; None if there is none.
    """
    trusted = [steps for steps in errors if errors[steps] <= max(limit, min(errors.values()))]
    least = NEGLIGIBLE * limit
    ratios = {
        (more, fewer): max(errors[more], least) / max(errors[fewer], least)
        for fewer in trusted
        for more in errors
        if more > fewer and errors[fewer] < math.inf
    }
    pair = max(ratios, key=lambda pair: ratios[pair], default=None)
    return pair if pair is not None and ratios[pair] > MONOTONE else None


def _unmeasured(errors: Errors, numbers: Iterable[int]) -> tuple[int, ...]:
    return tuple(steps for steps in numbers if steps not in errors)


def _candidate(errors: Errors, within: Range) -> int | None:
    """Return the fewest steps that can be the answer, as far as is known; None if no number in the range keeps the limit."""
    fewest = kept(errors, within.limit)
    if fewest is None or fewest > within.most:
        return None
    broken = any(steps < fewest for steps in errors)
    return max(within.fewest, max(fewest + 1, math.ceil(fewest * (1 + NEIGHBOURHOOD))) if broken else fewest)


def _next(errors: Errors, within: Range) -> int | None:
    """Return the number of steps to be measured next, to find the bracket; None if it is found."""
    fewest = kept(errors, within.limit)
    if fewest is None:
        return _downwards(errors, within)
    broken = max((steps for steps in errors if steps < fewest), default=None)
    if fewest > within.fewest:
        if broken is None:
            return _upwards(errors, fewest, within)
        if (between := _between(errors, fewest, broken, within)) is not None:
            return between
    return _below(errors, fewest, within)


def _downwards(errors: Errors, within: Range) -> int | None:
    """Return more steps if the most measured ones do not keep the limit; None if no more are allowed."""
    most = max(errors)
    if most >= within.most:
        return None
    ratio = AFTER_FAILURE
    if math.isfinite(errors[most]):
        order = min(_slope(errors, most), _claimed(within))
        ratio = max(LEAST_DOWNWARDS, CLOSE * (errors[most] / within.limit) ** (1 / order))
    return math.ceil(min(within.most, most * ratio))


def _upwards(errors: Errors, fewest: int, within: Range) -> int:
    """Return fewer steps if all measured runs keep the limit. fewest: the fewest measured steps."""
    ratio = UPWARDS
    if errors[fewest] > 0:
        ratio = max(CLOSE, min(UPWARDS, CLOSE * (within.limit / errors[fewest]) ** (1 / _claimed(within))))
    return max(within.fewest, min(fewest - 1, math.ceil(fewest / ratio)))


def _between(errors: Errors, fewest: int, broken: int, within: Range) -> int | None:
    """Return a number inside the bracket, from the fewest steps that keep the limit to the number that breaks it.

    It is the number at which the error is expected to cross the limit, or the geometric mean of both if two measured numbers
    near one of them show that this expectation converges slowly. None if the bracket is narrow enough.
    """
    if fewest - broken <= 1 or fewest <= broken * NEAR:
        return None
    width = math.log(fewest / broken)
    slow = sum(steps < fewest * math.exp(width / 4) for steps in errors if steps > fewest) > 1
    slow |= sum(steps > broken * math.exp(-width / 4) for steps in errors if steps < broken) > 1
    expected = math.sqrt(fewest * broken) if slow else _crossing(errors, fewest, broken, within)
    return min(fewest - 1, max(broken + 1, math.ceil(expected)))


def _crossing(errors: Errors, fewest: int, broken: int, within: Range) -> float:
    """Return the number of steps at which the error is expected to equal the limit."""
    below, above, width = errors[fewest], errors[broken], math.log(fewest / broken)
    if below <= 0:
        return math.sqrt(fewest * broken)
    more = min((steps for steps in errors if steps > fewest and errors[steps] > 0), default=None)
    order = _claimed(within) if more is None else max(LEAST_ORDER, _power(errors, more, fewest))
    if math.isfinite(above):
        order = max(order, math.log(above / below) / width)
    return fewest / math.exp(min(width, math.log(within.limit / below) / order))


def _below(errors: Errors, fewest: int, within: Range) -> int | None:
    """Return a number of steps above `fewest` at which the limit might be broken; None if enough of them were measured."""
    deepest = fewest * DEPTH if within.beyond is None else fewest + within.beyond
    most = min(max(within.most, fewest), deepest)
    if max(errors) < most:
        return most
    measured = [steps for steps in sorted(errors) if fewest <= steps <= most]
    steepest = max(LEAST_STEEPNESS, *(abs(_power(errors, more, fewer)) for fewer, more in pairwise(measured)), 0.0)
    assumed = STEEPER * min(steepest, LARGEST_ORDER)
    for fewer, more in pairwise(measured):
        width = math.log(more / fewer)
        if errors[fewer] == 0 or more - fewer <= 1 or more <= fewer * CLOSE:
            continue
        # Towards more steps the error can rise and then fall. `room` is the logarithm of the ratio by which it may exceed the
        # error with fewer steps.
        room, power = math.log(within.limit / errors[fewer]), min(_power(errors, more, fewer), assumed)
        if (assumed - power) * width / 2 > room:
            apart = max(math.log(CLOSE), min(width / 2, 2 * room / (assumed - power)))
            return max(fewer + 1, min(more - 1, math.floor(fewer * math.exp(apart))))
    return None


def _claimed(within: Range) -> float:
    return float(within.order or UNKNOWN_ORDER)


def _slope(errors: Errors, steps: int) -> float:
    """Return the order observed from a number of steps to the next fewer with a finite error, clipped to the allowed orders.

    If no order can be observed, return `LARGEST_ORDER`.
    """
    fewer = max((other for other in errors if other < steps and 0 < errors[other] < math.inf), default=None)
    if fewer is None or not errors[steps] > 0:
        return LARGEST_ORDER
    return max(LEAST_ORDER, min(LARGEST_ORDER, _power(errors, steps, fewer)))


def _power(errors: Errors, more: int, fewer: int) -> float:
    """Return the power of the time step with which the error grows from more to fewer steps; 0 if an error is 0."""
    if errors[more] <= 0 or errors[fewer] <= 0:
        return 0.0
    return math.log(errors[fewer] / errors[more]) / math.log(more / fewer)
