"""The laws of controllers and elastic stops at one instant."""

import math
from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from bodycheck.adapters.control_laws import effort_of, integral_of, push_of, saturated, value_of
from bodycheck.reference.mechanisms.control import Controller, Samples, Sine, Stops

SINE = Sine(0.7, 3.0, 0.4, -0.2)
HELD = Samples((0.1, 0.3, 1.0), (2.0, -1.0, 0.5))
LINEAR = replace(HELD, between="linear")


def test_a_table_has_its_first_and_last_value_outside_its_times() -> None:
    for table in (HELD, LINEAR):
        assert (value_of(table, -1.0), value_of(table, 0.1), value_of(table, 1.0), value_of(table, 9.0)) == (2, 2, 0.5, 0.5)
    assert (value_of(HELD, 0.2), value_of(HELD, 0.3)) == (2.0, -1.0)
    assert value_of(LINEAR, 0.2) == pytest.approx(0.5, rel=1e-14)  # of one rounding
    assert value_of(SINE, 0.5) == -0.2 + 0.7 * math.sin(1.9)
    assert value_of(3.0, 0.5) == 3.0


def test_exact_times_are_compared_exactly_with_those_of_a_table() -> None:
    # The double 0.3 is less than 3 / 10, and the double 0.1 more than 1 / 10.
    assert value_of(replace(HELD, times=(0.0, 0.3, 1.0)), Fraction(3, 10)) == -1.0
    assert value_of(replace(HELD, times=(0.0, 0.1, 1.0)), Fraction(1, 10)) == 2.0
    assert value_of(replace(HELD, times=(0.0, 0.1, 1.0)), 0.1) == -1.0


@pytest.mark.parametrize("signal", [1.3, SINE, HELD, LINEAR, replace(SINE, angular_frequency=0.0)])
@given(start=st.floats(0, 1.2), length=st.floats(0.001, 1))
def test_integrals_are_those_of_the_values(signal: float | Sine | Samples, start: float, length: float) -> None:
    end = start + length
    within = [time for time in (0.1, 0.3, 1.0) if start < time < end] or None
    expected, _ = quad(lambda time: value_of(signal, time), start, end, points=within, epsabs=1e-13, epsrel=1e-13)
    assert integral_of(signal, start, end) == pytest.approx(expected, abs=1e-12)  # ten times the tolerance of the quadrature


def test_a_law_adds_its_parts_before_it_is_saturated() -> None:
    controller = Controller(0, kp=3.0, kd=0.5, ki=2.0, target=1.0, target_velocity=-1.0, effort=SINE)
    parts = 3.0 * (1 - 0.2) + 0.5 * (-1 - 0.7) + 2.0 * 0.1 + value_of(SINE, 0.3)
    assert effort_of(controller, 0.3, 0.2, 0.7, 0.1) == pytest.approx(parts, rel=1e-14)
    assert effort_of(replace(controller, effort_limit=0.5), 0.3, 0.2, 0.7, 0.1) == 0.5
    assert effort_of(replace(controller, law="effort", kp=0.0, kd=0.0, ki=0.0), 0.3, 0.2, 0.7, 0.1) == value_of(SINE, 0.3)


@pytest.mark.parametrize(
    ("effort", "velocity", "cut"),
    [
        (9, 0, 4),
        (-9, 0, -4),
        (9, 5, 2),
        (-9, 5, -4),
        (9, -5, 4),
        (-9, -5, -2),
        (9, 12, 0),
        (-9, 12, -4),
        (1, 5, 1),
        (-3, 5, -3),
    ],
)
def test_the_torque_speed_line_limits_the_effort_along_the_velocity_alone(effort: float, velocity: float, cut: float) -> None:
    assert saturated(Controller(0, effort_limit=4.0, no_load_speed=10.0), effort, velocity) == cut


def test_elastic_stops_push_and_never_pull() -> None:
    stops = Stops(-1.0, 0.5, None, 400.0, 4.0)
    assert push_of(stops, 0.5, 1.0) == push_of(stops, -1.0, -1.0) == push_of(stops, 0.0, 9.0) == 0
    assert push_of(stops, 0.75, 2.0) == -108
    assert push_of(stops, -1.25, -2.0) == 108
    assert push_of(stops, 0.75, -30.0) == push_of(stops, -1.25, 30.0) == 0
    assert push_of(replace(stops, lower=None), -9.0, 0.0) == push_of(replace(stops, upper=None), 9.0, 0.0) == 0
