"""Vectors, matrices and attitudes of balls, and the numbers that scenes state exactly."""

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from fractions import Fraction
from typing import Any

from flint import arb, ctx, fmpq

#: A ball, three balls, and a matrix of balls by its rows.
Ball = Any
Triple = tuple[Ball, Ball, Ball]
Matrix = tuple[Triple, Triple, Triple]

#: The identity.
UNIT: Matrix = ((arb(1), arb(0), arb(0)), (arb(0), arb(1), arb(0)), (arb(0), arb(0), arb(1)))


@contextmanager
def precision(bits: int) -> Iterator[None]:
    """Compute with a number of bits."""
    before, ctx.prec = ctx.prec, bits
    try:
        yield
    finally:
        ctx.prec = before


def ball(value: float | Fraction) -> Ball:
    """Return a ball that contains a number, and nothing else if it is a double or an integer."""
    return arb(fmpq(value.numerator, value.denominator)) if isinstance(value, Fraction) else arb(value)


def triple(values: Sequence[float | Fraction]) -> Triple:
    """Return balls that contain three numbers."""
    x, y, z = map(ball, values)
    return x, y, z


def dot(a: Sequence[Ball], b: Sequence[Ball]) -> Ball:
    """Return the inner product of two vectors."""
    if len(a) == 3 == len(b):  # the most frequent case
        return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return sum((x * y for x, y in zip(a, b, strict=True)), arb(0))


def cross(a: Sequence[Any], b: Sequence[Any]) -> tuple[Any, Any, Any]:
    """Return the cross product of two vectors, of balls or of rationals."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def vector_sum(a: Triple, b: Triple) -> Triple:
    """Return the sum of two vectors."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def scaled(factor: Ball, a: Triple) -> Triple:
    """Return the product of a number and a vector."""
    return factor * a[0], factor * a[1], factor * a[2]


def applied(rows: Matrix, v: Sequence[Ball]) -> Triple:
    """Return the product of a matrix and a vector."""
    return dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)


def transposed(rows: Matrix) -> Matrix:
    """Return the transpose of a matrix."""
    (a, b, c), (d, e, f), (g, h, i) = rows
    return (a, d, g), (b, e, h), (c, f, i)


def product(one: Matrix, other: Matrix) -> Matrix:
    """Return the product of two matrices."""
    columns = transposed(other)
    a, b, c = ((dot(row, columns[0]), dot(row, columns[1]), dot(row, columns[2])) for row in one)
    return a, b, c


def about(index: int, sine: Ball, cosine: Ball) -> Matrix:
    """Return the matrix of a turn about an axis of the frame, which is given by its index."""
    s, c, one, zero = sine, cosine, arb(1), arb(0)
    if index == 0:
        return (one, zero, zero), (zero, c, -s), (zero, s, c)
    if index == 1:
        return (c, zero, s), (zero, one, zero), (-s, zero, c)
    return (c, -s, zero), (s, c, zero), (zero, zero, one)


def turned_about(unit: Triple, angle: Ball) -> Matrix:
    """Return the matrix of a turn by an angle (rad) about a unit vector, by Rodrigues' formula."""
    s, c = angle.sin_cos()
    x, y, z = unit
    v = arb(1) - c
    return (
        (c + v * x * x, v * x * y - s * z, v * x * z + s * y),
        (v * x * y + s * z, c + v * y * y, v * y * z - s * x),
        (v * x * z - s * y, v * y * z + s * x, c + v * z * z),
    )


def of_quaternion(quaternion: Sequence[float]) -> Matrix:
    """Return the matrix of the attitude of a quaternion (w, x, y, z) of any length, body to world components.

    Its entries are rational numbers, which are enclosed.
    """
    w, x, y, z = map(Fraction, quaternion)
    n = w * w + x * x + y * y + z * z
    a, b, c = (triple([entry / n for entry in row]) for row in quaternion_rows(w, x, y, z))
    return a, b, c


def of_doubles(quaternion: Sequence[float]) -> Matrix:
    """Return the same in balls from the start, which is faster; an entry that is zero is a ball around zero."""
    w, x, y, z = map(arb, quaternion)
    part = 1 / (w * w + x * x + y * y + z * z)
    a, b, c = ((part * p, part * q, part * r) for p, q, r in quaternion_rows(w, x, y, z))
    return a, b, c


def quaternion_rows(w: Any, x: Any, y: Any, z: Any) -> list[list[Any]]:
    """Return the matrix of a quaternion times the square of its length."""
    return [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]


def upper(value: Ball) -> float:
    """Return an upper bound of the numbers in a ball; infinite if it is not finite."""
    if value.is_zero():
        return 0.0
    return _outwards(value.upper(), 1) if value.is_finite() else math.inf


def lower(value: Ball) -> float:
    """Return a lower bound of the numbers in a ball that are not negative, at least 0."""
    return max(_outwards(value.lower(), -1), 0.0) if value.is_finite() else 0.0


def _outwards(value: Ball, side: int) -> float:
    """Return a double above (1) or below (-1) an exact number that is near to it."""
    return math.nextafter(math.nextafter(float(value), side * math.inf), side * math.inf)


def squared(value: Ball) -> Ball:
    """Return the square of a number; the power of a ball around 0 is no number."""
    return value * value


def size_of(vector: Sequence[Ball]) -> Ball:
    """Return the length of a vector, which may be zero."""
    return root(sum((squared(part) for part in vector), arb(0)))


def distance(one: Sequence[Ball], other: Sequence[Ball]) -> Ball:
    """Return the distance of two vectors."""
    return size_of([a - b for a, b in zip(one, other, strict=True)])


def angle_between(one: Matrix, other: Matrix) -> Ball:
    """Return the angle (rad) between two attitudes.

    A turn by the angle a differs from the identity by the Frobenius norm 2 sqrt(2) sin(a / 2).
    """
    squares = (squared(a - b) for p, q in zip(one, other, strict=True) for a, b in zip(p, q, strict=True))
    half = root(sum(squares, arb(0)) / 8)
    return 2 * half.asin() if half < 1 else arb.nan()


def root(value: Ball) -> Ball:
    """Return the square root of a number that is not negative, whose ball may contain negative numbers."""
    return value.sqrt() if value > 0 else arb(0, value.upper().sqrt().upper())
