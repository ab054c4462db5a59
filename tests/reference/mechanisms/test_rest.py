"""Mechanisms that start at rest: those in an equilibrium stay there, and nothing moves."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism, Mimic
from bodycheck.reference.mechanisms.rest import is_at_rest
from bodycheck.reference.scene import Push, Tensor

BODY = JointedBody("body", Tensor(2.0, ((0.1, 0.0, 0.0), (0.0, 0.2, 0.0), (0.0, 0.0, 0.25))), (0.0, 0.0, -0.5))

HINGE = Joint("hinge", "revolute", WORLD, 0, axis=(0.0, 1.0, 0.0), start=(0.0,), start_velocity=(0.0,))


def pendulum(**changes: object) -> Mechanism:
    return Mechanism((BODY,), (replace(HINGE, **changes),), (), 9.81)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("mechanism", "rests"),
    [
        (pendulum(), True),
        (pendulum(start=(0.1,)), False),
        (pendulum(start=(1e-12,)), False),
        (pendulum(start_velocity=(0.1,)), False),
        (pendulum(start=(0.1,), friction=0.99), True),
        (pendulum(start=(0.1,), friction=0.97), False),
        (pendulum(stiffness=2.0, rest=0.1), False),
        (pendulum(effort=1e-6), False),
        (pendulum(start=(0.5,), axis=(0.0, 0.0, 1.0)), True),
        (pendulum(start=(0.5,), axis=(1.0, 2.0, 3.0)), False),
        (replace(pendulum(start=(0.5,)), gravity=0.0), True),
        (replace(pendulum(), pushes=(Push((1.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.5, 1.0, 0),)), False),
        (Mechanism((BODY,), (), (), 9.81), False),
        (Mechanism((BODY,), (), (), 0.0), True),
        (pendulum(type="prismatic", axis=(1.0, 0.0, 0.0)), True),
        (pendulum(type="prismatic", axis=(1.0, 0.0, 0.1)), False),
        (pendulum(type="spherical", axis=None, start=(1.0, 0.0, 0.0, 0.0), start_velocity=(0.0,) * 3), True),
        (pendulum(type="spherical", axis=None, start=(0.8, 0.6, 0.0, 0.0), start_velocity=(0.0,) * 3), False),
        (pendulum(type="free", axis=None, start=(0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0), start_velocity=(0.0,) * 6), False),
        (pendulum(type="planar", axis=None, start=(0.0,) * 3, start_velocity=(0.0,) * 3), True),
        (pendulum(type="planar", axis=None, start=(0.0,) * 3, start_velocity=(0.0,) * 3, attitude=(0.8, 0.6, 0.0, 0.0)), False),
        (pendulum(type="fixed", axis=None, start=(), start_velocity=()), True),
    ],
)
def test_whether_nothing_moves(mechanism: Mechanism, *, rests: bool) -> None:
    assert is_at_rest(mechanism) is rests


def test_joints_that_follow_others_balance_them() -> None:
    """Two equal pendulums on opposite sides, of which one turns by the opposite angle, are in equilibrium; alone, both move."""
    one = replace(HINGE, start=(0.3,))
    other = replace(HINGE, name="other", child=1, start=(0.3,))
    bodies = (BODY, replace(BODY, name="other"))
    assert not is_at_rest(Mechanism(bodies, (one, other), (), 9.81))
    following = replace(other, mimic=Mimic(0, -1.0, 0.6))
    assert is_at_rest(Mechanism(bodies, (one, following), (), 9.81))
    assert not is_at_rest(Mechanism(bodies, (one, replace(following, mimic=Mimic(0, 1.0, 0.0))), (), 9.81))


def test_a_rounded_equilibrium_is_one() -> None:
    """A pendulum whose frame is turned to and fro by rounded quaternions hangs within a rounding of doubles."""
    half = float(np.sqrt(0.5))
    turned = replace(HINGE, attitude=(half, half, 0.0, 0.0), axis=(0.0, 0.0, -1.0))
    assert is_at_rest(Mechanism((replace(BODY, center_of_mass=(0.0, -0.5, 0.0)),), (turned,), (), 9.81))
