"""Schemes in the coordinates of joints converge to the motion of the mechanism with their textbook orders."""

import numpy as np
import pytest

from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.mechanisms.recursion import follow
from bodycheck.reference.mechanisms.tree import forest
from bodycheck.reference.schemes.catalogue import EXPLICIT, MUNTHE_KAAS
from bodycheck.reference.schemes.jointed import JOINTED, has_schemes, states, trajectory
from tests.support.jointed import body, four_bar, tree

#: The orders of schemes on a mechanism with a ball; Euler's have the order 1.
ORDERS = {
    MUNTHE_KAAS: 4,
    "averaged Runge-Kutta 4": 2,
    **{name: EXPLICIT[name].order for name in ("explicit midpoint", "Kutta 3")},
}

DURATION = 0.25


def ball_and_hinge() -> Mechanism:
    """A body on a damped ball, and on it one on a sprung and damped hinge."""
    moments = (0.05, 0.06, 0.03)
    return Mechanism(
        bodies=(body("arm", 0.8, moments, (0.1, 0.0, -0.4)), body("hand", 0.5, moments, (0.0, 0.1, -0.2))),
        joints=(
            Joint(*("ball", "spherical", WORLD, 0), damping=0.1, start=(0.9, 0.3, -0.1, 0.2), start_velocity=(1.0, -2.0, 1.5)),
            Joint(
                *("hinge", "revolute", 0, 1, (0.2, 0.0, -0.8), (0.8, 0.2, -0.4, 0.4), (0.0, 1.0, 0.3)),
                armature=0.02,
                damping=0.1,
                stiffness=2.0,
                rest=0.3,
                start=(0.5,),
                start_velocity=(2.0,),
            ),
        ),
        gravity=9.81,
    )


@pytest.mark.parametrize("name", ["explicit Euler", *(name for name in JOINTED if "implicit" in name), *ORDERS])
def test_a_scheme_converges_with_its_order(name: str) -> None:
    mechanism, order = ball_and_hinge(), ORDERS.get(name, 1)
    end = np.array([DURATION])
    truth = follow(mechanism, end, np.float64).bodies.position
    counts = (20, 40) if order == 1 else (8, 16)
    errors = []
    for count in counts:
        rows = [states(JOINTED[name], own, DURATION / count, np.array([count])) for own in forest(mechanism).trees]
        errors.append(np.abs(trajectory(mechanism, rows, end).position - truth).max())
    # The terms of the next order are at most a tenth or so of these steps' errors.
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.35)


def test_mechanisms_with_loops_or_bodies_that_fly_have_no_schemes() -> None:
    assert has_schemes(ball_and_hinge())
    assert not has_schemes(four_bar())
    assert not has_schemes(tree())
