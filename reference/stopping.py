"""Figures of a body that slides on a plane: when and where it stops, and what it does that a rigid body would not."""

import numpy as np

from bodycheck.reference.kinematics import conjugate, euler_from_quaternion, rotate
from bodycheck.reference.lying import Stop, yaw
from bodycheck.reference.scene import Brick, Cylinder, Scene
from bodycheck.reference.trajectory import Array, Trajectory

#: A body whose speed is below this part of the initial one has stopped; soft contacts creep on below it.
AT_REST = 1e-3


def tilt(trajectory: Trajectory) -> Array:
    """Angle (n,) between K and the vertical (rad)."""
    _, theta, _ = euler_from_quaternion(trajectory.quaternion)
    return theta


def penetration(scene: Scene, trajectory: Trajectory) -> Array:
    """Depth (n,) of the lowest point of the body below the plane (m); 0 where it is above."""
    # Components of the vertical along the axes of the body.
    down = rotate(conjugate(trajectory.quaternion), np.tile([0.0, 0.0, 1.0], (len(trajectory), 1)))
    match scene.body.shape:
        case Brick(semi_axes):
            reach = np.abs(down) @ np.array(semi_axes)
        case Cylinder(radius, half_length):
            reach = half_length * np.abs(down[:, 2]) + radius * np.hypot(down[:, 0], down[:, 1])
        case _:
            return np.zeros(len(trajectory))
    return np.asarray(np.maximum(reach - trajectory.position[:, 2], 0.0))


def measured_stop(scene: Scene, trajectory: Trajectory) -> Stop:
    """Where a trajectory comes to rest; one that has not by the last instant counts as doing so then.

    The speed is that of the kinetic energy, |u|^2 = v^2 + (C/m) w^2. Its last two values above `AT_REST` lead on to zero:
    friction slows evenly, so that the stop lies between the samples, where it is. The yaw counts on over full turns.
    """
    t = trajectory.t
    spin = trajectory.angular_velocity[:, 2] ** 2 * scene.body.moments[2] / scene.body.mass
    speed = np.sqrt((trajectory.velocity[:, :2] ** 2).sum(axis=1) + spin)
    moving = np.flatnonzero(speed > AT_REST * speed[0])
    last = int(moving[-1]) if len(moving) else -1
    index = min(last + 1, len(t) - 1)
    time = float(t[index])
    if 0 < last < len(t) - 1 and speed[last - 1] > speed[last]:
        slowing = (speed[last - 1] - speed[last]) / (t[last] - t[last - 1])
        time = min(float(t[last] + speed[last] / slowing), time)
    turned = np.unwrap(yaw(trajectory.quaternion))
    x, y, z = trajectory.position[index].tolist()
    return Stop(time, (x, y, z), float(yaw(np.array(scene.initial.quaternion)) + turned[index] - turned[0]))
