"""Arithmetic of many numbers at once with twice the digits of the widest type of NumPy.

A pair is the sum of two numbers of the wide type, the second of which is at most half a rounding of the first. Where the wide
type has 80 bits, a pair has 128 bits of mantissa, which hold the product of two doubles exactly. The algorithms are those of
Dekker (Numer. Math. 18, 224, 1971); the bounds of their errors are those of Joldes, Muller and Popescu (ACM Trans. Math. Softw.
44, 15res, 2017). Every operation acts on each element alone, so that a number does not depend on the other numbers of an array.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.trajectory import Array

if TYPE_CHECKING:
    from bodycheck.reference.exact.numbers import Real

#: An array of the wide type.
WideArray = NDArray[np.longdouble]

#: The relative error of one rounding to the wide type.
ROUNDING = float(np.finfo(np.longdouble).eps) / 2

#: Bound of the relative error of one operation on pairs; the error of a sum of three pairs and of a product is less than half
#: of it.
PAIR_ROUNDING = 16 * ROUNDING**2

#: The factor that splits a number of the wide type into two halves, whose products are exact.
_SPLITTER = np.longdouble(2) ** ((np.finfo(np.longdouble).nmant + 2) // 2) + 1


@dataclass(frozen=True, eq=False)
class Pair:
    """Numbers (...), each as the unevaluated sum of two numbers of the wide type.

    Attributes
    ----------
    high
        (...) the numbers, rounded to the wide type.
    low
        (...) the errors of this rounding, rounded to the wide type.
    """

    high: WideArray
    low: WideArray

    def __add__(self, other: "Pair") -> "Pair":
        high, error = _sum(self.high, other.high)
        low, rest = _sum(self.low, other.low)
        high, error = _ordered_sum(high, error + low)
        return Pair(*_ordered_sum(high, error + rest))

    def __neg__(self) -> "Pair":
        return Pair(-self.high, -self.low)

    def __sub__(self, other: "Pair") -> "Pair":
        return self + -other

    def __mul__(self, other: "Pair") -> "Pair":
        high, error = _product(self.high, other.high)
        across = self.high * other.low + self.low * other.high
        return Pair(*_ordered_sum(high, error + (across + self.low * other.low)))

    def __truediv__(self, other: "Pair") -> "Pair":
        first = self.high / other.high
        left = self - other * of_wide(first)
        second = left.high / other.high
        left = left - other * of_wide(second)
        return Pair(*_ordered_sum(first, second)) + of_wide(left.high / other.high)

    def __getitem__(self, places: Any) -> "Pair":
        return Pair(self.high[places], self.low[places])


def of_wide(values: Any) -> Pair:
    """Numbers (...) of the wide type, or of a narrower type, as pairs."""
    high = np.asarray(values, dtype=np.longdouble)
    return Pair(high, np.zeros_like(high))


def of_reals(values: "list[Real]") -> Pair:
    """Convert k numbers of a hundred digits to pairs (k,)."""
    from bodycheck.reference.exact.numbers import MP, wide  # single scenes need this module for its types, but not mpmath

    high = [wide(value) for value in values]
    low = [wide(value - MP.convert(part)) for value, part in zip(values, high, strict=True)]
    return Pair(np.array(high, dtype=np.longdouble), np.array(low, dtype=np.longdouble))


def squares(values: Array) -> Pair:
    """The squares (...) of doubles, exactly."""
    one = np.asarray(values, dtype=np.longdouble)
    return Pair(*_product(one, one))


def root(value: Pair) -> Pair:
    """The square roots (...) of pairs >= 0."""
    first = np.sqrt(value.high)
    square = Pair(*_product(first, first))
    left = (value - square).high
    # The root of zero is zero, without a correction.
    correction = np.divide(left, 2 * first, out=np.zeros_like(first), where=first > 0)
    return Pair(*_ordered_sum(first, correction))


def stacked(parts: list[Pair]) -> Pair:
    """Stack k pairs (...) as the components of vectors (..., k)."""
    return _each(lambda arrays: np.stack(arrays, axis=-1), parts)


def compare(one: Pair, other: Pair) -> NDArray[np.int_]:
    """Return -1, 0 or 1 (...) where a pair is smaller than, equal to or larger than another pair."""
    high, low = np.sign(one.high - other.high), np.sign(one.low - other.low)
    return np.asarray(np.where(high != 0, high, low)).astype(int)


def doubles(value: Pair) -> Array:
    """The doubles (...) that are nearest to pairs."""
    near = value.high.astype(float)
    # A number of the wide type that is half-way between two doubles is rounded to the even double, whatever the low part says.
    off = (value.high - near.astype(np.longdouble)) + value.low
    with np.errstate(over="ignore"):
        beside = np.nextafter(near, np.where(off > 0, np.inf, -np.inf))
    closer = np.abs((value.high - beside.astype(np.longdouble)) + value.low) < np.abs(off)
    return np.where(closer, beside, near)


def _each(function: Callable[[list[WideArray]], WideArray], pairs: list[Pair]) -> Pair:
    return Pair(function([each.high for each in pairs]), function([each.low for each in pairs]))


def _sum(a: WideArray, b: WideArray) -> tuple[WideArray, WideArray]:
    """The rounded sum and its rounding error, exactly (Knuth)."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


def _ordered_sum(a: WideArray, b: WideArray) -> tuple[WideArray, WideArray]:
    """The rounded sum and its rounding error, exactly, where |a| >= |b| or a = 0 (Dekker)."""
    total = a + b
    return total, b - (total - a)


def _product(a: WideArray, b: WideArray) -> tuple[WideArray, WideArray]:
    """The rounded product and its rounding error, exactly (Dekker, Veltkamp)."""
    total = a * b
    (a_head, a_tail), (b_head, b_tail) = _halves(a), _halves(b)
    return total, ((a_head * b_head - total) + a_head * b_tail + a_tail * b_head) + a_tail * b_tail


def _halves(a: WideArray) -> tuple[WideArray, WideArray]:
    """A number as the sum of two numbers, each with half of the digits."""
    scaled = _SPLITTER * a
    head = scaled - (scaled - a)
    return head, a - head
