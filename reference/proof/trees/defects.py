"""Bounds of how far the motion of a tree is from polynomials in a step, from the defects of the polynomials.

The coefficients u of the motions beside the motion (see `validated`) obey K u' = -[0; r + R u] with K = [P; M P'].
"""

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from flint import acb, arb, arb_mat, arb_poly, arb_series, ctx

from bodycheck.reference.proof.balls import Ball, ball, precision
from bodycheck.reference.proof.trees.derivatives import along
from bodycheck.reference.proof.trees.dynamics import efforts
from bodycheck.reference.proof.trees.polynomials import COARSE_BITS, Part, doubles_of, identity
from bodycheck.reference.proof.trees.tree import Tree

#: The radius of the disc of Cauchy's estimate, in units of half a step.
DISC = 2.5

#: The order of polynomials and the number of terms of series, with which defects of motions beside the motion are bounded.
ORDER, TERMS = 24, 32

#: The numbers of parts of a step in which a matrix is inverted at first and at most.
PARTS, MOST_PARTS = 4, 256

#: The largest distance (rad or m, and per s) of the exact motion from the polynomials, which the bounds assume.
TUBE = 2.0**-40


class TooLong(Exception):
    """A step is too long for its bounds."""


class TooFar(Exception):
    """Errors grow beyond what the proof assumes."""


def slack(tree: Tree, part: Part, begin: Any) -> Ball:
    """A bound of the changes of the coefficients u within a step, in which they are `begin` at first."""
    defects = arb_mat([[value] for value in _defects(tree, part)])
    with precision(COARSE_BITS):
        motion = _coarse(part)
        beside, by_r, by_u = _defects_beside(tree, part, motion), arb(0), arb(0)
        for inverse, rest in _inverses(tree, part, motion[0]):
            by_r = larger(by_r, norm(inverse * defects) / rest)
            by_u = larger(by_u, norm(inverse * beside) / rest)
        if not by_u < 0.2:
            raise TooLong
        most = (norm(begin) + 2 * by_r) / (1 - 2 * by_u)
        rate = ball(1 / part.half)
        for row in part.beside:
            position = sum((_bound(p.coeffs(), arb(1)) for p in row), arb(0)) * most
            velocity = sum((_bound(p.derivative().coeffs(), arb(1)) for p in row), arb(0)) * most * rate
            if not (position < TUBE and velocity < TUBE):
                raise TooFar
        return arb((2 * (by_r + by_u * most)).upper())


def _inverses(tree: Tree, part: Part, coordinates: list[Any]) -> list[tuple[Any, Ball]]:
    """For parts of a step that cover it, the entries of a matrix A and a lower bound of 1 - |A K - 1|.

    The entries are the absolute values of the columns of A that belong to M P', times half^2.
    """
    size = len(coordinates)
    polynomials, rest = _momenta(tree, part, coordinates)
    rows = part.beside + polynomials
    slopes = [[p.derivative() for p in row] for row in rows]
    off = arb_mat([[arb(0)] * 2 * size] * size + rest)
    square, pairs = ball(part.half**2), []
    waiting = [(2 * i + 1 - PARTS, PARTS) for i in range(PARTS)]
    while waiting:
        number, count = waiting.pop()
        middle, within = arb(number / count), arb(number / count, 1 / count)
        whole = _evaluated(rows, middle)
        near = np.linalg.pinv(doubles_of(whole))
        inverse = arb_mat(near.tolist())
        changes = inverse * (_evaluated(slopes, within) * arb(0, 1 / count) + off)
        left = 1 - norm(inverse * whole - identity(2 * size) + changes)
        if left > 0.1:
            pairs.append((arb_mat(np.abs(near[:, size:]).tolist()) * square, left))
        elif count < MOST_PARTS:
            waiting += [(2 * number - 1, 2 * count), (2 * number + 1, 2 * count)]
        else:
            raise TooLong
    return pairs


def _momenta(tree: Tree, part: Part, coordinates: list[Any]) -> tuple[list[list[Any]], list[list[Ball]]]:
    """Polynomials (n, 2 n) near to M P' within a step and the tube around the motion, and balls that contain the rests."""
    size = len(coordinates)
    columns = [[p.derivative() for p in row] for row in part.beside]

    def slopes(seen: Callable[[Any], Any]) -> list[dict[int, Any]]:
        q, zeros = [seen(p) for p in coordinates], [0] * size
        none: list[dict[int, Any]] = [{}] * size
        return along(tree, (q, zeros, zeros), _turns(q), (none, none, [dict(enumerate(map(seen, row))) for row in columns]))

    series, largest = _both(slopes)
    polynomials = [[arb_poly(_coefficients(row.get(j, 0))) for j in range(2 * size)] for row in series]
    rests = [[arb(0, _rest(row.get(j, 0), TERMS).upper()) for j in range(2 * size)] for row in largest]
    return polynomials, rests


def _evaluated(rows: list[list[Any]], x: Ball) -> Any:
    return arb_mat([[p(x) for p in row] for row in rows])


