"""Robot models in Pinocchio: what its readers make of what files say."""

from pathlib import Path

import numpy as np
import pytest

from bodycheck.adapters.mujoco import robots as mujoco_robots
from bodycheck.adapters.pinocchio import robots
from bodycheck.adapters.robot_reading import ModelRefused
from bodycheck.reference.robots.state import RobotState
from tests.support.robot_mjcf import ARM, STATE
from tests.support.robot_texts import (
    GRAVITY,
    LIMIT,
    MASSLESS,
    MIMIC,
    RIDES,
    WELDED_BASE,
    hinges,
    joint,
    link,
    on,
    ridden,
    robot,
    written,
)
from tests.support.robot_truths import assert_the_same


def test_links_that_are_welded_keep_their_names_and_frames(tmp_path: Path) -> None:
    reading = robots.read_robot(written(WELDED_BASE, tmp_path), [hinges("hinge")], GRAVITY)
    assert [(body.name, body.parent) for body in reading.bodies] == [("base", None), ("arm", "base")]
    assert [body.mass for body in reading.bodies] == [3.0, 1.5]
    assert reading.links == ("base", "plate", "arm")
    assert set(reading.terms[0].poses) == {"base", "plate", "arm"}


def test_a_moving_link_without_mass_is_accepted(tmp_path: Path) -> None:
    reading = robots.read_robot(written(MASSLESS, tmp_path), [hinges("hinge")], GRAVITY)
    assert [body.mass for body in reading.bodies] == [1.5, 0.0]


def test_mimic_joints_move_by_themselves(tmp_path: Path) -> None:
    reading = robots.read_robot(written(MIMIC, tmp_path), [hinges("first", "second")], GRAVITY)
    assert [(joint.name, joint.type, joint.mimic) for joint in reading.joints] == [
        ("first", "revolute", None),
        ("second", "revolute", None),
    ]
    assert reading.velocities == 2
    assert any("mimic=True" in note for note in reading.notes)


def test_joints_of_one_link_are_in_the_order_of_their_names(tmp_path: Path) -> None:
    text = robot(
        link("base"),
        link("one"),
        link("two"),
        joint("zeta", "continuous", "base", "one", '<axis xyz="-1 0 0"/>'),
        joint("alpha", "prismatic", "base", "two", '<axis xyz="0 0.6 0.8"/>' + LIMIT),
    )
    reading = robots.read_robot(written(text, tmp_path), [], GRAVITY)
    assert [(joint.name, joint.first, joint.lower, joint.upper) for joint in reading.joints] == [
        ("alpha", 0, -3.0, 3.0),
        ("zeta", 1, None, None),
    ]
    np.testing.assert_allclose([joint.axis for joint in reading.joints], [[0, 0.6, 0.8], [-1, 0, 0]], rtol=0, atol=1e-15)


def test_the_plane_of_a_planar_joint_is_that_of_x_and_y(tmp_path: Path) -> None:
    """Whichever normal the file has."""
    reading = robots.read_robot(written(on("planar", "1 0 0"), tmp_path), [RIDES["planar"]], GRAVITY)
    assert_the_same(reading.terms[0], ridden("planar", "0 0 1"), RIDES["planar"], GRAVITY)
    assert any("plane of a planar joint" in note for note in reading.notes)


def test_a_refusal_has_the_reason_that_is_printed(tmp_path: Path) -> None:
    """The exception alone says only that the file is not valid."""
    with pytest.raises(ModelRefused, match="Two root links found"):
        robots.read_robot(written(robot(link("one"), link("two")), tmp_path), [], GRAVITY)


def test_mjcf_is_read(tmp_path: Path) -> None:
    """With armature; the inertia of a body is in the frame of the body."""
    reading = robots.read_robot(written(ARM, tmp_path, "mjcf"), [STATE], GRAVITY)
    assert [(joint.name, joint.type, joint.armature, joint.damping) for joint in reading.joints] == [
        ("shoulder", "revolute", 0.3, 0.4),
        ("elbow", "prismatic", 0.0, 0.0),
    ]
    model = mujoco_robots.compiled(str(tmp_path / "robot.xml"))
    assert_the_same(reading.terms[0], model, STATE, GRAVITY)


def test_a_free_body_of_mjcf_is_where_the_file_has_it(tmp_path: Path) -> None:
    """Unless the file turns it: Pinocchio 4.1 shifts such a body."""
    hinge, turn = (
        '<joint name="shoulder" type="hinge" axis="0 0.6 0.8" armature="0.3" damping="0.4"/>',
        'quat="0.5 0.1 -0.7 0.5"',
    )
    text = ARM.replace(hinge, '<freejoint name="ride"/>').replace(turn, "")
    riding, arm = RIDES["floating"], STATE
    parts = ("positions", "velocities", "accelerations", "efforts")
    state = RobotState(*({"ride": getattr(riding, part)["ride"], "elbow": getattr(arm, part)["elbow"]} for part in parts))
    reading = robots.read_robot(written(text, tmp_path, "mjcf"), [state], GRAVITY)
    assert_the_same(reading.terms[0], mujoco_robots.compiled(str(tmp_path / "robot.xml")), state, GRAVITY)


def test_several_joints_of_a_body_keep_their_names(tmp_path: Path) -> None:
    """Pinocchio makes one joint of them."""
    slide = '<joint name="elbow" type="slide" axis="1 0 0" range="-1 1.5"/>'
    text = ARM.replace(slide, slide + '<joint name="twist" type="hinge" axis="0 0.6 0.8"/>')
    state = hinges("shoulder", "elbow", "twist")
    reading = robots.read_robot(written(text, tmp_path, "mjcf"), [state], GRAVITY)
    assert [(joint.name, joint.type, joint.first, joint.count) for joint in reading.joints] == [
        ("shoulder", "revolute", 0, 1),
        ("elbow", "prismatic", 1, 1),
        ("twist", "revolute", 2, 1),
    ]
    assert_the_same(reading.terms[0], mujoco_robots.compiled(str(tmp_path / "robot.xml")), state, GRAVITY)
