"""Vectors and rotation matrices at several instants at once, in the wide type."""

from typing import Any

import numpy as np

from bodycheck.reference.exact.numbers import Wide, wide
from bodycheck.reference.exact.pairs import WideArray


def rounded(values: Any) -> WideArray:
    """Numbers of a hundred digits, in sequences of any nesting, rounded to the wide type."""
    if isinstance(values, tuple | list):
        return np.array([rounded(value) for value in values], dtype=Wide)
    return np.asarray(wide(values))


def apply(matrices: WideArray, v: WideArray) -> WideArray:
    """Products (..., 3) of matrices (..., 3, 3) and vectors (..., 3)."""
    products: WideArray = (matrices * v[..., None, :]).sum(axis=-1)
    return products


def about(axis: WideArray, angle: WideArray) -> WideArray:
    """Rotation matrices (s, 3, 3) about a unit axis (3,) by angles (s,)."""
    x, y, z = axis
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]], dtype=Wide)
    cosine, sine = np.cos(angle)[:, None, None], np.sin(angle)[:, None, None]
    versine = 2 * np.sin(angle / 2)[:, None, None] ** 2
    matrices: WideArray = cosine * np.eye(3, dtype=Wide) + sine * skew + versine * np.outer(axis, axis)
    return matrices


def matrices(q: WideArray) -> WideArray:
    """Rotation matrices (s, 3, 3) of quaternions (s, 4) of any length."""
    w, x, y, z = q[:, 0], q[:, 1], q[:, 2], q[:, 3]
    size = w * w + x * x + y * y + z * z
    rows = [
        [size - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), size - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), size - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows, dtype=Wide) / size, -1, 0)


def turning(q: WideArray, rates: WideArray) -> WideArray:
    """The derivatives (s, 4) of quaternions (s, 4) of bodies with angular velocities (s, 3) along the bodies' axes."""
    w, x, y, z = q[:, 0], q[:, 1], q[:, 2], q[:, 3]
    a, b, c = rates[:, 0], rates[:, 1], rates[:, 2]
    parts = [-x * a - y * b - z * c, w * a + y * c - z * b, w * b + z * a - x * c, w * c + x * b - y * a]
    derivatives: WideArray = np.stack(parts, axis=1) / Wide(2)
    return derivatives
