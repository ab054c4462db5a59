"""The integral J(u) of cn^2 / (1 + nu sn^2) from 0 to u, by quadrature over panels.

For 0 <= nu <= 1 the integrand has no pole within pi/4 of the real axis, so that polynomials of high degree on short panels are
accurate to the last digit of the wide type. It decays as exp(-2 u): near the separatrix, where K is large, few panels are
needed.
"""

import functools
import math
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.independent.arithmetic import Wide, WideArray, wide
from bodycheck.reference.independent.border import MP
from bodycheck.reference.independent.jacobi import Modulus, functions

#: Argument beyond which the rest of the integral is negligible: 4 exp(-2 u) is 1e-20.
LARGEST_ARGUMENT = 24

#: Nodes of a panel, and its largest width. Chebyshev series then converge by a factor 4.3 or more for each term.
NODES = 32
LARGEST_WIDTH = 0.75


@dataclass(frozen=True, eq=False)
class Swing:
    """The integral J(u) of cn^2 / (1 + nu sn^2) from 0 to u, for one modulus and one nu.

    Attributes
    ----------
    width
        Width of a panel.
    series
        (NODES + 1, m) coefficients of the Chebyshev series of J on each of m panels, which begin at u = 0.
    total
        J(K).
    """

    width: np.longdouble
    series: WideArray
    total: np.longdouble


def swing(modulus: Modulus, nu: np.longdouble) -> Swing:
    """The integral J(u) of cn^2 / (1 + nu sn^2) from 0 to u, for a modulus and 0 <= nu <= 1."""
    reach = wide(min(modulus.quarter, MP.mpf(LARGEST_ARGUMENT)))
    count = math.ceil(reach / LARGEST_WIDTH)
    width = reach / count
    nodes, integrals = _chebyshev()
    u = width * (np.arange(count, dtype=Wide)[:, None] + (1 + nodes) / 2)
    sn, cn, _ = functions(modulus, u.ravel())
    values = (cn * cn / (1 + nu * sn * sn)).reshape(count, NODES)
    series = width / 2 * (integrals @ values.T)
    ends = np.concatenate(([Wide(0)], np.cumsum(series.sum(axis=0))))
    series[0] += ends[:-1]
    return Swing(width, series, ends[-1])


def integrated(course: Swing, u: WideArray) -> WideArray:
    """Return the integral J(u) of `Swing` for arguments u (n,) in [-K, K]."""
    scaled = np.minimum(np.abs(u) / course.width, Wide(course.series.shape[1]))
    panel = np.minimum(scaled.astype(int), course.series.shape[1] - 1)
    twice = 4 * (scaled - panel) - 2
    series = np.take(course.series, panel, axis=1)
    # Clenshaw's recurrence.
    later, now = np.zeros_like(twice), series[-1]
    for coefficients in series[-2:0:-1]:
        later, now = now, coefficients + twice * now - later
    return np.asarray(np.copysign(series[0] + twice / 2 * now - later, u))


@functools.cache
def _chebyshev() -> tuple[WideArray, WideArray]:
    """Chebyshev nodes (NODES,) in [-1, 1], and the matrix (NODES + 1, NODES) that maps values there to an integral from -1.

    The integral is given by the coefficients of its Chebyshev series; the integral of T_n is T_(n+1)/(2n+2) - T_(n-1)/(2n-2).
    """
    angles = [(2 * j + 1) * MP.pi / (2 * NODES) for j in range(NODES)]
    terms = [[MP.cos(n * angle) * (1 if n == 0 else 2) / NODES for angle in angles] for n in range(NODES)]
    zero = [MP.zero] * NODES
    padded = [[2 * value for value in terms[0]], *terms[1:], zero, zero]
    rows = [
        [(before - after) / (2 * n) for before, after in zip(padded[n - 1], padded[n + 1], strict=True)]
        for n in range(1, NODES + 1)
    ]
    constant = [-sum((-1) ** n * row[j] for n, row in enumerate(rows, start=1)) for j in range(NODES)]
    integrals = np.array([[wide(value) for value in row] for row in (constant, *rows)])
    return np.array([wide(MP.cos(angle)) for angle in angles]), integrals
