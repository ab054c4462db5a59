"""Rigid stops that a motion does not reach are left out, and stops that cease to act at an instant."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.reference.mechanisms.control import Stops
from bodycheck.reference.mechanisms.followed import followed
from bodycheck.reference.mechanisms.hybrid.acting import acting_stops
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism
from bodycheck.reference.mechanisms.truth import end_of_stops, mechanism_truth
from bodycheck.reference.scene import Tensor

pytest.importorskip("heyoka")

BODY = Tensor(1.0, ((0.02, 0.0, 0.0), (0.0, 0.03, 0.0), (0.0, 0.0, 0.01)))
T = np.linspace(0.0, 0.6, 25)


def chain(*stops: Stops | None) -> Mechanism:
    """Return a chain of hinges about y that begins stretched out and falls."""
    joints = tuple(
        Joint(
            f"j{n}",
            "revolute",
            n - 1 if n else WORLD,
            n,
            (0.4 * bool(n), 0.0, 0.0),
            axis=(0.0, 1.0, 0.0),
            start=(0.1 * n,),
            start_velocity=(0.0,),
            stops=each,
        )
        for n, each in enumerate(stops)
    )
    bodies = tuple(JointedBody(f"b{n}", BODY, (0.2, 0.0, 0.0)) for n in range(len(stops)))
    return Mechanism(bodies, joints, gravity=9.81)


def test_only_the_stops_that_are_reached_act_and_the_motion_is_that_with_all() -> None:
    far = Stops(-50.0, 50.0)
    mechanism = chain(Stops(-1.0, 0.5), far, far, far, far)
    assert acting_stops(mechanism, 0.6) == {0}
    all_of_them, truth = followed(mechanism, T), mechanism_truth(mechanism, T)
    assert truth.joints is not None
    assert truth.joints.position == pytest.approx(all_of_them.way.motion.position.astype(float), abs=1e-11)
    assert truth.joints.position[:, 0].max() == 0.5
    assert len(truth.witnesses) == 1
    assert truth.bounds.error[-1] < 1e-11


def test_the_witness_finds_the_stops_of_joints_behind_fixed_ones() -> None:
    """A fixed joint has no coordinates. Its place among the joints must not shift those of the joints behind it."""
    far = Stops(-50.0, 50.0)
    plain = chain(Stops(-1.0, 0.5), far, far, far, far)
    base = Joint("base", "fixed", WORLD, 0)
    moved = tuple(
        replace(joint, parent=0 if joint.parent == WORLD else joint.parent + 1, child=joint.child + 1) for joint in plain.joints
    )
    mechanism = replace(plain, bodies=(JointedBody("trunk", BODY), *plain.bodies), joints=(base, *moved))
    truth, same = mechanism_truth(mechanism, T), mechanism_truth(plain, T)
    assert truth.joints is not None
    assert same.joints is not None
    assert truth.joints.position[:, -5:] == pytest.approx(same.joints.position, abs=1e-13)
    assert len(truth.witnesses) == 1
    assert truth.bounds.error[-1] < 1e-11


def test_a_motion_that_reaches_no_stop_is_the_motion_without_stops() -> None:
    far = Stops(-50.0, 50.0)
    assert acting_stops(chain(far, far, far, far, far), 0.6) == set()
    stopped, free = (mechanism_truth(chain(*stops), T) for stops in ((far,) * 5, (None,) * 5))
    assert stopped.joints is not None
    assert free.joints is not None
    assert np.array_equal(stopped.joints.position, free.joints.position)
    assert end_of_stops(chain(far, far, far, far, far), T) is None


def test_a_stop_that_ceases_to_act_lets_go() -> None:
    """Until then it is the motion with the stop, and from then on the motion without stops from the same state."""
    mechanism, row = chain(Stops(-1.0, 0.5), None), 18
    until = float(T[row])
    whole, released = mechanism_truth(mechanism, T), mechanism_truth(replace(mechanism, stops_until=until), T)
    assert whole.joints is not None
    assert released.joints is not None
    assert released.joints.position[: row + 1] == pytest.approx(whole.joints.position[: row + 1], abs=1e-13)
    assert released.joints.position[row, 0] == 0.5  # the stop holds the joint until it ceases to act
    assert released.joints.position[-1, 0] > 0.55
    joints = tuple(
        replace(joint, stops=None, start=(float(q),), start_velocity=(float(v),))
        for joint, q, v in zip(mechanism.joints, released.joints.position[row], released.joints.velocity[row], strict=True)
    )
    free = mechanism_truth(replace(mechanism, joints=joints), T[row:] - until)
    assert free.joints is not None
    assert released.joints.position[row:] == pytest.approx(free.joints.position, abs=1e-12)  # the start is rounded
    assert released.witnesses
    assert released.bounds.error[-1] < 1e-12
