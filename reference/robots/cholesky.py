"""Solutions of linear equations with symmetric positive definite matrices, in the 80-bit type that NumPy's own solvers lack."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.robots.model import Wide


def solved(matrices: Wide, right: Wide) -> tuple[Wide, NDArray[np.bool_]]:
    """The solutions (n, k) of n equations, and whether each matrix is positive definite beyond rounding (n,).

    matrices: (n, k, k), symmetric. right: (n, k). Where a matrix is not positive definite, its solution means nothing.
    """
    rest, known = matrices.copy(), right.copy()
    count, size = right.shape
    smallest = size * np.finfo(np.longdouble).eps * np.diagonal(matrices, axis1=1, axis2=2)
    definite = np.ones(count, np.bool_)
    factor = np.zeros_like(matrices)
    for k in range(size):
        enough = rest[:, k, k] > smallest[:, k]
        definite &= enough
        pivot: Any = np.sqrt(np.where(enough, rest[:, k, k], 1))
        factor[:, k:, k] = rest[:, k:, k] / pivot[:, None]
        factor[:, k, k] = pivot
        below = factor[:, k + 1 :, k]
        rest[:, k + 1 :, k + 1 :] -= below[:, :, None] * below[:, None, :]
        known[:, k] /= pivot
        known[:, k + 1 :] -= below * known[:, k, None]
    for k in reversed(range(size)):
        known[:, k] /= factor[:, k, k]
        known[:, :k] -= factor[:, k, :k] * known[:, k, None]
    return known, definite
