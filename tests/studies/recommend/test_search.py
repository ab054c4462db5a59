"""The search for a time step on curves that are known: how near it comes, with how few runs, also where they are rough."""

import math
import random
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bodycheck.studies.recommend.search import MOST_STEPS, Range, answer, following, rounded_down, rounded_up

#: The error with a time step (s).
Curve = Callable[[float], float]


def searched(curve: Curve, limit: float, order: int | None = 4, first: float = 0.2) -> dict[float, float]:
    """The errors by time step of a whole search from 6 s down to 0.6 ms, in the order in which they were measured."""
    within = Range(limit, order, first, smallest=6e-4, largest=6.0)
    errors: dict[float, float] = {}
    while (step := following(errors, within)) is not None:
        assert step not in errors, "nothing is measured twice"
        assert within.smallest <= step <= within.largest
        assert float(f"{step:.1e}") == step, "two digits"
        errors[step] = curve(step)
    return errors


def largest(curve: Curve, limit: float) -> float | None:
    """The largest of 3,000 steps such that it and every smaller one keep the limit."""
    dense = {step: curve(step) for step in (6e-4 * 1e4 ** (place / 3000) for place in range(3001))}
    return answer(dense, limit)


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
    found, truly = answer(errors, limit), min((limit / size) ** (1 / order), 0.45)
    if found is None:
        assert truly < 6e-4
        assert len(errors) <= 10
    else:
        assert found <= truly
        # Two neighbouring numbers with two digits are at most 10 % apart; the largest 0.45 s is itself one.
        assert truly <= found * 1.1 * (1 + 1e-9)
        assert len(errors) <= 20


def test_the_claimed_order_spares_runs() -> None:
    assert len(searched(power_law(4, 5.0), 1e-4, order=4)) <= 6


def test_a_hump_below_the_crossing_is_found() -> None:
    def humped(step: float) -> float:
        # Ten times the error about 0.05 s, over a tenth of a decade; alone it would keep the limit up to 0.067 s.
        return 5 * step**4 * (1 + 9 * math.exp(-((math.log10(step / 0.05) / 0.1) ** 2)))

    found = answer(searched(humped, 1e-4), 1e-4)
    truly = largest(humped, 1e-4)
    assert found is not None
    assert truly is not None
    assert truly < 0.045 < 0.06 < (1e-4 / 5) ** 0.25
    assert found <= truly <= found * 1.1


def test_a_floor_of_rounding_above_the_limit_is_never_reached() -> None:
    errors = searched(lambda step: 5 * step**4 + 1e-12 / step, 1e-12)
    assert answer(errors, 1e-12) is None
    assert min(errors) == 6e-4


def test_what_is_exact_is_recommended_with_the_largest_step() -> None:
    errors = searched(lambda step: 0.0, 1e-9)
    assert answer(errors, 1e-9) == 6.0
    assert len(errors) <= 6


def test_what_always_fails_ends() -> None:
    errors = searched(lambda step: math.inf, 1e-3)
    assert answer(errors, 1e-3) is None
    assert min(errors) == 6e-4
    assert len(errors) <= 8


@pytest.mark.parametrize("seed", range(20))
def test_a_rough_curve_ends_with_an_answer_that_holds_for_what_was_measured(seed: int) -> None:
    def rough(step: float) -> float:
        return step * random.Random(f"{seed} {step}").choice([0.1, 1.0, 10.0, math.inf])

    limit = 0.05
    errors = searched(rough, limit, order=1)
    found = answer(errors, limit)
    assert len(errors) <= MOST_STEPS
    kept = [step for step in errors if found is not None and step <= found]
    assert all(errors[step] <= limit for step in kept)
    broken = [step for step, error in errors.items() if error > limit]
    assert bool(kept) == (min(errors) not in broken)
    if found is not None and broken and len(errors) < MOST_STEPS:
        assert min(broken) <= found * 1.1 * (1 + 1e-9)


@given(st.floats(1e-12, 1e12))
def test_steps_are_rounded_to_numbers_with_two_digits(step: float) -> None:
    down, up = rounded_down(step), rounded_up(step)
    assert down <= step <= up
    assert up <= down * 1.1 * (1 + 1e-9)
    for number in (down, up):
        assert float(f"{number:.1e}") == number
        assert rounded_down(number) == rounded_up(number) == number
