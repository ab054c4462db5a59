"""Mechanisms for tests: a cart with a pole, a ball with a hinge, a free chain, a loop, and a tree with all types of joint."""

import math
from dataclasses import replace
from typing import Literal

import numpy as np

from bodycheck.reference.mechanisms.coordinates import JointMotion
from bodycheck.reference.mechanisms.mechanism import WORLD, BodyStart, Joint, JointedBody, Loop, Mechanism
from bodycheck.reference.scene import Brick, EulerAngles, Solid, Tensor, Vector
from bodycheck.reference.trajectory import Array, Trajectory

DIAGONAL = tuple[float, float, float]


def body(name: str, mass: float, moments: DIAGONAL, centre: Vector = (0.0, 0.0, 0.0)) -> JointedBody:
    """A body with moments about its centre of mass along its axes."""
    a, b, c = moments
    return JointedBody(name, Tensor(mass, ((a, 0.0, 0.0), (0.0, b, 0.0), (0.0, 0.0, c))), centre)


def on_one_joint(type: Literal["revolute", "prismatic"], start: float, velocity: float, **acting: float) -> Mechanism:
    """A body of 1 kg and 1 kg m^2 on a joint along x through its centre of mass, without gravity, on which only joints act."""
    joint = Joint("joint", type, WORLD, 0, axis=(1.0, 0.0, 0.0), start=(start,), start_velocity=(velocity,), **acting)
    return Mechanism((body("body", 1.0, (1.0, 1.0, 1.0)),), (joint,))


def coordinate(mechanism: Mechanism, states: Array) -> tuple[Array, Array]:
    """The coordinates (n,) and velocities (n,) of the joint of `on_one_joint`, within a turn, from states (1, n, 1, 13)."""
    rows = states[0, :, 0]
    if mechanism.joints[0].type == "prismatic":
        return rows[:, 0], rows[:, 7]
    return 2 * np.arctan2(rows[:, 4], rows[:, 3]), rows[:, 10]


def cart_pole() -> Mechanism:
    """The cart and pole of the guide to mechanisms."""
    return Mechanism(
        bodies=(
            body("cart", 2.3, (0.1, 0.1, 0.1)),
            body("pole", 0.4, (0.016, 0.017, 0.001), (0.0, 0.0, 0.35)),
        ),
        joints=(
            Joint("rail", "prismatic", WORLD, 0, axis=(1.0, 0.0, 0.0), start=(0.0,), start_velocity=(0.5,)),
            Joint("pin", "revolute", 0, 1, (0.0, 0.0, 0.1), axis=(0.0, 1.0, 0.0), start=(0.3,), start_velocity=(0.0,)),
        ),
        gravity=9.81,
    )


def free_chain() -> Mechanism:
    """Three bodies in space on two hinges, without gravity; the first in the file hangs on the second, which is free."""
    start = BodyStart((0.5, -0.2, 1.0), (0.8, 0.2, -0.4, 0.4), (0.1, 0.2, -0.3), (0.5, -1.0, 2.0))
    moments = (0.05, 0.06, 0.03)
    return Mechanism(
        bodies=(
            body("arm", 0.8, moments, (0.0, 0.1, 0.2)),
            replace(body("base", 1.3, moments, (0.05, -0.1, 0.35)), start=start),
            body("hand", 0.5, moments, (0.1, 0.0, 0.1)),
        ),
        joints=(
            Joint(
                *("shoulder", "revolute", 1, 0, (0.1, 0.2, 0.3), (0.8, 0.2, -0.4, 0.4), (0.0, 1.0, 0.3)),
                start=(0.5,),
                start_velocity=(2.0,),
            ),
            Joint(
                *("wrist", "revolute", 0, 2, (0.0, 0.1, 0.4), (0.9, 0.1, 0.3, -0.2), (1.0, 0.0, 0.2)),
                start=(-0.7,),
                start_velocity=(-1.5,),
            ),
        ),
    )


