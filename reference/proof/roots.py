"""Roots of functions of one number in balls: their existence and uniqueness by the interval Newton method."""

from collections.abc import Callable

from flint import arb, ctx

from bodycheck.reference.proof.balls import Ball
from bodycheck.reference.proof.enclosure import NotEnclosed

#: The largest number of steps of Newton's method.
MOST_STEPS = 200

#: The bits of a root, as a part of all bits, with which a further step encloses it: the step squares the error.
NEAR = 0.5

#: The point at which an interval is split, so that roots at simple fractions are not at borders, and the most splits.
SPLIT, MOST_SPLITS = arb(0.4921875), 128

#: A function of a number, in balls.
Function = Callable[[Ball], Ball]


def root_near(value: Function, slope: Function, guess: Ball) -> Ball:
    """Return a ball with exactly one root of a function near to a guess. Raises `NotEnclosed` if there may be none.

    The interval Newton method: if m - f(m) / f'(X) is inside of X, X has one root, and it is there.
    """
    point = guess.mid()
    for _ in range(MOST_STEPS):
        left = value(point)
        step = left / slope(point)
        if not step.is_finite():
            break
        if abs(step.mid()) <= abs(point) * arb(2) ** -round(NEAR * ctx.prec) + arb(2) ** (-4 * ctx.prec):
            around = arb(point, 4 * (abs(step) + abs(point) * arb(2) ** (8 - ctx.prec)).upper())
            inner = point - left / slope(around)
            if around.contains_interior(inner):
                return inner
        point = (point - step).mid()
    raise NotEnclosed("a root that is not enclosed")


def first_change(value: Function, slope: Function, end: Ball) -> Ball | None:
    """Return a time near to the first root until an end of a function that is positive at first; None without one.

    Intervals before have no root. An interval in which the function decreases, and is positive at its begin, has one or none.
    """
    waiting = [(arb(0), end, 0)]
    while waiting:
        low, high, depth = waiting.pop()
        middle = (low + (high - low) * SPLIT).mid()
        half = (high - middle).max(middle - low).upper()
        steep = slope(arb(middle, half))
        if value(middle) + steep * arb(0, half) > 0:
            continue
        if steep < 0 and value(low) > 0:
            last = value(high)
            if last > 0:
                continue
            if last < 0:
                return middle
        if depth > MOST_SPLITS:
            raise NotEnclosed("a change of a motion that is only touched")
        waiting += [(middle, high, depth + 1), (low, middle, depth + 1)]
    return None
