"""The search for a time step on curves that are known: how near it comes, with how few runs, also where they are rough."""

import math
import random
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bodycheck.studies.recommend.search import (
    MANY_RUNS,
    MOST_NEIGHBOURS,
    MOST_RUNS,
    Range,
    answer,
    following,
    kept,
    neighbours,
    reversal,
)

#: The error with a time step (s).
Curve = Callable[[float], float]

#: The duration (s) of the runs, and the least and the largest number of their steps.
DURATION, FEWEST, MOST = 60.0, 10, 100_000


def within(limit: float, order: int | None = 4, first: float = 0.2) -> Range:
    """The range of a search that begins at a time step (s)."""
    return Range(limit, order, math.ceil(DURATION / first), FEWEST, MOST)


def searched(curve: Curve, limit: float, order: int | None = 4, first: float = 0.2) -> dict[int, float]:
    """The errors by number of steps of a whole search, in the order in which they were measured."""
    errors: dict[int, float] = {}
    while numbers := following(errors, within(limit, order, first)):
        assert not errors.keys() & set(numbers), "nothing is measured twice"
        for steps in numbers:
            assert FEWEST - 1 <= steps <= MOST * 1.07, "neighbours may be outside of the range"
            errors[steps] = curve(DURATION / steps)
    return errors


def recommended(errors: dict[int, float], limit: float) -> float | None:
    """The time step (s) that a search recommends."""
    steps = answer(errors, within(limit))
    return None if steps is None else DURATION / steps


def largest(curve: Curve, limit: float) -> float | None:
    """The largest of 3,000 steps such that it and every smaller one keep the limit."""
    numbers = sorted({round(FEWEST * (MOST / FEWEST) ** (place / 3000)) for place in range(3001)})
    fewest = kept({steps: curve(DURATION / steps) for steps in numbers}, limit)
    return None if fewest is None else DURATION / fewest


def power_law(order: float, size: float, breaking: float = 0.45) -> Curve:
    """The error of a method with an order: it reaches half a turn, and the method diverges beyond a step (s)."""
    return lambda step: math.inf if step > breaking else min(math.pi, size * step**order)


@given(
    order=st.sampled_from([1, 2, 3, 4]),
    claimed=st.sampled_from([1, 2, 4, None]),
    size=st.floats(0.01, 100),
    limit=st.floats(1e-9, 1),
    first=st.sampled_from([0.001, 0.02, 0.19, 1.0, 6.0]),
)
def test_a_smooth_curve_is_bracketed_with_few_runs(
    order: int, claimed: int | None, size: float, limit: float, first: float
) -> None:
    curve = power_law(order, size)
    errors = searched(curve, limit, claimed, first)
    found, truly = recommended(errors, limit), min((limit / size) ** (1 / order), 0.45)
    if found is None:
        assert truly < DURATION / MOST
        assert len(errors) <= 10
    else:
        # The bracket is at most 5 % wide, the neighbourhood is 3 %, and each rounding to an integer adds a step.
        assert found <= truly
        assert truly <= found * 1.05 * 1.03 + 3 * found**2 / DURATION
        assert len(errors) <= 20 + MOST_NEIGHBOURS
        assert reversal(errors, limit) is None


def test_the_claimed_order_spares_runs() -> None:
    assert len(searched(power_law(4, 5.0), 1e-4, order=4)) <= 6 + MOST_NEIGHBOURS


@given(st.integers(2, 200_000))
def test_neighbours_are_within_three_per_cent_and_at_least_two(steps: int) -> None:
    near = neighbours(steps)
    assert {steps - 1, steps, steps + 1} <= set(near)
    assert len(near) <= MOST_NEIGHBOURS
    assert near == tuple(sorted(set(near)))
    # A quotient has a relative rounding of 1e-16.
    assert all(abs(steps / other - 1) <= 0.03 + 1e-12 for other in near if abs(other - steps) > 1)
    if steps <= 200:
        all_near = [other for other in range(1, 2 * steps + 2) if abs(steps / other - 1) <= 0.03 + 1e-12]
        assert set(near) == {*all_near, steps - 1, steps, steps + 1}, "all of them"
    else:
        # The selection has both ends: the next number on either side is more than 3 % away.
        assert abs(steps / (near[0] - 1) - 1) > 0.03 - 1e-12
        assert abs(steps / (near[-1] + 1) - 1) > 0.03 - 1e-12