def ball_chain() -> Mechanism:
    """A chain of four bodies from the world on a hinge, two ball joints and a fixed one; the last ones first in the file."""
    moments = (0.05, 0.06, 0.03)
    return Mechanism(
        bodies=(
            body("tip", 0.2, moments, (0.1, 0.0, 0.1)),
            body("hand", 0.5, moments, (0.1, 0.0, 0.1)),
            body("arm", 0.8, moments, (0.0, 0.1, 0.2)),
            body("base", 1.3, moments, (0.05, -0.1, 0.35)),
        ),
        joints=(
            Joint("weld", "fixed", 1, 0, (0.0, 0.0, 0.4), (0.3, 0.4, 0.5, -0.6)),
            Joint(
                *("wrist", "spherical", 2, 1, (0.0, 0.1, 0.4), (0.9, 0.1, 0.3, -0.2)),
                damping=0.02,
                start=(2.0, -1.0, 0.5, 1.0),
                start_velocity=(1.0, -2.0, 0.5),
            ),
            Joint(
                *("shoulder", "spherical", 3, 2, (0.1, 0.2, 0.3), (0.8, 0.2, -0.4, 0.4)),
                start=(0.9, 0.1, 0.3, -0.2),
                start_velocity=(1.1, -0.7, 2.0),
            ),
            Joint("hip", "revolute", WORLD, 3, axis=(0.0, 3.0, 4.0), start=(0.5,), start_velocity=(-1.5,)),
        ),
        gravity=9.81,
    )


def four_bar() -> Mechanism:
    """Three rods, hinged about y, that close a quadrangle of four different sides with the world."""
    rod = body("first", 1.0, (0.001, 1 / 12, 1 / 12), (0.5, 0.0, 0.0))
    about_y, end, angle, rate = (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), -1.2, 1.0
    # x and z of the third rod from the end of the second, which lies along x, to the world; a turn about y takes x to -z.
    x, z = 1.7 - math.cos(angle) - 1, math.sin(angle)
    turning = -rate * -math.sin(angle) / z
    second = -rate * math.cos(angle) - turning * x
    last = (math.hypot(x, z), 0.0, 0.0)
    return Mechanism(
        bodies=(rod, replace(rod, name="second"), replace(rod, name="third")),
        joints=(
            Joint("left", "revolute", WORLD, 0, axis=about_y, start=(angle,), start_velocity=(rate,)),
            Joint("top", "revolute", 0, 1, end, axis=about_y, start=(-angle,), start_velocity=(second - rate,)),
            Joint("right", "revolute", 1, 2, end, axis=about_y, start=(math.atan2(-z, x),), start_velocity=(turning - second,)),
        ),
        loops=(Loop((2, WORLD), (last, (1.7, 0.0, 0.0))),),
        gravity=9.81,
    )


def bare_tree() -> Mechanism:
    """The tree without armature, springs and efforts."""
    bare = (replace(joint, armature=0.0, stiffness=0.0, rest=0.0, effort=0.0) for joint in tree().joints)
    return replace(tree(), joints=tuple(bare))


def ball_and_hinge() -> Mechanism:
    """A body on a damped ball, and on it one on a sprung and damped hinge."""
    moments = (0.05, 0.06, 0.03)
    return Mechanism(
        bodies=(body("arm", 0.8, moments, (0.1, 0.0, -0.4)), body("hand", 0.5, moments, (0.0, 0.1, -0.2))),
        joints=(
            Joint(*("ball", "spherical", WORLD, 0), damping=0.1, start=(0.9, 0.3, -0.1, 0.2), start_velocity=(1.0, -2.0, 1.5)),
            Joint(
                *("hinge", "revolute", 0, 1, (0.2, 0.0, -0.8), (0.8, 0.2, -0.4, 0.4), (0.0, 1.0, 0.3)),
                armature=0.02,
                damping=0.1,
                stiffness=2.0,
                rest=0.3,
                start=(0.5,),
                start_velocity=(2.0,),
            ),
        ),
        gravity=9.81,
    )


