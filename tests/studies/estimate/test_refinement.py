"""Estimates from differences between runs whose exact error is known."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bodycheck.studies.estimate import refinement
from bodycheck.studies.estimate.refinement import Reference

LEVELS = 7

#: One rounding at the start, and the number of steps of the finest run.
NUDGE, STEPS = 1e-15, 10_000


def differences(errors: list[float]) -> dict[tuple[int, int], float]:
    return {
        (one, other): abs(errors[one] - errors[other]) for one in range(len(errors)) for other in range(one + 1, len(errors))
    }


def intervals(errors: list[float], factor: float = 1.5, claimed: float = math.inf) -> list[refinement.Interval | None]:
    apart, count = differences(errors), len(errors)
    known = refinement.reference(apart, count, NUDGE, STEPS, factor, claimed)
    assert isinstance(known, Reference), known
    return [refinement.interval(known, apart, count, level, NUDGE, factor) for level in range(count)]


@given(order=st.integers(1, 4), size=st.floats(1e-3, 0.1), curved=st.floats(-0.3, 0.3))
def test_the_intervals_of_errors_that_fall_by_a_power_contain_them(order: int, size: float, curved: float) -> None:
    errors = [size * 2.0 ** (-order * level) * (1 + curved * 2.0**-level) for level in range(LEVELS)]
    for error, interval in zip(errors, intervals(errors), strict=True):
        assert interval is not None
        assert interval.low <= error <= interval.high


def test_the_observed_order_is_that_of_the_errors() -> None:
    errors = [2.0 ** (-2 * level) for level in range(LEVELS)]
    known = refinement.reference(differences(errors), LEVELS, NUDGE, STEPS, 1.5)
    assert isinstance(known, Reference)
    assert known.level == LEVELS - 1
    assert known.order == pytest.approx(2, abs=1e-9)
    assert known.error == pytest.approx(errors[-1], rel=1e-9)


def test_no_order_above_the_claimed_one_is_relied_on() -> None:
    errors = [2.0 ** (-6 * level) for level in range(4)]
    known = refinement.reference(differences(errors), 4, NUDGE, STEPS, 1.5, claimed=4)
    assert isinstance(known, Reference)
    assert known.error > errors[-1]  # the error of an order that is too high for the method is not trusted to be so small


def test_differences_that_do_not_fall_have_no_estimate_at_the_finest_level() -> None:
    errors = [1.0, 0.5, 0.1, 0.2, 0.05, 0.17]
    apart = differences(errors)
    known = refinement.reference(apart, len(errors), NUDGE, STEPS, 1.5)
    assert isinstance(known, Reference)
    assert known.kind == "uneven"
    assert "do not fall evenly" in known.reason
    assert refinement.interval(known, apart, len(errors), len(errors) - 1, NUDGE, 1.5) is None


def test_a_run_far_from_uneven_finer_ones_still_has_an_estimate() -> None:
    errors = [1.0, 1.3e-4, 1.9e-4, 1.1e-4, 1.6e-4, 1.2e-4]
    first, *others = intervals(errors)
    assert first is not None
    assert first.low <= 1.0 <= first.high
    assert others[-1] is None


def test_differences_that_are_rounding_end_the_refinement() -> None:
    errors = [1e-4, 1e-4 / 16, 1e-4 / 256, 1e-4 / 4096, 3e-12, 5e-12, 4e-12]
    estimates = intervals(errors)
    for error, interval in zip(errors, estimates, strict=True):
        assert interval is not None
        assert interval.low <= error <= interval.high
    assert math.isclose(estimates[0].estimate if estimates[0] is not None else 0.0, 1e-4, rel_tol=0.01)


def test_a_motion_without_error_has_an_error_of_rounding() -> None:
    for interval in intervals([0.0, 2e-16, 1e-16, 3e-16, 2e-16]):
        assert interval is not None
        assert interval.low == 0
        assert interval.high < 1e-13


def test_three_steps_are_too_few() -> None:
    known = refinement.reference(differences([1.0, 0.5, 0.25]), 3, NUDGE, STEPS, 1.5)
    assert known == "fewer than 4 time steps could be compared"


def test_a_finer_level_that_contradicts_a_reference_is_not_ignored() -> None:
    # Four levels of first order, and then a step that changes the motion, as an impact that is missed.
    errors = [0.8, 0.4, 0.2, 0.1, 0.9, 0.9]
    known = refinement.reference(differences(errors), len(errors), NUDGE, STEPS, 1.5)
    assert isinstance(known, Reference)
    assert known.kind == "uneven"


def test_an_error_that_falls_faster_than_claimed_has_a_wider_interval() -> None:
    """Errors C h^6 + D h^4 with the smaller term of the claimed order: the next run would be worse than by order 6."""
    errors = [1.2e-6 / 64**level + 2.8e-8 / 16**level for level in range(4)]
    apart = {(one, other): errors[one] - errors[other] for one in range(4) for other in range(one + 1, 4)}
    seen = refinement.reference(apart, 4, 1e-16, 1000, 1.25, 4.0)
    assert isinstance(seen, refinement.Reference)
    assert seen.loose > 1
    finest = refinement.interval(seen, apart, 4, seen.level, 0.0, 1.25)
    assert finest is not None
    assert finest.low <= errors[seen.level] <= finest.high
    even = [2.8e-8 / 16**level for level in range(4)]
    apart = {(one, other): even[one] - even[other] for one in range(4) for other in range(one + 1, 4)}
    plain = refinement.reference(apart, 4, 1e-16, 1000, 1.25, 4.0)
    assert isinstance(plain, refinement.Reference)
    assert plain.loose == 1


def test_differences_that_fall_after_they_have_risen_are_due_to_rounding() -> None:
    """Positions of a brick that falls for 30 s: roundings that are alike in all steps add up, in runs of up to 1e6 steps."""
    errors = [8e-10, 1.1e-9, 1.4e-9, 1e-8, 7.3e-9, 2.9e-8, 5.5e-8, 6.8e-8, 7.46e-8]
    count = len(errors)
    apart = {(one, other): abs(errors[one] - errors[other]) for one in range(count) for other in range(one + 1, count)}
    seen = refinement.reference(apart, count, 8.8e-12, 960_512, 1.25, 4.0)
    assert isinstance(seen, refinement.Reference)
    for level, error in enumerate(errors):
        rounding = refinement.accumulated(8.8e-12, 3752 * 2**level)
        ends = refinement.interval(seen, apart, count, level, rounding, 1.25)
        assert ends is not None
        assert ends.low <= error <= ends.high, level


@given(
    error=st.floats(1e-6, 1.0),
    shares=st.lists(st.floats(-1, 1), min_size=LEVELS, max_size=LEVELS),
    order=st.integers(1, 4),
)
def test_an_error_at_the_end_within_the_largest_over_time_is_contained(error: float, shares: list[float], order: int) -> None:
    """The error of each level at the end is any part of its largest over time, also zero, with either sign."""
    largest = [error * 2.0 ** (order * (LEVELS - 1 - level)) for level in range(LEVELS)]
    ends = [size * share for size, share in zip(largest, shares, strict=True)]
    known = Reference(LEVELS - 1, error, float(order), borrowed=True)
    for level, end in enumerate(ends):
        interval = refinement.interval(known, differences(ends), LEVELS, level, NUDGE, 1.25)
        assert interval is not None
        assert interval.low <= abs(end) <= interval.high
