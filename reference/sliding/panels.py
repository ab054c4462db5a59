"""A planar motion in panels: its states at instants between which it is smooth, and at the nodes of Gauss's rule in between.

Integrals over a panel are then sums over its nodes. A check of a motion needs no other information about its computation.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.trajectory import Array

#: Number of nodes in a panel. Integrals up to each node are then one order higher than the interpolant of an integration, which
#: is of order 7, so that they show its error.
PANEL_NODES = 7

#: The nodes and weights on a panel from 0 to 1.
NODES, WEIGHTS = (value / 2 for value in np.polynomial.legendre.leggauss(PANEL_NODES))
NODES = NODES + 0.5


def _partial_weights() -> Array:
    """The weights (k, k) of the integrals from 0 to each node, divided by the weights of the whole panel."""
    degrees = np.polynomial.legendre.legvander(2 * NODES - 1, PANEL_NODES)
    # The integral of P_m from -1 to x is (P_{m+1} - P_{m-1})/(2 m + 1), and x + 1 for m = 0.
    integrals = [degrees[:, 1] + 1]
    integrals += [(degrees[:, m + 1] - degrees[:, m - 1]) / (2 * m + 1) for m in range(1, PANEL_NODES)]
    # Gauss's rule gives the coefficients of a polynomial exactly; they are the numbers below times the weights.
    coefficients = (2 * np.arange(PANEL_NODES) + 1) * degrees[:, :PANEL_NODES]
    return np.asarray(np.stack(integrals, axis=1) @ coefficients.T / 2)


def _differentiation() -> Array:
    """The matrix (k, k) from values at the nodes to derivatives at the nodes, for a polynomial that is zero at the start."""
    points = np.array([0.0, *NODES])
    apart = points[:, None] - points + np.eye(len(points))
    products = apart.prod(axis=1)
    matrix = products[:, None] / products / apart
    np.fill_diagonal(matrix, 0.0)
    np.fill_diagonal(matrix, -matrix.sum(axis=1))
    return np.asarray(matrix[1:, 1:])


#: See `_partial_weights` and `_differentiation`.
PARTIAL_WEIGHTS, DIFFERENTIATION = _partial_weights(), _differentiation()


@dataclass(frozen=True, eq=False)
class Panels:
    """A planar motion in n panels, in each of which time and motion are smooth functions of some parameter from 0 to 1.

    Attributes
    ----------
    times
        (n + 1,) ascending times of the ends of the panels (s).
    rows
        (n + 1, 6) x, y, psi, dx/dt, dy/dt, dpsi/dt (m, rad, s) at these times, world frame.
    node_times
        (n, k) times (s) where the parameter is `NODES`.
    node_rows
        (n, k, 6) the motion at the nodes.
    """

    times: Array
    rows: Array
    node_times: Array
    node_rows: Array

    @property
    def weights(self) -> Array:
        """Weights (n, k), s: the integral of f over a panel's time is the sum of weights times f at its nodes."""
        return np.asarray((self.node_times - self.times[:-1, None]) @ DIFFERENTIATION.T * WEIGHTS)


def between(rows: Callable[[Array], Array], times: Array) -> Panels:
    """The panels between ascending times (n + 1,), s, of a motion that maps times (m,) to its rows (m, 6)."""
    lengths = np.diff(times)[:, None]
    node_times = times[:-1, None] + lengths * NODES
    node_rows = rows(node_times.ravel()).reshape(*node_times.shape, 6)
    return Panels(times, rows(times), node_times, node_rows)
