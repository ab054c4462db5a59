"""What is special about mechanisms in PhysX by SAPIEN: damping and springs are its drives, which TGS takes in ten parts."""

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from tests.support.jointed import coordinate, free_chain, on_one_joint
from tests.support.orders import observed_mechanism_order

SAPIEN = registry.load("sapien")

#: The parts of a step of each solver: TGS has as many as SAPIEN's default number of iterations.
PARTS = {"PGS": 1, "TGS": 10}


@pytest.mark.parametrize("solver", PARTS)
def test_the_order_is_one_on_hinges(solver: str) -> None:
    observed = observed_mechanism_order(SAPIEN, free_chain(), solver, (8e-3, 4e-3, 2e-3), 0.4)
    # Errors of some 1e-3 in single precision, and the next term of the error: the step times some ten per second.
    assert observed == pytest.approx({"position": 1, "attitude": 1}, abs=0.15)


@pytest.mark.parametrize(("solver", "parts"), PARTS.items())
def test_damping_is_that_at_the_end_of_each_part_of_a_step(solver: str, parts: int) -> None:
    h, d = 0.1, 3.0
    mechanism = on_one_joint("prismatic", 0.0, 1.0, damping=d)
    simulation = SAPIEN.prepare([mechanism], Method.parse(solver, h))
    _, velocity = coordinate(mechanism, simulation.advance(np.array([1])))
    assert velocity[0] == pytest.approx((1 + h * d / parts) ** -parts, rel=1e-6)  # single precision


@pytest.mark.parametrize("solver", PARTS)
def test_armature_is_inertia(solver: str) -> None:
    """One newton on 1 kg and 3 kg of armature: the velocity is t / 4."""
    mechanism = on_one_joint("revolute", 0.0, 0.0, armature=3.0, effort=1.0)
    simulation = SAPIEN.prepare([mechanism], Method.parse(solver, 0.1))
    _, velocity = coordinate(mechanism, simulation.advance(np.array([10])))
    assert velocity[0] == pytest.approx(0.25, rel=1e-5)  # single precision
