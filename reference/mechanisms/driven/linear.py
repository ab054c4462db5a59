"""Linear systems z' = A z: their steps in arithmetic of many digits, and their motions at many instants in the wide type.

exp(A t) z is the sum of its Taylor series over steps of at most one characteristic time, so that its terms do not cancel. Many
steps at once are products of powers of exp(A step).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np

from bodycheck.reference.exact.numbers import Real, Wide, wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.mechanisms.forms.motion import WIDE_EPS
from bodycheck.reference.trajectory import Array

#: A linear function of a state: its coefficients that are not zero, by the components of the state.
Row = Mapping[int, Real]

#: A step of a linear system: the rows of a matrix, in which a number alone is the component that is taken over unchanged.
Transition = tuple[Row | int, ...]

#: A state in arithmetic of many digits.
State = Sequence[Real]

#: The largest number of terms of a series in the wide type.
MOST_TERMS = 100


@dataclass(frozen=True, eq=False)
class Linear:
    """A system z' = A z.

    Attributes
    ----------
    mp
        The arithmetic.
    rows
        The rows of A.
    step
        The length of the steps (s), at most one characteristic time; None if the state is constant.
    powers
        The steps exp(A step 2^j) for j = 0, 1, ..., as far as they have been needed.
    """

    mp: Any
    rows: tuple[Row, ...]
    step: Real | None
    powers: list[Transition] = field(default_factory=list)


#: Decimal digits of the arithmetic that may be lost before a number counts as zero.
LOST = 20


@cache
def zero(mp: Any) -> Real:
    """The size of a sum relative to its terms up to which it counts as zero, in an arithmetic."""
    return mp.mpf(10) ** (LOST - mp.dps)


def value(mp: Any, row: Row, z: State) -> Real:
    """The value of a linear function."""
    return mp.fdot([(coefficient, z[column]) for column, coefficient in row.items()])


def applied(mp: Any, rows: Sequence[Row], z: State) -> list[Real]:
    """The product of a matrix and a state."""
    return [mp.fdot([(coefficient, z[column]) for column, coefficient in row.items()]) if row else mp.zero for row in rows]


def terms(linear: Linear, z: State, duration: Real) -> list[list[Real]]:
    """The terms of the Taylor series of the state after a duration (s) of at most one step."""
    mp, series = linear.mp, [list(z)]
    for n in range(1, term_count(mp.dps) if linear.step is not None else 1):
        factor = duration / n
        term = [factor * part for part in applied(mp, linear.rows, series[-1])]
        if not any(term):
            break
        series.append(term)
    return series


def term_count(digits: int) -> int:
    """The number of terms after which a series whose terms are at most 2^n / n! has converged to a number of digits."""
    n, size = 1, math.log10(2)
    while size > -digits - 5:
        n += 1
        size += math.log10(2 / n)
    return n + 1


def advanced(linear: Linear, z: State, count: int) -> list[Real]:
    """The state after a number of steps."""
    z = list(z)
    for bit in range(count.bit_length() if linear.step is not None else 0):
        if bit == len(linear.powers):
            linear.powers.append(_transition(linear) if not bit else _squared(linear.mp, linear.powers[-1]))
        if count >> bit & 1:
            z = [z[row] if isinstance(row, int) else value(linear.mp, row, z) for row in linear.powers[bit]]
    return z


def flown(linear: Linear, z: State, duration: Real) -> list[Real]:
    """The state after a duration (s)."""
    if linear.step is None:
        return list(z)
    mp, steps = linear.mp, duration / linear.step
    count = int(mp.floor(steps * (1 + zero(mp))))
    z, rest = advanced(linear, z, count), duration - count * linear.step
    if rest <= zero(mp) * duration:
        return z
    return [mp.fsum(column) for column in zip(*terms(linear, z, rest), strict=True)]


def _transition(linear: Linear) -> Transition:
    """The step exp(A step)."""
    mp, count = linear.mp, len(linear.rows)
    columns = []
    for column in range(count):
        unit = [mp.one if row == column else mp.zero for row in range(count)]
        columns.append([mp.fsum(part) for part in zip(*terms(linear, unit, linear.step), strict=True)])
    rows = [{column: columns[column][row] for column in range(count) if columns[column][row]} for row in range(count)]
    return tuple(row if linear.rows[index] else index for index, row in enumerate(rows))


def _squared(mp: Any, step: Transition) -> Transition:
    """Two equal steps."""
    squares: list[Row | int] = []
    for row in step:
        if isinstance(row, int):
            squares.append(row)
            continue
        sums: dict[int, Real] = {}
        for middle, factor in row.items():
            between = step[middle]
            for column, coefficient in {between: mp.one}.items() if isinstance(between, int) else between.items():
                sums[column] = sums.get(column, mp.zero) + factor * coefficient
        squares.append(sums)
    return tuple(squares)


def evaluated(linear: Linear, z: WideArray, durations: WideArray) -> tuple[WideArray, Array]:
    """The states (n, k) after durations (n,), s, of at most one step, and bounds of the rounding errors, in the wide type.

    z: (n, k) states at the start of the durations, rounded to the wide type.

    The error of the term n of the series is at most n times the number of operations of a term, in roundings of the sum of the
    sizes of the products in it.
    """
    rows = [{column: wide(coefficient) for column, coefficient in row.items()} for row in linear.rows]
    operations = 2 + max((len(row) for row in rows), default=0)
    term, size, lengths = z, np.abs(z), np.abs(durations)
    total, error = term.copy(), size.copy()
    for n in range(1, MOST_TERMS):
        term = (durations / n)[:, None] * _product(rows, term)
        size = (lengths / n)[:, None] * _product([{column: abs(part) for column, part in row.items()} for row in rows], size)
        total = total + term
        error = error + (n * operations + 1) * size
        if not (size > WIDE_EPS**2 * error).any():
            break
    return total, np.asarray(2 * WIDE_EPS * error, dtype=float)


def _product(rows: Sequence[Mapping[int, Any]], z: WideArray) -> WideArray:
    """The products (n, k) of a matrix and states (n, k)."""
    product = np.zeros_like(z)
    for index, row in enumerate(rows):
        for column, coefficient in row.items():
            product[:, index] += coefficient * z[:, column]
    return product


def in_wide(values: Sequence[Real]) -> WideArray:
    """Convert numbers (n,) to the wide type, with a relative error of at most one rounding."""
    high = [float(number) for number in values]
    low = [float(number - part) for number, part in zip(values, high, strict=True)]
    return np.array(high, dtype=Wide) + np.array(low, dtype=Wide)
