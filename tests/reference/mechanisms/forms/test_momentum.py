"""A chain that floats freely: its centre of mass falls on a parabola, and its angular momentum is constant."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.reference.mechanisms import observables
from bodycheck.reference.mechanisms.forms.momentum import floating
from bodycheck.reference.mechanisms.mechanism import WORLD, BodyStart, Joint, JointedBody, Loop, Mechanism
from bodycheck.reference.mechanisms.truth import mechanism_truth
from bodycheck.reference.scene import Tensor

ROWS = ((0.02, 0.001, 0.0), (0.001, 0.03, 0.0), (0.0, 0.0, 0.04))


def chain() -> Mechanism:
    """Three links that float, with a damped hinge and a ball between them, and a pendulum that does not."""
    start = BodyStart((0.1, 0.2, 0.3), (1.0, 0.2, 0.0, 0.1), (1.0, -2.0, 3.0), (0.5, 1.0, -2.0))
    bodies = (
        JointedBody("first", Tensor(1.0, ROWS), (0.1, 0.0, 0.0), start),
        JointedBody("second", Tensor(2.0, ROWS), (0.0, 0.3, 0.0)),
        JointedBody("third", Tensor(0.5, ROWS), (0.0, 0.0, -0.2)),
        JointedBody("pendulum", Tensor(1.0, ROWS), (0.0, 0.0, -1.0)),
    )
    joints = (
        Joint("hinge", "revolute", 0, 1, (0.4, 0.0, 0.0), damping=0.3, start=(0.2,), start_velocity=(4.0,)),
        Joint("ball", "spherical", 1, 2, (0.0, 0.5, 0.0), start=(1.0, 0.0, 0.1, 0.0), start_velocity=(1.0, 0.0, -1.0)),
        Joint("pin", "revolute", WORLD, 3, axis=(0.0, 1.0, 0.0), start=(0.2,), start_velocity=(0.0,)),
    )
    return Mechanism(bodies, joints, (), 9.81)


def test_the_motion_keeps_what_is_exact(monkeypatch: pytest.MonkeyPatch) -> None:
    whole, times = chain(), np.linspace(0, 2, 11)
    mechanism = replace(whole, bodies=whole.bodies[:2], joints=whole.joints[:1])
    (found,) = floating(mechanism, times)
    truth = mechanism_truth(mechanism, times, vouched=False)
    for exact, followed, bound in (
        (found.centre, truth.trajectory.position, truth.bounds.position_error),
        (found.velocity, truth.trajectory.velocity, truth.bounds.velocity_error),
    ):
        mean = (observables.masses(mechanism)[:, None, None] * followed).sum(axis=0) / 3
        # The mean of doubles of size 20 has roundings of its own.
        assert np.all(np.abs(mean - exact).max(axis=1) <= bound + 1e-14)
    seen = observables.observe(mechanism, truth.trajectory).angular_momentum
    assert seen == pytest.approx(np.tile(found.angular_momentum.astype(float), (11, 1)), abs=1e-12)
    # A centre of mass that leaves its parabola shows in the bounds, which are some 1e-15 otherwise.
    moved = replace(found, centre=found.centre + 1e-6)
    monkeypatch.setattr("bodycheck.reference.mechanisms.truth.floating", lambda mechanism, times: (moved,))
    assert mechanism_truth(mechanism, times, vouched=False).bounds.position_error.min() > 1e-8


def test_what_the_world_holds_does_not_float() -> None:
    free = chain()
    times = np.zeros(1)
    tied = replace(free, loops=(Loop((2, WORLD), ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))),))
    assert floating(tied, times) == ()
    together = replace(free, loops=(Loop((2, 3), ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))),))
    assert floating(together, times) == ()
    still = (0.0,) * 6
    joint = Joint("air", "free", WORLD, 0, start=(0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0), start_velocity=still)
    on_joint = replace(free, bodies=(replace(free.bodies[0], start=None), *free.bodies[1:]), joints=(*free.joints, joint))
    assert [tree.bodies for tree in floating(on_joint, times)] == [(0, 1, 2)]
