"""What is special about mechanisms in Simbody: orders on all joints, and loops that are projected when their gap is large."""

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.mechanism import Mechanism
from tests.support.coupled_joints import bare, gripper, hip
from tests.support.coupled_runs import errors, orders
from tests.support.jointed import ball_chain, bare_tree, cart_pole, four_bar, trajectory
from tests.support.orders import observed_mechanism_order

SIMBODY = registry.load("simbody")


@pytest.mark.parametrize(
    ("spelling", "order"),
    [
        ("ExplicitEuler", 1),
        ("SemiExplicitEuler2", 1),
        ("RungeKutta2", 2),
        ("RungeKutta3", 3),
        ("RungeKutta3:settings=engine", 3),
    ],
)
def test_an_integrator_has_its_order_on_joints_of_every_type(spelling: str, order: int) -> None:
    observed = observed_mechanism_order(SIMBODY, bare_tree(), spelling, (4e-3, 2e-3, 1e-3), 0.2)
    # The next term of the error changes the order by about the step times a rate: 2 ms times some ten per second.
    assert observed == pytest.approx({"position": order, "attitude": order}, abs=0.15)


@pytest.mark.parametrize(("spelling", "order"), [("Verlet", 2), ("RungeKuttaMerson", 4), ("RungeKuttaFeldberg", 4)])
def test_an_integrator_of_higher_order_has_it_on_a_cart_with_a_pole(spelling: str, order: int) -> None:
    """Feldberg's has 4, as in flight, although Simbody's documentation says fifth."""
    observed = observed_mechanism_order(SIMBODY, cart_pole(), spelling, (0.02, 0.01, 0.005), 0.8)
    assert observed == pytest.approx({"position": order, "attitude": order}, rel=0.1)  # as above, at larger steps


def test_a_loop_is_kept_within_the_tolerance_of_constraints() -> None:
    """Simbody projects the state only where the gap is above its tolerance, so that small steps do not make it smaller."""
    apart = []
    for timestep in (1e-3, 2.5e-4):
        strides = np.full(5, round(0.2 / timestep))
        states = SIMBODY.prepare([four_bar()], Method.parse("SemiExplicitEuler2", timestep)).advance(strides)
        apart.append(float(kinematics.gaps(four_bar(), trajectory(np.cumsum(strides) * timestep, states)).max()))
    # A tenth of the default accuracy of 0.001 for each of three components.
    assert 1e-5 < min(apart) < max(apart) < 2e-4


def test_a_ball_joint_has_no_damping() -> None:
    with pytest.raises(SceneUnsupported, match="no damping of a ball joint"):
        SIMBODY.prepare([ball_chain()], Method.parse("RungeKutta3", 1e-3))


@pytest.mark.parametrize(("spelling", "order"), [("ExplicitEuler", 1), ("RungeKuttaMerson", 4)])
def test_a_coupler_makes_a_joint_follow_another_with_the_order_of_the_scheme(spelling: str, order: int) -> None:
    sizes = errors(SIMBODY, bare(gripper()), spelling)
    assert orders(sizes) == pytest.approx([order] * 2, abs=0.15)
    assert sizes[-1] < (1e-9 if order == 4 else 1e-2)


def test_one_body_without_mass_between_two_joints_converges_to_the_truth() -> None:
    chain = Mechanism(hip().bodies[:2], hip().joints[:2], gravity=9.81)
    sizes = errors(SIMBODY, chain, "RungeKutta3")
    assert orders(sizes) == pytest.approx([3, 3], abs=0.15)


def test_two_bodies_without_mass_in_a_row_are_refused_in_the_words_of_opensim() -> None:
    with pytest.raises(SceneUnsupported, match=r"OpenSim refuses the mechanism: growTree.* massless body \(thigh:out\)"):
        SIMBODY.prepare([bare(hip())], Method.parse("RungeKutta3", 1e-3))
