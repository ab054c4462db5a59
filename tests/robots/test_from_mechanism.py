"""Mechanisms of case files as robot models. Their accelerations are compared in `tests/reference/robots/test_dynamics.py`."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.errors import BadInput
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms import mechanism as mechanisms
from bodycheck.reference.robots.dynamics import terms
from bodycheck.reference.robots.model import Mimic
from bodycheck.reference.robots.state import RobotState
from bodycheck.robots.from_mechanism import robot_model
from tests.support.jointed import ball_chain, four_bar, free_chain, tree


def test_a_mechanism_is_links_on_joints_from_the_world() -> None:
    model = robot_model(tree(), "tree")
    assert (model.name, model.gravity) == ("tree", (0.0, 0.0, -3.7))
    assert [link.name for link in model.links] == [
        *("world", "tip", "root", "rod", "ball", "cross", "puck", "drone", "weld", "cross:1"),
    ]
    told = [(joint.name, joint.type, model.links[joint.parent].name, model.links[joint.child].name) for joint in model.joints]
    assert told == [
        ("slide", "prismatic", "rod", "tip"),
        ("hinge", "revolute", "root", "rod"),
        ("ball", "spherical", "rod", "ball"),
        ("cross:1", "revolute", "ball", "cross:1"),
        ("cross:2", "revolute", "cross:1", "cross"),
        ("puck", "planar", "world", "puck"),
        ("flight", "floating", "puck", "drone"),
        ("weld", "fixed", "drone", "weld"),
        ("root", "floating", "world", "root"),
    ]
    assert (model.joints[0].armature, model.joints[0].stiffness, model.joints[0].rest) == (0.2, 3.0, 0.1)
    np.testing.assert_allclose(model.joints[1].axis.astype(float), (0.0, 0.6, 0.8), rtol=1e-15)  # roundings of doubles


def test_bodies_are_where_the_mechanism_has_them() -> None:
    mechanism = ball_chain()
    model = robot_model(mechanism, "chain")
    position = {joint.name: joint.start for joint in mechanism.joints if joint.start}
    velocity = {joint.name: joint.start_velocity for joint in mechanism.joints if joint.start}
    found = terms(model, RobotState(position, velocity, velocity, velocity), model.gravity)
    rates = np.concatenate([velocity[joint.name] for joint in model.joints if joint.name in velocity])
    begin = kinematics.initial(mechanism)
    for place, body in enumerate(mechanism.bodies):
        pose, twist = found.poses[body.name], found.jacobians[body.name] @ rates
        assert abs(pose[3:] @ begin.quaternion[place, 0]) == pytest.approx(1, abs=1e-14)  # roundings of doubles
        w, x, y, z = pose[3:].astype(float)
        turn = np.array(
            [
                [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
            ]
        )
        centre = turn @ np.array(body.center_of_mass)
        np.testing.assert_allclose((pose[:3] + centre).astype(float), begin.position[place, 0], atol=1e-14)
        np.testing.assert_allclose((turn.T @ twist[3:]).astype(float), begin.angular_velocity[place, 0], atol=1e-13)
        moving = twist[:3] + np.cross(twist[3:], centre)
        np.testing.assert_allclose(moving.astype(float), begin.velocity[place, 0], atol=1e-13)


def test_names_are_unlike_those_of_the_mechanism() -> None:
    mechanism = free_chain()
    first, *others = mechanism.bodies
    model = robot_model(replace(mechanism, bodies=(replace(first, name="world"), *others)), "chain")
    assert model.links[0].name == "world_"


def test_closed_chains_are_refused() -> None:
    with pytest.raises(BadInput, match="bar has closed loops"):
        robot_model(four_bar(), "bar")


def test_a_joint_that_follows_another_one_does_so_in_the_model() -> None:
    mechanism = tree()
    slide, hinge, *others = mechanism.joints
    rule = mechanisms.Mimic(1, -2.5, 0.1)
    model = robot_model(replace(mechanism, joints=(replace(slide, mimic=rule), hinge, *others)), "tree")
    assert [joint.mimic for joint in model.joints if joint.mimic is not None] == [Mimic("hinge", -2.5, 0.1)]
    assert model.joints[0].name == "slide"
