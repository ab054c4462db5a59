"""What is special about mechanisms in Newton: orders, what solvers lack, and Featherstone's ball joints."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.reference.trajectory import Array
from tests.support.jointed import ball_chain, cart_pole, free_chain
from tests.support.orders import observed_mechanism_order

NEWTON = registry.load("newton")


@pytest.mark.parametrize("spelling", ["Featherstone", "Steel", "MuJoCo-euler"])
def test_the_order_is_one_on_hinges(spelling: str) -> None:
    observed = observed_mechanism_order(NEWTON, free_chain(), spelling, (8e-3, 4e-3, 2e-3), 0.4)
    # Errors of some 1e-3 in single precision, and the next term of the error: the step times some ten per second.
    assert observed == pytest.approx({"position": 1, "attitude": 1}, abs=0.15)


def test_featherstone_has_wrong_accelerations_of_a_ball_joint_on_a_moving_body() -> None:
    """It differs from Steel, which is of the same scheme, by as much with half of the time step."""

    def after(spelling: str, timestep: float) -> Array:
        strides = np.array([round(0.2 / timestep)])
        return NEWTON.prepare([ball_chain()], Method.parse(spelling, timestep)).advance(strides)[0, 0]

    apart = [np.abs(after("Featherstone", step)[:, :3] - after("Steel", step)[:, :3]).max() for step in (2e-3, 1e-3)]
    assert min(apart) > 1e-3
    assert apart[0] / apart[1] == pytest.approx(1, abs=0.1)


@pytest.mark.parametrize(("spelling", "lacking"), [("Steel", "springs"), ("Steel", "friction"), ("Featherstone", "friction")])
def test_what_a_solver_ignores_is_refused(spelling: str, lacking: str) -> None:
    key = {"springs": "stiffness", "friction": "friction"}[lacking]
    joints = tuple(replace(joint, **{key: 1.0}) for joint in cart_pole().joints)
    with pytest.raises(SceneUnsupported, match=lacking):
        NEWTON.prepare([replace(cart_pole(), joints=joints)], Method.parse(spelling, 1e-3))
