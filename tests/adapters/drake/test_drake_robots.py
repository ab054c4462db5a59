"""Robot models in Drake: what its parser makes of what files say."""

from pathlib import Path

import numpy as np

from bodycheck.adapters.drake import robots
from bodycheck.reference.robots.model import Mimic
from bodycheck.reference.robots.state import RobotState
from tests.support.robot_texts import GRAVITY, LIMIT, MIMIC, hinges, joint, link, robot, written
from tests.support.tree_readings import assert_trees_agree

ACTUATOR = (
    '<transmission name="drive" type="SimpleTransmission"><actuator name="motor"><drake:rotor_inertia value="0.002"/>'
    '<drake:gear_ratio value="10"/></actuator><joint name="hinge"/></transmission>'
)


def test_random_trees_are_read_as_they_are(tmp_path: Path) -> None:
    # Rounding in double precision.
    assert_trees_agree(robots, tmp_path, 1e-14)
    assert_trees_agree(robots, tmp_path, 1e-14, floating=True)


def test_armature_and_effort_limits_are_those_of_transmissions(tmp_path: Path) -> None:
    """A rotor of 0.002 kg m^2 behind a gear of 10 adds 0.2 kg m^2."""
    arm = (link("base"), link("arm"), joint("hinge", "revolute", "base", "arm", LIMIT))
    state = hinges("hinge")
    bare = robots.read_robot(written(robot(*arm), tmp_path), [state], GRAVITY)
    named = robot(*arm, ACTUATOR).replace("<robot ", '<robot xmlns:drake="http://drake.mit.edu" ')
    driven = robots.read_robot(written(named, tmp_path), [state], GRAVITY)
    assert [(own.armature, own.effort_limit) for own in (*bare.joints, *driven.joints)] == [(0.0, None), (0.2, 10.0)]
    matrices = [reading.terms[0].mass_matrix for reading in (bare, driven)]
    assert matrices[0] is not None
    assert matrices[1] is not None
    np.testing.assert_allclose(matrices[1] - matrices[0], [[0.2]], rtol=0, atol=1e-15)


def test_a_mimic_joint_is_a_coupler_with_which_a_continuous_plant_has_no_accelerations(tmp_path: Path) -> None:
    reading = robots.read_robot(written(MIMIC, tmp_path), [hinges("first", "second")], GRAVITY)
    assert [own.mimic for own in reading.joints] == [None, Mimic("first", -2.0, 0.1)]
    assert reading.terms[0].forward_dynamics is None
    assert any("couplers" in note for note in reading.notes)


def test_what_drake_warns_of_is_said_once(tmp_path: Path) -> None:
    dry = LIMIT + '<dynamics damping="0.5" friction="0.2"/>'
    text = robot(
        link("base"),
        link("arm"),
        link("hand"),
        joint("one", "revolute", "base", "arm", dry),
        joint("two", "revolute", "arm", "hand", dry),
    )
    reading = robots.read_robot(written(text, tmp_path), [RobotState({}, {}, {}, {})], GRAVITY)
    assert [(own.damping, own.friction) for own in reading.joints] == [(0.5, None), (0.5, None)]
    (note,) = reading.notes
    assert note.startswith("Drake warns: A joint has specified a non-zero value for the 'friction' attribute")
