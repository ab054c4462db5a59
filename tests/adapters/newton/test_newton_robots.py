"""Robot models in Newton: what its importers make of what files say."""

from pathlib import Path
from random import Random

import numpy as np
import pytest

from bodycheck.adapters.newton import robots
from bodycheck.reference.robots.dynamics import terms
from bodycheck.reference.robots.model import Mimic
from bodycheck.reference.robots.states import seeded_states
from bodycheck.robots.mjcf_text import mjcf
from tests.support.robot_texts import GRAVITY, LIMIT, MIMIC, joint, link, on, robot, written
from tests.support.robot_trees import random_tree
from tests.support.tree_readings import assert_trees_agree

#: Some ten roundings in single precision.
ROUNDING = 1e-6


def test_random_trees_are_read_as_they_are_in_single_precision(tmp_path: Path) -> None:
    assert_trees_agree(robots, tmp_path, ROUNDING)
    assert_trees_agree(robots, tmp_path, ROUNDING, floating=True)


def test_a_random_tree_is_read_from_an_mjcf(tmp_path: Path) -> None:
    model = random_tree(Random(1), 8)
    (state,) = seeded_states(model, 1, 1)
    reading = robots.read_robot(written(mjcf(model), tmp_path, "mjcf"), [state], GRAVITY)
    true = terms(model, state, GRAVITY)
    names = [own.name for own in model.joints if own.type != "fixed"]
    order = [names.index(own.name) for own in reading.joints]
    expected = np.asarray(true.mass_matrix, dtype=float)[np.ix_(order, order)]
    size = np.sqrt(np.diag(expected))
    # A sum of products of some ten links in single precision.
    np.testing.assert_allclose(reading.terms[0].mass_matrix / np.outer(size, size), expected / np.outer(size, size), atol=1e-5)


def test_an_inertia_that_no_body_can_have_is_replaced_with_a_warning(tmp_path: Path) -> None:
    thin = link(
        "arm", '<inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial>'
    )
    text = robot(link("base"), thin, joint("hinge", "revolute", "base", "arm", LIMIT))
    reading = robots.read_robot(written(text, tmp_path), [], GRAVITY)
    arm = reading.bodies[-1].inertia
    assert arm is not None
    assert arm[0] + arm[1] >= arm[2] * (1 - ROUNDING)
    assert any("Inertia validation corrected 1 bodies" in note for note in reading.notes)


def test_a_mimic_joint_is_kept(tmp_path: Path) -> None:
    reading = robots.read_robot(written(MIMIC, tmp_path), [], GRAVITY)
    assert {own.name: own.mimic for own in reading.joints} == {
        "first": None,
        "second": Mimic("first", -2.0, float(np.float32(0.1))),
    }


def test_a_planar_joint_does_not_turn(tmp_path: Path) -> None:
    reading = robots.read_robot(written(on("planar", "0 0 1"), tmp_path), [], GRAVITY)
    assert [(own.type, own.count) for own in reading.joints if own.name == "ride"] == [("d6", 2)]


def test_a_link_without_inertia_has_that_of_its_shapes(tmp_path: Path) -> None:
    """A box of a litre of water."""
    box = '<link name="tip"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>'
    parts = (joint("hinge", "revolute", "base", "arm", LIMIT), joint("weld", "fixed", "arm", "tip"))
    reading = robots.read_robot(written(robot(link("base"), link("arm"), box, *parts), tmp_path), [], GRAVITY)
    (mass,) = [body.mass for body in reading.bodies if body.name == "tip"]
    assert mass == pytest.approx(1.0, rel=ROUNDING)
