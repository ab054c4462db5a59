"""Vectors and matrices of a hundred decimal digits, and rounding to the widest type of NumPy."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.independent.border import MP

#: Ratio of a difference to its terms up to which it is taken for what rounding has left of zero.
ROUNDED = MP.mpf(10) ** -80

#: A number of this arithmetic.
Real = Any

#: Three numbers, and three rows of them.
Vector = Sequence[Real]
Matrix = Sequence[Vector]

#: The widest floating-point type of NumPy: 80 bits on x86, double precision on some machines.
Wide = np.longdouble
WideArray = NDArray[np.longdouble]

#: Relative spacing of the numbers of this type.
WIDE_EPS = float(np.finfo(Wide).eps)

#: Doubles that together hold all digits of a number of this type.
_PARTS = -(-(np.finfo(Wide).nmant + 2) // 53)


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
