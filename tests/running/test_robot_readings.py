"""What an engine makes of a robot model is checked before it is compared."""

import numpy as np
import pytest

from bodycheck.adapters.robot_reading import RobotReading
from bodycheck.reference.robots.terms import Terms
from bodycheck.results.outcome import AdapterFault
from bodycheck.running.robot_readings import check_shapes


def reading(*terms: Terms) -> RobotReading:
    """A reading of a robot with two velocities."""
    return RobotReading((), (), (), 2, None, terms)


def test_terms_of_the_shapes_that_the_contract_states_are_taken() -> None:
    good = Terms(
        {"arm": np.zeros(7)}, {"arm": np.zeros((6, 2))}, mass_matrix=np.eye(2), gravity_force=np.zeros(2), coriolis_force=None
    )
    check_shapes(reading(good, Terms()), 2)


@pytest.mark.parametrize(
    ("terms", "told"),
    [
        (Terms(mass_matrix=np.zeros((2, 3))), r"mass_matrix has the shape \(2, 3\), not \(2, 2\)"),
        (Terms(gravity_force=np.array(None)), r"gravity_force has the shape \(\), not \(2,\)"),
        (Terms(poses={"arm": np.zeros(6)}), r"the pose of arm has the shape \(6,\), not \(7,\)"),
        (Terms(jacobians={"arm": np.zeros((6, 3))}), r"the Jacobian of arm has the shape \(6, 3\), not \(6, 2\)"),
    ],
)
def test_another_shape_is_a_fault_of_the_adapter(terms: Terms, told: str) -> None:
    with pytest.raises(AdapterFault, match=told):
        check_shapes(reading(terms), 1)


def test_terms_at_fewer_states_are_a_fault_of_the_adapter() -> None:
    with pytest.raises(AdapterFault, match="at 1 states, not at 2"):
        check_shapes(reading(Terms()), 2)
