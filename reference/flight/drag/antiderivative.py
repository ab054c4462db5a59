"""Antiderivatives of smooth functions on panels, by Gauss-Legendre nodes in the wide type.

On each panel [a, a + h] a function is represented by a series of Legendre polynomials P_k in x = 2 r - 1, with r = (y - a) / h
between 0 and 1. Its mean over [a, y] follows from the integral of P_k from -1 to x, which is -(1 - x^2) P_k'(x) / (k (k + 1))
for k > 0, by Legendre's equation [DLMF 14.2]. The integral from a to y is h r times this mean, so that its relative accuracy is
kept however close y is to a.
"""

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.flight.elliptic import WideArray

#: An array in double precision or in the wide type.
Floats = NDArray[np.floating[Any]]

#: An array of indices.
Indices = NDArray[np.integer[Any]]

#: Number of nodes of a panel. A function whose nearest singularity lies two panel lengths from the panel's middle is
#: represented to 7.9^-24 = 3e-22.
NODES = 24

#: Steps of Newton's method that refine the nodes from double precision to the wide type, including one spare step.
NODE_STEPS = 3

#: Steps of Newton's method for the place in a panel, in double precision. Four steps give all digits if a function varies by a
#: factor of two within a panel; the fifth is a spare. One step in the wide type follows.
INVERSION_STEPS = 5


@dataclass(frozen=True, eq=False)
class Panels:
    """Integrals of several functions over adjacent panels.

    Attributes
    ----------
    edges
        (m + 1,) ascending edges of the panels.
    sums
        (f, m + 1) integrals of each function from the first edge to each edge.
    terms
        (f, m, NODES) coefficients of each function's mean on each panel.
    """

    edges: WideArray
    sums: WideArray
    terms: WideArray


@functools.cache
def nodes() -> tuple[WideArray, WideArray]:
    """Nodes (NODES,) in (-1, 1) and weights (NODES,) of the Gauss-Legendre rule, in the wide type."""
    x = np.polynomial.legendre.leggauss(NODES)[0].astype(Wide)
    for _ in range(NODE_STEPS):
        x = x - legendre(x)[NODES] / _slope(x)
    return x, np.asarray(2 / ((1 - x * x) * _slope(x) ** 2), dtype=Wide)


def _slope(x: WideArray) -> WideArray:
    """Derivatives (n,) of the Legendre polynomial of degree NODES at x (n,) inside (-1, 1)."""
    values = legendre(x)
    return np.asarray(NODES * (values[NODES - 1] - x * values[NODES]) / (1 - x * x))


def legendre(x: Floats) -> Floats:
    """Legendre polynomials of degrees 0 to NODES at x (n,): an array (NODES + 1, n) of the type of x."""
    values = np.ones((NODES + 1, len(x)), dtype=x.dtype)
    values[1] = x
    for k in range(1, NODES):
        values[k + 1] = ((2 * k + 1) * x * values[k] - k * values[k - 1]) / (k + 1)
    return values


def mean_terms(r: Floats) -> Floats:
    """Means of the Legendre polynomials of degrees 0 to NODES - 1 from the left edge of a panel to r (n,): (NODES, n).

    r is in [0, 1]. The derivatives P_k' are Gegenbauer polynomials of order 3/2. The means have the type of r.
    """
    x = 2 * r - 1
    slopes = np.ones((NODES - 1, len(r)), dtype=r.dtype)  # row k holds P_{k+1}'
    slopes[1] = 3 * x
    for k in range(2, NODES - 1):
        slopes[k] = ((2 * k + 1) * x * slopes[k - 1] - (k + 1) * slopes[k - 2]) / k
    degree = np.arange(1, NODES)[:, None]
    return np.concatenate([np.ones_like(slopes[:1]), -2 * (1 - r) * slopes / (degree * (degree + 1))])


@functools.cache
def _series() -> WideArray:
    """Matrix (NODES, NODES) from values at the nodes to coefficients of the Legendre series."""
    x, weights = nodes()
    return np.asarray((np.arange(NODES) + Wide(0.5))[:, None] * legendre(x)[:NODES] * weights)


def places(edges: WideArray) -> WideArray:
    """The Gauss nodes (m * NODES,) of the panels between m + 1 ascending edges."""
    return np.asarray(edges[:-1, None] + np.diff(edges)[:, None] * ((1 + nodes()[0]) / 2)).ravel()


def panels(edges: WideArray, values: WideArray) -> Panels:
    """The panels between ascending edges (m + 1,), from the values (f, m * NODES) of the functions at `places`."""
    terms = values.reshape(len(values), len(edges) - 1, NODES) @ _series().T
    sums = np.zeros((len(values), len(edges)), dtype=Wide)
    np.cumsum(terms[:, :, 0] * np.diff(edges), axis=1, out=sums[:, 1:])
    return Panels(edges, sums, terms)


def integrals(antiderivatives: Panels, panel: Indices, r: WideArray) -> WideArray:
    """Integrals (f, n) of the functions from the first edge to places r (n,), in [0, 1], of panels with indices (n,)."""
    inside = np.einsum("fnk,kn->fn", antiderivatives.terms[:, panel], mean_terms(r))
    return np.asarray(antiderivatives.sums[:, panel] + np.diff(antiderivatives.edges)[panel] * r * inside)


def invert(antiderivatives: Panels, targets: WideArray) -> tuple[Indices, WideArray]:
    """Return the arguments at which the integral of the first function, which is positive, has given values.

    Parameters
    ----------
    antiderivatives
        The panels.
    targets
        (n,) values between zero and the whole integral.

    Returns
    -------
    tuple
        (n,) indices of panels and (n,) places r in [0, 1] within them.
    """
    sums, lengths = antiderivatives.sums[0], np.diff(antiderivatives.edges)
    panel = np.clip(np.searchsorted(sums, targets, side="right") - 1, 0, len(lengths) - 1)
    wanted, terms, length = targets - sums[panel], antiderivatives.terms[0][panel], lengths[panel]
    shares, scaled = (part.astype(float) for part in (wanted / length, terms))
    r = np.clip(shares / ((sums[panel + 1] - sums[panel]) / length).astype(float), 0, 1)
    for _ in range(INVERSION_STEPS):
        value = np.einsum("nk,kn->n", scaled, legendre(2 * r - 1)[:NODES])
        r = np.clip(r - (r * np.einsum("nk,kn->n", scaled, mean_terms(r)) - shares) / value, 0, 1)
    wide = r.astype(Wide)
    excess = wide * np.einsum("nk,kn->n", terms, mean_terms(wide)) - wanted / length
    return panel, np.clip(wide - excess / value, 0, 1)
