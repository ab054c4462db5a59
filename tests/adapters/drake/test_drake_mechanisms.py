"""What is special about mechanisms in Drake: orders of its integrators on joints, and its constraints for loops."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.truth import mechanism_truth
from tests.support.coupled_joints import gripper, hip
from tests.support.coupled_runs import errors, orders
from tests.support.jointed import four_bar, trajectory, tree
from tests.support.orders import observed_mechanism_order

DRAKE = registry.load("drake")


@pytest.mark.parametrize("spelling", offers.offered(DRAKE.engine, tree()))
def test_an_integrator_has_its_order_on_joints_of_every_type(spelling: str) -> None:
    """With armature, springs and efforts; and damping, which the discrete plant takes at the end of a step."""
    joints = tuple(replace(joint, damping=0.1) if joint.type in ("revolute", "spherical") else joint for joint in tree().joints)
    claimed = next(own.order for own in DRAKE.engine.integrators if own.name == spelling)
    observed = observed_mechanism_order(DRAKE, replace(tree(), joints=joints), spelling, (0.01, 0.005, 0.0025), 0.3)
    # The next term of the error changes the order by about the step times a rate: 5 ms times some ten per second.
    assert observed == pytest.approx({"position": claimed, "attitude": claimed}, abs=0.2)


@pytest.mark.parametrize("spelling", ["lagged", "sap"])
def test_a_loop_stays_closed_and_moves_with_the_order_of_the_scheme(spelling: str) -> None:
    """Drake's constraint is so stiff that it lasts two steps, in which the path of a point bends by h^2 v^2/L."""
    duration, steps = 0.5, (2e-3, 1e-3, 5e-4)
    exact = mechanism_truth(four_bar(), np.array([duration]), vouched=False).trajectory.position[:, 0]
    gaps, sizes = [], []
    for step in steps:
        strides = np.full(10, round(duration / 10 / step))
        states = DRAKE.prepare([four_bar()], Method.parse(spelling, step)).advance(strides)
        gaps.append(kinematics.gaps(four_bar(), trajectory(np.cumsum(strides) * step, states)).max())
        sizes.append(np.abs(states[0, -1, :, :3] - exact).max())
    # The rods of about 1 m turn by up to 5 rad/s, so that the gaps are about 25 h^2 m.
    assert orders(np.array(gaps)) == pytest.approx([2, 2], abs=0.1)
    assert gaps[-1] < 50 * steps[-1] ** 2
    assert orders(np.array(sizes)) == pytest.approx([1, 1], abs=0.1)


def test_a_continuous_plant_has_no_loops() -> None:
    with pytest.raises(SceneUnsupported, match="solver SAP only"):
        DRAKE.prepare([four_bar()], Method.parse("runge_kutta3", 1e-3))


@pytest.mark.parametrize(("spelling", "order"), [("runge_kutta3", 3), ("lagged", 1)])
def test_several_joints_of_a_body_converge_to_the_truth(spelling: str, order: int) -> None:
    sizes = errors(DRAKE, hip(), spelling)
    assert orders(sizes) == pytest.approx([order] * 2, abs=0.1)
    assert sizes[-1] < (1e-7 if order == 3 else 1e-3)


def test_a_coupler_makes_a_joint_follow_another_with_the_order_of_the_scheme() -> None:
    """The constraint lasts two steps, so that its softness vanishes with the step."""
    sizes = errors(DRAKE, gripper(armature=0.02, damping=0.1, stiffness=2.0), "lagged")
    assert orders(sizes) == pytest.approx([1, 1], abs=0.1)
    assert sizes[-1] < 1e-3


@pytest.mark.parametrize(
    ("mechanism", "spelling", "reason"),
    [
        (gripper(), "runge_kutta3", "couplers for mimic joints in cenic and in its discrete plant with the solver SAP only"),
        (hip(), "cenic", "cenic refuses the body trunk:rail: composite for body has zero mass"),
    ],
)
def test_what_drake_does_not_have_is_refused(mechanism: Mechanism, spelling: str, reason: str) -> None:
    with pytest.raises(SceneUnsupported, match=reason):
        DRAKE.prepare([mechanism], Method.parse(spelling, 1e-3))
