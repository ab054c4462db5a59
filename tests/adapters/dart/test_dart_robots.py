"""Robot models in DART: what its loader makes of what files say."""

from pathlib import Path

import numpy as np
import pytest

from bodycheck.adapters.dart import robots
from bodycheck.adapters.robot_numbers import matrix
from bodycheck.reference.robots.model import Mimic
from bodycheck.reference.robots.state import RobotState
from tests.support.robot_mjcf import ON_A_HINGE
from tests.support.robot_texts import GRAVITY, LIMIT, MIMIC, RIDES, TIP, hinges, joint, link, on, ridden, robot, written
from tests.support.robot_truths import assert_the_same
from tests.support.tree_readings import assert_trees_agree


def test_random_trees_are_read_as_they_are(tmp_path: Path) -> None:
    # Rounding in double precision.
    assert_trees_agree(robots, tmp_path, 1e-14)
    assert_trees_agree(robots, tmp_path, 1e-14, floating=True)


def test_a_link_without_inertia_has_a_kilogram(tmp_path: Path) -> None:
    tip = robots.read_robot(written(TIP, tmp_path), [], GRAVITY).bodies[-1]
    assert (tip.name, tip.mass, tip.center_of_mass, tip.inertia) == ("tip", 1.0, (0, 0, 0), (1, 1, 1, 0, 0, 0))


@pytest.mark.parametrize("axis", ["1 0 0", "0 1 0", "0 0 -1", "0.6 0 0.8"])
def test_a_planar_joint_is_in_its_plane(tmp_path: Path, axis: str) -> None:
    """DART has axes of its own in the plane, for which the state is converted."""
    (terms,) = robots.read_robot(written(on("planar", axis), tmp_path), [RIDES["planar"]], GRAVITY).terms
    assert_the_same(terms, ridden("planar", axis), RIDES["planar"], GRAVITY)


def test_nothing_of_a_time_step_is_left_in_damping(tmp_path: Path) -> None:
    """M a = effort - damping v - c - g exactly, though DART takes damping at the end of a step."""
    damped = joint("hinge", "revolute", "base", "arm", LIMIT + '<dynamics damping="5"/>')
    state = hinges("hinge")
    (terms,) = robots.read_robot(written(robot(link("base"), link("arm"), damped), tmp_path), [state], GRAVITY).terms
    parts = (terms.mass_matrix, terms.forward_dynamics, terms.coriolis_force, terms.gravity_force, terms.passive_force)
    matrix, acceleration, coriolis, gravity, passive = (np.array(part) for part in parts)
    np.testing.assert_allclose(passive, -5 * state.velocities["hinge"][0], rtol=1e-14)
    # Rounding of forces of some N m.
    np.testing.assert_allclose(matrix @ acceleration + coriolis + gravity - passive, state.efforts["hinge"], rtol=0, atol=1e-13)


def test_dry_friction_is_no_force_that_dart_computes(tmp_path: Path) -> None:
    dry = joint("hinge", "revolute", "base", "arm", LIMIT + '<dynamics friction="0.2"/>')
    reading = robots.read_robot(written(robot(link("base"), link("arm"), dry), tmp_path), [hinges("hinge")], GRAVITY)
    assert [own.friction for own in reading.joints] == [0.2]
    assert reading.terms[0].passive_force is None
    assert reading.terms[0].forward_dynamics is None


def test_a_mimic_joint_takes_its_effort_in_the_forward_dynamics(tmp_path: Path) -> None:
    state = hinges("first", "second")
    reading = robots.read_robot(written(MIMIC, tmp_path), [state], GRAVITY)
    assert [own.mimic for own in reading.joints] == [None, Mimic("first", -2.0, 0.1)]
    (terms,) = reading.terms
    parts = (terms.mass_matrix, terms.forward_dynamics, terms.coriolis_force, terms.gravity_force)
    matrix, acceleration, coriolis, gravity = (np.array(part) for part in parts)
    efforts = [state.efforts[own.name][0] for own in reading.joints]
    # Rounding of forces of some N m.
    np.testing.assert_allclose(matrix @ acceleration + coriolis + gravity, efforts, rtol=0, atol=1e-13)


def test_an_inertia_of_an_mjcf_is_ignored(tmp_path: Path) -> None:
    reading = robots.read_robot(written(ON_A_HINGE, tmp_path, "mjcf"), [hinges("hinge")], GRAVITY)
    assert [(body.name, body.mass) for body in reading.bodies] == [("world", None), ("base", 1.0), ("arm", 1.0)]
    assert [(own.name, own.type, own.damping) for own in reading.joints] == [("hinge", "revolute", 0.5)]


def test_a_ball_joint_of_an_mjcf_is_where_the_state_has_it(tmp_path: Path) -> None:
    """With velocities along the axes of the child."""
    text = ON_A_HINGE.replace('type="hinge" axis="0 0 1"', 'type="ball"')
    turn, spin = RIDES["spherical"].positions["ride"], RIDES["spherical"].velocities["ride"]
    state = RobotState({"hinge": turn}, {"hinge": spin}, {}, {})
    reading = robots.read_robot(written(text, tmp_path, "mjcf"), [state], GRAVITY)
    assert [(own.type, own.count) for own in reading.joints] == [("spherical", 3)]
    (terms,) = reading.terms
    # Roundings of a rotation vector and back.
    assert abs(terms.poses["arm"][3:] @ turn) == pytest.approx(1, abs=1e-14)
    np.testing.assert_allclose(terms.jacobians["arm"][3:], matrix(turn), rtol=0, atol=1e-14)