def _turns(q: list[Any]) -> tuple[list[Any], list[Any]]:
    """The sines and cosines of coordinates."""
    return [value.sin() for value in q], [value.cos() for value in q]


def _defects(tree: Tree, part: Part) -> list[Ball]:
    """Bounds of the defect of each joint within a step."""
    bits = ctx.prec
    terms = max(part.motion[0].degree() + 2, round(bits / math.log2(DISC)))
    motion = _derived(part.motion, part.half)
    series = _in_series(terms, lambda: _efforts(tree, [[arb_series(p.coeffs(), terms) for p in each] for each in motion]))
    with precision(COARSE_BITS):
        largest = _efforts(tree, [[_on_disc(p) for p in each] for each in motion])
        return [_whole(of_series, of_disc, terms) for of_series, of_disc in zip(series, largest, strict=True)]


def _defects_beside(tree: Tree, part: Part, motion: list[list[Any]]) -> Any:
    """Bounds (n, 2 n) of the defects of the motions beside the motion, within a step and the tube around the motion."""
    size = len(part.motion)
    columns = [_derived([row[j] for row in part.beside], part.half) for j in range(2 * size)]

    def slopes(seen: Callable[[Any], Any]) -> list[dict[int, Any]]:
        q, v, a = ([seen(p) for p in each] for each in motion)
        directions = [[{j: seen(columns[j][which][i]) for j in range(2 * size)} for i in range(size)] for which in range(3)]
        return along(tree, (q, v, a), _turns(q), directions)

    series, largest = _both(slopes)
    return arb_mat([[_whole(series[i].get(j, 0), largest[i].get(j, 0), TERMS) for j in range(2 * size)] for i in range(size)])


def _both(slopes: Callable[[Callable[[Any], Any]], list[dict[int, Any]]]) -> tuple[list[dict[int, Any]], list[dict[int, Any]]]:
    """Derivatives as power series, and their largest values on the disc. slopes: computes them from views of polynomials."""
    return _in_series(TERMS, lambda: slopes(lambda p: arb_series(p.coeffs(), TERMS))), slopes(_on_disc)


def _in_series(terms: int, compute: Callable[[], Any]) -> Any:
    """The result of a computation with power series of some terms."""
    before, ctx.cap = ctx.cap, terms
    try:
        return compute()
    finally:
        ctx.cap = before


def _efforts(tree: Tree, motion: Sequence[list[Any]]) -> list[Any]:
    q, v, a = motion
    return efforts(tree, q, v, a, *_turns(q))


def _derived(polynomials: list[Any], half: Fraction) -> list[list[Any]]:
    """Polynomials in x with their first and second derivatives by time."""
    rate = ball(1 / half)
    first = [p.derivative() * rate for p in polynomials]
    return [polynomials, first, [p.derivative() * rate for p in first]]


def _coarse(part: Part) -> list[list[Any]]:
    """The coordinates, velocities and accelerations in the tube around the motion as polynomials of low order, with balls."""
    motion = []
    for tube, polynomials in zip((TUBE, TUBE, 0.0), _derived(part.motion, part.half), strict=True):
        each = []
        for p in polynomials:
            first, *rest = p.coeffs()[: ORDER + 1] or [arb(0)]
            off = _bound(p.coeffs()[ORDER + 1 :], arb(1)) + tube
            each.append(arb_poly([_around(first, off), *rest]))
        motion.append(each)
    return motion


def _whole(series: Any, largest: Any, terms: int) -> Ball:
    """A bound of a function within a step, from its series in x and its largest value on the disc."""
    return arb((_bound(_coefficients(series), arb(1)) + _rest(largest, terms)).upper())


def _coefficients(series: Any) -> list[Ball]:
    return list(series.coeffs()) if isinstance(series, arb_series) else [arb(series)]


def _rest(largest: Any, terms: int) -> Ball:
    """A bound of what follows after some terms of a series, from the largest value of the function on the disc."""
    top = arb(abs(largest)) if isinstance(largest, int) else arb(abs(largest).upper())
    return top * arb(DISC) ** -terms / (1 - 1 / arb(DISC))


def _bound(coefficients: Sequence[Ball], radius: Ball) -> Ball:
    """A bound of a series on a disc."""
    whole = arb(0)
    for value in reversed(coefficients):
        whole = whole * radius + abs(value)
    return whole


def _on_disc(polynomial: Any) -> Any:
    """The values of a polynomial on the disc, as a complex ball."""
    first, *rest = polynomial.coeffs() or [arb(0)]
    most = (_bound(rest, arb(DISC)) * DISC).upper()
    return acb(arb(first), arb(0)) + acb(arb(0, most), arb(0, most))


def _around(value: Ball, radius: Ball) -> Ball:
    return value + arb(0, radius.upper())


def norm(matrix: Any) -> Ball:
    """An upper bound of the largest sum of absolute values in a row."""
    whole = arb(0)
    for row in matrix.tolist():
        whole = larger(whole, sum((abs(value) for value in row), arb(0)))
    return whole


def larger(one: Ball, other: Ball) -> Ball:
    """The larger of two upper bounds."""
    return arb(one.max(other).upper())
