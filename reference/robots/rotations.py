"""Rotations of frames of robot models: matrices, quaternions, and the axes of a plane.

`matrices` and `rotation_vector` keep the floating-point type of their input.
"""

from typing import Any

import numpy as np

from bodycheck.reference.kinematics import Float, Floats, normalise
from bodycheck.reference.robots.model import Wide


def matrices(turn: Floats[Float]) -> Floats[Float]:
    """Rotation matrices (n, 3, 3) of unit quaternions w, x, y, z (n, 4)."""
    w, x, y, z = turn.T
    entries = [
        *(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        *(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        *(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    ]
    return np.stack(entries, axis=1).reshape(-1, 3, 3)


def quaternion(matrix: Wide) -> Wide:
    """The unit quaternion w, x, y, z (4,) of a rotation matrix (3, 3), with a positive component of largest magnitude.

    For each component of the quaternion, four times its products with all components are sums of entries of the matrix; the
    largest component gives the most accurate products.
    """
    (a, b, c), (d, e, f), (g, h, i) = matrix
    products = np.array(
        [
            [1 + a + e + i, h - f, c - g, d - b],
            [h - f, 1 + a - e - i, b + d, c + g],
            [c - g, b + d, 1 - a + e - i, f + h],
            [d - b, c + g, f + h, 1 - a - e + i],
        ]
    )
    largest: Wide = products[np.argmax(np.diag(products))]
    return normalise(largest)


def plane_axes(normal: Wide) -> Wide:
    """The matrix (3, 3) whose columns are the axes x and y of a plane and its unit normal, for a unit normal (3,).

    It is the smallest rotation that takes z to the normal, or a half turn about x if the normal is -z. URDF defines the plane
    of a joint but no axes in the plane; for the normal z they are the axes x and y of the joint's frame.
    """
    x, y, z = normal
    if not (x or y):
        return np.diag(np.array([1, np.sign(z), np.sign(z)], np.longdouble))
    return np.asarray(matrices(normalise(np.array([[1 + z, -y, x, 0]], np.longdouble)))[0])


def rotation_vector(turn: Floats[Float]) -> Floats[Float]:
    """The rotation vectors (n, 3) of unit quaternions (n, 4): along the axis, as long as the angle, which is at most pi."""
    nearer: Any = np.where(turn[:, :1] < 0, -turn, turn)
    sine = np.sqrt((nearer[:, 1:] ** 2).sum(axis=1, keepdims=True))
    angle = 2 * np.arctan2(sine, nearer[:, :1])
    return np.asarray(nearer[:, 1:] * np.where(sine > 0, angle / np.where(sine > 0, sine, 1), 2))
