"""What is special about mechanisms in PyBullet: explicit damping and springs, motors as dry friction, and loops."""

from dataclasses import replace
from typing import Literal

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.mechanism import BodyStart, Mechanism
from bodycheck.reference.trajectory import Array
from tests.support.coupled_joints import bare, gripper, hip, massless
from tests.support.coupled_runs import errors, orders
from tests.support.jointed import ball_chain, coordinate, four_bar, free_chain, on_one_joint, trajectory
from tests.support.orders import observed_mechanism_order

PYBULLET = registry.load("pybullet")
ROUNDING = 1e-13  # of some hundred steps
TYPES: tuple[Literal["revolute", "prismatic"], ...] = ("revolute", "prismatic")


def moved(mechanism: Mechanism, timestep: float, *strides: int) -> tuple[Array, Array]:
    """Coordinates and velocities of one joint after so many steps."""
    simulation = PYBULLET.prepare([mechanism], Method.parse("multibody", timestep))
    return coordinate(mechanism, simulation.advance(np.array(strides)))


@pytest.mark.parametrize("mechanism", [free_chain(), ball_chain()], ids=["hinges", "balls"])
def test_the_order_is_one(mechanism: Mechanism) -> None:
    observed = observed_mechanism_order(PYBULLET, mechanism, "multibody", (2e-3, 1e-3, 5e-4), 0.3)
    # The next term of the error changes the order by about the step times a rate: 1 ms times some ten per second.
    assert observed == pytest.approx({"position": 1, "attitude": 1}, abs=0.1)


@pytest.mark.parametrize("type", TYPES)
def test_damping_and_springs_are_those_at_the_start_of_a_step(type: Literal["revolute", "prismatic"]) -> None:
    h, d, k, rest = 0.1, 3.0, 5.0, 0.2
    _, damped = moved(on_one_joint(type, 0.0, 1.0, damping=d), h, 1)
    assert damped[0] == pytest.approx(1 - h * d, abs=ROUNDING)
    _, sprung = moved(on_one_joint(type, 1.0, 0.0, stiffness=k, rest=rest), h, 1)
    assert sprung[0] == pytest.approx(-h * k * (1 - rest), abs=ROUNDING)


@pytest.mark.parametrize("type", TYPES)
def test_dry_friction_stops_a_joint_and_holds_it(type: Literal["revolute", "prismatic"]) -> None:
    h, friction = 0.01, 0.5
    place, velocity = moved(on_one_joint(type, 0.0, 1.0, friction=friction), h, 250, 50)
    # v0^2 / (2 f) less v0 h / 2, because each step moves with the velocity at its end.
    np.testing.assert_allclose(place, 1 / (2 * friction) - h / 2, rtol=0, atol=ROUNDING)
    np.testing.assert_allclose(velocity, 0, rtol=0, atol=ROUNDING)
    held, _ = moved(on_one_joint(type, 0.0, 0.0, friction=friction, effort=0.9 * friction), h, 100)
    assert held[0] == pytest.approx(0, abs=ROUNDING)
    pushed, _ = moved(on_one_joint(type, 0.0, 0.0, friction=friction, effort=1.1 * friction), h, 100)
    assert pushed[0] == pytest.approx(0.1 * friction / 2, rel=0.02)  # a step of first order moves it by 1 % more


def test_a_loop_comes_apart_by_the_square_of_the_step() -> None:
    apart = []
    for timestep in (1e-3, 5e-4):
        strides = np.full(5, round(0.1 / timestep))
        states = PYBULLET.prepare([four_bar()], Method.parse("multibody", timestep)).advance(strides)
        apart.append(float(kinematics.gaps(four_bar(), trajectory(np.cumsum(strides) * timestep, states)).max()))
    assert apart[0] < 1e-3
    assert apart[0] / apart[1] == pytest.approx(4, abs=0.8)  # a step has terms of higher order; four is far from two


@pytest.mark.parametrize("mechanism", [bare(hip()), bare(gripper())], ids=["massless", "gear"])
def test_several_joints_of_a_body_and_a_gear_converge_to_the_truth(mechanism: Mechanism) -> None:
    sizes = errors(PYBULLET, mechanism, "multibody")
    assert orders(sizes) == pytest.approx([1, 1], abs=0.1)
    assert sizes[-1] < 1e-3


def test_a_free_body_without_mass_is_refused() -> None:
    """Bullet takes a base without mass as one that does not move."""
    base = replace(massless("base"), start=BodyStart())
    hinges = bare(hip()).joints[1:2]
    floating = Mechanism((base, hip().bodies[1]), hinges, gravity=9.81)
    with pytest.raises(SceneUnsupported, match="the free body base without mass"):
        PYBULLET.prepare([floating], Method.parse("multibody", 1e-3))
