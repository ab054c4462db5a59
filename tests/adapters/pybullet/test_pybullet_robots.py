"""Robot models in PyBullet: what its loader makes of what files say."""

from pathlib import Path

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.pybullet import robots
from bodycheck.adapters.robot_numbers import components
from bodycheck.reference.robots.dynamics import terms
from tests.support.robot_mjcf import ON_A_HINGE
from tests.support.robot_motions import in_engine
from tests.support.robot_texts import BRAKED, FULL_TURN, GRAVITY, LIMIT, RIDES, hinges, joint, link, on, ridden, robot, written
from tests.support.tree_readings import assert_trees_agree


def test_random_trees_are_read_as_they_are_but_for_the_rounding_of_principal_axes(tmp_path: Path) -> None:
    assert_trees_agree(robots, tmp_path, robots.ROUNDING)


def test_the_rounding_of_a_reading_bounds_that_of_principal_axes(tmp_path: Path) -> None:
    """Tensors with two moments that are nearly the same, whose axes are found worst."""
    generator = np.random.default_rng(0)
    for _ in range(5):
        axes, _ = np.linalg.qr(generator.normal(size=(3, 3)))
        tensor = axes * np.array([0.02, 0.02 * (1 + generator.uniform(1e-6, 1e-3)), 0.03]) @ axes.T
        named = zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), components(tensor), strict=True)
        words = " ".join(f'{name}="{value!r}"' for name, value in named)
        text = robot(
            link("base"),
            link("arm", f'<inertial><mass value="1"/><inertia {words}/></inertial>'),
            joint("hinge", "revolute", "base", "arm", LIMIT),
        )
        reading = robots.read_robot(written(text, tmp_path), [], GRAVITY)
        read = reading.bodies[-1].inertia
        assert read is not None
        assert np.abs(np.array(read) - components(tensor)).max() < reading.rounding * np.trace(tensor)


def test_damping_and_friction_are_kept_and_limits_of_a_continuous_joint_are_none(tmp_path: Path) -> None:
    text = robot(
        link("base"), link("arm"), joint("hinge", "continuous", "base", "arm", '<dynamics damping="0.3" friction="0.2"/>')
    )
    (own,) = robots.read_robot(written(text, tmp_path), [hinges("hinge")], GRAVITY).joints
    assert (own.damping, own.friction, own.armature, own.lower, own.upper) == (0.3, 0.2, 0.0, None, None)


def test_limits_and_damping_act_and_friction_is_told_and_does_not(tmp_path: Path) -> None:
    file = written(BRAKED, tmp_path)
    known = in_engine(registry.load("pybullet"), file)["hinge"]
    assert (known.lower, known.upper, known.damping, known.friction) == (-3.0, 3.0, 0.5, 0.0)
    (told,) = robots.read_robot(file, [hinges("hinge")], GRAVITY).joints
    assert told.friction == 0.2


def test_limits_of_a_continuous_joint_are_told_and_stop_nothing(tmp_path: Path) -> None:
    file = written(FULL_TURN, tmp_path)
    (told,) = robots.read_robot(file, [hinges("hinge")], GRAVITY).joints
    assert (told.lower, told.upper) == (-6.28, 6.28)
    known = in_engine(registry.load("pybullet"), file)["hinge"]
    assert (known.tried, known.lower, known.upper) == ({"limits"}, None, None)


def test_the_warning_of_an_impossible_inertia_is_a_note(tmp_path: Path) -> None:
    bad = '<inertial><mass value="1"/><inertia ixx="1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'
    text = robot(link("base"), link("arm", bad), joint("hinge", "revolute", "base", "arm", LIMIT))
    notes = robots.read_robot(written(text, tmp_path), [], GRAVITY).notes
    assert any("Bad inertia tensor properties, setting inertia to zero for link: arm" in note for note in notes), notes


def test_a_robot_with_a_ball_has_its_poses(tmp_path: Path) -> None:
    """PyBullet's coordinates of a ball are along the principal axes of its child."""
    (own,) = robots.read_robot(written(on("spherical", ""), tmp_path), [RIDES["spherical"]], GRAVITY).terms
    true = terms(ridden("spherical"), RIDES["spherical"], GRAVITY)
    assert own.mass_matrix is None
    for name, pose in own.poses.items():
        expected = np.asarray(true.poses[name], dtype=float)
        np.testing.assert_allclose(pose[:3], expected[:3], rtol=0, atol=1e-14)
        assert abs(pose[3:] @ expected[3:]) == pytest.approx(1, abs=1e-14)


def test_the_text_of_a_refusal_is_what_is_printed(tmp_path: Path) -> None:
    broken = robot(link("base"), joint("hinge", "revolute", "base", "nobody", LIMIT))
    with pytest.raises(robots.ModelRefused, match="Cannot find child link for joint hinge"):
        robots.read_robot(written(broken, tmp_path), [], GRAVITY)


def test_masses_of_an_mjcf_are_kept_and_moments_are_not(tmp_path: Path) -> None:
    reading = robots.read_robot(written(ON_A_HINGE, tmp_path, "mjcf"), [hinges("hinge")], GRAVITY)
    arm = next(body for body in reading.bodies if body.name == "arm")
    assert (arm.mass, arm.inertia) == (2.0, (0, 0, 0, 0, 0, 0))
    assert [(own.name, own.type) for own in reading.joints] == [("hinge", "revolute")]
