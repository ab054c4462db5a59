"""Prove how far a printed motion is from the exact one, from balls that contain the exact states."""

import time
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
from flint import arb

from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.proof import bodies, free_body
from bodycheck.reference.proof.balls import (
    Ball,
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
from bodycheck.reference.proof.enclosure import QUANTITIES, Enclosure, NotEnclosed
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array, Trajectory

#: The precisions (bits) that are tried in turn, and the radius of balls that is small enough (rad, m and the like).
BITS, SMALL = (96, 128, 192, 256, 384, 512), 2.0**-60


def enclosed(scene: AnyScene, printed: Trajectory) -> Enclosure:
    """Return the enclosure of the motion of a scene at the instants of a printed trajectory.

    Raises `NotEnclosed` if there is no proof of this motion.
    """
    begin = time.perf_counter()
    reason = NotEnclosed("balls that are too large")
    for bits in BITS:
        with precision(bits):
            try:
                way, states = _motion(scene)
                radius, balls = _compared(states, printed)
            except NotEnclosed as error:
                reason = error
                continue
        if radius <= SMALL:
            farthest, nearest = (
                {name: np.array([side(each) for each in balls[name]]) for name in QUANTITIES} for side in (upper, lower)
            )
            return Enclosure(way, bits, radius, farthest, nearest, time.perf_counter() - begin)
    raise reason


#: A function from a time (s) to position, attitude, velocity and angular velocity in balls.
States = Callable[[Fraction], tuple[Triple, Any, Triple, Triple]]


def _motion(scene: AnyScene) -> tuple[str, States]:
    """The method of the proof of a scene, and the states of its body as a function of time."""
    if isinstance(scene, Mechanism):
        raise NotEnclosed("several bodies, or bodies on joints")
    for kind, there in (("a plane", scene.plane is not None), ("drag", scene.drag), ("pushes", scene.pushes)):
        if there:
            raise NotEnclosed(kind)
    return "closed form in ball arithmetic", _flight(scene)


def _flight(scene: Scene) -> States:
    rotation = free_body.rotation(bodies.rotor(scene))
    begin, speed = ([Fraction(value) for value in values] for values in (scene.initial.position, scene.initial.velocity))
    gravity = (Fraction(0), Fraction(0), -Fraction(scene.gravity))

    def at(t: Fraction) -> tuple[Triple, Any, Triple, Triple]:
        attitude, rates = rotation(t)
        position = triple([x + v * t + g * t * t / 2 for x, v, g in zip(begin, speed, gravity, strict=True)])
        return position, attitude, triple([v + g * t for v, g in zip(speed, gravity, strict=True)]), rates

    return at


def _compared(states: States, printed: Trajectory) -> tuple[float, dict[str, list[Ball]]]:
    """The largest radius of the balls of a motion, and the distances of the printed states from them at each instant."""
    radius, apart = 0.0, dict[str, list[Ball]]({name: [] for name in QUANTITIES})
    for row, instant in enumerate(printed.t.tolist()):
        position, attitude, velocity, rates = states(Fraction(instant))
        entries = [*position, *velocity, *rates, *(entry for line in attitude for entry in line)]
        if not all(entry.is_finite() for entry in entries):
            raise NotEnclosed("a ball without a bound")
        radius = max(radius, *(float(entry.rad()) for entry in entries))
        apart["error"].append(angle_between(attitude, of_quaternion(printed.quaternion[row].tolist())))
        apart["position_error"].append(distance(position, _balls(printed.position[row])))
        apart["velocity_error"].append(distance(velocity, _balls(printed.velocity[row])))
        apart["angular_velocity_error"].append(distance(rates, _balls(printed.angular_velocity[row])))
    return radius, apart


def _balls(values: Array) -> list[arb]:
    return [ball(value) for value in values.tolist()]
