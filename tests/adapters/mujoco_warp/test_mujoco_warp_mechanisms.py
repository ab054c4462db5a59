"""What is special about mechanisms in MuJoCo Warp: single precision, and loops that are soft."""

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.reference.mechanisms import kinematics
from tests.support.coupled_joints import gripper, hip
from tests.support.coupled_runs import errors, orders
from tests.support.jointed import ball_chain, four_bar, trajectory
from tests.support.orders import observed_mechanism_order

WARP = registry.load("mujoco_warp")


def test_euler_is_of_first_order_on_ball_joints() -> None:
    observed = observed_mechanism_order(WARP, ball_chain(), "Euler", (8e-3, 4e-3, 2e-3), 0.2)
    # Errors of some 1e-3 in single precision, and the next term of the error: the step times some ten per second.
    assert observed == pytest.approx({"position": 1, "attitude": 1}, abs=0.15)


def test_a_loop_is_as_soft_as_its_constraint() -> None:
    """With RK4, whose other errors are small, the gap does not vanish with the time step."""
    apart = []
    for timestep in (2e-3, 1e-3):
        strides = np.full(5, round(0.1 / timestep))
        states = WARP.prepare([four_bar()], Method.parse("RK4", timestep)).advance(strides)
        apart.append(float(kinematics.gaps(four_bar(), trajectory(np.cumsum(strides) * timestep, states)).max()))
    assert min(apart) > 1e-5
    assert apart[0] / apart[1] == pytest.approx(1, abs=0.3)


def test_several_joints_of_a_body_converge_to_the_truth() -> None:
    sizes = errors(WARP, hip(), "Euler", (8e-3, 4e-3, 2e-3))
    assert orders(sizes) == pytest.approx([1, 1], abs=0.15)  # errors of some 1e-3 in single precision


def test_a_mimic_joint_is_as_soft_as_that_of_mujoco() -> None:
    coarse, fine = errors(WARP, gripper(damping=0.1), "RK4", (2e-3, 1e-3))
    assert fine == pytest.approx(coarse, rel=0.3)  # rounding in single precision
    assert fine > 1e-6
