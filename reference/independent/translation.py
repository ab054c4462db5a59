"""The motion of the centre of mass of a free body: it falls with a constant acceleration downwards, which is -z."""

import numpy as np

from bodycheck.reference.integration.rotation import WideArray
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

#: Roundings of a sum of three terms, each of a few factors.
ROUNDINGS = 8.0


def parabola(scene: Scene, times: Array) -> tuple[WideArray, WideArray, Array, Array]:
    """Positions (n, 3), m, and velocities (n, 3), m/s, world frame, at times (n,), s, in NumPy's widest type, without drag.

    The way is the time multiplied by the mean of the first and the last velocity. The two last results are bounds (n,) of the
    errors of both.
    """
    wide = np.longdouble
    t = times.astype(wide)[:, None]
    first = np.array(scene.initial.velocity, dtype=wide)
    last = np.tile(first, (len(times), 1))
    last[:, 2] -= t[:, 0] * wide(scene.gravity)
    position = np.array(scene.initial.position, dtype=wide) + t * ((first + last) / 2)
    rounding = ROUNDINGS * float(np.finfo(wide).eps)
    speed = np.linalg.norm(scene.initial.velocity) + scene.gravity * times
    reach = np.linalg.norm(scene.initial.position) + speed * times
    return position, last, np.asarray(rounding * reach), np.asarray(rounding * speed)
