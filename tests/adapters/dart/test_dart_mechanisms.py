"""What is special about mechanisms in DART: implicit damping and springs, dry friction, and loops."""

from dataclasses import replace
from typing import Literal

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array
from tests.support.coupled_joints import bare, hip
from tests.support.coupled_runs import errors, orders
from tests.support.jointed import bare_tree, coordinate, four_bar, on_one_joint, trajectory
from tests.support.orders import observed_mechanism_order

DART = registry.load("dart")
SCHEME = "semi-implicit-euler"
ROUNDING = 1e-13  # of some hundred steps
TYPES: tuple[Literal["revolute", "prismatic"], ...] = ("revolute", "prismatic")


def moved(mechanism: Mechanism, timestep: float, *strides: int) -> tuple[Array, Array]:
    """Coordinates and velocities of one joint after so many steps."""
    simulation = DART.prepare([mechanism], Method.parse(SCHEME, timestep))
    return coordinate(mechanism, simulation.advance(np.array(strides)))


def test_the_order_is_one_on_joints_of_every_type() -> None:
    joints = tuple(replace(joint, damping=0.1 if joint.type == "spherical" else 0.0) for joint in bare_tree().joints)
    observed = observed_mechanism_order(DART, replace(bare_tree(), joints=joints), SCHEME, (2e-3, 1e-3, 5e-4), 0.3)
    # The next term of the error changes the order by about the step times a rate: 1 ms times some ten per second.
    assert observed == pytest.approx({"position": 1, "attitude": 1}, abs=0.1)


@pytest.mark.parametrize("type", TYPES)
def test_damping_and_springs_are_those_at_the_end_of_a_step(type: Literal["revolute", "prismatic"]) -> None:
    """v' = v / (1 + h d), and x' = x + h v' with v' = v - h k (x' - r), for a body of one unit of inertia."""
    h, d, k, rest = 0.1, 3.0, 5.0, 0.2
    _, damped = moved(on_one_joint(type, 0.0, 1.0, damping=d), h, 1)
    assert damped[0] == pytest.approx(1 / (1 + h * d), abs=ROUNDING)
    _, sprung = moved(on_one_joint(type, 1.0, 0.0, stiffness=k, rest=rest), h, 1)
    assert sprung[0] == pytest.approx(-h * k * (1 - rest) / (1 + h * h * k), abs=ROUNDING)


@pytest.mark.parametrize("type", TYPES)
def test_dry_friction_stops_a_joint_and_holds_it(type: Literal["revolute", "prismatic"]) -> None:
    h, friction = 0.01, 0.5
    place, velocity = moved(on_one_joint(type, 0.0, 1.0, friction=friction), h, 250, 50)
    # v0^2 / (2 f) less v0 h / 2, because each step moves with the velocity at its end. The constraint's softness is 1e-9.
    np.testing.assert_allclose(place, 1 / (2 * friction) - h / 2, rtol=0, atol=1e-8)
    np.testing.assert_allclose(velocity, 0, rtol=0, atol=1e-8)
    held, _ = moved(on_one_joint(type, 0.0, 0.0, friction=friction, effort=0.9 * friction), h, 100)
    assert held[0] == pytest.approx(0, abs=1e-8)
    pushed, _ = moved(on_one_joint(type, 0.0, 0.0, friction=friction, effort=1.1 * friction), h, 100)
    assert pushed[0] == pytest.approx(0.1 * friction / 2, rel=0.02)  # a step of first order moves it by 1 % more


def test_a_loop_comes_apart_and_less_with_smaller_steps() -> None:
    """DART keeps the velocities, and takes away a hundredth of the gap in a step."""
    apart = []
    for timestep in (1e-3, 5e-4):
        strides = np.array([round(0.5 / timestep)])
        states = DART.prepare([four_bar()], Method.parse(SCHEME, timestep)).advance(strides)
        apart.append(float(kinematics.gaps(four_bar(), trajectory(np.cumsum(strides) * timestep, states))[0]))
    assert 1e-4 < apart[0] < 1e-2
    assert 1.5 < apart[0] / apart[1] < 6  # an error of first or second order


def test_several_joints_of_a_body_converge_to_the_truth(capfd: pytest.CaptureFixture[str]) -> None:
    """Without a word: DART warns of bodies without mass."""
    sizes = errors(DART, bare(hip()), SCHEME)
    assert orders(sizes) == pytest.approx([1, 1], abs=0.1)
    assert sizes[-1] < 1e-3
    assert capfd.readouterr().err == ""