def test_a_lucky_step_is_not_recommended_and_is_told() -> None:
    """With 14 steps there is no error; with 15 to 17 the limit is broken."""

    def lucky(step: float) -> float:
        return 0.0 if round(DURATION / step) == 14 else step**2

    limit = (DURATION / 18) ** 2 * (1 + 1e-9)
    errors = searched(lucky, limit, order=2, first=DURATION / 14)
    found = answer(errors, within(limit))
    assert found == 19, "its neighbours, 18 and 20, keep the limit too"
    assert {18, 19, 20} <= errors.keys()
    pair = reversal(errors, limit)
    assert pair is not None
    assert pair[1] == 14
    assert errors[pair[0]] > limit
    assert reversal({steps: error for steps, error in errors.items() if steps != 14}, limit) is None


def test_errors_that_are_too_small_or_too_much_alike_are_monotone() -> None:
    assert reversal({10: 1e-6, 20: 9e-6}, 1e-3) is None, "below a hundredth of the limit"
    assert reversal({10: 8e-4, 20: 8.7e-4}, 1e-3) is None, "less than 10 %"
    assert reversal({10: 8e-4, 20: 9e-4}, 1e-3) == (20, 10)
    assert reversal({10: 8e-4, 20: math.inf, 40: 1e-6}, 1e-3) == (20, 10), "a failed run"
    assert reversal({10: 2.0, 20: 3.0, 40: 1e-4}, 1e-3) is None, "both break the limit"
    assert reversal({10: 2.0, 20: 1.0, 40: 3.0}, 1e-3) == (40, 20), "none keeps the limit"
    assert reversal({10: math.inf, 20: math.inf}, 1e-3) is None
    assert reversal({}, 1e-3) is None


def test_a_hump_below_the_crossing_is_found() -> None:
    def humped(step: float) -> float:
        # Ten times the error about 0.05 s, over a tenth of a decade; alone it would keep the limit up to 0.067 s.
        return 5 * step**4 * (1 + 9 * math.exp(-((math.log10(step / 0.05) / 0.1) ** 2)))

    found = recommended(searched(humped, 1e-4), 1e-4)
    truly = largest(humped, 1e-4)
    assert found is not None
    assert truly is not None
    assert truly < 0.045 < 0.06 < (1e-4 / 5) ** 0.25
    assert found <= truly <= found * 1.1


def test_a_floor_of_rounding_above_the_limit_is_never_reached() -> None:
    errors = searched(lambda step: 5 * step**4 + 1e-12 / step, 1e-12)
    assert recommended(errors, 1e-12) is None
    assert max(errors) == MOST


def test_what_is_exact_is_recommended_with_the_largest_step() -> None:
    errors = searched(lambda step: 0.0, 1e-9)
    assert recommended(errors, 1e-9) == 6.0
    assert len(errors) <= 8


def test_what_always_fails_ends() -> None:
    errors = searched(lambda step: math.inf, 1e-3)
    assert recommended(errors, 1e-3) is None
    assert max(errors) == MOST
    assert len(errors) <= 8


@pytest.mark.parametrize("seed", range(20))
def test_a_rough_curve_ends_with_an_answer_that_holds_for_what_was_measured(seed: int) -> None:
    def rough(step: float) -> float:
        return step * random.Random(f"{seed} {step}").choice([0.1, 1.0, 10.0, math.inf])

    limit = 0.05
    errors = searched(rough, limit, order=1)
    steps = answer(errors, within(limit))
    assert len(errors) <= MOST_RUNS + MOST_NEIGHBOURS
    if steps is not None:
        assert all(errors[more] <= limit for more in errors if more >= steps)
        assert all(errors[near] <= limit for near in neighbours(steps))
    elif len(errors) < MANY_RUNS:
        assert (kept(errors, limit) or math.inf) > MOST
