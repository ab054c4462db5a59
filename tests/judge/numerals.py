"""Numbers of fifty digits and more: elementary functions, vectors, matrices and rotations of `decimal.Decimal`.

All of it must be called within `fifty_digits`, which sets the digits of the thread. Vectors are tuples of three numbers,
matrices tuples of three rows, quaternions tuples w, x, y, z that take the components of a body to those of the world.
"""

from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager
from decimal import ROUND_HALF_EVEN, Context, Decimal, localcontext
from typing import Any

Number = Decimal
Vector = tuple[Any, Any, Any]
Matrix = tuple[Vector, Vector, Vector]
Quaternion = tuple[Decimal, Decimal, Decimal, Decimal]

#: Digits of all arithmetic: fifty that count and some that rounding may use up.
DIGITS = 58

ZERO, ONE, TWO, HALF = Decimal(0), Decimal(1), Decimal(2), Decimal("0.5")
IDENTITY: Matrix = ((ONE, ZERO, ZERO), (ZERO, ONE, ZERO), (ZERO, ZERO, ONE))


def fifty_digits() -> AbstractContextManager[Context]:
    """Return the context in which numbers have `DIGITS` digits."""
    return localcontext(Context(prec=DIGITS, rounding=ROUND_HALF_EVEN, Emin=-99999, Emax=99999))


def exact(value: Any) -> Any:
    """Return a number of a file, or a list of them, without a rounding: the nearest double is what counts."""
    if isinstance(value, list | tuple):
        return tuple(exact(each) for each in value)
    return Decimal(value)


def sine_cosine(angle: Decimal) -> tuple[Decimal, Decimal]:
    """Return the sine and the cosine of an angle (rad), by power series of a part of it and doubled angles."""
    with localcontext() as context:
        context.prec += 20
        halvings = max(0, angle.adjusted() * 4 + 8) if angle else 0
        small = angle / 2**halvings
        square, cosine, sine = -small * small, ZERO, ZERO
        term, order = ONE, 0
        while abs(term) > Decimal(10) ** -context.prec:
            cosine += term
            sine += term / (order + 1)
            order += 2
            term *= square / (order * (order - 1))
        sine *= small
        for _ in range(halvings):
            cosine, sine = cosine * cosine - sine * sine, 2 * sine * cosine
    return +sine, +cosine


def cross(a: Vector, b: Vector) -> Vector:
    """Return the vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a: Iterable[Any], b: Iterable[Any]) -> Any:
    """Return the scalar product."""
    first, *others = (x * y for x, y in zip(a, b, strict=True))
    for other in others:
        first = first + other
    return first


def plus(*vectors: Vector) -> Vector:
    """Return a sum of vectors."""
    total = vectors[0]
    for vector in vectors[1:]:
        total = (total[0] + vector[0], total[1] + vector[1], total[2] + vector[2])
    return total


def times(factor: Any, vector: Vector) -> Vector:
    """Return a multiple of a vector."""
    return (factor * vector[0], factor * vector[1], factor * vector[2])


def minus(a: Vector, b: Vector) -> Vector:
    """Return a difference of vectors."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def size(vector: Iterable[Decimal]) -> Decimal:
    """Return the length of a vector."""
    return sum((value * value for value in vector), ZERO).sqrt()


def unit(vector: Vector) -> Vector:
    """Return a vector of length one."""
    return times(1 / size(vector), vector)


def applied(matrix: Matrix, vector: Vector) -> Vector:
    """Return the product of a matrix and a vector."""
    return (dot(matrix[0], vector), dot(matrix[1], vector), dot(matrix[2], vector))


def transposed(matrix: Matrix) -> Matrix:
    """Return the transpose, for a rotation its inverse."""
    (a, b, c), (d, e, f), (g, h, i) = matrix
    return ((a, d, g), (b, e, h), (c, f, i))


def product(a: Matrix, b: Matrix) -> Matrix:
    """Return the product of two matrices."""
    columns = transposed(b)
    return tuple(tuple(dot(row, column) for column in columns) for row in a)  # type: ignore[return-value]


def about(axis: Vector, sine: Any, cosine: Any) -> Matrix:
    """Return the rotation about a unit axis by the angle of a sine and a cosine, which may be power series."""
    x, y, z = axis
    rest = ONE - cosine
    return (
        (cosine + rest * (x * x), rest * (x * y) - sine * z, rest * (x * z) + sine * y),
        (rest * (x * y) + sine * z, cosine + rest * (y * y), rest * (y * z) - sine * x),
        (rest * (x * z) - sine * y, rest * (y * z) + sine * x, cosine + rest * (z * z)),
    )


def solved(matrix: dict[tuple[int, int], Any], right: dict[int, Any], order: Sequence[int]) -> dict[int, Any]:
    """Return the solution of equations with a positive definite matrix, by elimination without exchanges."""
    matrix, right = dict(matrix), dict(right)
    for n, i in enumerate(order):
        for j in order[n + 1 :]:
            factor = matrix[j, i] / matrix[i, i]
            right[j] = right[j] - factor * right[i]
            for k in order[n + 1 :]:
                matrix[j, k] = matrix[j, k] - factor * matrix[i, k]
    solution: dict[int, Any] = {}
    for n, i in reversed(list(enumerate(order))):
        rest = right[i]
        for j in order[n + 1 :]:
            rest = rest - matrix[i, j] * solution[j]
        solution[i] = rest / matrix[i, i]
    return solution


def matrix_of(quaternion: Quaternion) -> Matrix:
    """Return the rotation of a quaternion of any length."""
    w, x, y, z = quaternion
    norm = w * w + x * x + y * y + z * z
    return (
        ((w * w + x * x - y * y - z * z) / norm, 2 * (x * y - w * z) / norm, 2 * (x * z + w * y) / norm),
        (2 * (x * y + w * z) / norm, (w * w - x * x + y * y - z * z) / norm, 2 * (y * z - w * x) / norm),
        (2 * (x * z - w * y) / norm, 2 * (y * z + w * x) / norm, (w * w - x * x - y * y + z * z) / norm),
    )


def attitude(table: dict[str, Any], otherwise: Matrix = IDENTITY) -> Matrix:
    """Return the rotation that a table of a file gives by Euler angles z-x-z or by a quaternion."""
    if "quaternion" in table:
        return matrix_of(exact(table["quaternion"]))
    if "euler_zxz" not in table:
        return otherwise
    turns = [sine_cosine(angle) for angle in exact(table["euler_zxz"])]
    x, z = (ONE, ZERO, ZERO), (ZERO, ZERO, ONE)
    return product(product(about(z, *turns[0]), about(x, *turns[1])), about(z, *turns[2]))


def angle_between(a: Matrix, b: Matrix) -> Decimal:
    """Return the angle of the rotation between two attitudes (rad), exact to its third power for small ones."""
    turn = product(transposed(a), b)
    sine = size((turn[2][1] - turn[1][2], turn[0][2] - turn[2][0], turn[1][0] - turn[0][1])) / 2
    cosine = (turn[0][0] + turn[1][1] + turn[2][2] - 1) / 2
    if cosine > Decimal("0.9999"):
        return sine
    return size((sine, 1 - cosine))  # large in any case
