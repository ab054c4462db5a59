"""What is special about mechanisms in Rapier: impulse joints, with motors as damping and springs."""

from typing import Literal

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.reference.mechanisms import kinematics
from tests.support.jointed import coordinate, four_bar, free_chain, on_one_joint, trajectory
from tests.support.orders import observed_mechanism_order

RAPIER = registry.load("rapier")
SCHEME = "symplectic-euler"
TYPES: tuple[Literal["revolute", "prismatic"], ...] = ("revolute", "prismatic")


def test_the_order_is_one_on_hinges() -> None:
    observed = observed_mechanism_order(RAPIER, free_chain(), SCHEME, (8e-3, 4e-3, 2e-3), 0.4)
    # Errors of some 1e-3 in single precision, and the next term of the error: the step times some ten per second.
    assert observed == pytest.approx({"position": 1, "attitude": 1}, abs=0.15)


@pytest.mark.parametrize("type", TYPES)
def test_damping_and_springs_are_those_at_the_end_of_a_step(type: Literal["revolute", "prismatic"]) -> None:
    """v' = v / (1 + h d), and x' = x + h v' with v' = v - h k (x' - r), for a body of one unit of inertia."""
    h, d, k, rest = 0.01, 3.0, 5.0, 0.2
    for acting, start, velocity, expected in (
        ({"damping": d}, 0.0, 1.0, 1 / (1 + h * d)),
        ({"stiffness": k, "rest": rest}, 1.0, 0.0, -h * k * (1 - rest) / (1 + h * h * k)),
    ):
        mechanism = on_one_joint(type, start, velocity, **acting)
        simulation = RAPIER.prepare([mechanism], Method.parse(SCHEME, h))
        _, found = coordinate(mechanism, simulation.advance(np.array([1])))
        assert found[0] == pytest.approx(expected, rel=1e-5)  # single precision


def test_a_loop_comes_apart_less_with_smaller_steps() -> None:
    apart = []
    for timestep in (2e-3, 1e-3):
        strides = np.full(5, round(0.1 / timestep))
        states = RAPIER.prepare([four_bar()], Method.parse(SCHEME, timestep)).advance(strides)
        apart.append(float(kinematics.gaps(four_bar(), trajectory(np.cumsum(strides) * timestep, states)).max()))
    assert apart[0] < 1e-3
    assert apart[0] / apart[1] > 1.5
