"""The extent of a body in a direction, from the support function of its shape, and its depth below a plane."""

import numpy as np

from bodycheck.reference.kinematics import conjugate, rotate
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Shape, Sphere, Vector
from bodycheck.reference.trajectory import Array, Trajectory


def reach(shape: Shape, quaternion: Array, normal: Vector) -> Array:
    """Return the extent (n,), m, of a body from its centre of mass against a direction.

    Parameters
    ----------
    shape
        The shape, about the centre of mass and along the axes of the body.
    quaternion
        (n, 4) unit quaternions w, x, y, z, body to world.
    normal
        The unit vector in the world, such as the normal of a plane: the body touches a plane that is so far below it.
    """
    down = rotate(conjugate(quaternion), np.tile(np.asarray(normal, dtype=float), (len(quaternion), 1)))
    match shape:
        case Brick(semi_axes):
            return np.asarray(np.abs(down) @ np.array(semi_axes))
        case Ellipsoid(semi_axes):
            return np.asarray(np.sqrt(np.square(down * np.array(semi_axes)).sum(axis=1)))
        case Cylinder(radius, half_length):
            return np.asarray(half_length * np.abs(down[:, 2]) + radius * np.hypot(down[:, 0], down[:, 1]))
        case Sphere(radius):
            return np.full(len(quaternion), radius)


def depth(shape: Shape, motion: Trajectory, normal: Vector) -> Array:
    """Depth (n,), m, of the lowest point of a body below a plane through the origin, along its unit normal; zero above it."""
    height = motion.position @ np.array(normal)
    return np.asarray(np.maximum(reach(shape, motion.quaternion, normal) - height, 0.0))
