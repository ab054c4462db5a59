"""States that follow from a seed alone."""

import math
from dataclasses import replace
from random import Random

import pytest

from bodycheck.reference.robots.model import Mimic, RobotModel, with_joint
from bodycheck.reference.robots.state import COORDINATES, VELOCITIES
from bodycheck.reference.robots.states import seeded_states
from tests.support.robot_trees import random_tree

ALL = ("revolute", "prismatic", "fixed", "floating", "planar", "spherical")


def hinges() -> RobotModel:
    return random_tree(Random(2), 4, types=("revolute",))


def test_states_have_the_numbers_of_every_joint() -> None:
    model = random_tree(Random(1), 20, True, ALL)
    for state in seeded_states(model, 3, 0):
        for joint in model.joints:
            if joint.type == "fixed":
                assert joint.name not in state.positions
                continue
            assert len(state.positions[joint.name]) == COORDINATES[joint.type]
            for part in (state.velocities, state.accelerations, state.efforts):
                assert len(part[joint.name]) == VELOCITIES[joint.type]
                assert all(abs(value) <= 1 for value in part[joint.name])
            if joint.type in ("spherical", "floating"):
                assert math.hypot(*state.positions[joint.name][-4:]) == pytest.approx(1, abs=1e-15)  # roundings


def test_a_seed_gives_the_same_states_everywhere() -> None:
    model = random_tree(Random(1), 2, types=("revolute",))
    names = [joint.name for joint in model.joints]
    # Random.random is the same on every machine, and so are sums, products and square roots.
    random = Random(17)
    low, part = 0.05, 0.9
    expected = -math.pi + 2 * math.pi * (low + part * random.random())
    (state,) = seeded_states(model, 1, 17)
    assert state.positions[names[0]][0] == pytest.approx(expected, abs=1e-15)
    assert seeded_states(model, 3, 17)[0] == state
    assert seeded_states(model, 1, 18)[0] != state


@pytest.mark.parametrize(
    ("limits", "between"),
    [
        ((None, None), (-math.pi, math.pi)),
        ((-0.3, 0.1), (-0.3, 0.1)),
        ((5.0, 6.0), (5.0, 6.0)),
        ((1.0, None), (1.0, 1.0 + math.pi)),
        ((None, -1.0), (-1.0 - math.pi, -1.0)),
        ((-1e10, 1e10), (-math.pi, math.pi)),
        ((100.0, 1e10), (100.0, 100 + 2 * math.pi)),
        ((-math.inf, math.inf), (-math.pi, math.pi)),
        ((1.0, -1.0), (-math.pi, math.pi)),
        ((math.nan, math.nan), (-math.pi, math.pi)),
    ],
)
def test_positions_are_inside_the_limits(limits: tuple, between: tuple) -> None:
    model = with_joint(hinges(), "joint_1", lower=limits[0], upper=limits[1])
    drawn = [state.positions["joint_1"][0] for state in seeded_states(model, 200, 3)]
    low, high = between
    edge = 0.04 * (high - low)
    assert low + edge < min(drawn) < low + 4 * edge
    assert high - 4 * edge < max(drawn) < high - edge


def test_a_joint_that_cannot_move_stays() -> None:
    model = with_joint(hinges(), "joint_1", lower=0.25, upper=0.25)
    assert {state.positions["joint_1"] for state in seeded_states(model, 5, 0)} == {(0.25,)}


def test_joints_follow_those_that_they_mimic() -> None:
    model = with_joint(hinges(), "joint_1", mimic=Mimic("joint_2", 2.0, 0.5), lower=-0.1, upper=0.1)
    model = with_joint(model, "joint_2", mimic=Mimic("joint_3", -3.0, 1.0))
    for state in seeded_states(model, 5, 0):
        (leader,) = state.positions["joint_3"]
        assert state.positions["joint_2"] == (pytest.approx(-3 * leader + 1),)
        assert state.positions["joint_1"] == (pytest.approx(2 * (-3 * leader + 1) + 0.5),)
        for part in (state.velocities, state.accelerations):
            assert part["joint_1"] == (pytest.approx(-6 * part["joint_3"][0]),)
        assert state.efforts["joint_1"] != state.efforts["joint_3"]


@pytest.mark.parametrize("target", ["joint_1", "joint_2", "nowhere"])
def test_mimicry_that_leads_nowhere_is_left_out(target: str) -> None:
    model = with_joint(hinges(), "joint_1", mimic=Mimic(target, 2.0))
    model = with_joint(model, "joint_2", mimic=Mimic("joint_1", 2.0))
    free = replace(model, joints=tuple(replace(joint, mimic=None) for joint in model.joints))
    (state,), (alone,) = seeded_states(model, 1, 0), seeded_states(free, 1, 0)
    assert state.positions["joint_1"] == alone.positions["joint_1"]
