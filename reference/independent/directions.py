"""Quaternions of matrices of direction cosines."""

import numpy as np

from bodycheck.reference.independent.border import MP, Matrix
from bodycheck.reference.integration.rotation import WideArray


def quaternion_of(cosines: WideArray) -> WideArray:
    """The unit quaternions (n, 4) of matrices of direction cosines (n, 3, 3), body to world components.

    4 q q^T is formed from the matrix; the row of its largest diagonal entry is q, times a number of at least 1.
    """
    m = np.moveaxis(cosines, 0, 2)
    wx, wy, wz = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]
    xy, xz, yz = m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1]
    ww, xx = 1 + m[0, 0] + m[1, 1] + m[2, 2], 1 + m[0, 0] - m[1, 1] - m[2, 2]
    yy, zz = 1 - m[0, 0] + m[1, 1] - m[2, 2], 1 - m[0, 0] - m[1, 1] + m[2, 2]
    rows = np.array([[ww, wx, wy, wz], [wx, xx, xy, xz], [wy, xy, yy, yz], [wz, xz, yz, zz]])
    largest = np.argmax(np.array([ww, xx, yy, zz]).astype(float), axis=0)
    q = rows[largest, :, np.arange(len(largest))]
    return np.asarray(q / np.sqrt((q * q).sum(axis=1))[:, None])


def exact_quaternion(cosines: Matrix) -> WideArray:
    """The unit quaternion (4,), in NumPy's widest type, of a matrix of direction cosines in numbers of `border.MP`."""
    head = np.array([[float(entry) for entry in row] for row in cosines])
    tail = np.array([[float(entry - MP.mpf(float(entry))) for entry in row] for row in cosines])
    return np.asarray(quaternion_of((head.astype(np.longdouble) + tail)[None])[0])
