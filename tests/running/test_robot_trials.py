"""Motions show what an engine does with a joint, whatever its records tell."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters.robot_reading import Behaviour
from bodycheck.reference.robots.model import Mimic, RobotModel
from bodycheck.running.robot_trials import behaviours
from tests.support.robot_motions import NAMES, RULE, STATE, Does, file_model, told

ROUNDING = float(np.finfo(np.float64).eps)


def tried(model: RobotModel, does: Does) -> dict[str, Behaviour]:
    """What the motions of an engine show that tells of the joints what the file says."""
    return behaviours(does.step, told(model), model, STATE, ROUNDING)


LIMITED = file_model(lower=dict.fromkeys(NAMES, -2.0), upper=dict.fromkeys(NAMES, 3.0))
BRAKED = file_model(damping={"first": 0.5, "second": 0.2}, friction={"first": 0.3, "second": 0.4})
FOLLOWING = file_model(mimic={"second": RULE})


def test_limits_that_stop_a_joint_are_confirmed() -> None:
    known = tried(LIMITED, Does(limits=dict.fromkeys(NAMES, (-2.0, 3.0))))
    assert {name: (one.lower, one.upper, one.tried) for name, one in known.items()} == dict.fromkeys(
        NAMES, (-2.0, 3.0, {"limits"})
    )


def test_limits_that_are_told_and_stop_no_joint_are_none() -> None:
    known = tried(LIMITED, Does(limits={"first": (-2.0, np.inf)}))
    assert (known["first"].lower, known["first"].upper) == (-2.0, None)
    assert (known["second"].lower, known["second"].upper) == (None, None)
    assert known["second"].tried == {"limits"}


def test_a_soft_limit_that_gives_way_at_first_is_not_called_ignored() -> None:
    """A spring of 50 N m/rad turns the joint back after a fifth of a second."""
    known = tried(LIMITED, Does(springs=dict.fromkeys(NAMES, (-2.0, 3.0))))
    assert known == {}


def test_a_limit_that_is_told_for_a_joint_without_limits_in_the_file_is_tried() -> None:
    """As of a continuous joint, for which an engine keeps the numbers of the file."""
    continuous = file_model()
    for does, limits in ((Does(), (None, None)), (Does(limits={"first": (-1.0, 1.0)}), (-1.0, 1.0))):
        known = behaviours(
            does.step, told(file_model(lower={"first": -1.0}, upper={"first": 1.0})), continuous, STATE, ROUNDING
        )
        assert (known["first"].lower, known["first"].upper) == limits


def test_a_rule_that_joints_obey_is_confirmed() -> None:
    assert tried(FOLLOWING, Does(rules={"second": RULE}))["second"].mimic == RULE


def test_a_rule_with_exchanged_joints_is_measured() -> None:
    """The multiplier in the record is right, so that an adapter that copies it would agree with the file."""
    known = tried(FOLLOWING, Does(rules={"second": Mimic("first", 0.5, -0.05)}))["second"]
    assert known.mimic == Mimic("first", 0.5, -0.05)


def test_a_rule_that_no_joint_obeys_is_none() -> None:
    known = tried(FOLLOWING, Does())["second"]
    assert (known.tried, known.mimic) == ({"mimic"}, None)


def test_damping_and_friction_that_brake_are_confirmed() -> None:
    known = tried(BRAKED, Does(damping={"first": 0.5, "second": 0.2}, friction={"first": 0.3, "second": 0.4}))
    assert {name: (one.damping, one.friction) for name, one in known.items()} == {"first": (0.5, 0.3), "second": (0.2, 0.4)}


@pytest.mark.parametrize("part", ["damping", "friction"])
def test_damping_or_friction_that_does_not_brake_is_zero(part: str) -> None:
    both = {"damping": {"first": 0.5, "second": 0.2}, "friction": {"first": 0.3, "second": 0.4}}
    known = tried(BRAKED, Does(**{**both, part: {}}))
    assert {getattr(one, part) for one in known.values()} == {0.0}
    other = next(name for name in both if name != part)
    assert {name: getattr(one, other) for name, one in known.items()} == both[other]


def test_a_force_that_is_lost_in_rounding_is_not_tried() -> None:
    does = Does(damping={"first": 0.5, "second": 0.2}, friction={"first": 0.3, "second": 0.4})
    assert behaviours(does.step, told(BRAKED), BRAKED, STATE, 0.1) == {}


def test_soft_friction_of_a_light_joint_is_not_called_ignored() -> None:
    # The friction that halves the speed in a step, 500 and 1000 N m, is small beside the friction that the file states.
    known = tried(file_model(friction=dict.fromkeys(NAMES, 1e5)), Does(damping=dict.fromkeys(NAMES, 500.0)))
    assert 0.0 not in {one.friction for one in known.values()}


def test_a_rule_that_yields_to_damping_is_not_called_another_rule() -> None:
    rules, yielding = {"second": RULE}, {"second": replace(RULE, multiplier=1.3 * RULE.multiplier)}
    known = tried(file_model(mimic=rules, damping={"first": 0.5}), Does(rules=yielding))
    assert all("mimic" not in one.tried for one in known.values())
    assert tried(file_model(mimic=rules), Does(rules=yielding))["second"].mimic == Mimic("first", 2.6, 0.1)


def test_joints_that_follow_are_moved_together_to_their_limits() -> None:
    model = file_model(
        mimic={"second": Mimic("first", -1.0)}, lower=dict.fromkeys(NAMES, -2.0), upper=dict.fromkeys(NAMES, 2.0)
    )
    known = tried(model, Does(rules={"second": Mimic("first", -1.0)}, limits=dict.fromkeys(NAMES, (-2.0, 2.0))))
    assert {name: (one.lower, one.upper) for name, one in known.items()} == dict.fromkeys(NAMES, (-2.0, 2.0))
