"""Driven joints in Simbody: efforts as the overriding values of actuators, and elastic limits of coordinates."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import ErrorControlled, Method
from bodycheck.reference.mechanisms.control import Stops
from tests.support.coupled_runs import orders
from tests.support.driven_hinge import PD, hinge
from tests.support.driven_runs import arm_errors, landing, sampled_error, turned_against_a_stop

SIMBODY = registry.load("simbody")


@pytest.mark.parametrize(
    "spelling", ["RungeKuttaMerson", "RungeKuttaFeldberg", "RungeKutta3", "Verlet", "RungeKuttaMerson:accuracy=1e-6"]
)
def test_a_sampled_law_on_one_joint_is_exact(spelling: str) -> None:
    assert sampled_error(SIMBODY, spelling, 0.002) < 1e-12


def test_a_sampled_law_converges_with_the_order_of_the_scheme() -> None:
    errors = np.array([sampled_error(SIMBODY, "SemiExplicitEuler2", step) for step in (0.001, 0.0005)])
    assert orders(errors) == pytest.approx([1], abs=0.2)


@pytest.mark.parametrize(("rate", "order"), [(100.0, 4), (None, 1)])
def test_an_arm_is_driven_with_the_order_of_the_scheme(rate: float | None, order: int) -> None:
    """A continuous law is held from the start of a step."""
    errors = arm_errors(SIMBODY, "RungeKuttaMerson", rate, (0.0025, 0.00125))
    assert orders(errors) == pytest.approx([order], abs=0.3)
    assert errors[-1] < (1e-7 if order == 4 else 1e-2)


def test_work_is_counted_over_all_periods() -> None:
    """At a step of 2 ms and a rate of 500 Hz every period has one step at least, of a scheme with five evaluations."""
    method = Method.parse("RungeKuttaMerson:accuracy=1e-6", 0.002)
    simulation = offers.prepare(SIMBODY, [hinge(replace(PD, rate=500.0))], method)
    assert isinstance(simulation, ErrorControlled)
    simulation.finish(0.1)
    work = simulation.work
    assert work.steps >= 50
    assert work.evaluations is not None
    assert 5 * work.steps <= work.evaluations <= 20 * work.steps


def test_elastic_stops_are_springs_with_dampers_that_also_pull() -> None:
    most, last, speed = landing(SIMBODY, "RungeKuttaMerson", 0.001, Stops(-0.1, None, None, 2000.0, 100.0))
    assert most < 0.025  # the weight less the effort, 11.7 N, bends the stop by 5.85 mm at rest
    assert abs(last) < 6e-3
    assert abs(speed) < 1e-2
    stops = Stops(-4.0, 0.1, None, 40.0, 0.3)
    (own, own_rate), (_, rate) = (
        turned_against_a_stop(SIMBODY, f"RungeKuttaMerson{option}", 0.0005, stops) for option in ("", ":limits=effort")
    )
    beyond = own > 0.1
    assert np.abs(own_rate - rate)[beyond].max() < 0.2  # until the pull at the end
    assert 0 < (own_rate - rate)[-1] < 0.2  # of a speed of 0.6 rad/s
