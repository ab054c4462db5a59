"""Robot models in Brax, which reads MJCF."""

from pathlib import Path

import pytest

from bodycheck.adapters.brax.engine import read_robot
from bodycheck.adapters.mujoco import robots as mujoco_robots
from bodycheck.adapters.robot_reading import FormatUnknown, ModelRefused
from tests.support.robot_mjcf import ARM, STATE
from tests.support.robot_texts import GRAVITY, WELDED_BASE, written
from tests.support.robot_truths import assert_the_same


def test_an_arm_has_the_terms_of_the_model_that_mujoco_compiles(tmp_path: Path) -> None:
    file = written(ARM.replace('type="slide"', 'type="hinge"'), tmp_path, "mjcf")
    reading = read_robot(file, [STATE], GRAVITY)
    assert [(joint.name, joint.armature, joint.damping) for joint in reading.joints] == [
        ("shoulder", 0.3, 0.4),
        ("elbow", 0.0, 0.0),
    ]
    assert [(body.name, body.parent, body.mass) for body in reading.bodies][1:] == [
        ("upper", "world", 1.0),
        ("lower", "upper", 0.4),
    ]
    assert reading.gravity == (0.0, 0.0, -3.0)
    assert_the_same(reading.terms[0], mujoco_robots.compiled(file.path), STATE, GRAVITY)


def test_a_slide_pushes_along_the_axis_of_its_frame_as_if_that_were_not_turned(tmp_path: Path) -> None:
    """Brax turns the axes of hinges to the world, and not those of slides: the weight along x is the mass times gravity's x."""
    (terms,) = read_robot(written(ARM, tmp_path, "mjcf"), [STATE], GRAVITY).terms
    assert terms.gravity_force is not None
    assert terms.gravity_force[1] == pytest.approx(-0.4 * GRAVITY[0], rel=1e-12)  # a product, rounded a few times


def test_a_urdf_is_unknown(tmp_path: Path) -> None:
    with pytest.raises(FormatUnknown):
        read_robot(written(WELDED_BASE, tmp_path), [], GRAVITY)


def test_ball_joints_are_refused(tmp_path: Path) -> None:
    text = ARM.replace('type="slide" axis="1 0 0" range="-1 1.5"', 'type="ball"')
    with pytest.raises(ModelRefused, match="not supported"):
        read_robot(written(text, tmp_path, "mjcf"), [], GRAVITY)
