"""Driven joints in MuJoCo Warp: efforts in `qfrc_applied`, which all stages of a step keep, and MuJoCo's limits."""

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.reference.mechanisms.control import Stops
from tests.support.coupled_runs import orders
from tests.support.driven_runs import arm_errors, landing, sampled_error

WARP = registry.load("mujoco_warp")


@pytest.mark.parametrize("timestep", [0.002, 0.001])
def test_a_sampled_law_on_one_joint_is_exact(timestep: float) -> None:
    assert sampled_error(WARP, "RK4", timestep) < 1e-5


@pytest.mark.parametrize("spelling", ["Euler", "implicitfast"])
def test_a_sampled_law_converges_with_the_order_of_the_scheme(spelling: str) -> None:
    errors = np.array([sampled_error(WARP, spelling, step) for step in (0.001, 0.0005)])
    assert orders(errors) == pytest.approx([1], abs=0.2)


def test_an_arm_is_driven_to_single_precision() -> None:
    assert arm_errors(WARP, "RK4", 100.0, (0.0025, 0.00125)).max() < 1e-5


def test_a_continuous_law_is_held_from_the_start_of_a_step() -> None:
    errors = arm_errors(WARP, "RK4", None, (0.0025, 0.00125))
    assert orders(errors) == pytest.approx([1], abs=0.2)
    assert errors[-1] < 1e-2


@pytest.mark.parametrize("stops", [Stops(-0.1, None), Stops(-0.1, None, None, 2000.0, 100.0)])
def test_a_limit_holds_a_slide(stops: Stops) -> None:
    most, last, speed = landing(WARP, "Euler", 0.001, stops)
    # The rigid stop is MuJoCo's stiffest spring; the weight less the effort, 11.7 N, bends the elastic one by 5.85 mm at rest.
    assert most < (1e-3 if stops.rigid else 0.03)
    assert abs(last) < (1e-5 if stops.rigid else 6e-3)
    assert abs(speed) < (1e-5 if stops.rigid else 1e-2)
