"""Vectors, matrices and rotations of the recursion, in any arithmetic.

Numbers are floats, arrays of any type, or expressions of heyoka, which drops terms that are multiplied by zero.
"""

import operator
from collections.abc import Sequence
from typing import Any

#: A number of the arithmetic in use, a vector of three, and the rows of a matrix.
Number = Any
Vec = list[Number]
Rows = list[Vec]

ZERO: Vec = [0, 0, 0]


class Rotation:
    """A rotation from a child's axes to its parent's axes, given by a matrix."""

    def __init__(self, rows: Rows) -> None:
        self.rows = rows

    def out(self, v: Vec) -> Vec:
        """Convert a vector from the parent's axes to the child's axes."""
        return [dot([row[k] for row in self.rows], v) for k in range(3)]

    def back(self, v: Vec) -> Vec:
        """Convert a vector from the child's axes to the parent's axes."""
        return [dot(row, v) for row in self.rows]

    def block(self, block: Rows, symmetric: bool) -> Rows:
        """Convert a matrix from the child's axes to the parent's axes."""
        half = [[dot(row, [line[k] for line in block]) for k in range(3)] for row in self.rows]
        if not symmetric:
            return [[dot(line, row) for row in self.rows] for line in half]
        return mirrored(lambda i, j: dot(half[i], self.rows[j]))


class AboutZ(Rotation):
    """A rotation about z, given by its cosine and sine."""

    def __init__(self, cosine: Number, sine: Number) -> None:
        super().__init__([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
        self.cosine, self.sine = cosine, sine

    def block(self, block: Rows, symmetric: bool) -> Rows:
        """Convert a matrix from the child's axes to the parent's axes.

        In the first two rows and columns, the trace and the antisymmetric part do not change, and the remaining part turns by
        twice the angle.
        """
        (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = block
        double_sine, double_cosine = 2 * self.sine * self.cosine, 1 - 2 * self.sine * self.sine
        mean, half = (xx + yy) / 2, (xx - yy) / 2
        across, skew = (xy, 0) if symmetric else ((xy + yx) / 2, (xy - yx) / 2)
        half, across = half * double_cosine - across * double_sine, half * double_sine + across * double_cosine
        right, up, _ = self.back([xz, yz, 0])
        far, near = (right, up) if symmetric else self.back([zx, zy, 0])[:2]
        return [[mean + half, across + skew, right], [across - skew, mean - half, up], [far, near, zz]]


def quaternion_rows(q: Sequence[Number]) -> Rows:
    """The rotation matrix of a unit quaternion w, x, y, z."""
    w, x, y, z = q
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]


def dot(a: Sequence[Number], b: Sequence[Number]) -> Number:
    return sum(map(operator.mul, a, b))


def cross(a: Vec, b: Vec) -> Vec:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def plus(a: Vec, b: Vec) -> Vec:
    return [one + other for one, other in zip(a, b, strict=True)]


def plus_rows(a: Rows, b: Rows) -> Rows:
    return [plus(one, other) for one, other in zip(a, b, strict=True)]


def transposed(rows: Rows) -> Rows:
    return [list(column) for column in zip(*rows, strict=True)]


def square(entries: Sequence[Number]) -> Rows:
    return [list(entries[3 * k : 3 * k + 3]) for k in range(3)]


def mirrored(entry: Any, size: int = 3) -> Rows:
    """The symmetric matrix whose entries on and above the diagonal are entry(i, j)."""
    half = {(i, j): entry(i, j) for i in range(size) for j in range(i, size)}
    return [[half[min(i, j), max(i, j)] for j in range(size)] for i in range(size)]
