"""Scenes of bodies that touch whose initial states are nudged by the expected rounding error of a run.

A nudge must not part what touches, and must not let slip what rolls. All bodies are therefore moved alike along the plane, and
all their velocities are scaled alike.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bodycheck.figures.scales import largest
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.mechanism import AnyScene, BodyStart, JointedBody, Mechanism
from bodycheck.reference.scene import Plane, Vector, vector_of
from bodycheck.reference.trajectory import Array, Trajectory

Change = Callable[[Vector], Vector]


def nudged_contacts(scene: AnyScene, trajectory: Trajectory, amount: float, random: np.random.Generator) -> AnyScene:
    """Return a scene of bodies that touch whose bodies begin a little beside where they do, and a little faster or slower.

    Parameters
    ----------
    scene, trajectory
        The scene, and a run of it.
    amount
        The size of the nudges, relative to the largest values in the run.
    random
        What directions are drawn from.
    """
    assert scene.plane is not None
    along = _direction(scene.plane, random) * amount * largest(trajectory.position)
    faster = 1.0 + amount * random.choice([-1.0, 1.0])

    def beside(position: Vector) -> Vector:
        return vector_of(np.array(position) + along)

    def scaled(velocity: Vector) -> Vector:
        return vector_of(faster * np.array(velocity))

    if isinstance(scene, Mechanism):
        return replace(scene, bodies=tuple(_body(body, beside, scaled) for body in scene.bodies))
    start = scene.initial
    moved = replace(
        start,
        position=beside(start.position),
        velocity=scaled(start.velocity),
        angular_velocity=scaled(start.angular_velocity),
    )
    return replace(scene, initial=moved)


def _direction(plane: Plane, random: np.random.Generator) -> Array:
    """Return a random unit vector along the plane."""
    angle, downhill = random.uniform(0.0, 2 * np.pi), np.array([np.cos(plane.incline), 0.0, -np.sin(plane.incline)])
    direction: Array = np.cos(angle) * downhill + np.sin(angle) * np.array([0.0, 1.0, 0.0])
    return direction


def _body(body: JointedBody, beside: Change, scaled: Change) -> JointedBody:
    start = BodyStart() if body.start is None else body.start
    rates = vector_of(exact.rates(start.attitude, start.rotation))
    moved = replace(start, position=beside(start.position), velocity=scaled(start.velocity), rotation=scaled(rates))
    return replace(body, start=moved)
