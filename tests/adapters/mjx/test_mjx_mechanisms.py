"""What is special about mechanisms in MJX: the order of RK4 on ball joints, and the softness of loops."""

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism
from bodycheck.reference.scene import Tensor
from tests.support.coupled_joints import gripper, hip
from tests.support.coupled_runs import errors, orders
from tests.support.jointed import cart_pole, four_bar, trajectory
from tests.support.orders import observed_mechanism_order

MJX = registry.load("mjx")

TOP = Mechanism(
    (JointedBody("top", Tensor(1.3, ((0.05, 0.0, 0.0), (0.0, 0.06, 0.0), (0.0, 0.0, 0.03))), (0.05, -0.1, 0.35)),),
    (Joint("ball", "spherical", WORLD, 0, start=(0.9, 0.1, 0.3, -0.2), start_velocity=(1.1, -0.7, 2.0)),),
    gravity=9.81,
)


@pytest.mark.parametrize(("mechanism", "order"), [(cart_pole(), 4), (TOP, 2)], ids=["hinge and slide", "ball"])
def test_rk4_is_of_second_order_on_a_ball_joint(mechanism: Mechanism, order: int) -> None:
    """The last turn of a step follows the mean of the velocities of the stages, as in MuJoCo before version 4."""
    observed = observed_mechanism_order(MJX, mechanism, "RK4", (0.02, 0.01, 0.005), 0.4)
    # The next term of the error changes the order by about the step times a rate: 10 ms times some ten per second.
    assert observed == pytest.approx({"position": order, "attitude": order}, abs=0.2)


def test_a_loop_is_as_soft_as_its_constraint() -> None:
    """The gap does not vanish with the time step, because MuJoCo's default constraint has a time constant of 20 ms."""
    apart = []
    for timestep in (2e-3, 1e-3):
        strides = np.full(5, round(0.1 / timestep))
        states = MJX.prepare([four_bar()], Method.parse("Euler", timestep)).advance(strides)
        apart.append(float(kinematics.gaps(four_bar(), trajectory(np.cumsum(strides) * timestep, states)).max()))
    assert min(apart) > 1e-4
    assert apart[0] / apart[1] == pytest.approx(1, abs=0.3)


def test_several_joints_of_a_body_are_those_of_mujoco() -> None:
    """RK4 of hinges and slides is of order 4, with an error of 5e-10 m at 4 ms."""
    sizes = errors(MJX, hip(), "RK4", (0.008, 0.004))
    assert orders(sizes) == pytest.approx([4], abs=0.2)


def test_a_mimic_joint_is_as_soft_as_that_of_mujoco() -> None:
    sizes = errors(MJX, gripper(damping=0.1), "RK4", (0.002, 0.001))
    assert sizes[0] == pytest.approx(sizes[1], rel=1e-3)
    assert sizes[1] > 1e-6
