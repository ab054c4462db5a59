"""The Lagrangian with multipliers: it agrees with the multipliers in joint coordinates, and its faults are seen."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bodycheck.reference.bounds import STATES
from bodycheck.reference.certificate import certify
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.mechanisms.followed import followed
from bodycheck.reference.mechanisms.lagrangian import solution
from bodycheck.reference.mechanisms.loops import joint_space, ways
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.truth import mechanism_truth
from bodycheck.reference.mechanisms.ways import Motion, apart
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import Truth
from tests.support.linkages import closed_spatially, four_bar, n_four_bar, slider_crank

pytest.importorskip("heyoka")


def held_to_the_world() -> Mechanism:
    """The spatial linkage with the loop that holds it to the world alone, without the free body of the other."""
    made = closed_spatially()
    return replace(made, loops=made.loops[:1])


def followed_by_lagrangian(mechanism: Mechanism, times: Array) -> Motion:
    found = solution.follow(mechanism, times)
    bodies = Trajectory(times, found.position, found.quaternion, found.velocity, found.angular_velocity)
    return Motion(found.joint_position, found.joint_velocity, bodies)


@pytest.mark.parametrize(
    ("mechanism", "end"),
    [(slider_crank(), 1.0), (four_bar(), 0.6), (held_to_the_world(), 0.3), (n_four_bar(2), 0.6)],
    ids=["slider-crank", "four-bar", "all joints", "two four-bars"],
)
def test_it_agrees_with_the_multipliers_in_joint_coordinates(mechanism: Mechanism, end: float) -> None:
    times = np.linspace(0, end, 4)
    off = apart(mechanism, ways.way(mechanism, times).motion, followed_by_lagrangian(mechanism, times))
    # The numbers of the file close the loops to some 1e-16, which the two ways take in different ways.
    assert max(values.max() for values in off.values()) < 2e-14


def test_free_bodies_in_loops_are_left_to_the_equations_of_bodies() -> None:
    with pytest.raises(NotModelled, match="free bodies in loops"):
        solution.follow(closed_spatially(), np.array([0.1]))


def test_the_truth_names_it_and_tells_how_an_error_grows() -> None:
    """The growth is that between two cranks whose first angles differ by 1e-6 rad."""
    times = np.linspace(0, 1.0, 21)
    found = mechanism_truth(slider_crank(), times)
    assert [name.partition(",")[0] for name in found.witnesses] == ["Euler-Lagrange with multipliers"]
    assert found.bounds.error[-1] < 1e-13
    other = followed(slider_crank(0.6 + 1e-6), times).way.motion
    apart_by = np.abs(other.position[:, 0] - followed(slider_crank(), times).way.motion.position[:, 0]).astype(float)
    assert found.growth is not None
    # What is nudged is closed by the smallest changes of all joints, so that growth is known to a factor.
    assert 0.2 < found.growth[-1] / (apart_by.max() / 1e-6) < 20


def test_the_certificate_has_three_ways() -> None:
    found = certify(slider_crank(), np.linspace(0, 0.5, 6))
    assert found.certified, found.faults
    assert len(found.differences) == 3
    assert found.bound[-1] < 1e-13


def test_a_fault_of_the_multipliers_is_in_the_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    times = np.linspace(0, 1.0, 6)
    right = mechanism_truth(slider_crank(), times)
    tree = joint_space.tree

    def heavier(mechanism: Mechanism) -> Any:
        made = tree(mechanism)
        return replace(made, gravity=made.gravity * (1 + 1e-9))

    monkeypatch.setattr(joint_space, "tree", heavier)
    wrong = mechanism_truth(slider_crank(), times)
    off = apart(slider_crank(), motion_of(wrong), motion_of(right))
    for name in STATES:
        assert off[name].max() > 1e-11
        assert (off[name] <= getattr(wrong.bounds, name)).all()


def motion_of(found: Truth) -> Motion:
    assert found.joints is not None
    return Motion(found.joints.position, found.joints.velocity, found.trajectory)
