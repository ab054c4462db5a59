"""Between the frame of a body and its principal axes, along which the equations of motion are written."""

from dataclasses import replace

import numpy as np

from bodycheck.reference.kinematics import conjugate, multiply, normalise, rotate
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Trajectory

ALIGNED = (1.0, 0.0, 0.0, 0.0)


def along_principal_axes(scene: Scene) -> Scene:
    """The same scene, its state told along the principal axes of its body; unchanged where these are the body's frame."""
    if scene.body.axes == ALIGNED:
        return scene
    axes = np.array(scene.body.axes)
    w, x, y, z = normalise(multiply(np.array(scene.initial.quaternion), axes)).tolist()
    p, q, r = rotate(conjugate(axes), np.array(scene.initial.angular_velocity)).tolist()
    initial = replace(scene.initial, quaternion=(w, x, y, z), angular_velocity=(p, q, r))
    return replace(scene, body=replace(scene.body, axes=ALIGNED), initial=initial)


def in_body_frame(scene: Scene, motion: Trajectory) -> Trajectory:
    """A motion told along the principal axes of a scene's body, in the frame of that body."""
    if scene.body.axes == ALIGNED:
        return motion
    axes = np.array(scene.body.axes)
    return replace(
        motion,
        quaternion=multiply(motion.quaternion, np.broadcast_to(conjugate(axes), motion.quaternion.shape)),
        angular_velocity=rotate(np.broadcast_to(axes, motion.quaternion.shape), motion.angular_velocity),
    )
