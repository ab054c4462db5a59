"""Vectors and matrices of a hundred decimal digits, and rounding to the widest type of NumPy.

Phases that grow steadily with time are reduced to one turn before they are rounded.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.independent.border import MP
from bodycheck.reference.trajectory import Array

#: Ratio of a difference to its terms up to which the difference counts as a rounding error of zero.
ROUNDED = MP.mpf(10) ** -80

#: A number of this arithmetic.
Real = Any

#: A vector of three numbers, and a matrix of three rows.
Vector = Sequence[Real]
Matrix = Sequence[Vector]

#: The widest floating-point type of NumPy: 80 bits on x86, double precision on some machines.
Wide = np.longdouble
WideArray = NDArray[np.longdouble]

#: Relative spacing of the numbers of this type.
WIDE_EPS = float(np.finfo(Wide).eps)

#: Number of doubles that together hold all digits of a number of this type.
_PARTS = -(-(np.finfo(Wide).nmant + 2) // 53)

#: Bits of the lower part of a time that is split into two; the upper part has the other 26.
_LOWER_BITS = 27

#: Bits of a rate that are used: the error is 2^-64 of a turn after 2^46 turns.
_RATE_BITS = 110

#: Bits of a piece of a rate. Its product with either part of a time is exact in the wide type.
_PIECE_BITS = np.finfo(Wide).nmant + 1 - _LOWER_BITS


def wide(value: Real) -> np.longdouble:
    """A number of a hundred digits, rounded to the wide type."""
    if not value:
        return Wide(0)
    rest, exponent = MP.frexp(value)
    total = Wide(0)
    for _ in range(_PARTS):
        part = float(rest)
        total += Wide(part)
        rest -= part
    return Wide(np.ldexp(total, exponent))


def wide_matrix(rows: Sequence[Sequence[Real]]) -> WideArray:
    """A matrix of the wide type from rows of a hundred digits."""
    return np.array([[wide(value) for value in row] for row in rows], dtype=Wide)


def dot(one: Vector, other: Vector) -> Real:
    """The scalar product of two vectors."""
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]


def cross(one: Vector, other: Vector) -> Vector:
    """The vector product of two vectors."""
    (a, b, c), (x, y, z) = one, other
    return b * z - c * y, c * x - a * z, a * y - b * x


def norm(vector: Vector) -> Real:
    """The length of a vector."""
    return MP.sqrt(dot(vector, vector))


def plus(*vectors: Vector) -> Vector:
    """The sum of vectors."""
    return [sum(parts) for parts in zip(*vectors, strict=True)]


def minus(one: Vector, other: Vector) -> Vector:
    """The difference of two vectors."""
    return [a - b for a, b in zip(one, other, strict=True)]


def scaled(vector: Vector, factor: Real) -> Vector:
    """A vector times a number."""
    return vector[0] * factor, vector[1] * factor, vector[2] * factor


def transposed(rows: Matrix) -> Matrix:
    """The transpose of a matrix."""
    first, second, third = zip(*rows, strict=True)
    return first, second, third


def applied(rows: Matrix, vector: Vector) -> Vector:
    """A matrix times a vector."""
    return dot(rows[0], vector), dot(rows[1], vector), dot(rows[2], vector)


def product(one: Matrix, other: Matrix) -> Matrix:
    """The product of two matrices."""
    first, second, third = (applied(one, column) for column in transposed(other))
    return transposed((first, second, third))


def turns(offset: Real, rate: Real, times: Array) -> tuple[WideArray, WideArray]:
    """Whole turns (n,), and the remaining fractions of a turn (n,), in [-1/2, 1/2], of offset + rate t at times t (n,), s.

    offset: turns at t = 0. rate: turns per second. Each piece of the rate and of the time is multiplied without rounding, and
    whole turns are dropped at once, so that the fractions have the accuracy of the wide type after any number of turns.
    """
    whole = MP.nint(offset)
    count, left = np.full(len(times), wide(whole)), np.full(len(times), wide(offset - whole))
    upper = (np.ascontiguousarray(times).view(np.int64) & -(1 << _LOWER_BITS)).view(np.float64)
    parts = upper.astype(Wide), (times - upper).astype(Wide)
    for piece in _pieces(rate):
        for part in parts:
            product = piece * part
            nearest = np.rint(product)
            count += nearest
            left += product - nearest
    nearest = np.rint(left)
    return count + nearest, left - nearest


def _pieces(rate: Real) -> list[np.longdouble]:
    """Split a rate into numbers of few bits each, whose sum is the rate."""
    pieces, rest, bits = [], rate, 0
    while rest and bits < _RATE_BITS:
        fraction, exponent = MP.frexp(rest)
        piece = MP.ldexp(MP.nint(MP.ldexp(fraction, _PIECE_BITS)), exponent - _PIECE_BITS)
        pieces.append(wide(piece))
        rest, bits = rest - piece, bits + _PIECE_BITS
    return pieces
