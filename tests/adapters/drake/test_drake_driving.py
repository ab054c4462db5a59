"""Driven joints in Drake: efforts as inputs of actuators, laws at the stages of integrators, and the limits of plants."""

import numpy as np
import pytest

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.reference.mechanisms.control import Stops
from tests.support.coupled_runs import orders
from tests.support.driven_hinge import PD, hinge
from tests.support.driven_runs import arm_errors, continuous_error, landing, sampled_error

DRAKE = registry.load("drake")


@pytest.mark.parametrize("spelling", ["runge_kutta3", "runge_kutta5", "radau3", "runge_kutta3:accuracy=1e-9"])
def test_a_sampled_law_on_one_joint_is_exact(spelling: str) -> None:
    assert sampled_error(DRAKE, spelling, 0.002) < 1e-12


@pytest.mark.parametrize("spelling", ["lagged", "tamsi", "cenic", "semi_explicit_euler"])
def test_a_sampled_law_converges_with_the_order_of_the_scheme(spelling: str) -> None:
    errors = np.array([sampled_error(DRAKE, spelling, step) for step in (0.001, 0.0005)])
    assert orders(errors) == pytest.approx([1], abs=0.2)


@pytest.mark.parametrize(("spelling", "order"), [("runge_kutta3", 3), ("lagged", 1), ("sap", 1)])
@pytest.mark.parametrize("rate", [100.0, None])
def test_an_arm_is_driven_with_the_order_of_the_scheme(spelling: str, order: int, rate: float | None) -> None:
    errors = arm_errors(DRAKE, spelling, rate, (0.0025, 0.00125))
    assert orders(errors) == pytest.approx([order], abs=0.2)
    assert errors[-1] < (1e-6 if order == 3 else 1e-2)


def test_a_continuous_law_is_evaluated_at_the_stages() -> None:
    errors = np.array([continuous_error(DRAKE, "runge_kutta3", step) for step in (0.001, 0.0005)])
    assert orders(errors) == pytest.approx([3], abs=0.2)


@pytest.mark.parametrize(
    ("spelling", "largest"), [*((name, 0.002) for name in ("lagged", "similar", "sap", "cenic")), ("tamsi", 0.01)]
)
def test_a_limit_holds_a_joint(spelling: str, largest: float) -> None:
    """A step moves the body by 1.2 mm when it lands; `tamsi` has a spring as a limit."""
    most, last, speed = landing(DRAKE, spelling, 0.001, Stops(-0.1, None))
    assert most < largest
    assert abs(last) < largest / 5
    assert abs(speed) < 1e-3


def test_what_drake_lacks_is_refused() -> None:
    rebounding, rigid = hinge(PD, stops=Stops(-1.0, 1.1, 0.5)), hinge(PD, stops=Stops(-1.0, 1.1))
    with pytest.raises(SceneUnsupported, match=r"no rebound, and pin has the restitution 0\.5"):
        offers.prepare(DRAKE, [rebounding], Method.parse("lagged", 0.001))
    with pytest.raises(SceneUnsupported, match="limits of joints in cenic and in its discrete plant only"):
        offers.prepare(DRAKE, [rigid], Method.parse("runge_kutta3", 0.001))
