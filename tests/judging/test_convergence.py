"""Orders and floors are read off runs as they are, from what is known of an error that is G h^p above a limit."""

import math
from itertools import pairwise
from random import Random

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from scipy.optimize import brentq

from bodycheck import load, simulate, truth
from bodycheck.judging.schemes.convergence import (
    UNITS,
    asymptotic,
    attitude_order,
    common,
    converge,
    local_orders,
    observe_convergence,
    root,
)
from bodycheck.reference.trajectory import Trajectory
from bodycheck.results.outcome import Completed

LADDER = (0.02, 0.01, 0.005, 0.002, 0.001, 0.0005, 0.0002)
ORDERS = st.floats(0.5, 6)
SIZES = st.floats(1e-3, 1e3)


def changes(errors: list[float]) -> list[float]:
    """What an error of one sign changes by from step to step."""
    return [abs(coarse - fine) for coarse, fine in pairwise(errors)]


def test_a_root_is_that_of_scipy_to_the_last_bit() -> None:
    chance = Random(1)
    for _ in range(300):
        base, exponent = chance.uniform(0.1, 9.0), chance.uniform(0.3, 9.9)

        def function(x: float, base: float = base, exponent: float = exponent) -> float:
            return base**x - base**exponent

        assert root(function, 0.25, 10.0) == brentq(function, 0.25, 10.0)
    for known, first, second in ((math.cos, 0.0, 3.0), (math.sin, -1.0, 1.0), (math.sin, 0.0, 1.0), (math.atan, -1e3, 1e2)):
        assert root(known, first, second) == brentq(known, first, second)


@given(ORDERS, SIZES, st.floats(-1e3, 1e3))
@example(order=5.0, size=4.0, limit=2.2e-16)  # many times the last error, but not the last change
def test_a_power_law_above_any_limit_shows_its_order(order: float, size: float, limit: float) -> None:
    powers = [size * h**order for h in LADDER]
    # Formed without the limit: as small differences of large numbers they would be rounding.
    found = local_orders(LADDER, changes(powers))
    assert found == pytest.approx([order] * 5, rel=1e-6)  # brentq's tolerance, and the rounding of the differences
    converged = converge(LADDER, [abs(power + limit) for power in powers], changes(powers))
    assert converged.order == pytest.approx(order, rel=1e-6)
    # At first order 2/3 of the last change would be left, of which an error of the limit is three times as much. The last of
    # the powers, which may have the other sign, is at most 1.8 times the last change, at the order 1/2.
    if abs(limit) > 4 * changes(powers)[-1]:
        assert converged.floor == pytest.approx(abs(powers[-1] + limit), abs=0)


@given(ORDERS.filter(lambda order: order > 1), SIZES)
def test_an_error_that_is_still_falling_has_no_floor(order: float, size: float) -> None:
    powers = [size * h**order for h in LADDER]
    assert converge(LADDER, powers, changes(powers)).floor is None


def test_rounding_is_a_floor_and_ends_the_asymptotic_range() -> None:
    noise = np.random.default_rng(1).uniform(0.5, 1, len(LADDER)) * 1e-9
    errors = [*(1e3 * h**4 for h in LADDER[:5]), *noise[5:].tolist()]
    found = converge(LADDER, errors, [max(pair) for pair in pairwise(errors)])
    assert found.order is not None
    assert found.order == pytest.approx(4, abs=0.1)  # of changes that are taken as large as the larger error
    assert found.floor == min(errors)


def test_orders_that_do_not_agree_are_none() -> None:
    assert asymptotic([1.0, 2.0, 1.0, 2.0, 1.0]) == []
    assert asymptotic([1.0, 1.01]) == [], "two local orders may agree by chance"
    assert asymptotic([math.nan, 1.0, 1.01, math.nan, 0.99]) == []
    assert asymptotic([3.0, 1.1, 1.05, 1.02, math.nan, 0.3]) == [1.1, 1.05, 1.02]
    assert asymptotic([2.0, 2.0, 2.0, 9.0, 1.0, 1.0, 1.0]) == [1.0, 1.0, 1.0], "of two, the one with the finer steps"


