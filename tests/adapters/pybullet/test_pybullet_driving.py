"""Driven joints in PyBullet: torques that are applied in each step, and the limits of a URDF file."""

import numpy as np
import pytest

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.reference.mechanisms.control import Stops
from tests.support.coupled_runs import orders
from tests.support.driven_hinge import PD, hinge
from tests.support.driven_runs import arm_errors, landing, sampled_error, turned_against_a_stop

PYBULLET = registry.load("pybullet")


def test_a_sampled_law_converges_with_the_order_of_the_scheme() -> None:
    errors = np.array([sampled_error(PYBULLET, "multibody", step) for step in (0.001, 0.0005)])
    assert orders(errors) == pytest.approx([1], abs=0.2)


@pytest.mark.parametrize("rate", [100.0, None])
def test_an_arm_is_driven_with_the_order_of_the_scheme(rate: float | None) -> None:
    errors = arm_errors(PYBULLET, "multibody", rate, (0.0025, 0.00125))
    assert orders(errors) == pytest.approx([1], abs=0.2)
    assert errors[-1] < 1e-2


@pytest.mark.parametrize("stops", [Stops(-0.1, None), Stops(-0.1, 0.5)])
def test_a_limit_holds_a_slide(stops: Stops) -> None:
    """A step moves the body by 1.2 mm when it lands."""
    most, last, speed = landing(PYBULLET, "multibody", 0.001, stops)
    assert most < 0.002
    assert abs(last) < 1e-3
    assert abs(speed) < 1e-3


def test_a_limit_gives_back_a_fifth_of_the_speed_at_most() -> None:
    """Bullet pushes out a fifth of a penetration in a step, and a step penetrates by its own way at most."""
    angle, rate = turned_against_a_stop(PYBULLET, "multibody", 0.001, Stops(-4.0, 0.1))
    assert angle.max() < 0.1025
    assert rate.min() > -0.2 * 2.25


def test_a_rebound_is_refused() -> None:
    with pytest.raises(SceneUnsupported, match=r"no rebound, and pin has the restitution 0\.5"):
        offers.prepare(PYBULLET, [hinge(PD, stops=Stops(-1.0, 1.1, 0.5))], Method.parse("multibody", 0.001))
