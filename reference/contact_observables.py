"""Observables of a body on the plane: its tilt, its penetration, and the instant and place of its stop.

The penetration follows from the extent of the body in a direction, the support function of its shape. All observables are
computed from a trajectory alone, with the same formulas for the truth and for every engine.
"""

import numpy as np

from bodycheck.reference.kinematics import conjugate, euler_from_quaternion, rotate
from bodycheck.reference.planar import Stop, yaw
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Scene, Shape, Sphere, Vector
from bodycheck.reference.trajectory import Array, Trajectory

#: Fraction of the initial speed below which a body counts as stopped; bodies on soft contacts keep creeping below it.
STOP_SPEED_FRACTION = 1e-3


def reach(shape: Shape, quaternion: Array, normal: Vector) -> Array:
    """Return the extent (n,), m, of a body from its centre of mass in the direction opposite to `normal`.

    Parameters
    ----------
    shape
        The shape, about the centre of mass and along the axes of the body.
    quaternion
        (n, 4) unit quaternions w, x, y, z, body to world.
    normal
        The unit vector in the world frame, such as the normal of a plane: the body touches the plane if its centre of mass is
        this extent above it.
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


def tilt(trajectory: Trajectory) -> Array:
    """Angle (n,), rad, in [0, pi], between the body axis K and the vertical."""
    _, theta, _ = euler_from_quaternion(trajectory.quaternion)
    return theta


def penetration(scene: Scene, trajectory: Trajectory) -> Array:
    """Depth (n,), m, of the lowest point of the body below the plane, along its normal; zero where the body is above it.

    It is zero for a body without a shape.
    """
    if scene.plane is None or scene.body.shape is None:
        return np.zeros(len(trajectory))
    return depth(scene.body.shape, trajectory, scene.plane.normal)


def measured_stop(scene: Scene, trajectory: Trajectory) -> Stop:
    """The stop of a sampled trajectory; if the body still moves at the last instant, that instant is the stop.

    The speed |u| follows from the kinetic energy, |u|^2 = v^2 + (C/m) w^2, and a body has stopped when it stays below
    `STOP_SPEED_FRACTION` of its initial value. Friction reduces the speed at an even rate, so the time of the stop is
    extrapolated from the last two samples above this threshold, but is no later than the first sample below it. The yaw
    includes full turns.
    """
    t = trajectory.t
    spin = trajectory.angular_velocity[:, 2] ** 2 * scene.body.moments[2] / scene.body.mass
    speed = np.sqrt((trajectory.velocity[:, :2] ** 2).sum(axis=1) + spin)
    moving = np.flatnonzero(speed > STOP_SPEED_FRACTION * speed[0])
    last = int(moving[-1]) if len(moving) else -1
    index = min(last + 1, len(t) - 1)
    time = float(t[index])
    if 0 < last < len(t) - 1 and speed[last - 1] > speed[last]:
        slowing = (speed[last - 1] - speed[last]) / (t[last] - t[last - 1])
        time = min(float(t[last] + speed[last] / slowing), time)
    turned = np.unwrap(yaw(trajectory.quaternion))
    x, y, z = trajectory.position[index].tolist()
    return Stop(time, (x, y, z), float(yaw(np.array(scene.initial.quaternion)) + turned[index] - turned[0]))
