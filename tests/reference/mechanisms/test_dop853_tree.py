"""The motion of mechanisms where heyoka is not installed."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.mechanisms import kinematics, observables, recursion
from bodycheck.reference.mechanisms.recursion import JointStates, follow, solver
from bodycheck.reference.trajectory import Trajectory
from tests.support.jointed import cart_pole, tree

TIMES = np.linspace(0.0, 0.25, 6)


@pytest.fixture(scope="module")
def without_heyoka() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(recursion, "solver", lambda: recursion.followed_by_dop853)
        yield


@pytest.fixture(scope="module")
def moved_tree(without_heyoka: None) -> JointStates:
    """The motion of the tree with a joint of every type."""
    return follow(tree(), TIMES)


def test_a_tree_of_every_joint_conserves_its_energy_and_its_joints_hold(moved_tree: JointStates) -> None:
    mechanism, bodies = tree(), moved_tree.bodies
    parts = (bodies.position, bodies.quaternion, bodies.velocity, bodies.angular_velocity)
    states = Trajectory(TIMES, *(part.astype(float) for part in parts))
    # DOP853 near the rounding of double precision, for some ten steps and energies of some joules.
    assert np.ptp(observables.observe(mechanism, states).total_energy) < 1e-12
    np.testing.assert_allclose(
        kinematics.joints(mechanism, states).position, moved_tree.position.astype(float), rtol=0, atol=1e-13
    )


def test_the_motion_is_that_of_taylors_method(moved_tree: JointStates, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("heyoka")
    monkeypatch.setattr(recursion, "solver", solver)
    precise = follow(tree(), TIMES)
    # An error grows a few times over this quarter of a second.
    assert np.abs(moved_tree.position - precise.position).max() < 1e-12
    assert np.abs(moved_tree.bodies.position - precise.bodies.position).max() < 1e-12


def test_dry_friction_is_out_of_reach(without_heyoka: None) -> None:
    mechanism = cart_pole()
    dry = replace(mechanism, joints=(replace(mechanism.joints[0], friction=0.1), mechanism.joints[1]))
    with pytest.raises(OutOfReach, match="joints with dry friction are followed by heyoka, which is not installed"):
        follow(dry, TIMES)
