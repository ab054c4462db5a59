"""What is written as a file is read as the same model."""

from dataclasses import replace
from random import Random

import numpy as np
import pytest

from bodycheck.reference.robots.model import Mimic, RobotModel, with_joint
from bodycheck.robots import urdf as reader
from bodycheck.robots.urdf_text import urdf
from bodycheck.robots.written import UNLIMITED
from tests.support.robot_trees import random_tree, urdf_with_turned_inertias

#: What is read are doubles: some roundings of numbers below 10.
READ = 1e-14

TYPES = ("revolute", "prismatic", "fixed", "floating", "planar")


def read(text: str) -> RobotModel:
    """The model of a URDF in which the specification refuses nothing."""
    found = reader.read(text.encode(), "tree.urdf")
    assert found.faults == ()
    assert found.model is not None
    return found.model


@pytest.mark.parametrize("seed", range(10))
def test_a_urdf_is_read_as_the_model_that_was_written(seed: int) -> None:
    random = Random(seed)
    model = random_tree(random, random.randint(1, 30), seed % 2 == 0, TYPES)
    other = read(urdf_with_turned_inertias(model, random))
    assert [link.name for link in other.links] == [link.name for link in model.links]
    for one, two in zip(model.links, other.links, strict=True):
        assert one.mass == two.mass
        assert np.abs(one.center_of_mass - two.center_of_mass).max() == 0
        assert np.abs(one.inertia - two.inertia).max() < READ
    for one, two in zip(model.joints, other.joints, strict=True):
        assert (one.name, one.type, one.parent, one.child) == (two.name, two.type, two.parent, two.child)
        assert np.abs(one.position - two.position).max() == 0
        assert np.abs(one.rotation - two.rotation).max() < READ
        assert np.abs(one.axis - two.axis).max() < READ
        unlimited = UNLIMITED if one.type == "prismatic" else None
        assert (two.upper, two.effort_limit, two.velocity_limit) == (unlimited,) * 3
        assert two.lower == (None if unlimited is None else -unlimited)


def test_what_acts_on_joints_is_read_as_it_was_written() -> None:
    model = random_tree(Random(1), 3, types=("revolute",))
    acting = {"damping": 0.1, "friction": 0.2, "lower": -1.1, "upper": 0.7, "effort_limit": 3.3, "velocity_limit": 4.4}
    model = with_joint(model, "joint_1", **acting, mimic=Mimic("joint_0", -0.3, 0.6))
    other = read(urdf(replace(model, name="<robot> & 'friends'")))
    assert other.name == "<robot> & 'friends'"
    joint = next(joint for joint in other.joints if joint.name == "joint_1")
    assert {key: getattr(joint, key) for key in acting} == acting
    assert joint.mimic == Mimic("joint_0", -0.3, 0.6)
