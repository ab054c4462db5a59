"""The bodies of a scene with a plane, as what is measured of their motion needs them."""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Mechanism, shape_of
from bodycheck.reference.mechanisms.observables import masses, tensor
from bodycheck.reference.scene import Push, Scene, Shape, Vector
from bodycheck.reference.trajectory import Array, Trajectory


@dataclass(frozen=True, eq=False)
class Touching:
    """A body on a plane.

    Attributes
    ----------
    shape
        Its shape, about the centre of mass.
    mass, tensor
        Mass (kg) and inertia tensor (3, 3) about the centre of mass, along its axes (kg m^2).
    normal
        The normal of the plane, world frame.
    restitution
        Coefficient of restitution between it and the plane.
    """

    shape: Shape
    mass: float
    tensor: Array
    normal: Vector
    restitution: float


def touching(scene: AnyScene) -> tuple[Touching, ...]:
    """The bodies of a scene with a plane; empty where one of them has no shape, or there is no plane."""
    plane = scene.plane
    if plane is None:
        return ()
    if isinstance(scene, Scene):
        if scene.body.shape is None:
            return ()
        own = Touching(scene.body.shape, scene.body.mass, np.diag(scene.body.moments), plane.normal, plane.restitution)
        return (own,)
    given = {pair.bodies: pair.restitution for pair in scene.contacts}
    found = []
    for place, (body, mass) in enumerate(zip(scene.bodies, masses(scene), strict=True)):
        if (shape := shape_of(body)) is None:
            return ()
        restitution = given.get((WORLD, place), plane.restitution)
        found.append(Touching(shape, float(mass), tensor(body), plane.normal, restitution))
    return tuple(found)


def motions(scene: AnyScene, trajectory: Trajectory) -> tuple[Trajectory, ...]:
    """The states (n, ...) of each body of a scene."""
    if not isinstance(scene, Mechanism):
        return (trajectory,)
    return tuple(trajectory.body(place) for place in range(len(scene.bodies)))


def pushes_on(scene: AnyScene, place: int) -> tuple[Push, ...]:
    """The pushes on the body at a place."""
    return tuple(push for push in scene.pushes if push.body == place)
