"""Pairs of numbers of the wide type against arithmetic of a hundred digits."""

import operator
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from bodycheck.reference.exact import pairs
from bodycheck.reference.exact.numbers import MP, real
from bodycheck.reference.exact.pairs import PAIR_ROUNDING, Pair
from bodycheck.reference.trajectory import Array

COUNT = 400


def exact(value: Pair, index: int) -> Any:
    return MP.convert(value.high[index]) + MP.convert(value.low[index])


def numbers(seed: int) -> Pair:
    """Random pairs of sizes from 1e-6 to 1e6 and both signs, with all their digits."""
    rng = np.random.default_rng(seed)
    size = rng.choice([-1.0, 1.0], COUNT) * 10 ** rng.uniform(-6, 6, COUNT)
    return pairs.of_wide(size) / pairs.of_wide(rng.uniform(1, 2, COUNT))


@pytest.mark.parametrize("operation", [operator.add, operator.sub, operator.mul, operator.truediv])
def test_each_operation_errs_by_less_than_a_rounding_of_pairs(operation: Callable[[Any, Any], Any]) -> None:
    one, other = numbers(1), numbers(2)
    found = operation(one, other)
    for index in range(COUNT):
        expected = operation(exact(one, index), exact(other, index))
        assert abs(exact(found, index) - expected) <= PAIR_ROUNDING * abs(expected)


def test_a_difference_of_neighbours_has_all_its_digits() -> None:
    one = numbers(3)
    other = one * pairs.of_wide(np.full(COUNT, 1 + 2.0**-52))
    found = other - one
    for index in range(COUNT):
        expected = exact(other, index) - exact(one, index)
        assert abs(exact(found, index) - expected) <= PAIR_ROUNDING * abs(expected)


def test_square_roots() -> None:
    value = numbers(4)
    value = value * value
    found = pairs.root(value)
    for index in range(COUNT):
        expected = MP.sqrt(exact(value, index))
        assert abs(exact(found, index) - expected) <= PAIR_ROUNDING * expected
    perfect = pairs.root(pairs.of_wide([0.0, 25.0, 2.0**-40]))
    np.testing.assert_array_equal(perfect.high, [0.0, 5.0, 2.0**-20])
    np.testing.assert_array_equal(perfect.low, 0.0)


def test_squares_of_doubles_are_exact() -> None:
    values: Array = numbers(5).high.astype(float)
    found = pairs.squares(values)
    assert [exact(found, index) for index in range(COUNT)] == [real(value) ** 2 for value in values.tolist()]


def test_doubles_are_the_nearest_ones() -> None:
    value = numbers(6)
    nearest = pairs.doubles(value)
    assert nearest.tolist() == [float(exact(value, index)) for index in range(COUNT)]
    # A number that a second rounding, from the wide type, would take to the wrong side: half-way but for its low part.
    beside = np.array([1.0, -1.0, 1 + 2.0**-52, -(2.0**30) * (1 + 2.0**-52)])
    half = np.copysign(np.spacing(np.abs(beside)) / 2, beside)
    for tiny in (2.0**-100, -(2.0**-100), 0.0):
        value = pairs.of_wide(beside) + pairs.of_wide(half) + pairs.of_wide(beside * tiny)
        assert pairs.doubles(value).tolist() == [float(exact(value, index)) for index in range(len(beside))]


def test_numbers_of_a_hundred_digits_keep_those_of_a_pair() -> None:
    values = [MP.pi, -MP.sqrt(2), MP.mpf(1) / 3, MP.mpf(0)]
    found = pairs.of_reals(values)
    assert all(abs(exact(found, index) - value) <= PAIR_ROUNDING * abs(value) for index, value in enumerate(values))


def test_pairs_are_compared_by_all_their_digits() -> None:
    one = pairs.of_reals([MP.pi] * 3)
    steps = np.array([0.0, 1e-30, -1e-30])
    np.testing.assert_array_equal(pairs.compare(one + pairs.of_wide(steps), one), [0, 1, -1])
