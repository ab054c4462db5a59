"""Robot models as MJCF: bodies in one another, and joints with what acts on them."""

from dataclasses import replace
from random import Random
from xml.etree import ElementTree

import numpy as np

from bodycheck.reference.robots.model import Mimic, with_joint, with_link
from bodycheck.robots.from_mechanism import robot_model
from bodycheck.robots.mjcf_text import mjcf
from tests.support.jointed import cart_pole
from tests.support.robot_trees import random_tree


def test_bodies_are_in_one_another_as_links_hang_on_one_another() -> None:
    model = random_tree(Random(3), 12)
    root = ElementTree.fromstring(mjcf(model))
    held = {child.get("name"): parent.get("name") for parent in root.iter() for child in parent if child.tag == "body"}
    expected = {model.links[joint.child].name: model.links[joint.parent].name for joint in model.joints}
    assert held == {"base": None, **expected}
    kinds = {"revolute": ["hinge"], "prismatic": ["slide"], "fixed": []}
    for joint in model.joints:
        body = next(body for body in root.iter("body") if body.get("name") == model.links[joint.child].name)
        assert [own.get("type") for own in body.findall("joint")] == kinds[joint.type]
        assert [float(word) for word in body.get("pos").split()] == joint.position.tolist()


def test_a_joint_has_all_that_acts_on_it() -> None:
    model = random_tree(Random(3), 2, types=("revolute",))
    acting = {"armature": 0.5, "damping": 0.25, "stiffness": 2.0, "rest": 0.75, "friction": 1.5}
    model = with_joint(model, "joint_0", **acting, lower=-1.0, upper=2.0, effort_limit=8.0)
    model = with_joint(model, "joint_1", mimic=Mimic("joint_0", 2.0, 0.5))
    root = ElementTree.fromstring(mjcf(model))
    own = dict(next(joint for joint in root.iter("joint") if joint.get("name") == "joint_0").attrib)
    assert own.pop("axis").count(" ") == 2
    assert own == {
        "name": "joint_0",
        "type": "hinge",
        "armature": "0.5",
        "damping": "0.25",
        "stiffness": "2.0",
        "springref": "0.75",
        "frictionloss": "1.5",
        "range": "-1.0 2.0",
        "actuatorfrcrange": "-8.0 8.0",
    }
    (equal,) = root.findall("equality/joint")
    assert equal.attrib == {"joint1": "joint_1", "joint2": "joint_0", "polycoef": "0.5 2.0 0.0 0.0 0.0"}


def test_joints_with_several_coordinates_have_parts() -> None:
    types = ("planar", "spherical", "floating")
    for kind, parts in zip(types, (["slide", "slide", "hinge"], ["ball"], ["slide", "slide", "slide", "ball"]), strict=True):
        model = random_tree(Random(3), 1, types=(kind,))
        joint = replace(model.joints[0], rotation=model.joints[0].rotation.copy(), position=np.ones(3, np.longdouble))
        found = ElementTree.fromstring(mjcf(replace(model, joints=(joint,)))).iter("joint")
        assert [own.get("type") for own in found] == parts


def test_a_body_that_floats_on_the_world_has_a_free_joint() -> None:
    model = random_tree(Random(3), 1, True)
    here = replace(model.joints[0], rotation=np.eye(3, dtype=np.longdouble), position=np.zeros(3, np.longdouble))
    root = ElementTree.fromstring(mjcf(replace(model, joints=(here,))))
    (body,) = root.findall("worldbody/body")
    assert body.get("name") == "link_0"
    assert body.find("joint").attrib == {"name": "joint_0", "type": "free"}


def test_gravity_is_that_of_the_model() -> None:
    model = replace(random_tree(Random(3), 1), gravity=(0.5, 0.25, -1.5))
    assert ElementTree.fromstring(mjcf(model)).find("option").get("gravity") == "0.5 0.25 -1.5"


def test_a_root_with_a_mass_is_beside_what_floats_on_it() -> None:
    model = with_link(random_tree(Random(3), 1, True), "base", mass=1.0, inertia=np.eye(3, dtype=np.longdouble))
    here = replace(model.joints[0], rotation=np.eye(3, dtype=np.longdouble), position=np.zeros(3, np.longdouble))
    root = ElementTree.fromstring(mjcf(replace(model, joints=(here,))))
    assert [body.get("name") for body in root.findall("worldbody/body")] == ["base", "link_0"]


def test_a_root_that_is_the_world_has_no_body() -> None:
    model = robot_model(cart_pole(), "cart-pole")
    root = ElementTree.fromstring(mjcf(model))
    assert [body.get("name") for body in root.iter("body")] == ["cart", "pole"]
