"""A body that lies flat on a plane: whether it does, its planar state, and where it stops."""

import math
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.scene import Brick, Cylinder, Scene, Shape, Vector
from bodycheck.reference.trajectory import Array

#: How far a body may be from lying flat (rad, and relative to its height and speeds): the rounding of a case file.
LYING = 1e-12


@dataclass(frozen=True)
class Stop:
    """Where a body comes to rest: time (s), position of the centre of mass (m), yaw psi (rad), counted on over full turns."""

    time: float
    position: Vector
    yaw: float


def planar_state(scene: Scene) -> Array:
    """x, y, psi, dx/dt, dy/dt, dpsi/dt (6,) of a body that lies flat; raises `NotFlat` where it does not."""
    initial, resting = scene.initial, height_of(scene.body.shape)
    (x, y, z), (vx, vy, vz), (p, q, r) = initial.position, initial.velocity, initial.angular_velocity
    qw, qx, qy, qz = initial.quaternion
    theta = 2 * math.atan2(math.hypot(qx, qy), math.hypot(qw, qz))
    faults = []
    if theta > LYING:
        faults.append(f"its axis K is {theta:.3g} rad from the vertical")
    if abs(z - resting) > LYING * resting:
        faults.append(f"its centre of mass is {z:.9g} m above the plane instead of {resting:.9g} m")
    if abs(vz) > LYING * math.hypot(vx, vy):
        faults.append(f"it moves vertically at {vz:.3g} m/s")
    if math.hypot(p, q) > LYING * abs(r):
        faults.append(f"it turns about other axes than K at {math.hypot(p, q):.3g} rad/s")
    if faults:
        raise NotFlat("the body does not lie flat: " + "; ".join(faults))
    return np.array([x, y, yaw(np.array(initial.quaternion)), vx, vy, r])


def yaw(quaternion: Array) -> Array:
    """Turn (..., rad) about the vertical of a body that lies flat, from its attitude (..., 4)."""
    return np.asarray(2 * np.arctan2(quaternion[..., 3], quaternion[..., 0]))


class NotFlat(Exception):
    """A body that does not lie flat on the plane, or cannot; the text says what is not so."""


def height_of(shape: Shape | None) -> float:
    """Height (m) of the centre of mass of a body that lies on the face across its axis K; raises `NotFlat` as above."""
    match shape:
        case Brick((_, _, height)) | Cylinder(_, height):
            return height
        case _:
            raise NotFlat(f"{named(shape)} has no face to lie on")


def named(shape: Shape | None) -> str:
    """A body of this shape, in words."""
    return "a body without a shape" if shape is None else f"a body of the shape {type(shape).__name__.lower()}"
