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


def quaternions(axes: WideArray) -> WideArray:
    """Unit quaternions (s, 4) of rotation matrices (s, 3, 3).

    The largest component follows from the diagonal, and the others from it by divisions (Shepperd, J. Guid. Control 1, 1978).
    """
    diagonal = np.stack([axes[:, 0, 0], axes[:, 1, 1], axes[:, 2, 2]], axis=1)
    trace = diagonal.sum(axis=1)
    largest = np.argmax(np.column_stack([trace, diagonal]), axis=1)
    q = np.empty((len(axes), 4), dtype=Wide)
    for k in np.unique(largest):
        some = largest == k
        m, d, sums = axes[some], diagonal[some].T, trace[some]
        if k == 0:
            q[some, 0] = size = np.sqrt(1 + sums) / 2
            for i, j, part in ((2, 1, 1), (0, 2, 2), (1, 0, 3)):
                q[some, part] = (m[:, i, j] - m[:, j, i]) / (4 * size)
            continue
        i, j, n = k - 1, k % 3, (k + 1) % 3
        q[some, k] = size = np.sqrt(1 + 2 * d[i] - sums) / 2
        q[some, 0] = (m[:, n, j] - m[:, j, n]) / (4 * size)
        for other in (j, n):
            q[some, 1 + other] = (m[:, i, other] + m[:, other, i]) / (4 * size)
    unit: WideArray = q / np.sqrt((q * q).sum(axis=1, keepdims=True))
    return unit


def turning(q: WideArray, rates: WideArray) -> WideArray:
    """The derivatives (s, 4) of quaternions (s, 4) of bodies with angular velocities (s, 3) along the bodies' axes."""
    w, x, y, z = q[:, 0], q[:, 1], q[:, 2], q[:, 3]
    a, b, c = rates[:, 0], rates[:, 1], rates[:, 2]
    parts = [-x * a - y * b - z * c, w * a + y * c - z * b, w * b + z * a - x * c, w * c + x * b - y * a]
    derivatives: WideArray = np.stack(parts, axis=1) / Wide(2)
    return derivatives
