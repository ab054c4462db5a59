"""Polynomials near to the motion of a tree in each of many steps, and to the motions beside it.

Nothing here is proved, and nothing has to be: any polynomials will do.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from flint import arb_mat, arb_poly

from bodycheck.reference.proof.balls import Ball, ball, precision
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.trees.flow import COUNT, flows
from bodycheck.reference.proof.trees.tree import Tree
from bodycheck.reference.trajectory import Array

#: The number of nodes of the polynomial in a step, for each bit of the precision.
NODES_PER_BIT = 0.45

#: The bits of a polynomial's coefficients that its interpolation loses, for each node: those of (1 + sqrt(2)).
LOSS = 1.3

#: Bits of the nodes and of the lengths of steps, so that all times are doubles.
NODE_BITS, LENGTH_BITS = 20, 12

#: The number of terms from which motions beside the motion are computed.
ORDER = 24

#: The bits with which bounds of small numbers are computed.
COARSE_BITS = 64

#: The number of steps of the first mesh, and the largest number of times that they are halved.
FIRST, HALVINGS = 8, 14

#: The last coefficients of a polynomial of `COUNT` Chebyshev polynomials in a step, relative to its largest one, that are small
#: enough: they decrease as 7^-k. The same for motions beside the motion, whose bounds need fewer digits.
SMALL_LAST, SMALL_BESIDE = 7.0 ** (1 - COUNT), 1e-9

#: The part of a coordinate that is rounding, and the largest angle (rad) by which it changes in half a step.
ROUNDING, TURN = 1e-17, 3.0

#: A candidate: a function from ascending times (n,), s, and a number of bits to the coordinates of links (n, k), as balls.
Candidate = Callable[[Array, int], list[list[Ball]]]


@dataclass(frozen=True, eq=False)
class Part:
    """Polynomials in a step, in x = (t - centre) / half.

    Attributes
    ----------
    centre, half
        The centre of the step and half of its length (s).
    motion
        The polynomial of each coordinate.
    beside
        The polynomials P (n, 2 n) of the motions beside the motion.
    """

    centre: Fraction
    half: Fraction
    motion: list[Any]
    beside: list[list[Any]]

    @property
    def end(self) -> Fraction:
        """The end of the step (s)."""
        return self.centre + self.half

    def states(self, x: Ball) -> Any:
        """The coordinates and their derivatives by x."""
        return arb_mat([[p(x)] for p in self.motion] + [[p.derivative()(x)] for p in self.motion])

    def deviations(self, x: Ball) -> Any:
        """The matrix of P and its derivative by x."""
        return arb_mat([[p(x) for p in row] for row in self.beside] + [[p.derivative()(x) for p in row] for row in self.beside])


def mesh(tree: Tree, duration: Fraction, candidate: Candidate) -> list[tuple[Fraction, Fraction]]:
    """Return the centres and halves of steps that cover a duration (s), in which polynomials are near to the motion."""
    unit = Fraction(2) ** (math.frexp(float(duration) / FIRST)[1] - LENGTH_BITS)
    half = math.ceil(duration / FIRST / unit / 2) * unit
    waiting = [((2 * i + 1) * half, half) for i in range(FIRST) if 2 * i * half < duration]
    done: list[tuple[Fraction, Fraction]] = []
    for _ in range(HALVINGS):
        long = _too_long(tree, waiting, candidate)
        done += [step for step, is_long in zip(waiting, long, strict=True) if not is_long]
        halved = [
            (centre + side * half / 2, half / 2)
            for (centre, half), is_long in zip(waiting, long, strict=True)
            if is_long
            for side in (-1, 1)
        ]
        waiting = [(centre, half) for centre, half in halved if centre - half < duration]
        if not waiting:
            return sorted(done)
    raise NotEnclosed("a motion that changes too fast")


def _too_long(tree: Tree, steps: list[tuple[Fraction, Fraction]], candidate: Candidate) -> list[bool]:
    """True for each step that is too long for polynomials of few terms, as doubles show."""
    doubles = _interpolated(steps, COUNT, candidate, COARSE_BITS, tree.size)
    series = np.array([[[float(value) for value in row] for row in rows] for rows in doubles])
    by_chebyshev = np.abs(series @ _monomials().T)
    fast = by_chebyshev[:, tree.turning, 1:].sum(axis=2).max(axis=1, initial=0.0) > TURN
    rough = by_chebyshev[:, :, -2:].max(axis=2) > SMALL_LAST * by_chebyshev[:, :, 1:].max(axis=2) + ROUNDING * (
        1 + by_chebyshev[:, :, 0]
    )
    beside = np.abs(flows(tree, series, np.array([float(half) for _, half in steps])))
    last = beside[:, -2:].max(axis=(1, 2, 3)) > SMALL_BESIDE * beside.max(axis=(1, 2, 3))
    return [bool(value) for value in fast | rough.any(axis=1) | last]


def _monomials() -> Array:
    """The coefficients (i, j) of the Chebyshev polynomial i in the power j."""
    return np.array(
        [np.pad(np.polynomial.chebyshev.poly2cheb(np.eye(COUNT)[j, : j + 1]), (0, COUNT - 1 - j)) for j in range(COUNT)]
    ).T


def _interpolated(
    steps: list[tuple[Fraction, Fraction]], count: int, candidate: Candidate, digits: int, size: int
) -> list[list[list[Ball]]]:
    """The coefficients of the polynomials of a candidate in x, of each coordinate in each step."""
    cosines = np.cos(np.pi * (2 * np.arange(count) + 1) / (2 * count))[::-1]
    nodes = [Fraction(round(value * 2**NODE_BITS), 2**NODE_BITS) for value in cosines.tolist()]
    times = np.array([float(centre + half * node) for centre, half in steps for node in nodes])
    with precision(digits):
        values = candidate(times, digits)
    with precision(2 * digits):
        powers = arb_mat([[ball(node**power) for power in range(count)] for node in nodes])
        columns = [[values[step * count + node][i] for step in range(len(steps)) for i in range(size)] for node in range(count)]
        rows = (powers.inv() * arb_mat(columns)).mid().transpose().tolist()
    return [rows[size * step : size * (step + 1)] for step in range(len(steps))]


def parts(tree: Tree, steps: list[tuple[Fraction, Fraction]], candidate: Candidate, bits: int) -> list[Part]:
    """Return the polynomials in all steps, for bounds in some bits."""
    size, count = tree.size, max(12, round(NODES_PER_BIT * bits))
    rows = _interpolated(steps, count, candidate, bits + round(LOSS * count), size)
    doubles = np.array([[[float(value) for value in row[:ORDER]] for row in each] for each in rows])
    beside = flows(tree, doubles, np.array([float(half) for _, half in steps]))
    return [
        Part(
            *step,
            [arb_poly(row) for row in each],
            [[arb_poly(of_step[:, i, j].tolist()) for j in range(2 * size)] for i in range(size)],
        )
        for step, each, of_step in zip(steps, rows, beside, strict=True)
    ]


def doubles_of(matrix: Any) -> Array:
    """Return the middles of a matrix of balls, rounded to doubles."""
    return np.array([[float(value) for value in row] for row in matrix.tolist()])


def identity(size: int) -> Any:
    """Return the identity as a matrix of balls."""
    return arb_mat(size, size, [int(i == j) for i in range(size) for j in range(size)])
