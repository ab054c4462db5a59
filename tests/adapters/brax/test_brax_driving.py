"""Driven joints in Brax: efforts as inputs of motors, and MuJoCo's limits."""

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.reference.mechanisms.control import Stops
from tests.support.coupled_runs import orders
from tests.support.driven_runs import arm_errors, landing, sampled_error

BRAX = registry.load("brax")


def test_a_sampled_law_converges_with_the_order_of_the_scheme() -> None:
    errors = np.array([sampled_error(BRAX, "generalized", step) for step in (0.001, 0.0005)])
    assert orders(errors) == pytest.approx([1], abs=0.2)


def test_an_arm_is_driven_with_the_order_of_the_scheme() -> None:
    errors = arm_errors(BRAX, "generalized", 100.0, (0.0025, 0.00125))
    assert orders(errors) == pytest.approx([1], abs=0.2)
    assert errors[-1] < 1e-2


def test_a_limit_holds_a_slide() -> None:
    """The stop is the stiffest spring that MuJoCo advises for a step."""
    most, last, speed = landing(BRAX, "generalized", 0.001, Stops(-0.1, None))
    assert most < 1e-3
    assert abs(last) < 1e-5
    assert abs(speed) < 1e-3
