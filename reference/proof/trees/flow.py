"""Polynomials near to the motions beside a motion of a tree, in doubles.

The motions beside a motion obey M y'' + C y' + G y = 0 with the derivatives M, C and G of the efforts by accelerations,
velocities and coordinates. In each step there are twice as many of them as coordinates, those that begin in its centre with
unit deviations; they are found by collocation. Nothing here is proved, and nothing has to be: `validated` bounds their errors.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.trees.derivatives import along, each_alone
from bodycheck.reference.proof.trees.tree import Number, Tree
from bodycheck.reference.trajectory import Array

#: The number of nodes in a step, which is odd, so that its centre is one of them, and the nodes in units of half a step.
COUNT = 17
NODES = np.cos(np.pi * (2 * np.arange(COUNT) + 1) / (2 * COUNT))[::-1]


def flows(tree: Tree, coefficients: Array, halves: Array) -> Array:
    """Return the coefficients (steps, terms, n, 2 n) of the motions beside a motion, in units of half a step.

    coefficients: (steps, n, terms) of the coordinates in units of half a step; halves: (steps,) halves of the steps (s).
    """
    size = coefficients.shape[1]
    powers = np.arange(coefficients.shape[2])
    of_q = NODES[:, None] ** powers
    of_v = np.where(powers > 0, powers * NODES[:, None] ** np.maximum(powers - 1, 0), 0.0)
    of_a = np.where(powers > 1, powers * (powers - 1) * NODES[:, None] ** np.maximum(powers - 2, 0), 0.0)
    q, v, a = (np.einsum("skp,xp->ksx", coefficients, part) for part in (of_q, of_v, of_a))
    v, a = v / halves[:, None], a / halves[:, None] ** 2
    turns = [*np.sin(q)], [*np.cos(q)]
    doubles = in_doubles(tree)
    by_q, by_v, by_a = (
        _rows(along(doubles, ([*q], [*v], [*a]), turns, each_alone(size, part)), q.shape[1:]) for part in range(3)
    )
    by_q, by_v = by_q * halves[:, None, None, None] ** 2, by_v * halves[:, None, None, None]
    return np.stack([_collocated(*each) for each in zip(by_q, by_v, by_a, strict=True)])


def _rows(slopes: Sequence[dict[int, Any]], shape: tuple[int, ...]) -> Array:
    """Matrices (steps, nodes, n, n) of derivatives."""
    size = len(slopes)
    entries = [[np.broadcast_to(row.get(i, 0.0), shape) for i in range(size)] for row in slopes]
    return np.moveaxis(np.array(entries, dtype=float), (0, 1), (2, 3))


def _collocated(by_q: Array, by_v: Array, by_a: Array) -> Array:
    """The coefficients (terms, n, 2 n) of the solutions of M y'' + C y' + G y = 0 in a step, from matrices at the nodes."""
    size = by_a.shape[-1]
    try:
        frame = np.linalg.inv(np.linalg.cholesky(by_a[COUNT // 2])).T
    except np.linalg.LinAlgError:
        raise NotEnclosed("a mass matrix that is singular") from None
    start = np.zeros((2, size, 2 * size))
    start[0, :, :size] = start[1, :, size:] = frame
    powers = np.arange(COUNT)
    inverse = np.linalg.inv(NODES[:, None] ** powers)
    once = (NODES[:, None] ** (powers + 1) / (powers + 1)) @ inverse
    twice = (NODES[:, None] ** (powers + 2) / ((powers + 1) * (powers + 2))) @ inverse
    system = np.einsum("xij,xy->xiyj", by_q, twice) + np.einsum("xij,xy->xiyj", by_v, once)
    system += np.einsum("xij,xy->xiyj", by_a, np.eye(COUNT))
    known = np.einsum("xij,xjk->xik", by_q, start[0] + NODES[:, None, None] * start[1]) + by_v @ start[1]
    try:
        curved = np.linalg.solve(system.reshape(COUNT * size, -1), -known.reshape(COUNT * size, -1))
    except np.linalg.LinAlgError:
        raise NotEnclosed("a mass matrix that is singular") from None
    bent = np.tensordot(inverse, curved.reshape(COUNT, size, 2 * size), 1) / ((powers + 1) * (powers + 2))[:, None, None]
    return np.concatenate([start, bent])


def in_doubles(tree: Tree) -> Tree:
    """Return a tree whose numbers are doubles; those that are exactly 0, 1 or -1 remain integers."""

    def rounded(value: Number) -> Number:
        return value if isinstance(value, int) else float(value)

    changed = [
        replace(
            link,
            turn=[[rounded(entry) for entry in row] for row in link.turn],
            offset=[rounded(entry) for entry in link.offset],
            moment=[rounded(entry) for entry in link.moment],
            tensor=[[rounded(entry) for entry in row] for row in link.tensor],
            **{name: rounded(getattr(link, name)) for name in ("mass", "armature", "damping", "stiffness", "rest", "effort")},
        )
        for link in tree.links
    ]
    return replace(tree, gravity=rounded(tree.gravity), links=changed)
