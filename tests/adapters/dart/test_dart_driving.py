"""Driven joints in DART: efforts as commands of joints, and limits of positions."""

import numpy as np
import pytest

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.reference.mechanisms.control import Stops
from tests.support.coupled_runs import orders
from tests.support.driven_hinge import PD, hinge
from tests.support.driven_runs import arm_errors, landing, sampled_error, turned_against_a_stop

DART = registry.load("dart")


@pytest.mark.parametrize("spelling", ["semi-implicit-euler"])
def test_a_sampled_law_converges_with_the_order_of_the_scheme(spelling: str) -> None:
    errors = np.array([sampled_error(DART, spelling, step) for step in (0.001, 0.0005)])
    assert orders(errors) == pytest.approx([1], abs=0.2)


@pytest.mark.parametrize("spelling", ["semi-implicit-euler"])
@pytest.mark.parametrize("rate", [100.0, None])
def test_an_arm_is_driven_with_the_order_of_the_scheme(spelling: str, rate: float | None) -> None:
    errors = arm_errors(DART, spelling, rate, (0.0025, 0.00125))
    assert orders(errors) == pytest.approx([1], abs=0.2)
    assert errors[-1] < 1e-2


@pytest.mark.parametrize("spelling", ["semi-implicit-euler"])
@pytest.mark.parametrize("stops", [Stops(-0.1, None), Stops(-0.1, 0.5)])
def test_a_limit_holds_a_slide(spelling: str, stops: Stops) -> None:
    """DART lets a step end at the limit."""
    most, last, speed = landing(DART, spelling, 0.001, stops)
    assert most < 1e-12
    assert abs(last) < 1e-12
    assert abs(speed) < 1e-12


@pytest.mark.parametrize("spelling", ["semi-implicit-euler"])
def test_a_limit_holds_a_hinge(spelling: str) -> None:
    angle, rate = turned_against_a_stop(DART, spelling, 0.001, Stops(-4.0, 0.1))
    assert angle.max() < 0.1 + 1e-12
    assert abs(rate[-1]) < 1e-12


def test_a_rebound_is_refused() -> None:
    with pytest.raises(SceneUnsupported, match=r"no rebound, and pin has the restitution 0\.5"):
        offers.prepare(DART, [hinge(PD, stops=Stops(-1.0, 1.1, 0.5))], Method.parse("semi-implicit-euler", 0.001))
