"""The search for the largest stable step, and what it finds for schemes whose limit is known."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bodycheck import load, simulate
from bodycheck.studies.extremes.stability import FINAL_RATIO, PRODUCTS, SECTIONS, Bracket, bracket, stable, turning


def search(is_stable: "dict[float, bool] | float", interrupted: bool = False) -> tuple[Bracket, dict[float, bool]]:
    """The bracket in the end and all probes; what is stable is below a number, but for exceptions."""
    probes: dict[float, bool] = {}
    while following := (known := bracket(probes)).following:
        for product in following[: 1 if interrupted else None]:
            assert product not in probes
            if isinstance(is_stable, float):
                probes[product] = product < is_stable
            else:
                probes[product] = is_stable.get(product, product < is_stable[0.0])
    return known, probes


@given(st.floats(1.6e-3, 6.2))
def test_a_limit_is_enclosed_to_two_percent(limit: float) -> None:
    found, probes = search(limit)
    if limit <= 4 * PRODUCTS[-1]:  # several halvings below it must be stable too
        return
    assert found.stable is not None
    assert found.unstable is not None
    assert found.stable < limit <= found.unstable <= FINAL_RATIO * found.stable
    assert len(probes) <= len(PRODUCTS) + 2 * (SECTIONS - 1)


@given(st.floats(1e-3, 10.0))
def test_an_interrupted_search_finds_the_same(limit: float) -> None:
    assert search(limit)[0] == search(limit, interrupted=True)[0]


def test_all_stable_and_none() -> None:
    assert search(10.0)[0] == Bracket(stable=PRODUCTS[0])
    assert search(1e-3)[0] == Bracket(unstable=PRODUCTS[-1])


def test_a_stable_step_among_unstable_ones_is_not_taken_for_the_limit() -> None:
    limit, island = 0.1, PRODUCTS[1]
    found, _ = search({0.0: limit, island: True})
    assert found.stable is not None
    assert found.stable < limit < found.stable * FINAL_RATIO


CASE = load("extreme-spin")


def limit_of(engine: str, integrator: str, rate: float) -> float | None:
    case, probes = turning(CASE, rate), {}
    while following := (known := bracket(probes)).following:
        for product in following:
            probes[product] = stable(case.scene, simulate(case, engine, integrator, product / rate).outcome)
    return known.stable


@pytest.mark.parametrize("rate", [10.0, 1e4])
def test_rk4_is_stable_to_half_a_turn_in_a_step_whatever_the_spin(rate: float) -> None:
    # Measured: 3.21 rad, the same for both engines, whose schemes are the same; a hundred turns at 10 and at 1e4 rad/s.
    assert limit_of("mujoco", "RK4", rate) == limit_of("pinocchio", "rk4", rate) == pytest.approx(3.21, rel=0.01)


def test_implicit_euler_is_less_stable_than_rk4() -> None:
    # It holds at a whole turn in a step, but not at half of one: the limit is below.
    case = turning(CASE, 10.0)
    assert stable(case.scene, simulate(case, "mujoco", "implicit", 2 * math.pi / 10).outcome)
    assert limit_of("mujoco", "implicit", 10.0) == pytest.approx(1.93, rel=0.01)


def test_mujoco_has_no_stable_step_where_its_bound_on_accelerations_is_exceeded() -> None:
    # At 1e6 rad/s the wobble's accelerations are of the order of 0.01 * (1e6 rad/s)^2 = 1e10 rad/s^2, its largest number.
    assert limit_of("mujoco", "RK4", 1e6) is None
    assert limit_of("pinocchio", "rk4", 1e6) == pytest.approx(3.21, rel=0.01)