def test_nothing_that_moves_has_neither_order_nor_floor() -> None:
    found = converge(LADDER, [0.0] * 7, [0.0] * 6)
    assert (found.order, found.floor) == (None, None)


def trajectory(t: np.ndarray) -> Trajectory:
    position = np.column_stack([t, 0 * t, 0 * t])
    return Trajectory(t, position, np.tile([1.0, 0, 0, 0], (len(t), 1)), 0 * position, 0 * position)


@given(st.integers(1, 40), st.integers(1, 40), st.floats(1e-5, 1e-1))
def test_runs_are_compared_at_instants_that_all_of_them_have(m: int, n: int, h: float) -> None:
    coarse, fine = trajectory(np.arange(60) * (h * m * n)), trajectory(np.arange(200) * (h * n))
    shared = common([coarse, fine])
    # Multiples of one step that meet those of the other to rounding; positions here are the times themselves.
    assert shared[0].t == pytest.approx(shared[1].t, rel=1e-12)
    assert len(shared[0]) == min(60, 199 // m + 1)
    assert shared[1].position[:, 0] == pytest.approx(shared[0].t, rel=1e-12)


def test_runs_with_nothing_in_common_tell_nothing() -> None:
    case = load("projectile")
    runs = [(h, simulate(case, "mujoco", "Euler", h).outcome) for h in (0.02, 0.0133, 0.0077)]
    trajectories = [(h, outcome.trajectory) for h, outcome in runs if isinstance(outcome, Completed)]
    assert observe_convergence(trajectories, truth(case), {}, 2.0**-53) == {}


@pytest.mark.parametrize(("integrator", "order"), [("Euler", 1), ("RK4", 4)])
def test_three_steps_of_an_engine_show_its_order(integrator: str, order: int) -> None:
    case = load("osrf-boxes-complex")
    runs = [(h, simulate(case, "mujoco", integrator, h).outcome) for h in (0.004, 0.002, 0.001)]
    trajectories = [(h, outcome.trajectory) for h, outcome in runs if isinstance(outcome, Completed)]
    # Local orders of three steps are off by terms of the next order: 4 % at 4 ms (and rounding, of RK4).
    assert attitude_order(trajectories, truth(case, trajectories[0][1].t)) == pytest.approx(order, abs=0.25)


def test_floors_are_told_by_their_cause() -> None:
    """A limit is what runs tend to; by rounding smaller steps change them no less, but no more than so many roundings can."""
    rounded = 1e-12
    limit = converge(LADDER, [1e-3 + h for h in LADDER], changes([1e-3 + h for h in LADDER]), rounded)
    assert (limit.floor, limit.cause) == (pytest.approx(1.2e-3), "limit")
    errors = [1e-5, 1e-7, 1e-9, 2e-10, 5e-10, 1e-9, 2e-9]
    larger = [max(pair) for pair in pairwise(errors)]
    assert converge(LADDER, errors, larger, rounded).cause == "rounding"
    assert converge(LADDER, errors, larger, rounded / 1e6).cause == "", "there are not as many roundings in the run"


def test_the_order_of_a_motion_that_is_lost_is_that_of_its_beginning() -> None:
    """After ten seconds of a flip every first-order step of 2.5 to 40 ms has led to another attitude."""
    case = load("intermediate-axis-flip")
    runs = [(h, simulate(case, "mujoco", "Euler", h).outcome) for h in (0.04, 0.02, 0.01, 0.005, 0.0025)]
    trajectories = [(h, outcome.trajectory) for h, outcome in runs if isinstance(outcome, Completed)]
    lost = dict.fromkeys(UNITS, [3.0] * len(runs))
    found = observe_convergence(trajectories, truth(case), lost, 2.0**-53)["attitude"]
    assert found.horizon == pytest.approx(2.5, abs=0.05)  # halved twice, to an instant that all runs have
    assert found.order == pytest.approx(1, abs=0.1)  # the next term of the error, at 40 ms and some 2 rad/s
    assert found.floor is None
