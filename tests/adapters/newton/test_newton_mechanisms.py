"""What is special about mechanisms in Newton: orders, what solvers lack, the order of bodies, and XPBD's relaxation."""

from dataclasses import replace
from typing import Literal

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.mechanisms.truth import mechanism_truth
from tests.support.coupled_joints import hip
from tests.support.coupled_runs import errors, orders
from tests.support.jointed import ball_chain, body, cart_pole, free_chain
from tests.support.orders import observed_mechanism_order

NEWTON = registry.load("newton")


@pytest.mark.parametrize("spelling", ["Featherstone", "Steel", "MuJoCo-euler"])
def test_the_order_is_one_on_hinges(spelling: str) -> None:
    observed = observed_mechanism_order(NEWTON, free_chain(), spelling, (8e-3, 4e-3, 2e-3), 0.4)
    # Errors of some 1e-3 in single precision, and the next term of the error: the step times some ten per second.
    assert observed == pytest.approx({"position": 1, "attitude": 1}, abs=0.15)


@pytest.mark.parametrize("spelling", ["Featherstone", "Steel", "MuJoCo-euler"])
@pytest.mark.parametrize("mechanism", [ball_chain(), free_chain()], ids=["ball chain", "free chain"])
def test_a_motion_converges_to_the_truth_whatever_the_order_of_the_bodies_in_the_file(
    mechanism: Mechanism, spelling: str
) -> None:
    """In both files a body is before the body that it hangs on, and balls hang on bodies that move."""
    duration = 0.2
    exact = mechanism_truth(mechanism, np.array([duration])).trajectory.position[:, 0]

    def error(timestep: float) -> float:
        strides = np.array([round(duration / timestep)])
        states = NEWTON.prepare([mechanism], Method.parse(spelling, timestep)).advance(strides)
        return float(np.abs(states[0, 0, :, :3] - exact).max())

    # Order 1; the next term of the error is as large as the step times some ten per second, and rounding is a thousandth.
    assert error(2e-3) / error(1e-3) == pytest.approx(2, abs=0.1)


def test_xpbd_errs_less_without_relaxation() -> None:
    """Its joints scale their impulses by 0.7 and 0.4, unless the method says otherwise."""
    duration, step = 0.2, 1e-3
    exact = mechanism_truth(cart_pole(), np.array([duration])).trajectory.position[:, 0]

    def error(spelling: str) -> float:
        states = NEWTON.prepare([cart_pole()], Method.parse(spelling, step)).advance(np.array([round(duration / step)]))
        return float(np.abs(states[0, 0, :, :3] - exact).max())

    assert error("XPBD:relaxation=1") < error("XPBD") / 2


@pytest.mark.parametrize("type", ["prismatic", "revolute"])
def test_a_body_stays_on_an_oblique_axis(type: Literal["prismatic", "revolute"]) -> None:
    """XPBD frees every axis of a frame along which the axis of a joint has a component, so that frames are turned for it."""
    link = body("link", 1.0, (0.01, 0.02, 0.03), (0.2, 0.0, 0.0))
    joint = Joint("joint", type, WORLD, 0, axis=(0.0, 0.6, 0.8), start=(0.0,), start_velocity=(1.0,))
    mechanism = Mechanism((link,), (joint,), gravity=9.81)
    exact = mechanism_truth(mechanism, np.array([0.3])).trajectory.position[:, 0]
    states = NEWTON.prepare([mechanism], Method.parse("XPBD:relaxation=1", 1e-3)).advance(np.array([300]))
    # Order 1: a step of 1 ms is off by about g h t / 2 = 1.5 mm after 0.3 s; a body that leaves its axis, by 0.2 m.
    assert float(np.abs(states[0, 0, :, :3] - exact).max()) < 3e-3


@pytest.mark.parametrize(("spelling", "lacking"), [("Steel", "springs"), ("Steel", "friction"), ("Featherstone", "friction")])
def test_what_a_solver_ignores_is_refused(spelling: str, lacking: str) -> None:
    key = {"springs": "stiffness", "friction": "friction"}[lacking]
    joints = tuple(replace(joint, **{key: 1.0}) for joint in cart_pole().joints)
    with pytest.raises(SceneUnsupported, match=lacking):
        NEWTON.prepare([replace(cart_pole(), joints=joints)], Method.parse(spelling, 1e-3))


def test_several_joints_of_a_body_converge_to_the_truth() -> None:
    sizes = errors(NEWTON, hip(), "Featherstone", (8e-3, 4e-3, 2e-3))
    assert orders(sizes) == pytest.approx([1, 1], abs=0.15)  # errors of some 1e-3 in single precision


@pytest.mark.parametrize(
    ("spelling", "reason"),
    [
        ("MuJoCo-euler", "mass and inertia of moving bodies must be larger than mjMINVAL trunk:rail"),
        ("XPBD", "massless bodies"),
    ],
)
def test_solvers_that_need_a_mass_refuse_bodies_without_it_by_name(spelling: str, reason: str) -> None:
    bodies, joints = hip().bodies[:2], hip().joints[:2]
    with pytest.raises(SceneUnsupported, match=reason):
        NEWTON.prepare([Mechanism(bodies, joints, gravity=9.81)], Method.parse(spelling, 1e-3))
