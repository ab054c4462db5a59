"""Mechanisms whose initial states are nudged by the expected rounding error of a run."""

from dataclasses import replace

import numpy as np

from bodycheck.figures.scales import largest
from bodycheck.reference.kinematics import multiply
from bodycheck.reference.mechanisms import exact, kinematics
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.mechanism import BodyStart, Joint, JointedBody, Mechanism
from bodycheck.reference.scene import Vector, vector_of
from bodycheck.reference.trajectory import Array, Trajectory


def nudged_mechanism(mechanism: Mechanism, trajectory: Trajectory, amount: float, random: np.random.Generator) -> Mechanism:
    """Return a mechanism whose joints and free bodies begin a little beside where they do.

    Parameters
    ----------
    mechanism, trajectory
        The mechanism, and a run of it.
    amount
        The size of the nudges, relative to the largest values in the run, and in half a rad for attitudes.
    random
        What directions are drawn from.
    """
    motion = kinematics.joints(mechanism, trajectory)
    most, fastest = (np.abs(values).max(axis=0, initial=0.0) for values in (motion.position, motion.velocity))
    joints = (
        _joint(joint, amount * most[held], amount * fastest[moving], amount / 2, random)
        for joint, (held, moving) in zip(mechanism.joints, places(mechanism), strict=True)
    )
    bodies = (_body(body, trajectory.body(place), amount, random) for place, body in enumerate(mechanism.bodies))
    return replace(mechanism, joints=tuple(joints), bodies=tuple(bodies))


def _joint(joint: Joint, apart: Array, rates: Array, turn: float, random: np.random.Generator) -> Joint:
    """Return a joint with other initial values. apart, rates: the sizes of the nudges; turn: that of a quaternion (rad)."""
    start = np.array(joint.start) + random.choice([-1.0, 1.0], len(apart)) * apart
    if joint.type in ("spherical", "free"):
        start[-4:] = multiply(np.array(joint.start[-4:]), _turned(turn, random))
    velocity = np.array(joint.start_velocity) + random.choice([-1.0, 1.0], len(rates)) * rates
    return replace(joint, start=tuple(start.tolist()), start_velocity=tuple(velocity.tolist()))


def _body(body: JointedBody, states: Trajectory, amount: float, random: np.random.Generator) -> JointedBody:
    """Return a free body with another initial state; any other body as it is."""
    if body.start is None:
        return body
    start = body.start

    def beside(given: Vector, size: float) -> Vector:
        direction = random.normal(size=3)
        return vector_of(np.array(given) + amount * size * direction / np.linalg.norm(direction))

    rates = vector_of(exact.rates(start.attitude, start.rotation))
    w, x, y, z = multiply(np.array(exact.nearest_turn(start.attitude)), _turned(amount / 2, random)).tolist()
    moved = BodyStart(
        beside(start.position, largest(states.position)),
        (w, x, y, z),
        beside(start.velocity, largest(states.velocity)),
        beside(rates, largest(states.angular_velocity)),
    )
    return replace(body, start=moved)


def _turned(angle: float, random: np.random.Generator) -> Array:
    """Return the quaternion of a turn by a small angle (rad) about a random axis."""
    axis = random.normal(size=3)
    return np.concatenate([[1.0], angle / 2 * axis / np.linalg.norm(axis)])
