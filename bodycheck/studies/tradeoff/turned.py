"""Copies of a scene that are turned about the vertical, whose truths are that of the scene turned likewise.

Nothing in these scenes has a horizontal direction: gravity is vertical, and so is the normal of the plane; drag and Coulomb
friction oppose the motion. Inclined planes and pushes have one. The copies have other numbers, so that no result of one serves
for another one, but they are as difficult.
"""

from dataclasses import replace

import numpy as np

from bodycheck.adapters.contract import SceneUnsupported
from bodycheck.reference.kinematics import conjugate, geodesic_angle, multiply, rotate
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Quaternion, Scene, vector_of
from bodycheck.reference.trajectory import Array, Trajectory

#: Why there are no copies of bodies that touch otherwise than one that lies flat on a level plane.
NOT_TURNED = "the scenes of a batch are turned about the vertical, and bodies that touch are not turned"

#: The seed of the angles.
SEED = 20


def turns(count: int) -> Array:
    """Return quaternions (count, 4), w x y z, of turns about the vertical by any angles; the first is no turn."""
    halves = np.random.default_rng(SEED).uniform(0.0, np.pi, count)
    halves[0] = 0.0
    nothing = np.zeros(count)
    return np.column_stack([np.cos(halves), nothing, nothing, np.sin(halves)])


def turned(scene: Scene, count: int) -> list[Scene]:
    """Return a scene and copies of it that are turned about the vertical, `count` scenes in all. Raises `SceneUnsupported`."""
    if touches(scene):
        raise SceneUnsupported(NOT_TURNED)
    initial, by = scene.initial, turns(count)
    position, velocity = (rotate(by, np.array(part)).tolist() for part in (initial.position, initial.velocity))
    quaternion = multiply(by, np.array(initial.quaternion)).tolist()
    copies = [
        replace(scene, initial=replace(initial, position=vector_of(p), quaternion=_quaternion(q), velocity=vector_of(v)))
        for p, q, v in zip(position, quaternion, velocity, strict=True)
    ]
    return [scene, *copies[1:]]


def errors(states: Array, truth: Trajectory) -> tuple[Array, Array]:
    """Return the position errors (m) and the attitude errors (rad) of turned scenes, both (scenes, n).

    Parameters
    ----------
    states
        The states (scenes, n, 13) of the scenes that `turned` returns.
    truth
        The truth of the scene itself at the n instants.
    """
    back = conjugate(turns(len(states)))[:, None]
    apart = rotate(back, states[..., :3]) - truth.position
    return np.linalg.norm(apart, axis=-1), geodesic_angle(multiply(back, states[..., 3:7]), truth.quaternion)


def _quaternion(components: list[float]) -> Quaternion:
    w, x, y, z = components
    return w, x, y, z
