"""Schemes in the coordinates of joints converge to the motion of the mechanism with their textbook orders."""

import numpy as np
import pytest

from bodycheck.reference.mechanisms.recursion import follow
from bodycheck.reference.mechanisms.tree import forest
from bodycheck.reference.schemes.catalogue import EXPLICIT, MUNTHE_KAAS
from bodycheck.reference.schemes.jointed import JOINTED, has_schemes, states, trajectory
from tests.support.jointed import ball_and_hinge, four_bar, tree

#: The orders of schemes on a mechanism with a ball; Euler's have the order 1.
ORDERS = {
    MUNTHE_KAAS: 4,
    "averaged Runge-Kutta 4": 2,
    **{name: EXPLICIT[name].order for name in ("explicit midpoint", "Kutta 3")},
}

DURATION = 0.25


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
