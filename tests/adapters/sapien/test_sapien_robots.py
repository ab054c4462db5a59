"""Robot models in SAPIEN: what its loader makes of what files say."""

from pathlib import Path

import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.robot_reading import ModelRefused, RobotModels
from bodycheck.reference.robots.model import Mimic
from tests.support.robot_motions import in_engine
from tests.support.robot_texts import BRAKED, GRAVITY, LIMIT, MIMIC, TIP, hinges, joint, link, robot, written
from tests.support.tree_readings import assert_trees_agree

LOADED = registry.load("sapien")
assert isinstance(LOADED, RobotModels)
SAPIEN: RobotModels = LOADED


def test_random_trees_are_read_as_they_are_in_single_precision(tmp_path: Path) -> None:
    # Single precision, in numbers of which some are the differences of others that are ten times as large.
    assert_trees_agree(SAPIEN, tmp_path, 1e-5)


def test_friction_and_effort_limits_are_dropped_and_damping_is_kept(tmp_path: Path) -> None:
    text = robot(
        link("base"), link("arm"), joint("hinge", "revolute", "base", "arm", LIMIT + '<dynamics damping="0.5" friction="0.2"/>')
    )
    reading = SAPIEN.read_robot(written(text, tmp_path), [hinges("hinge")], GRAVITY)
    assert [(own.damping, own.friction, own.effort_limit) for own in reading.joints] == [(0.5, None, None)]
    # Pinocchio's model in SAPIEN has no damping, which PhysX has in each step.
    assert reading.terms[0].forward_dynamics is None


def test_a_massless_link_gets_a_mass_from_physx(tmp_path: Path) -> None:
    bodies = {body.name: body for body in SAPIEN.read_robot(written(TIP, tmp_path), [], GRAVITY).bodies}
    assert bodies["tip"].mass is not None
    assert bodies["tip"].mass > 0


def test_a_robot_that_cannot_move_has_its_links_where_the_file_puts_them(tmp_path: Path) -> None:
    text = robot(link("base"), link("arm"), joint("weld", "fixed", "base", "arm"))
    (terms,) = SAPIEN.read_robot(written(text, tmp_path), [hinges()], GRAVITY).terms
    assert terms.poses["arm"][:3] == pytest.approx([0.1, -0.2, 0.3], abs=1e-6)


def test_a_mimic_joint_on_the_same_link_is_a_tendon(tmp_path: Path) -> None:
    reading = SAPIEN.read_robot(written(MIMIC, tmp_path), [], GRAVITY)
    assert [own.mimic for own in reading.joints] == [None, Mimic("first", -2.0, 0.1)]


def test_siblings_follow_by_the_inverse_rule_though_the_record_is_right(tmp_path: Path) -> None:
    """The file says -2 times the leader plus 0.1; the leader follows the follower by this rule."""
    known = in_engine(LOADED, written(MIMIC, tmp_path))["second"]
    assert known.mimic is not None
    assert (known.mimic.multiplier, known.mimic.offset) == (-0.5, 0.05)


def test_a_chain_follows_by_the_rule_of_the_file(tmp_path: Path) -> None:
    rule = '<mimic joint="first" multiplier="-2" offset="0.1"/>'
    text = robot(
        *map(link, ("base", "left", "right")),
        joint("hold", "revolute", "base", "left", LIMIT),
        link("tip"),
        joint("first", "revolute", "left", "right", '<axis xyz="0 0 1"/>' + LIMIT),
        joint("second", "revolute", "right", "tip", f'<axis xyz="0 0 1"/>{LIMIT}{rule}'),
    )
    assert in_engine(LOADED, written(text, tmp_path))["second"].mimic == Mimic("first", -2.0, 0.1)


def test_limits_and_damping_act(tmp_path: Path) -> None:
    known = in_engine(LOADED, written(BRAKED, tmp_path))["hinge"]
    assert (known.lower, known.upper, known.damping) == (-3.0, 3.0, 0.5)


def test_an_inertia_that_is_not_positive_is_refused(tmp_path: Path) -> None:
    flat = link("arm", '<inertial><mass value="1"/><inertia ixx="0" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>')
    with pytest.raises(ModelRefused, match="invalid moment of inertia"):
        SAPIEN.read_robot(
            written(robot(link("base"), flat, joint("hinge", "revolute", "base", "arm", LIMIT)), tmp_path), [], GRAVITY
        )


def test_reading_leaves_the_gravity_of_the_process_alone(tmp_path: Path) -> None:
    text = robot(link("base"), link("arm"), joint("hinge", "revolute", "base", "arm", LIMIT))
    first = SAPIEN.read_robot(written(text, tmp_path), [], GRAVITY).gravity
    assert SAPIEN.read_robot(written(text, tmp_path), [], GRAVITY).gravity == first


def test_a_robot_of_one_velocity_has_all_terms_but_jacobians(tmp_path: Path) -> None:
    text = robot(link("base"), link("arm"), joint("hinge", "continuous", "base", "arm"))
    (found,) = SAPIEN.read_robot(written(text, tmp_path), [hinges("hinge")], GRAVITY).terms
    assert found.mass_matrix is not None
    assert found.mass_matrix.shape == (1, 1)
    assert found.inverse_dynamics is not None
    assert found.jacobians == {}
