"""Flight against the air: two ways agree, and limits that are known."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bodycheck import compare, load, simulate, truth
from bodycheck.reference.flight.drag.translation import translation
from bodycheck.reference.flight.drag.witness import witness
from bodycheck.reference.observables import observe
from bodycheck.reference.scene import Body, Scene, State
from tests.support.cases import shortened

TIMES = np.linspace(0, 5, 26)
SPEED = st.one_of(st.floats(-40, 40), st.sampled_from([0.0, 1e-3, 1e-6, 1e-9, 1e-12, -1e-12, 1e-100]))


def thrown(velocity: tuple[float, float, float], resistance: float = 0.01, gravity: float = 9.81) -> Scene:
    return Scene(Body(0.4, (1.0, 1.0, 1.0)), State((1.0, 2.0, 3.0), velocity=velocity), gravity, drag=resistance)


@settings(max_examples=60, deadline=None)  # the first example may compile the witness
@given(st.tuples(SPEED, SPEED, SPEED), st.floats(1e-4, 1.0), st.sampled_from([0.0, 1.62, 9.81]))
def test_two_ways_agree(velocity: tuple[float, float, float], resistance: float, gravity: float) -> None:
    scene = thrown(velocity, resistance, gravity)
    found, other = translation(scene, TIMES), witness(scene, TIMES)
    if other is None:
        assert not gravity
        assert not any(velocity)
        return
    for one, seen in (found.position, other.motion.position), (found.velocity, other.motion.velocity):
        # Up to 200 m by DOP853, of which the witness is sure to 2e-12; by heyoka it is better.
        np.testing.assert_allclose(one[other.instants], seen.astype(float), rtol=0, atol=1e-9)


def test_a_long_fall_reaches_the_terminal_speed() -> None:
    velocity = translation(thrown((5.0, 0.0, 0.0)), np.array([0.0, 60.0])).velocity
    # After 30 times the time constant, v / g = 2 s, e^-30 is left of the beginning.
    assert velocity[-1, 2] == pytest.approx(-math.sqrt(0.4 * 9.81 / 0.01), rel=1e-12, abs=0)
    assert abs(velocity[-1, 0]) < 1e-10


def test_without_gravity_a_body_coasts_by_a_logarithm() -> None:
    found = translation(thrown((3.0, 0.0, 4.0), gravity=0.0), TIMES)
    way = np.log1p(0.01 / 0.4 * 5.0 * TIMES) / (0.01 / 0.4)
    np.testing.assert_allclose(np.linalg.norm(found.position - [1, 2, 3], axis=1), way, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(found.velocity, axis=1), 5.0 / (1 + 0.01 / 0.4 * 5.0 * TIMES), rtol=1e-13)


def test_little_drag_is_no_drag() -> None:
    weak, none = (translation(thrown((10.0, 0.0, 10.0), resistance), TIMES).position for resistance in (1e-13, 0.0))
    # The way lost grows as k v^2 t^2 / 2m: 1e-8 m at most here.
    np.testing.assert_allclose(weak, none, atol=1e-8)


def test_the_energy_lost_is_the_work_of_the_drag() -> None:
    case = load("football-drag")
    times = np.linspace(0, case.duration, 20001)
    found = truth(case, times)
    seen = observe(case.scene, found.trajectory)
    power = case.scene.drag * np.linalg.norm(found.trajectory.velocity, axis=1) ** 3
    work = np.trapezoid(power, times)
    # The trapezoidal rule at 0.1 ms.
    assert seen.total_energy[0] - seen.total_energy[-1] == pytest.approx(work, rel=1e-7)


def test_the_range_of_the_football_without_air_is_the_closed_form() -> None:
    case = load("football-spiral")
    final = truth(case).trajectory.position[-1]
    assert final[0] == pytest.approx(20.0**2 * math.sin(math.radians(60)) / 9.81, rel=1e-12)
    assert abs(final[2]) < 1e-13
    assert abs(final[1]) == 0


def test_both_ways_of_the_football_against_the_air_agree() -> None:
    case = load("football-drag")
    found, other = truth(case), witness(case.scene, case.instants)
    assert other is not None
    # Half a rounding to double precision of 30 m, and the witness's error by DOP853.
    assert found.bounds.position_error.max() < 1e-14
    for one, seen in (found.trajectory.position, other.motion.position), (found.trajectory.velocity, other.motion.velocity):
        np.testing.assert_allclose(one[other.instants], seen.astype(float), rtol=0, atol=1e-10)


@pytest.mark.parametrize(
    ("engine", "integrator", "order", "tolerance"),
    [("pinocchio", "rk4", 4, 0.2), ("mujoco", "RK4", 4, 0.2), ("mujoco", "Euler", 1, 0.1), ("pinocchio", "rk4-naive", 2, 0.1)],
)
def test_every_scheme_keeps_its_order_against_the_air(engine: str, integrator: str, order: int, tolerance: float) -> None:
    """The drag is evaluated in every stage: a force held over a step would leave order 1."""
    case = load("football-drag")
    thick = replace(case, scene=replace(case.scene, drag=0.1))
    exact = truth(thick)
    errors = [compare(exact, simulate(thick, engine, integrator, h)).maxima()["position_error"] for h in (0.02, 0.01, 0.005)]
    np.testing.assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), order, atol=tolerance)


def test_mujocos_own_fluid_is_another_model() -> None:
    """It meets the ball by the axes of its body, so that its difference does not vanish with the step."""
    case = shortened(load("football-drag"), 2.0, 201)  # of which both steps are parts
    exact = truth(case)
    own = [compare(exact, simulate(case, "mujoco", "RK4:drag=fluid", h)).maxima()["position_error"] for h in (2e-3, 1e-3)]
    assert min(own) > 0.1
    assert own[0] == pytest.approx(own[1], rel=1e-7)
    # Where the ball flies along its long axis without turning, the two are the same force.
    straight = replace(case.scene.initial, angular_velocity=(0.0, 0.0, 0.0))
    still = shortened(replace(case, scene=replace(case.scene, initial=straight, gravity=0.0)), 1.0, 11)
    assert compare(truth(still), simulate(still, "mujoco", "RK4:drag=fluid", 1e-3)).maxima()["position_error"] < 1e-9


def test_errors_against_the_truth_stand_where_drifts_would() -> None:
    names = set(compare(truth(load("football-drag")), simulate(load("football-drag"), "mujoco", "Euler")).maxima())
    assert {"energy_error", "rotational_energy_error", "angular_momentum_error"} <= names
    assert not any(name.endswith("_drift") for name in names)
