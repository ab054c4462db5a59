"""Robot models in Rapier: what its loader makes of what files say."""

from pathlib import Path
from random import Random

import numpy as np
import pytest
import rapier3d
from rapier3d.loaders import urdf as loader

from bodycheck.adapters.rapier import robots
from bodycheck.adapters.robot_reading import ModelRefused
from bodycheck.reference.robots.dynamics import terms
from bodycheck.reference.robots.states import seeded_states
from bodycheck.robots.urdf_text import urdf
from tests.support.robot_texts import GRAVITY, LIMIT, joint, link, robot, written
from tests.support.robot_trees import random_tree

#: Some ten roundings in single precision.
ROUNDING = 1e-6


def test_random_trees_have_their_masses_and_poses(tmp_path: Path) -> None:
    for seed in range(3):
        model = random_tree(Random(seed), 12)
        states = seeded_states(model, 2, seed)
        reading = robots.read_robot(written(urdf(model), tmp_path), states, GRAVITY)
        masses = {link.name: float(link.mass) for link in model.links}
        assert {body.name: body.mass for body in reading.bodies} == pytest.approx(masses, rel=ROUNDING)
        for state, own in zip(states, reading.terms, strict=True):
            for name, pose in terms(model, state, GRAVITY).poses.items():
                expected = np.asarray(pose, dtype=float)
                np.testing.assert_allclose(own.poses[name][:3], expected[:3], rtol=0, atol=10 * ROUNDING)
                assert abs(own.poses[name][3:] @ expected[3:]) == pytest.approx(1, abs=ROUNDING)


def test_the_turn_of_an_inertia_is_ignored(tmp_path: Path) -> None:
    """A rod along x that is turned along y stays along x."""
    rod = '<inertial><origin rpy="0 0 1.5707963267948966"/><mass value="1"/>{}</inertial>'
    moments = '<inertia ixx="0.001" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/>'
    text = robot(link("base"), link("rod", rod.format(moments)), joint("hinge", "revolute", "base", "rod", LIMIT))
    read = robots.read_robot(written(text, tmp_path), [], GRAVITY).bodies[-1].inertia
    np.testing.assert_allclose(read, [0.001, 0.02, 0.02, 0, 0, 0], rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("moments", [(2.0, 1.0, 1.0), (3e-6, 2e-6, 1.5e-6)])
def test_rapier_turns_an_inertia_that_is_round_about_x_or_small(moments: tuple[float, float, float], tmp_path: Path) -> None:
    """A body shows by what an impulse of torque does to it that it has the wrong axes of which Rapier tells."""
    numbers = " ".join(f'{name}="{value!r}"' for name, value in zip(("ixx", "iyy", "izz"), moments, strict=True))
    inertial = f'<inertial><mass value="1"/><inertia {numbers} ixy="0" ixz="0" iyz="0"/></inertial>'
    file = written(robot(link("body", inertial)), tmp_path)
    (body,) = robots.read_robot(file, [], GRAVITY).bodies
    assert body.inertia is not None
    told = np.array(body.inertia[:3])
    np.testing.assert_allclose(sorted(told), sorted(moments), rtol=robots.ROUNDING)
    assert abs(told - moments).max() > 0.4 * max(moments)
    np.testing.assert_allclose(pushed(file.path), 1 / told, rtol=2 * robots.ROUNDING)


def pushed(path: str) -> list[float]:
    """The angular velocity (rad/s) about each axis by an impulse of torque of 1 N m s about it."""
    bodies, colliders, joints = rapier3d.RigidBodySet(), rapier3d.ColliderSet(), rapier3d.MultibodyJointSet()
    loaded, _ = loader.UrdfRobot.from_file(path, loader.UrdfLoaderOptions(make_roots_fixed=False))
    (handle,) = loaded.insert_using_multibody_joints(bodies, colliders, joints).links
    body = bodies[handle.body]
    body.recompute_mass_properties_from_colliders(colliders)
    found = []
    for axis in np.eye(3):
        body.angvel = rapier3d.Vec3(0.0, 0.0, 0.0)
        body.apply_torque_impulse(rapier3d.Vec3(*axis.tolist()), True)
        found.append(float(np.dot(body.angvel.to_tuple(), axis)))
    return found


def test_damping_of_the_file_is_dropped_and_that_of_rapier_is_told(tmp_path: Path) -> None:
    damped = joint("hinge", "revolute", "base", "arm", LIMIT + '<dynamics damping="5" friction="2"/>')
    file = written(robot(link("base"), link("arm"), damped), tmp_path)
    reading = robots.read_robot(file, [], GRAVITY)
    (own,) = reading.joints
    assert (own.damping, own.friction, own.effort_limit) == (None, None, None)
    assert robots.loaded(file).tree.damping()[own.first + robots.ROOT] == pytest.approx(0.1, rel=1e-6)
    assert any("damping of 0.1" in note for note in reading.notes)


def test_a_panic_is_a_refusal(tmp_path: Path) -> None:
    broken = robot(link("base"), joint("hinge", "revolute", "base", "nobody", LIMIT))
    with pytest.raises(ModelRefused, match="no entry found"):
        robots.read_robot(written(broken, tmp_path), [], GRAVITY)
