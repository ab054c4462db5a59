"""The planar state of a body that lies flat on the plane: three coordinates, x, y and yaw, along the axes of the plane.

A body lies flat if its axis K is along the normal, if the face across K touches the plane, and if it neither moves
along the normal nor rotates about another axis than K.
"""

import math
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.errors import NotFlat
from bodycheck.reference.kinematics import multiply, rotate
from bodycheck.reference.scene import Brick, Cylinder, Scene, Shape, State, Vector
from bodycheck.reference.trajectory import Array

#: How far a body may deviate from lying flat: an angle (rad), and a fraction of its height and of its speeds. It allows for
#: the rounding of the numbers in a case file.
FLATNESS_TOLERANCE = 1e-12


@dataclass(frozen=True)
class Stop:
    """The instant and the place where a body comes to rest.

    Attributes
    ----------
    time
        Time (s).
    position
        Position of the centre of mass, world frame (m).
    yaw
        Yaw psi about the vertical (rad), including full turns.
    """

    time: float
    position: Vector
    yaw: float


def planar_state(scene: Scene) -> Array:
    """Initial x, y (m), psi (rad), dx/dt, dy/dt (m/s), dpsi/dt (rad/s) along the axes of the plane, as an array (6,).

    Raises `NotFlat` for a body that does not lie flat, with a list of the deviations, and for a body that has no face to lie
    on.
    """
    initial, resting = along_plane(scene), resting_height(scene.body.shape)
    (x, y, z), (vx, vy, vz), (p, q, r) = initial.position, initial.velocity, initial.angular_velocity
    qw, qx, qy, qz = initial.quaternion
    theta = 2 * math.atan2(math.hypot(qx, qy), math.hypot(qw, qz))
    faults = []
    if theta > FLATNESS_TOLERANCE:
        faults.append(f"its axis K is {theta:.3g} rad from the vertical")
    if abs(z - resting) > FLATNESS_TOLERANCE * resting:
        faults.append(f"its centre of mass is {z:.9g} m above the plane instead of {resting:.9g} m")
    if abs(vz) > FLATNESS_TOLERANCE * math.hypot(vx, vy):
        faults.append(f"it moves vertically at {vz:.3g} m/s")
    if math.hypot(p, q) > FLATNESS_TOLERANCE * abs(r):
        faults.append(f"it turns about other axes than K at {math.hypot(p, q):.3g} rad/s")
    if faults:
        raise NotFlat("the body does not lie flat: " + "; ".join(faults))
    return np.array([x, y, yaw(np.array(initial.quaternion)), vx, vy, r])


def along_plane(scene: Scene) -> State:
    """The initial state along the axes of the scene's plane, in which the plane is z = 0."""
    initial = scene.initial
    if scene.plane is None or not scene.plane.incline:
        return initial
    half = scene.plane.incline / 2
    back = np.array([math.cos(half), 0.0, -math.sin(half), 0.0])
    x, y, z = rotate(back, np.array(initial.position)).tolist()
    u, v, w = rotate(back, np.array(initial.velocity)).tolist()
    a, b, c, d = multiply(back, np.array(initial.quaternion)).tolist()
    return State((x, y, z), (a, b, c, d), (u, v, w), initial.angular_velocity)


def yaw(quaternion: Array) -> Array:
    """Yaw psi (...), rad, in [-2 pi, 2 pi], of a body that lies flat, from unit quaternions (..., 4), w x y z, body to world.

    q and -q give values that differ by 2 pi.
    """
    return np.asarray(2 * np.arctan2(quaternion[..., 3], quaternion[..., 0]))


def resting_height(shape: Shape | None) -> float:
    """Height (m) of the centre of mass of a body that lies on the face across its axis K.

    Raises `NotFlat` for a body without such a face: a sphere, an ellipsoid, or a body without a shape.
    """
    match shape:
        case Brick((_, _, height)) | Cylinder(_, height):
            return height
        case _:
            raise NotFlat(f"{describe_shape(shape)} has no face to lie on")


def describe_shape(shape: Shape | None) -> str:
    """A body of this shape in words, for the subject of a message."""
    return "a body without a shape" if shape is None else f"a body of the shape {type(shape).__name__.lower()}"