def tree() -> Mechanism:
    """A tree with a joint of every type and a free body, whose joints are not in the order of the tree."""
    solid = Solid(Brick((0.1, 0.2, 0.3)), 0.7, (0.1, 0.0, -0.1), (0.9, 0.1, -0.3, 0.2))
    start = BodyStart((0.5, -0.2, 1.0), EulerAngles(0.3, 0.8, -0.4), (0.1, 0.2, -0.3), (0.5, -1.0, 2.0))
    moments = (0.02, 0.025, 0.03)
    return Mechanism(
        bodies=(
            body("tip", 0.3, moments, (0.0, 0.1, 0.2)),
            JointedBody("root", solid, start=start),
            body("rod", 0.4, moments, (0.0, 0.0, 0.35)),
            body("ball", 0.5, moments, (0.1, 0.2, 0.3)),
            body("cross", 0.6, moments, (-0.1, 0.0, 0.1)),
            body("puck", 0.7, moments, (0.0, 0.0, 0.1)),
            body("drone", 0.8, moments, (0.2, 0.0, 0.0)),
            body("weld", 0.9, moments, (0.0, -0.2, 0.0)),
        ),
        joints=(
            Joint(
                *("slide", "prismatic", 2, 0, (0.1, 0.2, 0.3), EulerAngles(0.1, 0.2, 0.3), (1.0, 2.0, -1.0)),
                armature=0.2,
                stiffness=3.0,
                rest=0.1,
                start=(0.3,),
                start_velocity=(-0.7,),
            ),
            Joint(
                *("hinge", "revolute", 1, 2, (0.0, 0.3, 0.1), (0.8, 0.1, 0.2, -0.5), (0.0, 3.0, 4.0)),
                armature=0.05,
                effort=0.4,
                start=(7.5,),
                start_velocity=(1.5,),
            ),
            Joint("ball", "spherical", 2, 3, (0.0, 0.0, 0.7), start=(2.0, -1.0, 0.5, 1.0), start_velocity=(1.0, -2.0, 0.5)),
            Joint(
                *("cross", "universal", 3, 4, (0.2, 0.0, 0.1), (0.5, 0.5, -0.5, 0.5)),
                start=(-0.4, 0.9),
                start_velocity=(2.0, -1.0),
            ),
            Joint(
                *("puck", "planar", WORLD, 5, (1.0, 2.0, 3.0), (0.7, 0.7, 0.1, 0.0)),
                start=(0.3, -0.2, 1.1),
                start_velocity=(0.4, 0.6, -3.0),
            ),
            Joint(
                *("flight", "free", 5, 6, (0.0, 0.5, 0.0), (0.6, -0.8, 0.0, 0.0)),
                start=(0.1, 0.2, 0.3, 1.0, 1.0, -0.5, 0.2),
                start_velocity=(0.3, -0.1, 0.2, 1.0, 2.0, 3.0),
            ),
            Joint("weld", "fixed", 6, 7, (0.0, 0.0, 0.4), (0.3, 0.4, 0.5, -0.6)),
        ),
        gravity=3.7,
    )


def trajectory(t: Array, states: Array) -> Trajectory:
    """The trajectory of bodies from their states (1, n, bodies, 13), as an engine returns them, at instants (n,)."""
    rows = states[0].swapaxes(0, 1)
    return Trajectory(t, rows[..., :3], rows[..., 3:7], rows[..., 7:10], rows[..., 10:])


def states(position: Array, quaternion: Array, velocity: Array, angular_velocity: Array, t: Array) -> Trajectory:
    """The trajectory of one free body as that of several."""
    return Trajectory(t, position[None], quaternion[None], velocity[None], angular_velocity[None])


def coordinates(*values: float) -> JointMotion:
    """One instant of a motion of joints that have as many coordinates as velocities: coordinates, then velocities."""
    both = np.array(values).reshape(2, 1, -1)
    return JointMotion(both[0], both[1])
