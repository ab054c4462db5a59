"""What is special to mechanisms in MuJoCo: the formulas of its implicit steps, of its soft friction and of its soft loops."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.mujoco import engine as adapter
from bodycheck.reference.mechanisms.control import Stops
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Loop, Mechanism
from bodycheck.reference.trajectory import Array
from tests.support.jointed import body, cart_pole, four_bar, tree
from tests.support.orders import observed_mechanism_order

STEP = 0.002

#: A few roundings of numbers near 1.
ROUNDING = 1e-14

SLIDER = Joint("rail", "prismatic", WORLD, 0, axis=(1.0, 0.0, 0.0), start=(0.2,), start_velocity=(0.7,))

MASS, ARMATURE, DAMPING, STIFFNESS, REST, EFFORT = 0.8, 0.3, 5.0, 40.0, -0.1, 2.0


def slider(**forces: float) -> Mechanism:
    """A body on a rail along x, with properties of its joint."""
    return Mechanism((body("cart", MASS, (0.1, 0.1, 0.1)),), (replace(SLIDER, **forces),), gravity=9.81)  # type: ignore[arg-type]


def after(mechanism: Mechanism, spelling: str, *strides: int, timestep: float = STEP) -> Array:
    """The states (n, bodies, 13) after strides."""
    return adapter.prepare([mechanism], Method.parse(spelling, timestep)).advance(np.array(strides))[0]


@pytest.mark.parametrize(
    ("spelling", "of_damping", "of_stiffness"),
    [
        ("Euler", 1, 0),
        ("Euler:eulerdamp=disable", 0, 0),
        ("implicit", 1, 0),
        ("implicitfast", 1, 0),
        ("discrete", 1, 1),
    ],
)
def test_a_step_takes_damping_and_springs_as_its_integrator_does(spelling: str, of_damping: int, of_stiffness: int) -> None:
    """The inertia of a step is m + armature + h d + h^2 k, with the terms that the integrator takes at the end of the step."""
    forces = {"armature": ARMATURE, "damping": DAMPING, "stiffness": STIFFNESS, "rest": REST, "effort": EFFORT}
    _, moved = after(slider(**forces), spelling, 0, 1)
    (x,), (v,) = SLIDER.start, SLIDER.start_velocity
    inertia = MASS + ARMATURE + of_damping * STEP * DAMPING + of_stiffness * STEP**2 * STIFFNESS
    force = EFFORT - DAMPING * v - STIFFNESS * (x - REST) - of_stiffness * STEP * STIFFNESS * v
    expected = v + STEP * force / inertia
    assert moved[0, 7] == pytest.approx(expected, abs=ROUNDING)
    assert moved[0, 0] == pytest.approx(x + STEP * expected, abs=ROUNDING)


@pytest.mark.parametrize(("spelling", "order"), [("RK4", 4), ("Euler", 1), ("implicit", 1), ("implicitfast", 1)])
def test_integrators_have_their_order_on_every_type_of_joint(spelling: str, order: int) -> None:
    """The tree has a joint of every type. At these steps RK4 is far from rounding, and terms of the next order are a tenth."""
    orders = observed_mechanism_order(adapter, tree(), spelling, (0.004, 0.002, 0.001), 0.2)
    assert orders == pytest.approx(dict.fromkeys(orders, order), abs=0.1)


def test_a_moving_body_without_moments_is_refused_in_the_words_of_mujoco() -> None:
    point = body("bob", 1.0, (0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    pendulum = Joint("pin", "revolute", WORLD, 0, axis=(0.0, 1.0, 0.0), start=(0.5,), start_velocity=(0.0,))
    with pytest.raises(SceneUnsupported, match="mass and inertia of moving bodies must be larger than mjMINVAL"):
        after(Mechanism((point,), (pendulum,), gravity=9.81), "Euler", 1)


def test_a_constant_effort_acts_at_every_step_however_often_a_run_is_sampled() -> None:
    often, seldom = after(slider(effort=EFFORT), "RK4", *[1] * 20), after(slider(effort=EFFORT), "RK4", 20)
    np.testing.assert_array_equal(often[-1], seldom[-1])


@pytest.mark.parametrize(
    ("options", "impedance", "timeconst"),
    [
        ("", 0.9, 0.02),
        ("solreffriction=0.008 1", 0.9, 0.008),
        ("solimpfriction=0.999 0.999 0.001", 0.999, 0.02),
    ],
)
def test_a_joint_that_friction_holds_creeps_as_its_softness_says(options: str, impedance: float, timeconst: float) -> None:
    """At a constant velocity v, 0 = (1 - d) a - d b v, with a = e / m, b = 2 / (d_max timeconst) and d = d_0."""
    largest = max(impedance, 0.95)
    held = replace(slider(friction=2.0, effort=1.0).joints[0], start_velocity=(0.0,))
    mechanism = replace(slider(), joints=(held,))
    speed = after(mechanism, f"Euler:{options}" if options else "Euler", 2000)[0, 0, 7]
    expected = (1 - impedance) / impedance * (1.0 / MASS) * largest * timeconst / 2
    # Newton's iterations of the constraint solver stop at a relative change of 1e-8.
    assert speed == pytest.approx(expected, rel=1e-5)


def test_noslip_iterations_hold_what_friction_holds() -> None:
    held = replace(SLIDER, friction=2.0, effort=1.0, start_velocity=(0.0,))
    assert abs(after(replace(slider(), joints=(held,)), "Euler:noslip=10", 500)[0, 0, 7]) < ROUNDING


def test_a_loop_sags_as_its_softness_says() -> None:
    """A cart on a vertical rail hangs on a loop: k r d = (1 - d) g, with k = d / (d timeconst)^2 at a constant impedance d."""
    rail = replace(SLIDER, axis=(0.0, 0.0, 1.0), start=(0.0,), start_velocity=(0.0,))
    hung = Mechanism((body("cart", MASS, (0.1, 0.1, 0.1)),), (rail,), (Loop((0, WORLD), ((0.0, 0.0, 0.0),) * 2),), 9.81)
    impedance, timeconst = 0.9, 0.02
    sag = -after(hung, f"Euler:solref={timeconst} 1,solimp={impedance} {impedance} 0.001", 2000)[0, 0, 2]
    stiffness = impedance / (impedance * timeconst) ** 2
    assert sag == pytest.approx((1 - impedance) * 9.81 / (impedance * stiffness), rel=1e-6)


def test_an_option_without_an_effect_is_refused() -> None:
    with pytest.raises(SceneUnsupported, match=r"solref=0\.01 1 for a mechanism without loops"):
        after(cart_pole(), "Euler:solref=0.01 1", 1)
    with pytest.raises(SceneUnsupported, match=r"raise the time constant 0\.001 s of solref to 0\.004 s"):
        after(four_bar(), "Euler:solref=0.001 1", 1)


def test_stops_cease_to_act_between_two_steps() -> None:
    """Until then the states are those with the stop, afterwards the joint passes it, and strides make no difference."""
    hinge = Joint(
        "hinge", "revolute", WORLD, 0, axis=(0.0, 1.0, 0.0), start=(0.0,), start_velocity=(0.0,), stops=Stops(None, 0.3)
    )
    stopped = Mechanism((body("arm", 1.0, (0.02, 0.03, 0.01), (0.2, 0.0, 0.0)),), (hinge,), gravity=9.81)
    released = replace(stopped, stops_until=0.41)
    whole, single, long = states(stopped, [1] * 600), states(released, [1] * 600), states(released, [150, 150, 150, 150])
    assert np.array_equal(single[:410], whole[:410])
    heights = single[:, 0, 2]
    assert heights[410] == pytest.approx(whole[410, 0, 2], abs=1e-4)
    assert heights[-1] < heights[410] - 0.02
    assert np.array_equal(long, single[149::150])
    assert np.array_equal(states(stopped, [1] * 600), whole)  # the model of others is not changed


def states(mechanism: Mechanism, strides: list[int]) -> Array:
    return adapter.prepare([mechanism], Method.parse("RK4", 0.001)).advance(np.array(strides))[0]
