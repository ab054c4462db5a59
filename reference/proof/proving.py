"""Prove how far a printed motion is from the exact one, from balls that contain the exact states."""

import time
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np

from bodycheck.reference.mechanisms.coordinates import JointMotion
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.proof import bodies, free_body, one_joint
from bodycheck.reference.proof.balls import (
    Ball,
    Matrix,
    Triple,
    angle_between,
    ball,
    distance,
    lower,
    of_quaternion,
    precision,
    triple,
    upper,
)
from bodycheck.reference.proof.enclosure import COORDINATES, QUANTITIES, Enclosure, NotEnclosed
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array, Trajectory

#: The method of proofs by closed forms.
CLOSED_FORM = "closed form in ball arithmetic"

#: The precisions (bits) that are tried in turn, and the radius of balls that is small enough (rad, m and the like).
BITS, SMALL = (96, 128, 192, 256, 384, 512), 2.0**-60


def enclosed(scene: AnyScene, printed: Trajectory, joints: JointMotion | None = None) -> Enclosure:
    """Return the enclosure of the motion of a scene at the instants of a printed trajectory.

    printed: the printed states; of a mechanism with the bodies as the first axis. joints: the printed coordinates of joints and
    their velocities, of a mechanism.

    Raises `NotEnclosed` if there is no proof of this motion.
    """
    begin = time.perf_counter()
    of_body = printed.body(0) if isinstance(scene, Mechanism) else printed
    reason = NotEnclosed("balls that are too large")
    for bits in BITS:
        with precision(bits):
            try:
                radius, balls = _compared(_motion(scene), of_body, joints)
            except NotEnclosed as error:
                reason = error
                continue
        if radius <= SMALL:
            farthest, nearest = (
                {name: np.array([side(each) for each in balls[name]]) for name in balls} for side in (upper, lower)
            )
            return Enclosure(CLOSED_FORM, bits, radius, farthest, nearest, time.perf_counter() - begin)
    raise reason


#: A function from a time (s) to the coordinate of a joint with its velocity (None for a free body), and to position, attitude,
#: velocity and angular velocity of a body.
States = Callable[[Fraction], tuple[tuple[Ball, Ball] | None, Triple, Matrix, Triple, Triple]]


def _motion(scene: AnyScene) -> States:
    """The states of the body of a scene as a function of time."""
    if isinstance(scene, Mechanism):
        return one_joint.states(scene)
    for kind, there in (("a plane", scene.plane is not None), ("drag", scene.drag), ("pushes", scene.pushes)):
        if there:
            raise NotEnclosed(kind)
    return _flight(scene)


def _flight(scene: Scene) -> States:
    rotation = free_body.rotation(bodies.rotor(scene))
    begin, speed = ([Fraction(value) for value in values] for values in (scene.initial.position, scene.initial.velocity))
    gravity = (Fraction(0), Fraction(0), -Fraction(scene.gravity))

    def at(t: Fraction) -> tuple[None, Triple, Matrix, Triple, Triple]:
        attitude, rates = rotation(t)
        position = triple([x + v * t + g * t * t / 2 for x, v, g in zip(begin, speed, gravity, strict=True)])
        return None, position, attitude, triple([v + g * t for v, g in zip(speed, gravity, strict=True)]), rates

    return at


def _compared(states: States, printed: Trajectory, joints: JointMotion | None) -> tuple[float, dict[str, list[Ball]]]:
    """The largest radius of the balls of a motion, and the distances of the printed states from them at each instant."""
    radius, apart = 0.0, dict[str, list[Ball]]({name: [] for name in (*QUANTITIES, *(COORDINATES if joints else ()))})
    for row, instant in enumerate(printed.t.tolist()):
        coordinate, position, attitude, velocity, rates = states(Fraction(instant))
        entries = [*position, *velocity, *rates, *(entry for line in attitude for entry in line), *(coordinate or ())]
        if not all(entry.is_finite() for entry in entries):
            raise NotEnclosed("a ball without a bound")
        radius = max(radius, *(float(entry.rad()) for entry in entries))
        apart["error"].append(angle_between(attitude, of_quaternion(printed.quaternion[row].tolist())))
        apart["position_error"].append(distance(position, _balls(printed.position[row])))
        apart["velocity_error"].append(distance(velocity, _balls(printed.velocity[row])))
        apart["angular_velocity_error"].append(distance(rates, _balls(printed.angular_velocity[row])))
        if joints is not None and coordinate is not None:
            for name, value, given in zip(COORDINATES, coordinate, (joints.position, joints.velocity), strict=True):
                apart[name].append(abs(value - ball(float(given[row, 0]))))
    return radius, apart


def _balls(values: Array) -> list[Any]:
    return [ball(value) for value in values.tolist()]
