"""Arithmetic of a hundred decimal digits, and rounding to the types of NumPy."""

from collections.abc import Sequence
from typing import Any

import mpmath
import numpy as np

#: Decimal digits of the arithmetic. The product of four doubles is exact in it.
DIGITS = 100

#: The arithmetic. It is a context of its own, so that nobody else can change its digits.
MP = mpmath.MPContext()
MP.dps = DIGITS

#: A number of this arithmetic.
Real = Any

#: Two and three numbers of this arithmetic.
Vector2 = tuple[Real, Real]
Vector3 = tuple[Real, Real, Real]

#: The components w, x, y, z of a quaternion in this arithmetic.
Quaternion4 = tuple[Real, Real, Real, Real]

#: Ratio of a difference to its terms up to which it is only what rounding has left of a zero.
NEGLIGIBLE = MP.mpf(10) ** (10 - DIGITS)

#: Bits of the mantissa of a double.
DOUBLE_BITS = 53

#: The widest floating-point type of NumPy: 80 bits on x86. Elsewhere it can be double precision, with that accuracy.
Wide = np.longdouble


def real(value: Any) -> Real:
    """A number of any type as one of this arithmetic, without rounding."""
    return MP.convert(value)


def vector(values: Sequence[Any]) -> Vector3:
    """Three numbers of any type as numbers of this arithmetic, without rounding."""
    x, y, z = values
    return MP.mpf(x), MP.mpf(y), MP.mpf(z)


def wide(value: Real) -> Wide:
    """The number of the widest type that is nearest to a number of this arithmetic."""
    sign, mantissa, exponent, bits = value._mpf_
    if bits > 2 * DOUBLE_BITS:  # two doubles hold more digits than the widest type
        mantissa, exponent = mantissa >> (bits - 2 * DOUBLE_BITS), exponent + bits - 2 * DOUBLE_BITS
    head, tail = divmod(int(mantissa), 1 << DOUBLE_BITS)
    size = np.ldexp(np.ldexp(Wide(head), DOUBLE_BITS) + Wide(tail), exponent)
    return Wide(-size if sign else size)


def doubles(values: Sequence[Real]) -> tuple[float, ...]:
    """The doubles that are nearest to some numbers of this arithmetic."""
    return tuple(float(value) for value in values)
