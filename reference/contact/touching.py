"""The bodies of a scene with a plane, with the properties that the observables of their motion need."""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.bodies import bodies
from bodycheck.reference.kinematics import conjugate, dot, rotate
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Mechanism
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Push, Shape, Sphere, Vector
from bodycheck.reference.trajectory import Array, Trajectory

#: The cosine of the angle between the axis of a cylinder and the plane's normal up to which the cylinder lies on its side. Its
#: lowest point is then the middle of its line of contact.
LYING = 1e-2


@dataclass(frozen=True, eq=False)
class Touching:
    """A body on a plane.

    Attributes
    ----------
    shape
        The shape of the body, about the centre of mass.
    mass, tensor
        Mass (kg) and inertia tensor (3, 3) about the centre of mass, along its axes (kg m^2).
    normal
        The normal of the plane, world frame.
    restitution
        Coefficient of restitution between the body and the plane.
    pivots_freely
        Whether nothing brakes the spin of a sphere about the normal, as there is no torsional friction.
    """

    shape: Shape
    mass: float
    tensor: Array
    normal: Vector
    restitution: float
    pivots_freely: bool = True


def touching(scene: AnyScene) -> tuple[Touching, ...]:
    """The bodies of a scene with a plane; empty if a body has no shape, or there is no plane."""
    plane = scene.plane
    if plane is None:
        return ()
    pairs = {pair.bodies: pair for pair in scene.contacts} if isinstance(scene, Mechanism) else {}
    touching_bodies = []
    for index, body in enumerate(bodies(scene)):
        if body.shape is None:
            return ()
        law = pairs.get((WORLD, index), plane)
        freely = not law.torsional_friction
        touching_bodies.append(Touching(body.shape, body.mass, body.tensor, plane.normal, law.restitution, freely))
    return tuple(touching_bodies)


def pushes_on(scene: AnyScene, index: int) -> tuple[Push, ...]:
    """The pushes on the body with an index."""
    return tuple(push for push in scene.pushes if push.body == index)


def into_plane(body: Touching, motion: Trajectory) -> Array:
    """The direction (n, 3) into the plane, along the axes of the body."""
    return rotate(conjugate(motion.quaternion), np.tile(-np.array(body.normal), (len(motion), 1)))


def lowest(body: Touching, motion: Trajectory) -> Array:
    """The point (n, 3), m, of a body that is nearest to the plane or farthest below it, from its centre, in its frame."""
    down = into_plane(body, motion)
    match body.shape:
        case Sphere(radius):
            return radius * down
        case Cylinder(radius, half_length):
            side = np.hypot(down[:, 0], down[:, 1])
            rim = radius * down[:, :2] / np.where(side > 0, side, 1.0)[:, None]
            end = np.where(np.abs(down[:, 2]) > LYING, half_length * np.sign(down[:, 2]), 0.0)
            return np.column_stack([rim, end])
        case Brick(semi_axes):
            return np.asarray(np.sign(down) * np.array(semi_axes))
        case Ellipsoid(semi_axes):
            scaled = down * np.array(semi_axes)
            return np.asarray(np.array(semi_axes) * scaled / np.sqrt(dot(scaled, scaled))[:, None])
