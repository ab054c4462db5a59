"""Robot models as URDF: the numbers, the angles of frames, and what a URDF cannot say."""

import math
from random import Random
from xml.etree import ElementTree

import numpy as np
import pytest

from bodycheck.errors import BadInput
from bodycheck.reference.robots.model import Mimic, Wide, with_joint
from bodycheck.robots.urdf_text import roll_pitch_yaw, urdf
from tests.support.robot_texts import rotation
from tests.support.robot_trees import random_rotation, random_tree, urdf_with_turned_inertias

#: Some roundings of products of three numbers in the 80-bit type, and of the doubles that are read.
ROUNDINGS, READ = 1e2 * float(np.finfo(np.longdouble).eps), 1e-15


def read(text: str) -> Wide:
    """The doubles nearest to the numbers of a text."""
    return np.array([float(word) for word in text.split()], np.longdouble)


def test_angles_make_the_rotation_that_they_are_of() -> None:
    random = Random(1)
    rotations = [random_rotation(random) for _ in range(50)]
    quarter = np.longdouble(math.pi) / 2  # not quite a quarter turn, and a quarter turn up to rounding
    rotations += [rotation(0.3, pitch, yaw) for pitch in (quarter, -quarter) for yaw in (0.0, 2.0, -3.0)]
    rotations += [np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]], np.longdouble), np.diag([1, -1, -1]).astype(np.longdouble)]
    for turn in rotations:
        assert np.abs(rotation(*roll_pitch_yaw(turn)) - turn).max() < ROUNDINGS


def test_numbers_have_all_their_digits() -> None:
    model = random_tree(Random(4), 6, True)
    root = ElementTree.fromstring(urdf(model))
    for joint, element in zip(model.joints, root.iter("joint"), strict=True):
        origin, axis = element.find("origin"), element.find("axis")
        assert element.find("parent").get("link") == model.links[joint.parent].name
        assert np.array_equal(read(origin.get("xyz")), joint.position)
        assert np.abs(rotation(*read(origin.get("rpy"))) - joint.rotation).max() < READ
        assert axis is None or np.abs(read(axis.get("xyz")) - joint.axis).max() < READ
    for link, element in zip(model.links, root.iter("link"), strict=True):
        inertia = element.find("inertial/inertia")
        assert (inertia is None) == (link.mass == 0)
        if inertia is not None:
            assert float(element.find("inertial/mass").get("value")) == link.mass
            assert float(inertia.get("ixy")) == link.inertia[0, 1]
            assert float(inertia.get("izz")) == link.inertia[2, 2]


def test_inertia_is_written_along_other_axes() -> None:
    model = random_tree(Random(4), 3)
    root = ElementTree.fromstring(urdf_with_turned_inertias(model, Random(1)))
    for link, element in zip(model.links, root.iter("link"), strict=True):
        if link.mass:
            turn = rotation(*read(element.find("inertial/origin").get("rpy")))
            names = [["ixx", "ixy", "ixz"], ["ixy", "iyy", "iyz"], ["ixz", "iyz", "izz"]]
            inertia = element.find("inertial/inertia")
            tensor = np.array([[np.longdouble(inertia.get(name)) for name in row] for row in names])
            assert np.abs(turn - np.eye(3)).max() > 0.1
            assert np.abs(turn @ tensor @ turn.T - link.inertia).max() < READ


def test_joints_say_what_acts_on_them_and_what_limits_them() -> None:
    model = random_tree(Random(4), 3, types=("revolute",))
    model = with_joint(
        model, "joint_0", damping=0.5, friction=0.25, lower=-1.0, upper=2.0, effort_limit=3.0, velocity_limit=4.0
    )
    model = with_joint(model, "joint_1", mimic=Mimic("joint_2", 2.0, 0.5), upper=1.0)
    model = with_joint(model, "joint_2", type="prismatic")
    found = {element.get("name"): element for element in ElementTree.fromstring(urdf(model)).iter("joint")}
    limits = {"lower": "-1.0", "upper": "2.0", "effort": "3.0", "velocity": "4.0"}
    assert found["joint_0"].find("limit").attrib == limits
    assert found["joint_0"].find("dynamics").attrib == {"damping": "0.5", "friction": "0.25"}
    assert found["joint_0"].find("mimic") is None
    assert found["joint_1"].find("mimic").attrib == {"joint": "joint_2", "multiplier": "2.0", "offset": "0.5"}
    assert found["joint_1"].find("limit").get("lower") == "-1000000000.0"
    assert found["joint_2"].find("limit").get("upper") == "1000000000.0"
    assert found["joint_2"].find("dynamics") is None


def test_a_joint_without_limits_is_continuous() -> None:
    model = random_tree(Random(4), 1, types=("revolute",))
    joint = ElementTree.fromstring(urdf(model)).find("joint")
    assert (joint.get("type"), joint.find("limit")) == ("continuous", None)
    limited = ElementTree.fromstring(urdf(with_joint(model, "joint_0", effort_limit=2.0))).find("joint")
    assert limited.find("limit").attrib == {"effort": "2.0", "velocity": "1000000000.0"}


@pytest.mark.parametrize(
    ("changes", "told"), [({"armature": 0.1}, "armature"), ({"stiffness": 1.0}, "a spring"), ({"type": "spherical"}, "a ball")]
)
def test_what_a_urdf_cannot_say_is_refused(changes: dict, told: str) -> None:
    model = with_joint(random_tree(Random(4), 2), "joint_1", **changes)
    with pytest.raises(BadInput, match=f"'joint_1' has or is {told}"):
        urdf(model)
