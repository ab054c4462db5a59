"""Mechanisms with several joints of one body, written as bodies without mass in between, and with joints that follow others."""

import math
from dataclasses import replace
from typing import Any

from bodycheck.reference.mechanisms import mimicry
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism, Mimic
from bodycheck.reference.scene import Tensor, Vector
from tests.support.jointed import body

MOMENTS = (0.02, 0.025, 0.03)


def massless(name: str) -> JointedBody:
    """A body without mass."""
    return JointedBody(name, Tensor(0.0, ((0.0, 0.0, 0.0),) * 3))


def hip() -> Mechanism:
    """A trunk on a slide and a hinge; on it a thigh on three hinges with turned frames and anchors apart from each other.

    A frame without mass is fixed between the joints of the thigh, and another one on the thigh itself.
    """
    turned, anchor = (0.9, 0.2, -0.3, 0.25), (0.02, -0.03, 0.05)
    hinge = {"damping": 0.05, "stiffness": 1.5, "rest": 0.1}
    return Mechanism(
        bodies=(
            massless("trunk:rail"),
            body("trunk", 1.3, (0.05, 0.06, 0.03), (0.05, -0.1, 0.35)),
            massless("thigh:out"),
            massless("bracket"),
            massless("thigh:turn"),
            body("thigh", 0.8, MOMENTS, (0.0, 0.02, -0.2)),
            massless("sensor"),
        ),
        joints=(
            Joint(*("rail", "prismatic", WORLD, 0, (0.1, 0.2, 0.3)), axis=(1.0, 0.0, 0.2), start=(0.2,), start_velocity=(0.7,)),
            Joint(*("pitch", "revolute", 0, 1), axis=(0.0, 1.0, 0.0), start=(-0.4,), start_velocity=(0.9,)),
            Joint(
                *("out", "revolute", 1, 2, (0.0, 0.1, -0.1), turned), axis=(1.0, 0.0, 0.0), start=(0.3,), start_velocity=(1.0,)
            ),
            Joint(*("plate", "fixed", 2, 3, anchor, turned)),
            Joint(*("turn", "revolute", 3, 4, anchor), axis=(0.0, 0.6, 0.8), start=(0.5,), start_velocity=(-2.0,), **hinge),
            Joint(*("bend", "revolute", 4, 5, anchor, turned), start=(0.8,), start_velocity=(1.5,), armature=0.01, effort=0.2),
            Joint(*("mount", "fixed", 5, 6, (0.0, 0.1, 0.0), turned)),
        ),
        gravity=9.81,
    )


def gripper(multiplier: float = -1.7, offset: float = 0.3, **acting: Any) -> Mechanism:
    """An arm with two fingers, of which the second, on a slide, follows the first with the joint between them.

    acting: what acts in the joint of the second finger, such as damping.
    """
    joints = (
        Joint(*("arm", "revolute", WORLD, 0, (0.1, 0.2, 0.3)), axis=(1.0, 0.0, 0.2), start=(0.4,), start_velocity=(2.0,)),
        Joint(*("first", "revolute", 0, 1, (0.1, 0.2, 0.3)), axis=(0.6, 0.8, 0.0), start=(0.3,), start_velocity=(1.0,)),
        Joint(*("link", "revolute", 0, 2, (0.0, 0.2, 0.1)), axis=(0.0, 1.0, 0.0), start=(0.3,), start_velocity=(0.5,)),
        Joint(
            *("second", "prismatic", 2, 3, (0.1, 0.0, 0.2)), axis=(0.0, 0.0, 1.0), mimic=Mimic(1, multiplier, offset), **acting
        ),
    )
    bodies = (
        body("arm", 0.6, MOMENTS, (0.1, 0.2, -0.4)),
        body("first", 0.5, MOMENTS, (0.1, 0.0, -0.3)),
        body("link", 0.4, MOMENTS, (0.0, 0.1, 0.2)),
        body("second", 0.3, MOMENTS, (0.0, 0.1, 0.2)),
    )
    return Mechanism(bodies, begun(joints), gravity=9.81)


def bare(mechanism: Mechanism) -> Mechanism:
    """A mechanism without armature, and without damping and springs on joints, for engines that do not have all of these."""
    return replace(
        mechanism, joints=tuple(replace(joint, armature=0.0, damping=0.0, stiffness=0.0) for joint in mechanism.joints)
    )


def begun(joints: tuple[Joint, ...]) -> tuple[Joint, ...]:
    """Joints, of which those that follow others begin as their rules say."""
    starts = [mimicry.start(joints, index) for index in range(len(joints))]
    return tuple(
        replace(joint, start=(float(position),), start_velocity=(float(velocity),)) if joint.mimic else joint
        for joint, (position, velocity) in zip(joints, starts, strict=True)
    )


def pair(multiplier: float, first: Vector = MOMENTS, second: Vector = MOMENTS) -> Mechanism:
    """Two wheels about z, without gravity, of which the second follows the first, with an effort and an armature each."""
    joints = (
        Joint(*("leader", "revolute", WORLD, 0), armature=0.01, effort=0.4, damping=0.1, start=(0.0,), start_velocity=(0.5,)),
        Joint(*("follower", "revolute", WORLD, 1), armature=0.02, effort=0.3, damping=0.2, mimic=Mimic(0, multiplier)),
    )
    return Mechanism((body("one", 1.0, first), body("two", 1.0, second)), begun(joints))


def spinning(multiplier: float, time: float) -> float:
    """The rate (rad/s) of the first wheel of `pair` after a time (s): I w' = effort - damping w, of both wheels together."""
    square = multiplier**2
    inertia = MOMENTS[2] + 0.01 + square * (MOMENTS[2] + 0.02)
    effort, damping = 0.4 + multiplier * 0.3, 0.1 + square * 0.2
    return effort / damping + (0.5 - effort / damping) * math.exp(-damping / inertia * time)
