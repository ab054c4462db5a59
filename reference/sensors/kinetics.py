"""The motion of the bodies of a scene with its accelerations, in the wide type, and what sensors on bodies read of it."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.exact.rotations import matrix
from bodycheck.reference.kinematics import cross
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.loops import joint_space
from bodycheck.reference.mechanisms.loops.vectors import apply, matrices, rounded
from bodycheck.reference.sensors.equations import Equations, Solution
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class Kinetics:
    """The motion of b bodies at s instants, along the axes of the world.

    Attributes
    ----------
    axes
        (b, s, 3, 3) the axes of the bodies as columns.
    position, velocity, acceleration
        (b, s, 3) of the centres of mass (m, m/s, m/s^2).
    spin, turning
        (b, s, 3) angular velocities (rad/s) and angular accelerations (rad/s^2).
    """

    axes: WideArray
    position: WideArray
    velocity: WideArray
    acceleration: WideArray
    spin: WideArray
    turning: WideArray


def kinetics(written: Equations, solved: Solution, seen: Trajectory | None = None) -> Kinetics:
    """Return the motion of the bodies with the accelerations of a solution.

    seen: the states (b, s, ...) of the bodies, if they are not to follow from the coordinates of the solution.
    """
    linkage, motion = written.linkage, solved.motion
    accelerations, turnings = [], []
    for body, end in enumerate(linkage.ends):
        position, _, bias = joint_space.point_motion(motion, end, linkage.centre[body])
        rows = joint_space.point_rows(linkage, motion, body, position)
        turns = motion.turns * linkage.along[body][:, None]
        accelerations.append(bias + (rows * solved.accelerations[:, :, None]).sum(axis=1))
        turnings.append(motion.turn_bias[end] + (turns * solved.accelerations[:, :, None]).sum(axis=1))
    states: tuple[Any, ...] = joint_space.bodies(linkage, solved.states) if seen is None else ()
    return with_accelerations(seen or Trajectory(np.empty(0), *states), np.stack(accelerations), np.stack(turnings))


def with_accelerations(moving: Trajectory, acceleration: WideArray, turning: WideArray) -> Kinetics:
    """Return the motion of bodies with states (b, s, ...) and accelerations (b, s, 3), along the axes of the world."""
    parts = (moving.quaternion, moving.position, moving.velocity, moving.angular_velocity)
    quaternion, position, velocity, rate = (part.astype(Wide) for part in parts)
    axes = np.stack([matrices(each) for each in quaternion])
    return Kinetics(axes, position, velocity, acceleration, apply(axes, rate), turning)


def on_body(sensor: Sensor, arm: WideArray, gravity: float, moving: Kinetics) -> WideArray:
    """The readings (s, 3) of an accelerometer, a gyroscope or a velocimeter.

    arm: (3,) its place relative to the centre of mass, in the frame of the body (m). gravity: along -z (m/s^2).
    """
    axes, spin = moving.axes[sensor.body], moving.spin[sensor.body]
    offset = apply(axes, arm)
    match sensor.type:
        case "accelerometer":
            swung = cross(moving.turning[sensor.body], offset) + cross(spin, cross(spin, offset))
            vector = moving.acceleration[sensor.body] + swung + np.array([0, 0, gravity], dtype=Wide)
        case "velocimeter":
            vector = moving.velocity[sensor.body] + cross(spin, offset)
        case _:
            vector = spin
    mounted = rounded([list(row) for row in matrix(exact.turn(sensor.attitude))])
    return apply(np.swapaxes(axes @ mounted, 1, 2), vector)


def terms_on_body(sensor: Sensor, arm: WideArray, gravity: float, moving: Kinetics) -> WideArray:
    """The sizes (s, 1) of the terms that `on_body` adds up; the arguments are the same."""
    length = norm(arm[None])
    spin, turning, velocity, acceleration = (
        norm(each[sensor.body]) for each in (moving.spin, moving.turning, moving.velocity, moving.acceleration)
    )
    match sensor.type:
        case "accelerometer":
            return np.asarray(acceleration + (turning + spin**2) * length + gravity)
        case "velocimeter":
            return np.asarray(velocity + spin * length)
        case _:
            return np.asarray(spin)


def norm(vectors: WideArray) -> WideArray:
    """The lengths (s, 1) of vectors (s, 3)."""
    return np.asarray(np.sqrt((vectors * vectors).sum(axis=1, keepdims=True)))
