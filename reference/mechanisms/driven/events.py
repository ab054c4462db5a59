"""The first instant within a step at which a condition of a mode ceases to hold.

Double precision excludes it for most steps: the conditions are computed at evenly spaced instants of the step, between which
they differ from a straight line by at most a bound of their second derivatives. Otherwise the conditions are polynomials in
arithmetic of many digits, the Taylor series of the motion. Intervals are halved until each polynomial is positive in an
interval, or monotone.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bodycheck.reference.exact.numbers import Real
from bodycheck.reference.mechanisms.driven.linear import Linear, Row, State, applied, value, zero
from bodycheck.reference.trajectory import Array

#: The number of parts of a step at whose ends the conditions are computed, and of the terms of their series.
PARTS, TERMS = 16, 40

#: Bound of the rounding errors of a condition in double precision, relative to the sum of the sizes of its terms.
ROUNDING = 1e-13


@dataclass(frozen=True, eq=False)
class Scan:
    """The conditions of a mode during one step, as linear functions of the state at its start, in double precision.

    Attributes
    ----------
    values
        (c, PARTS + 1, k) the c conditions at evenly spaced instants of the step.
    slack
        (c, k) factors of the sizes of the components of the state in bounds of errors of lines between these instants.
    """

    values: Array
    slack: Array


def scan_of(linear: Linear, conditions: Sequence[Row]) -> Scan:
    """The scan of the conditions of a mode."""
    size = len(linear.rows)
    matrix = _dense(linear.rows, size) * float(linear.step or 0)
    term = _dense(conditions, size)
    largest = np.abs(term)
    instants = np.linspace(0.0, 1.0, PARTS + 1)
    values, sizes, bends = term[:, None, :] * np.ones((1, PARTS + 1, 1)), largest.copy(), np.zeros_like(largest)
    for n in range(1, TERMS):
        term, largest = term @ matrix / n, largest @ np.abs(matrix) / n
        values += term[:, None, :] * (instants**n)[None, :, None]
        sizes, bends = sizes + largest, bends + n * (n - 1) * largest
    return Scan(values, bends / (8 * PARTS**2) + ROUNDING * sizes)


def clear(scan: Scan, z: State) -> bool:
    """Return whether all conditions certainly hold during the whole step after a state."""
    numbers = np.array([float(part) for part in z])
    return bool(((scan.values @ numbers).min(axis=1) > scan.slack @ np.abs(numbers)).all())


def _dense(rows: Sequence[Row], size: int) -> Array:
    matrix = np.zeros((len(rows), size))
    for index, row in enumerate(rows):
        for column, coefficient in row.items():
            matrix[index, column] = float(coefficient)
    return matrix


def first_end(linear: Linear, series: Sequence[State], duration: Real, conditions: Sequence[Row]) -> Real | None:
    """The first part of a duration (s) at which a condition ceases to hold; None if all hold until its end.

    series: the terms of the Taylor series of the state at the end of the duration.

    A condition that is zero within rounding, with derivatives that are zero, counts from the first derivative on that is not. A
    condition that touches zero to within half of the digits of the arithmetic continues to hold; the motion without the event
    differs by less than the square root of this.
    """
    mp, first = linear.mp, None
    sizes = _sizes(linear, series, duration)
    for condition in conditions:
        polynomial = _polynomial(mp, series, sizes, condition)
        end = _first_root(mp, polynomial, mp.one if first is None else first) if polynomial else None
        if end is not None:
            first = end
    return first


def _sizes(linear: Linear, series: Sequence[State], duration: Real) -> list[list[Real]]:
    """The sizes to which rounding errors of the first terms of a series are proportional; the later terms follow from these."""
    rows = [{column: abs(part) for column, part in row.items()} for row in linear.rows]
    sizes = [[abs(part) for part in series[0]]]
    for n in range(1, len(rows) + 1):
        sizes.append([duration / n * part for part in applied(linear.mp, rows, sizes[-1])])
    return sizes


def _polynomial(mp: Any, series: Sequence[State], sizes: Sequence[State], condition: Row) -> list[Real]:
    """The coefficients of a condition as a polynomial in the part of the step, divided by the power whose factor is first."""
    absolute = {column: abs(coefficient) for column, coefficient in condition.items()}
    for order, (term, size) in enumerate(zip(series, sizes, strict=False)):
        if abs(value(mp, condition, term)) > zero(mp) * value(mp, absolute, size):
            return [value(mp, condition, later) for later in series[order:]]
    return []


def _first_root(mp: Any, polynomial: list[Real], last: Real) -> Real | None:
    """The first root of a polynomial in [0, last], last <= 1; 0 if it is negative at 0, and None if it has no root.

    A root at `last` at which the polynomial does not become negative is none.
    """
    if polynomial[0] < 0:
        return mp.zero
    bend = mp.fsum([n * (n - 1) * abs(part) for n, part in enumerate(polynomial)])
    shortest = mp.mpf(10) ** (LOST_IN_TOUCH - mp.dps // 2)
    waiting = [(mp.zero, last)]
    while waiting:
        begin, end = waiting.pop()
        middle, half = (begin + end) / 2, (end - begin) / 2
        number, slope = _horner(mp, polynomial, middle)
        if number > abs(slope) * half + bend * half * half / 2:
            continue
        if abs(slope) > bend * half:
            if _horner(mp, polynomial, begin)[0] < 0:
                return begin
            if _horner(mp, polynomial, end)[0] < 0:
                return _root(mp, polynomial, begin, end)
        elif half > shortest:
            waiting += [(middle, end), (begin, middle)]
    return None


#: Decimal digits, beyond half of those of the arithmetic, of the shortest interval that is still halved.
LOST_IN_TOUCH = 5


def _root(mp: Any, polynomial: list[Real], begin: Real, end: Real) -> Real:
    """The root of a polynomial that falls from a value >= 0 to a value < 0, by Newton's method within an interval.

    The root in double precision is the first approximation.
    """
    size = mp.fsum([abs(part) * end**n for n, part in enumerate(polynomial)])
    smallest = mp.mpf(10) ** (2 - mp.dps)
    at = mp.mpf(_rough_root([float(part / size) for part in polynomial], float(begin), float(end)))
    at = min(max(at, begin), end)
    if 2 * at < end:
        # Near a root that is small beside the step, few of the terms count.
        end, sizes = 2 * at, [abs(part) * (2 * at) ** n for n, part in enumerate(polynomial)]
        size = mp.fsum(sizes)
        while sizes[-1] < smallest * smallest * size:
            sizes.pop()
        polynomial = polynomial[: len(sizes)]
    for _ in range(4 * mp.dps):
        number, slope = _horner(mp, polynomial, at)
        begin, end = (begin, at) if number < 0 else (at, end)
        after = at - number / slope if slope else at
        if slope and abs(after - at) <= smallest * (at + size / abs(slope)):
            return at
        if not begin <= after <= end:
            after = (begin + end) / 2
        at = after
    return at


def _rough_root(polynomial: list[float], begin: float, end: float) -> float:
    """The root of a falling polynomial by bisection in double precision."""
    while begin < (middle := (begin + end) / 2) < end:
        number = 0.0
        for part in reversed(polynomial):
            number = number * middle + part
        begin, end = (begin, middle) if number < 0 else (middle, end)
    return (begin + end) / 2


def _horner(mp: Any, polynomial: list[Real], at: Real) -> tuple[Real, Real]:
    """The value of a polynomial and its derivative."""
    number, slope = mp.zero, mp.zero
    for part in reversed(polynomial):
        slope = slope * at + number
        number = number * at + part
    return number, slope
