"""Power series in time of the solutions of differential equations, their steps and the roots of their sums.

A `Tape` records the right-hand sides once, as operations of `Series`; `expand` then computes the coefficients of all of them,
order by order, from numbers for the states and parameters.
"""

import math
from collections.abc import Callable, Sequence
from decimal import Decimal
from itertools import islice
from operator import mul
from typing import Any

from tests.judge.numerals import ONE, ZERO, sine_cosine

#: Terms of a series. A step of exp(-2) of the radius of convergence leaves out exp(-2 ORDER), 1e-35.
ORDER = 40
SHORTER = Decimal("0.135")


class Series:
    """One quantity as a power series in time; `steady` ones have a first term alone."""

    __slots__ = ("coefficients", "steady", "tape")

    def __init__(self, tape: "Tape", steady: bool) -> None:
        self.tape, self.steady = tape, steady
        self.coefficients: list[Decimal] = []

    def __add__(self, other: Any) -> Any:
        a = self.coefficients
        if isinstance(other, Series):
            b = other.coefficients
            return self.tape.record(lambda k: a[k] + b[k], self.steady and other.steady)
        if not other:
            return self
        return self.tape.record(lambda k: a[k] if k else a[0] + other, self.steady)

    __radd__ = __add__

    def __neg__(self) -> Any:
        a = self.coefficients
        return self.tape.record(lambda k: -a[k], self.steady)

    def __sub__(self, other: Any) -> Any:
        if isinstance(other, Series):
            a, b = self.coefficients, other.coefficients
            return self.tape.record(lambda k: a[k] - b[k], self.steady and other.steady)
        return self + -other

    def __rsub__(self, other: Any) -> Any:
        return -self + other

    def __mul__(self, other: Any) -> Any:
        a = self.coefficients
        if not isinstance(other, Series):
            if not other:
                return ZERO
            return self if other == ONE else self.tape.record(lambda k: a[k] * other, self.steady)
        b = other.coefficients
        if other.steady:
            return self.tape.record(lambda k: a[k] * b[0], self.steady)
        if self.steady:
            return self.tape.record(lambda k: a[0] * b[k], False)
        return self.tape.record(lambda _k: sum(map(mul, a, reversed(b))), False)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Any:
        a = self.coefficients
        if not isinstance(other, Series):
            return self.tape.record(lambda k: a[k] / other, self.steady)
        b = other.coefficients
        if other.steady:
            return self.tape.record(lambda k: a[k] / b[0], self.steady)
        ratio = Series(self.tape, False)
        q = ratio.coefficients
        return self.tape.record(lambda k: (a[k] - sum(map(mul, q, b[k:0:-1]))) / b[0], False, ratio)

    def __rtruediv__(self, other: Any) -> Any:
        return self.tape.record(lambda k: ZERO if k else other, True) / self

    def sqrt(self) -> Any:
        """Return the square root."""
        a, root = self.coefficients, Series(self.tape, self.steady)
        r = root.coefficients

        def term(k: int) -> Decimal:
            return (a[k] - sum(map(mul, r[1:], r[:0:-1]))) / (2 * r[0]) if k else a[0].sqrt()

        return self.tape.record(term, self.steady, root)

    def sine_cosine(self) -> tuple[Any, Any]:
        """Return the sine and the cosine."""
        angle, sine, cosine = self.coefficients, Series(self.tape, self.steady), Series(self.tape, self.steady)
        s, c = sine.coefficients, cosine.coefficients
        rates: list[Decimal] = []

        def next_sine(k: int) -> Decimal:
            if k == 0:
                rates.clear()
                return sine_cosine(angle[0])[0]
            rates.append(k * angle[k])
            return sum(map(mul, rates, reversed(c)), ZERO) / k

        def next_cosine(k: int) -> Decimal:
            return -sum(map(mul, rates, islice(reversed(s), 1, None))) / k if k else sine_cosine(angle[0])[1]

        return self.tape.record(next_sine, self.steady, sine), self.tape.record(next_cosine, self.steady, cosine)


