"""Conversion between the frame of a body and its principal axes, along which the equations of motion are written."""

from dataclasses import replace

import numpy as np

from bodycheck.reference.kinematics import conjugate, multiply, normalise, rotate
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Trajectory

#: The quaternion (w, x, y, z) of no rotation: the body frame is that of the principal axes.
IDENTITY = (1.0, 0.0, 0.0, 0.0)


def along_principal_axes(scene: Scene) -> Scene:
    """The same scene with the principal axes of its body as the body frame.

    Attitude and angular velocity are converted. A scene whose body frame is that of the principal axes is returned as it is.
    """
    if scene.body.axes == IDENTITY:
        return scene
    axes = np.array(scene.body.axes)
    w, x, y, z = normalise(multiply(np.array(scene.initial.quaternion), axes)).tolist()
    p, q, r = rotate(conjugate(axes), np.array(scene.initial.angular_velocity)).tolist()
    initial = replace(scene.initial, quaternion=(w, x, y, z), angular_velocity=(p, q, r))
    return replace(scene, body=replace(scene.body, axes=IDENTITY), initial=initial)


def in_body_frame(scene: Scene, motion: Trajectory) -> Trajectory:
    """The same motion in the frame of the scene's body, from a trajectory along the principal axes of that body."""
    if scene.body.axes == IDENTITY:
        return motion
    axes = np.array(scene.body.axes)
    return replace(
        motion,
        quaternion=multiply(motion.quaternion, np.broadcast_to(conjugate(axes), motion.quaternion.shape)),
        angular_velocity=rotate(np.broadcast_to(axes, motion.quaternion.shape), motion.angular_velocity),
    )
