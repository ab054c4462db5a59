"""The derivatives of the efforts of a tree along directions, in balls, in power series of balls, or in arrays of doubles."""

from collections.abc import Sequence
from typing import Any

from bodycheck.reference.proof.trees.dynamics import efforts, negative, plus, times
from bodycheck.reference.proof.trees.tree import Number, Tree

#: The derivatives of a number along directions, by their indices; those that are missing are zero.
Slopes = dict[int, Number]


class Slope:
    """A number with its derivatives along some directions."""

    __slots__ = ("slopes", "value")
    __array_ufunc__ = None  # so that arrays leave their products with slopes to this class

    def __init__(self, value: Number, slopes: Slopes) -> None:
        self.value = value
        self.slopes = slopes

    def __add__(self, other: Any) -> "Slope":
        if not isinstance(other, Slope):
            return Slope(plus(self.value, other), self.slopes)
        slopes = dict(self.slopes)
        for index, slope in other.slopes.items():
            slopes[index] = plus(slopes[index], slope) if index in slopes else slope
        return Slope(plus(self.value, other.value), slopes)

    __radd__ = __add__

    def __sub__(self, other: "Slope") -> "Slope":
        return self + -other

    def __neg__(self) -> "Slope":
        return Slope(negative(self.value), {index: negative(slope) for index, slope in self.slopes.items()})

    def __mul__(self, other: Any) -> "Slope":
        if not isinstance(other, Slope):
            return Slope(times(self.value, other), {index: times(slope, other) for index, slope in self.slopes.items()})
        slopes = {index: times(slope, other.value) for index, slope in self.slopes.items()}
        for index, slope in other.slopes.items():
            part = times(self.value, slope)
            slopes[index] = plus(slopes[index], part) if index in slopes else part
        return Slope(times(self.value, other.value), slopes)

    __rmul__ = __mul__


#: The sines and cosines of coordinates.
Turns = tuple[Sequence[Number], Sequence[Number]]


def along(tree: Tree, motion: Sequence[Sequence[Number]], turns: Turns, directions: Sequence[Sequence[Slopes]]) -> list[Slopes]:
    """Return the derivatives of all efforts along directions.

    motion: coordinates, velocities and accelerations. directions: the derivatives of these along the directions.
    """
    q, v, a = (
        [Slope(value, slopes) if slopes else value for value, slopes in zip(values, rows, strict=True)]
        for values, rows in zip(motion, directions, strict=True)
    )
    sines, cosines = list(turns[0]), list(turns[1])
    for i, slopes in enumerate(directions[0]):
        if slopes:
            s, c = turns[0][i], turns[1][i]
            sines[i] = Slope(s, {index: times(c, slope) for index, slope in slopes.items()})
            cosines[i] = Slope(c, {index: negative(times(s, slope)) for index, slope in slopes.items()})
    needed = efforts(tree, q, v, a, sines, cosines)
    return [each.slopes if isinstance(each, Slope) else {} for each in needed]


def each_alone(size: int, part: int) -> list[list[Slopes]]:
    """Return the directions of all coordinates (part 0), velocities (1) or accelerations (2), each alone."""
    return [[{i: 1} if which == part else {} for i in range(size)] for which in range(3)]