class Tape:
    """The operations of a system of differential equations, in the order in which they are computed."""

    def __init__(self) -> None:
        self._operations: list[tuple[Callable[[int], Decimal], Series]] = []
        self._inputs: list[Series] = []
        self._states: list[tuple[Series, Any]] = []
        self._watched: list[Series] = []

    def record(self, term: Callable[[int], Any], steady: bool, result: Series | None = None) -> Series:
        """Return the series whose terms an operation gives."""
        result = result or Series(self, steady)
        self._operations.append((term, result))
        return result

    def state(self) -> Series:
        """Return a new state, whose number `expand` is given; `rate` gives its derivative."""
        self._inputs.append(Series(self, False))
        return self._inputs[-1]

    def parameter(self) -> Series:
        """Return a new number that does not change in time, and that `expand` is given in its turn."""
        self._inputs.append(Series(self, True))
        return self._inputs[-1]

    def rate(self, state: Series, derivative: Any) -> None:
        """State the derivative of a state with respect to time."""
        self._states.append((state, derivative))

    @property
    def states(self) -> list[Series]:
        """The states, in the order in which their rates were stated."""
        return [state for state, _ in self._states]

    def watch(self, result: Any) -> None:
        """State that a result must converge within a step, too."""
        if isinstance(result, Series):
            self._watched.append(result)

    def expand(self, numbers: Sequence[Decimal], order: int = ORDER) -> None:
        """Compute so many coefficients of everything, from the numbers of the states and parameters in their order."""
        for _, result in self._operations:
            result.coefficients.clear()
        for each, number in zip(self._inputs, numbers, strict=True):
            each.coefficients[:] = [number, *([ZERO] * (order - 1))] if each.steady else [number]
        for k in range(order):
            for term, result in self._operations:
                result.coefficients.append(ZERO if k and result.steady else term(k))
            for state, derivative in self._states:
                rate = derivative.coefficients[k] if isinstance(derivative, Series) else (ZERO if k else derivative)
                state.coefficients.append(rate / (k + 1))

    def step(self) -> Decimal | None:
        """Return a step (s) in which the states and what is watched converge; None where all are polynomials."""
        least = math.inf
        for series in (*self.states, *self._watched):
            terms = series.coefficients
            scale = max(0.0, _log10(terms[0]))
            for k, term in enumerate(terms[-8:], len(terms) - 8):
                if term:
                    least = min(least, (scale - _log10(term)) / k)
        return None if least == math.inf else Decimal(10) ** Decimal(least) * SHORTER


def _log10(number: Decimal) -> float:
    """Return the logarithm of the size of a number, -inf for zero."""
    exponent = number.adjusted()
    return exponent + math.log10(abs(float(number.scaleb(-exponent)))) if number else -math.inf


def at(coefficients: Sequence[Decimal], time: Decimal) -> Decimal:
    """Return the value of a power series."""
    value = ZERO
    for coefficient in reversed(coefficients):
        value = value * time + coefficient
    return value


def first_root(coefficients: Sequence[Decimal], end: Decimal) -> Decimal | None:
    """Return the first time in (0, end] at which a power series changes its sign; None where it does not.

    A zero at the begin is none. Signs are isolated by the sizes of the terms about the middle of ever shorter intervals.
    """
    scaled, factor = [], ONE
    for coefficient in coefficients:
        scaled.append(coefficient * factor)
        factor *= end
    size = max(map(abs, scaled))
    while scaled and abs(scaled[0]) <= size * Decimal("1e-28"):
        scaled = scaled[1:]
    intervals = [(ZERO, ONE)]
    while intervals and scaled:
        low, high = intervals.pop()
        middle, radius = (low + high) / 2, (high - low) / 2
        terms = _about(scaled, middle, radius)
        if abs(terms[0]) > sum(map(abs, terms[1:])):
            continue
        slopes = [k * abs(term) for k, term in enumerate(terms)][1:]
        if not slopes or slopes[0] > sum(slopes[1:]):
            if (at(scaled, low) > 0) != (at(scaled, high) > 0):
                return end * _bisected(scaled, low, high)
        elif radius > Decimal("1e-24"):
            intervals += [(middle, high), (low, middle)]
    return None


def _about(coefficients: Sequence[Decimal], middle: Decimal, radius: Decimal) -> list[Decimal]:
    """Return the coefficients about another point, in units of a radius."""
    terms = list(coefficients)
    for first in range(len(terms)):
        for k in range(len(terms) - 2, first - 1, -1):
            terms[k] += middle * terms[k + 1]
    factor = ONE
    for k in range(len(terms)):
        terms[k] *= factor
        factor *= radius
    return terms


def _bisected(coefficients: Sequence[Decimal], low: Decimal, high: Decimal) -> Decimal:
    """Return the root between two points with other signs, by Newton's method within the interval that is left."""
    slopes = [k * term for k, term in enumerate(coefficients)][1:]
    rising = at(coefficients, high) > 0
    point = (low + high) / 2
    for _ in range(400):
        value = at(coefficients, point)
        low, high = (low, point) if (value > 0) == rising else (point, high)
        slope = at(slopes, point)
        after = point - value / slope if slope else low
        if not low <= after <= high:
            after = (low + high) / 2
        if abs(after - point) <= Decimal("1e-48") * after:
            return after
        point = after
    return point
