"""The derivatives of the efforts of a tree by coordinates, velocities and accelerations, in balls."""

from collections.abc import Sequence
from typing import Any

from flint import arb

from bodycheck.reference.proof.trees import Number, Tree, efforts, negative, plus, times

#: The derivatives of a number by all variables, by their indices; those that are missing are zero.
Slopes = dict[int, Number]


class Slope:
    """A number with its derivatives by some variables."""

    __slots__ = ("slopes", "value")

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


def jacobians(tree: Tree, q: Sequence[Any], v: Sequence[Any], a: Sequence[Any]) -> list[list[list[Any]]]:
    """Return the derivatives of all efforts by coordinates, velocities and accelerations, each as rows of balls."""
    size = len(q)
    sines = [Slope(value.sin(), {i: value.cos()}) for i, value in enumerate(q)]
    cosines = [Slope(value.cos(), {i: -value.sin()}) for i, value in enumerate(q)]
    at, moving, hurrying = (
        [Slope(value, {part * size + i: 1}) for i, value in enumerate(values)] for part, values in enumerate((q, v, a))
    )
    needed = efforts(tree, at, moving, hurrying, sines, cosines)
    return [[[_ball(each, part * size + i) for i in range(size)] for each in needed] for part in range(3)]


def _ball(value: Number, index: int) -> Any:
    slope = value.slopes.get(index, 0) if isinstance(value, Slope) else 0
    return arb(slope) if isinstance(slope, int) else slope
