"""Accelerations and constraint forces: the equations of motion with multipliers, solved in the wide type with minimum norm.

    M a + J^T l = f,    J a = c

A small negative multiple of the identity replaces the zero block of the matrix. Its inverse in doubles is used to refine the
solution with residuals in the wide type (a proximal iteration; for robots: Carpentier et al., Robotics: Science and Systems
2021). If constraints are redundant, the multipliers have minimum norm, to some five digits, and the accelerations are exact to
rounding. Constraints are ignored in directions in which they are very weak.
"""

import numpy as np

from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.trajectory import Array

#: The multiple of the identity, relative to the mean of the diagonal of J M^-1 J^T.
_PROXIMAL = 1e-11

#: Relative change at which refinements end.
_ENOUGH = 2e-20


def solved(
    mass: WideArray, rows: WideArray, force: WideArray, target: WideArray, *, refinements: int = 16
) -> tuple[WideArray, WideArray]:
    """The accelerations a (s, n) and multipliers l (s, m) for M (s, n, n), J (s, m, n), f (s, n) and c (s, m)."""
    n, m = rows.shape[2], rows.shape[1]
    matrix = np.zeros((len(mass), n + m, n + m), dtype=Wide)
    matrix[:, :n, :n], matrix[:, n:, :n], matrix[:, :n, n:] = mass, rows, np.swapaxes(rows, 1, 2)
    narrow = matrix.astype(float)
    if m:
        across = (narrow[:, n:, :n] ** 2 / _loosened(narrow[:, :n, :n])[:, None]).sum(axis=(1, 2))
        narrow[:, range(n, n + m), range(n, n + m)] = -_PROXIMAL * (across / m + 1e-300)[:, None]
    inverse = _inverse(narrow, n)
    right = np.concatenate([force, target], axis=1)
    solution = np.zeros_like(right)
    smallest = np.inf
    for _ in range(refinements):
        rest = right - (matrix @ solution[:, :, None])[:, :, 0]
        step = (inverse * rest.astype(float)[:, None]).sum(axis=2)
        solution = solution + step
        change = float((np.abs(step[:, :n]).max(axis=1) / (np.abs(solution[:, :n]).max(axis=1) + Wide(1e-300))).max())
        if change < _ENOUGH or change > 0.5 * smallest:
            break
        smallest = change
    return solution[:, :n], solution[:, n:]


def _inverse(matrix: Array, n: int) -> Array:
    """The inverses (s, k, k) of matrices with a positive definite block of n rows, the rest being negative definite.

    Gauss-Jordan elimination needs no pivots for such matrices. It is done for all matrices at once, without the threads of a
    library for linear algebra, whose start takes longer than the work for small matrices.
    """
    inverse = matrix.copy()
    inverse[:, range(n), range(n)] = _loosened(matrix[:, :n, :n])
    for index in range(matrix.shape[1]):
        row = inverse[:, index] / inverse[:, index, index, None]
        row[:, index] = 1 / inverse[:, index, index]
        column = inverse[:, :, index].copy()
        column[:, index] = 0
        inverse[:, :, index] = 0
        inverse -= column[:, :, None] * row[:, None]
        inverse[:, index] = row
    return inverse


def _loosened(mass: Array) -> Array:
    """The diagonals (s, n) of mass matrices, with small numbers instead of zeros, which a point mass may have."""
    diagonal = np.diagonal(mass, axis1=1, axis2=2)
    return np.asarray(np.maximum(diagonal, diagonal.max(axis=1, keepdims=True) * 1e-6 + 1e-300))
