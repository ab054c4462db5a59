"""Arithmetic of a hundred decimal digits, and rounding to the types of NumPy and heyoka."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray

#: Decimal digits of the arithmetic. The product of four doubles is exact in it.
DIGITS = 100

#: The arithmetic. It is a separate context of mpmath, so that no other code can change its digits.
MP = mpmath.MPContext()
MP.dps = DIGITS

#: A number of this arithmetic.
Real = Any

#: Two and three numbers of this arithmetic.
Vector2 = tuple[Real, Real]
Vector3 = tuple[Real, Real, Real]

#: The components w, x, y, z of a quaternion in this arithmetic.
Quaternion4 = tuple[Real, Real, Real, Real]

#: Ratio of a difference to its terms up to which the difference is a rounding error of zero.
NEGLIGIBLE = MP.mpf(10) ** (10 - DIGITS)

#: Bits of the mantissa of a double.
DOUBLE_BITS = 53

#: The widest floating-point type of NumPy: 80 bits on x86. Elsewhere it can be double precision, with that accuracy.
Wide = np.longdouble

#: An array of any floating-point type; the types of heyoka are not NumPy's own.
WideArray = NDArray[Any]


def real(value: Any) -> Real:
    """Convert a number of any type to this arithmetic, without rounding."""
    return MP.convert(value)


def exactly(value: Any) -> Real:
    """Convert a number of a type of NumPy or heyoka, however many bits it has, to this arithmetic, without rounding.

    Raises `OverflowError` if it is not finite.
    """
    total, part = MP.zero, float(value)
    if not math.isfinite(part):
        raise OverflowError(f"{part} is not a number of this arithmetic")
    while part:
        total, value = total + MP.mpf(part), value - part
        part = float(value)
    return total


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


@dataclass(frozen=True)
class FloatType:
    """A floating-point type: NumPy's double precision or `longdouble`, heyoka's `real128`, or its `real` of `bits` bits."""

    dtype: Any = np.longdouble
    bits: int | None = None

    @property
    def eps(self) -> float:
        """The distance from 1 to the next number of this type."""
        if self.bits is not None:
            return 2.0 ** (1 - self.bits)
        return float(np.finfo(self.dtype).eps) if self.dtype in (np.float64, np.longdouble) else 2.0**-112

    def number(self, value: Real) -> Any:
        """The number of this type that is nearest to an exact number or to a double."""
        value = real(value)
        if self.bits is not None:
            return self.dtype(MP.nstr(value, DIGITS), self.bits)
        if self.dtype is np.float64:
            return np.float64(float(value))
        if self.dtype is np.longdouble:
            return wide(value)
        return self.dtype(MP.nstr(value, DIGITS))

    def array(self, values: Iterable[Real]) -> WideArray:
        """Exact numbers or doubles as an array of this type."""
        return np.array([self.number(value) for value in values])
