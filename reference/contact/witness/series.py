"""Power series of a motion on a plane in one step, in fixed-point arithmetic.

Coefficients are whole numbers in units of 2^-`BITS`, and belong to powers of the part s of the step, 0 <= s <= 1. Products of
whole numbers are exact and much faster than those of floating-point numbers with as many digits.
"""

from collections.abc import Sequence
from operator import mul

import numpy as np

from bodycheck.reference.independent.arithmetic import Real, Vector, Wide, WideArray
from bodycheck.reference.independent.border import MP

#: Binary digits after the point.
BITS = 192

#: The number of coefficients of a series after the first.
TERMS = 36

#: The size of the last three coefficients of a series of numbers of size 1 up to which a step is accepted: 1e-24.
LEAST = 1 << (BITS - 80)

#: The coefficients of a series.
Series = list[int]

ONE = 1 << BITS


def fixed(value: Real) -> int:
    """A number as a whole number of units."""
    return int(MP.ldexp(value, BITS))


def real(value: int) -> Real:
    """A whole number of units as a number."""
    return MP.ldexp(MP.mpf(value), -BITS)


def constant(value: int) -> Series:
    """The series of a constant."""
    return [value] + [0] * TERMS


def linear(start: Vector, change: Vector) -> list[Series]:
    """The series of numbers that change uniformly in the step. change: their changes in the whole step."""
    return [[fixed(a), fixed(b)] + [0] * (TERMS - 1) for a, b in zip(start, change, strict=True)]


def product(one: Series, other: Series) -> Series:
    """The coefficients of a product of two series."""
    return [_term(one, other, order) for order in range(TERMS + 1)]


def times(series: Series, factor: Real) -> Series:
    """A series times a number."""
    scale = fixed(factor)
    return [scale * value >> BITS for value in series]


def summed(start: Real, *rates: tuple[Series, Real]) -> Series:
    """The series of a number that begins at `start` and has the sum of some rates, each a series times a number."""
    total = [fixed(start)] + [0] * TERMS
    for series, factor in rates:
        for order, value in enumerate(times(series[:-1], factor), start=1):
            total[order] += value // order
    return total


def slip(directions: Vector, downhill: Vector, slowing: Real) -> tuple[list[Series], Series]:
    """The slip of a body on an inclined plane and its size, both in units of the size at the start of the step.

    The slip u obeys du/ds = |u| g - c u. Its size follows from |u|^2 = u u, coefficient by coefficient.

    Parameters
    ----------
    directions
        The slip at the start of the step, of length 1.
    downhill
        The vector g: the gravitational acceleration along the plane, times the step over the size of the slip.
    slowing
        The number c: the rate at which friction reduces the slip, times the step over the size of the slip.
    """
    pull, slow = [fixed(value) for value in downhill], fixed(slowing)
    u = [[fixed(value)] for value in directions]
    size = [ONE]
    for order in range(TERMS):
        for part, g in zip(u, pull, strict=True):
            part.append((size[order] * g - slow * part[order] >> BITS) // (order + 1))
        squares = sum(_term(part, part, order + 1) for part in u)
        known = sum(map(mul, size[1:], size[:0:-1])) >> BITS
        size.append((squares - known) >> 1)
    return u, size


def turned(start: Vector, rates: Sequence[Series]) -> list[Series]:
    """The quaternion w, x, y, z of a body that turns in a step, from dQ/ds = w Q / 2.

    start: its components at the start of the step. rates: the angular velocity along fixed axes, times the step.
    """
    w, x, y, z = ([fixed(value)] for value in start)
    a, b, c = rates
    for k in range(TERMS):
        halves = 2 * (k + 1)
        w_next = -(_term(a, x, k) + _term(b, y, k) + _term(c, z, k)) // halves
        x_next = (_term(a, w, k) + _term(b, z, k) - _term(c, y, k)) // halves
        y_next = (_term(b, w, k) + _term(c, x, k) - _term(a, z, k)) // halves
        z_next = (_term(c, w, k) + _term(a, y, k) - _term(b, x, k)) // halves
        for part, value in ((w, w_next), (x, x_next), (y, y_next), (z, z_next)):
            part.append(value)
    return [w, x, y, z]


def converged(series: Sequence[Series]) -> bool:
    """Return whether the last coefficients of series of terms of size 1 are negligible."""
    return all(abs(value) <= LEAST for part in series for value in part[-3:])


def ended(series: Sequence[Series]) -> Vector:
    """The values of series at the end of the step."""
    return [real(sum(part)) for part in series]


def widened(series: Sequence[Series]) -> WideArray:
    """The coefficients (k, `TERMS` + 1) of k series in the widest type of NumPy."""
    heads = [[float(value) for value in part] for part in series]
    tails = [
        [float(value - int(head)) for value, head in zip(part, row, strict=True)]
        for part, row in zip(series, heads, strict=True)
    ]
    return np.asarray(np.ldexp(np.array(heads, Wide) + np.array(tails, Wide), -BITS))


def _term(one: Series, other: Series, order: int) -> int:
    """The coefficient of a power of a product of two series."""
    total: int = sum(map(mul, one, other[order::-1]))
    return total >> BITS
