"""Poses and velocities of bodies on joints, and the coordinates of joints from the poses."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.reference.kinematics import conjugate, geodesic_angle, multiply
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.coordinates import JointMotion
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Loop, Mechanism
from bodycheck.reference.trajectory import Array, Trajectory
from tests.support import jointed

#: Half of the step of central differences (s): their error of about step^2 and rounding over step are alike.
STEP = 1e-5


def test_the_cart_and_pole_begin_where_the_file_says() -> None:
    start = kinematics.initial(jointed.cart_pole())
    angle, arm = 0.3, 0.35
    assert start.position[:, 0] == pytest.approx(np.array([[0, 0, 0], [arm * np.sin(angle), 0, 0.1 + arm * np.cos(angle)]]))
    assert start.velocity[:, 0] == pytest.approx(np.array([[0.5, 0, 0], [0.5, 0, 0]]))
    assert geodesic_angle(start.quaternion[1, 0], np.array([np.cos(0.15), 0, np.sin(0.15), 0])) < 1e-15


def moved_on(motion: JointMotion, by: float) -> JointMotion:
    """The initial coordinates of `jointed.tree` a little later, if its velocities were constant."""
    q, v = motion.position.copy(), motion.velocity
    q[0, :2] += by * v[0, :2]  # slide and hinge
    q[0, 2:6] = turned(q[0, 2:6], v[0, 2:5], by)
    q[0, 6:11] += by * v[0, 5:10]  # universal and planar
    q[0, 11:14] += by * v[0, 10:13]
    q[0, 14:] = turned(q[0, 14:], v[0, 13:], by)
    return JointMotion(q, v)


def turned(turn: Array, rate: Array, by: float) -> Array:
    speed = np.linalg.norm(rate)
    return multiply(turn, np.array([np.cos(speed * by / 2), *(rate / speed * np.sin(speed * by / 2))]))


def at(by: float) -> Trajectory:
    """The states of `jointed.tree` a little later; its free body moves too."""
    mechanism = jointed.tree()
    root = kinematics.initial(mechanism).body(1)
    turn = turned(root.quaternion[0], root.angular_velocity[0], by)
    free = jointed.states(root.position + by * root.velocity, turn[None], root.velocity, root.angular_velocity, root.t)
    return kinematics.bodies(mechanism, moved_on(kinematics.start_of(mechanism), by), free)


def test_velocities_are_the_derivatives_of_the_poses_for_every_type_of_joint() -> None:
    now, before, after = at(0.0), at(-STEP), at(STEP)
    slope = (after.position - before.position) / (2 * STEP)
    assert slope == pytest.approx(now.velocity, abs=1e-8)  # STEP^2 and 1e-16 / STEP, times some 10 for the rates of the tree
    turn = multiply(conjugate(before.quaternion), after.quaternion)
    assert turn[..., 1:] / STEP == pytest.approx(now.angular_velocity, abs=1e-8)


def test_joint_coordinates_come_back_from_the_poses() -> None:
    mechanism = jointed.tree()
    start = kinematics.start_of(mechanism)
    found = kinematics.joints(mechanism, kinematics.initial(mechanism))
    # Rounding: states of some units through four joints.
    assert found.position == pytest.approx(start.position, abs=1e-14)
    assert found.velocity == pytest.approx(start.velocity, abs=1e-14)


def test_angles_go_on_over_full_turns() -> None:
    """A hinge turns by up to 5.9 rad from one instant to the next, first forwards and then backwards."""
    arm = Mechanism(
        (jointed.body("arm", 1.0, (1.0, 1.0, 1.0), (0.3, 0.0, 0.0)),),
        (Joint("hinge", "revolute", WORLD, 0, start=(4.0,), start_velocity=(30.0,)),),
    )
    t = np.linspace(0, 10, 51)
    exact = 4.0 + 30 * t - 3.2 * t**2
    motion = JointMotion(exact[:, None], (30 - 6.4 * t)[:, None])
    found = kinematics.joints(arm, kinematics.bodies(arm, motion, t=t))
    assert found.position == pytest.approx(motion.position, rel=1e-14, abs=1e-14)


def test_a_quaternion_keeps_its_sign_from_one_instant_to_the_next() -> None:
    ball = Mechanism(
        (jointed.body("ball", 1.0, (1.0, 1.0, 1.0)),),
        (Joint("ball", "spherical", WORLD, 0, start=(-1.0, 0.0, 0.0, 0.0), start_velocity=(0.0, 0.0, 2.0)),),
    )
    t = np.linspace(0, 6, 61)
    turn = -np.stack([np.cos(t), 0 * t, 0 * t, np.sin(t)], axis=-1)
    seen = kinematics.bodies(ball, JointMotion(turn, np.tile([0.0, 0.0, 2.0], (61, 1))), t=t)
    flipped = replace(seen, quaternion=seen.quaternion * np.where(np.arange(61) % 3, 1, -1)[:, None])
    assert kinematics.joints(ball, flipped).position == pytest.approx(turn, abs=1e-15)


def test_gaps_are_what_joints_and_loops_do_not_allow() -> None:
    mechanism = jointed.cart_pole()
    start = kinematics.initial(mechanism)
    assert kinematics.gaps(mechanism, start) == pytest.approx([0.0], abs=1e-16)

    def pushed(place: int, by: tuple[float, float, float]) -> float:
        position = start.position.copy()
        position[place] += by
        return float(kinematics.gaps(mechanism, replace(start, position=position))[0])

    assert pushed(1, (0.0, 0.0, 0.25)) == pytest.approx(0.25)
    assert pushed(0, (0.0, 0.3, 0.4)) == pytest.approx(0.5)
    both = replace(start, position=start.position + np.array([5.0, 0.0, 0.0]))
    assert kinematics.gaps(mechanism, both) == pytest.approx([0.0], abs=1e-15)
    loop = Loop((1, WORLD), ((0.0, 0.0, 0.0), (0.0, 0.0, 0.4)))
    assert kinematics.gaps(replace(mechanism, loops=(loop,)), start) == pytest.approx([0.3])


def test_instants_are_needed_where_no_body_is_free() -> None:
    mechanism = jointed.cart_pole()
    with pytest.raises(ValueError, match="instants"):
        kinematics.bodies(mechanism, kinematics.start_of(mechanism))
