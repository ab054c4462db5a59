"""Driven joints in Exudyn: forces of the coordinates of trees, laws at the stages of explicit solvers, and limit stops."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.reference.mechanisms.control import Stops
from bodycheck.reference.mechanisms.mechanism import Joint
from tests.support.coupled_runs import orders
from tests.support.driven_hinge import PD, hinge
from tests.support.driven_runs import arm_errors, continuous_error, landing, sampled_error, turned_against_a_stop
from tests.support.jointed import body

EXUDYN = registry.load("exudyn")


@pytest.mark.parametrize("spelling", ["RK44", "RK33", "DOPRI5", "DOPRI5:accuracy=1e-9"])
def test_a_sampled_law_on_one_joint_is_exact(spelling: str) -> None:
    assert sampled_error(EXUDYN, spelling, 0.002) < 1e-12


@pytest.mark.parametrize("spelling", ["ExplicitEuler", "TrapezoidalIndex2"])
def test_a_sampled_law_converges_with_order_one(spelling: str) -> None:
    """The implicit solvers carry the acceleration before a jump of an effort into the step after it."""
    errors = np.array([sampled_error(EXUDYN, spelling, step) for step in (0.0005, 0.00025)])
    assert orders(errors) == pytest.approx([1], abs=0.2)


@pytest.mark.parametrize(("spelling", "order"), [("RK44", 4), ("GeneralizedAlpha", 2), ("TrapezoidalIndex2", 2)])
def test_a_continuous_law_is_evaluated_at_the_stages(spelling: str, order: int) -> None:
    errors = np.array([continuous_error(EXUDYN, spelling, step) for step in (0.001, 0.0005)])
    assert orders(errors) == pytest.approx([order], abs=0.2)


@pytest.mark.parametrize("rate", [100.0, None])
def test_an_arm_is_driven_with_the_order_of_the_scheme(rate: float | None) -> None:
    errors = arm_errors(EXUDYN, "RK44", rate, (0.0025, 0.00125))
    assert orders(errors) == pytest.approx([4], abs=0.2)
    assert errors[-1] < 1e-7


@pytest.mark.parametrize("spelling", ["RK44", "GeneralizedAlpha"])
def test_elastic_stops_are_springs_with_dampers_that_also_pull(spelling: str) -> None:
    most, last, speed = landing(EXUDYN, spelling, 0.001, Stops(-0.1, None, None, 2000.0, 100.0))
    assert most < 0.025  # the weight less the effort, 11.7 N, bends the stop by 5.85 mm at rest
    assert abs(last) < 6e-3
    assert abs(speed) < 1e-2
    stops = Stops(-4.0, 0.1, None, 40.0, 0.3)
    (own, own_rate), (_, rate) = (
        turned_against_a_stop(EXUDYN, method, 0.0005, stops) for method in (spelling, f"{spelling}:limits=effort")
    )
    beyond = own > 0.1
    assert np.abs(own_rate - rate)[beyond].max() < 0.15  # until the pull at the end
    assert 0 < (own_rate - rate)[-1] < 0.2  # of a speed of 0.6 rad/s


def test_jointed_bodies_are_refused() -> None:
    joint = Joint("ball", "spherical", 0, 1, start=(1.0, 0.0, 0.0, 0.0), start_velocity=(0.0, 0.0, 0.0))
    driven = hinge(PD)
    tree = replace(driven, bodies=(*driven.bodies, body("more", 1.0, (0.1, 0.1, 0.1))), joints=(*driven.joints, joint))
    with pytest.raises(SceneUnsupported, match="in its kinematic trees only"):
        offers.prepare(EXUDYN, [tree], Method.parse("GeneralizedAlpha", 0.001))
