"""The motion of a tree of links in balls, by a polynomial that is proved to be near to it.

A candidate for the motion, which may come from anywhere, is interpolated by a polynomial p in each of many steps. Its defect is
the effort r(t) that the motion p(t) needs beyond those that act. The defect is bounded by its Taylor series in balls, and what
follows after the last term by Cauchy's estimate: the effort is an entire function of time. The distance e of the exact motion
from p obeys

    M e'' + C e' + G e = -r,

with the derivatives M, C and G of the effort by accelerations, velocities and coordinates at points between both motions. In
coordinates in which M is nearly the identity, the lengths Y of e and V of e' are at most the solution of Y' = V, V' = g Y + c V
+ d with bounds g, c and d of the terms (Walter, Differential and Integral Inequalities, 1970), which is an exponential.
"""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
from flint import acb, arb, arb_mat, arb_poly, arb_series, ctx

from bodycheck.reference.proof.balls import Ball, ball, precision
from bodycheck.reference.proof.derivatives import jacobians
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.trees import Tree, efforts
from bodycheck.reference.trajectory import Array

#: The number of nodes of the polynomial in a step, for each bit of the precision.
NODES_PER_BIT = 0.36

#: The bits of a polynomial's coefficients that its interpolation loses, for each node: those of (1 + sqrt(2)).
LOSS = 1.3

#: Half of the length of a step, as a part of the time in which the fastest coordinate changes by one, and rounds of halving.
HALF, ROUNDS = 0.22, 4

#: The radius of the disc of Cauchy's estimate, as a multiple of half of a step.
DISC = 2.5

#: The number of parts of a step in which derivatives are bounded, the order of the polynomials that are used there, and bits.
PARTS, ORDER, COARSE_BITS = 8, 20, 64

#: The largest distance (rad or m, and per s and s^2) of the exact motion from the polynomials, which the bounds assume.
TUBE = 2.0**-40

#: A candidate: a function from ascending times (n,), s, and a number of bits to the coordinates of links (n, k), as balls.
Candidate = Callable[[Array, int], list[list[Ball]]]


@dataclass(frozen=True, eq=False)
class Step:
    """A polynomial near to the motion from `begin` to `end` (s), about `centre`, and bounds of its distance from it.

    Attributes
    ----------
    begin, end, centre
        Times (s).
    polynomials
        The polynomial of each coordinate.
    scales
        The lengths of the rows of the matrix from the coordinates of the bounds to those of the links.
    apart, rate
        Bounds of the lengths Y and V within the step.
    """

    begin: Fraction
    end: Fraction
    centre: Fraction
    polynomials: list[Any]
    scales: list[float]
    apart: Ball
    rate: Ball

    def at(self, t: Fraction) -> tuple[list[Ball], list[Ball]]:
        """The coordinates and their velocities at a time within the step."""
        since = ball(t - self.centre)
        pairs = list(zip(self.polynomials, self.scales, strict=True))
        q = [_around(p(since), self.apart * ball(scale)) for p, scale in pairs]
        v = [_around(p.derivative()(since), self.rate * ball(scale)) for p, scale in pairs]
        return q, v


def _around(value: Ball, radius: Ball) -> Ball:
    return value + arb(0, radius.upper())


def steps(tree: Tree, duration: Fraction, fastest: float, candidate: Candidate, bits: int, deadline: float) -> list[Step]:
    """Return the steps of a motion from 0 to a duration (s), with the precision of the context.

    They end earlier where errors grow too much for this precision, or the deadline has passed. fastest: a rate (1/s) at which
    coordinates change. candidate: see `Candidate`. deadline: the last time of `time.perf_counter` (s). Raises `NotEnclosed` if
    no step length leads to bounds.
    """
    half = HALF / fastest
    for _ in range(ROUNDS):
        try:
            return _steps(tree, duration, half, candidate, bits, deadline)
        except TooLong:
            half /= 2
    raise NotEnclosed("a mass matrix that changes too much within the shortest step")


class TooLong(Exception):
    """A step is too long for its bounds."""


class TooFar(Exception):
    """Errors grow beyond what the proof assumes."""


def _steps(tree: Tree, duration: Fraction, half: float, candidate: Candidate, bits: int, deadline: float) -> list[Step]:
    count = max(1, math.ceil(float(duration) / (2 * half)))
    edges = [Fraction(float(duration) * number / count) for number in range(count)] + [duration]
    nodes = max(12, round(NODES_PER_BIT * bits))
    cosines = np.cos(np.pi * (2 * np.arange(nodes) + 1) / (2 * nodes))[::-1]
    centres = [(begin + end) / 2 for begin, end in pairwise(edges)]
    widths = [float(end - begin) / 2 for begin, end in pairwise(edges)]
    times = np.concatenate([float(centre) + width * cosines for centre, width in zip(centres, widths, strict=True)])
    digits = bits + round(LOSS * nodes)
    with precision(digits):
        values = candidate(times, digits)
    done: list[Step] = []
    last: _Bounds | None = None
    for number, (centre, begin, end) in enumerate(zip(centres, edges[:-1], edges[1:], strict=True)):
        rows = slice(number * nodes, (number + 1) * nodes)
        xs = [ball(Fraction(instant) - centre) for instant in times[rows].tolist()]
        columns = zip(*values[rows], strict=True)
        with precision(2 * bits + round(2 * LOSS * nodes)):
            polynomials = [_interpolated(xs, list(column)) for column in columns]
        try:
            last = _bounded(tree, polynomials, centre, begin, end, last)
        except TooFar:
            break
        done.append(Step(begin, end, centre, polynomials, _scales(last.frame), last.apart, last.rate))
        if time.perf_counter() > deadline:
            break
    return done


def _scales(frame: Array) -> list[float]:
    """The lengths of the rows of a matrix, rounded up."""
    return [float(np.linalg.norm(row)) * (1 + 1e-9) for row in frame]


def _interpolated(xs: list[Ball], values: list[Ball]) -> Any:
    """The polynomial through some values, with the midpoints of coefficients: any polynomial will do."""
    largest = xs[-1]
    polynomial = arb_poly.interpolate([x / largest for x in xs], values)
    coefficients, power = [], arb(1)
    for value in polynomial.coeffs():
        coefficients.append((value / power).mid())
        power = power * largest
    return arb_poly(coefficients)


@dataclass(frozen=True, eq=False)
class _Bounds:
    """The bounds at the end of a step, in coordinates y with e = frame y, and its polynomials about its centre."""

    frame: Array
    apart: Ball
    rate: Ball
    polynomials: list[Any]
    centre: Fraction


def _bounded(
    tree: Tree, polynomials: list[Any], centre: Fraction, begin: Fraction, end: Fraction, before: _Bounds | None
) -> _Bounds:
    """The bounds at the end of a step from those at the end of the step before it; None at the start of the motion."""
    half = ball((end - begin) / 2)
    defects = _defects(tree, polynomials, half)
    frame = _frame(tree, polynomials)
    apart, rate = _begun(tree, polynomials, frame, ball(begin - centre), begin, before)
    coarse = [arb_poly(p.coeffs()[: ORDER + 1]) for p in polynomials]
    with precision(COARSE_BITS):
        rests = [_rest(p, half) for p in polynomials]
        part = 2 * half / PARTS
        sizes = [[ball(abs(value)) for value in column] for column in frame.T.tolist()]
        defect = _norm([sum((size * each for size, each in zip(column, defects, strict=True)), arb(0)) for column in sizes])
        scale = arb(max(_scales(frame)))
        for number in range(PARTS):
            middle = -half + part * (2 * number + 1) / 2
            ranges = _ranges(coarse, rests, _around(middle, part / 2))
            g, c, a = _growth(tree, frame, *ranges)
            apart, rate = _grown(apart, rate, g, c, defect / (1 - a), part)
            change = (g * apart + c * rate + defect) / (1 - a)
            if not all(value.is_finite() and scale * value < arb(TUBE) for value in (apart, rate, change)):
                raise TooFar
    return _Bounds(frame, apart, rate, polynomials, centre)


def _defects(tree: Tree, polynomials: list[Any], half: Ball) -> list[Ball]:
    """Bounds of the defect of each joint within a step."""
    terms = polynomials[0].degree() + 1
    terms += terms // 2
    before, ctx.cap = ctx.cap, terms
    try:
        q = [arb_series(p.coeffs(), terms) for p in polynomials]
        v = [arb_series(p.derivative().coeffs(), terms) for p in polynomials]
        a = [arb_series(p.derivative().derivative().coeffs(), terms) for p in polynomials]
        series = efforts(tree, q, v, a, [each.sin() for each in q], [each.cos() for each in q])
    finally:
        ctx.cap = before
    with precision(COARSE_BITS):
        disc = half * arb(DISC)
        q, v, a = ([_on_disc(part, disc) for part in parts] for parts in _with_derivatives(polynomials))
        largest = efforts(tree, q, v, a, [each.sin() for each in q], [each.cos() for each in q])
        tail = (half / disc) ** terms / (1 - half / disc)
        bounds = []
        for defect, most in zip(series, largest, strict=True):
            coefficients = defect.coeffs() if isinstance(defect, arb_series) else [arb(defect)]
            top = abs(most).upper() if not isinstance(most, int) else arb(abs(most))
            bounds.append(arb((_series_bound(coefficients, half) + top * tail).upper()))
    return bounds


def _with_derivatives(polynomials: list[Any]) -> list[list[Any]]:
    first = [p.derivative() for p in polynomials]
    return [polynomials, first, [p.derivative() for p in first]]


def _series_bound(coefficients: Sequence[Ball], half: Ball) -> Ball:
    whole, power = arb(0), arb(1)
    for value in coefficients:
        whole, power = whole + abs(value) * power, power * half
    return whole


def _on_disc(polynomial: Any, radius: Ball) -> Any:
    """The values of a polynomial on a disc about 0, as a complex ball."""
    first, *rest = polynomial.coeffs() or [arb(0)]
    most = (_series_bound(rest, radius) * radius).upper()
    return acb(arb(first), arb(0)) + acb(arb(0, most), arb(0, most))


def _rest(polynomial: Any, half: Ball) -> tuple[Ball, Ball, Ball]:
    """Bounds of the terms after `ORDER` of a polynomial and its derivatives within a step."""
    coefficients = [arb(0)] * (ORDER + 1) + polynomial.coeffs()[ORDER + 1 :]
    rest = arb_poly(coefficients)
    first = rest.derivative()
    of_all = [_series_bound(p.coeffs(), half) for p in (rest, first, first.derivative())]
    return of_all[0], of_all[1], of_all[2]


def _ranges(coarse: list[Any], rests: list[tuple[Ball, Ball, Ball]], t: Ball) -> list[list[Ball]]:
    """The coordinates, velocities and accelerations within a part of a step, and in the tube around them."""
    ranges = []
    for index, polynomials in enumerate(_with_derivatives(coarse)):
        ranges.append([_around(p(t), rest[index] + arb(TUBE)) for p, rest in zip(polynomials, rests, strict=True)])
    return ranges


def _frame(tree: Tree, polynomials: list[Any]) -> Array:
    """A matrix of doubles that makes the mass matrix in the middle of a step nearly the identity: frame^T M frame = 1."""
    with precision(COARSE_BITS):
        q = [p(arb(0)) for p in polynomials]
        still = [arb(0)] * len(q)
        mass = np.array([[float(value) for value in row] for row in jacobians(tree, q, still, still)[2]])
    try:
        return np.asarray(np.linalg.inv(np.linalg.cholesky(mass)).T)
    except np.linalg.LinAlgError:
        raise NotEnclosed("a mass matrix that is singular") from None


def _growth(tree: Tree, frame: Array, q: list[Ball], v: list[Ball], a: list[Ball]) -> tuple[Ball, Ball, Ball]:
    """Bounds of the terms by coordinates and by velocities, and of the distance of the mass matrix from the identity."""
    by_q, by_v, by_a = (_seen(frame, rows) for rows in jacobians(tree, q, v, a))
    for index in range(len(frame)):
        by_a[index][index] = by_a[index][index] - 1
    a_part = _norm([entry for row in by_a for entry in row])
    if not a_part < 0.9:
        raise TooLong
    rest = 1 - a_part
    g, c = (_norm([entry for row in rows for entry in row]) / rest for rows in (by_q, by_v))
    return g, c, a_part


def _seen(frame: Array, rows: list[list[Ball]]) -> list[list[Ball]]:
    """The matrix frame^T rows frame."""
    turn = arb_mat([[arb(value) for value in row] for row in frame.tolist()])
    seen = turn.transpose() * arb_mat([list(row) for row in rows]) * turn
    return [[seen[i, j] for j in range(len(frame))] for i in range(len(frame))]


def _norm(entries: list[Ball]) -> Ball:
    """An upper bound of the root of the sum of squares, as an exact number."""
    return arb(sum((entry * entry for entry in entries), arb(0)).upper().sqrt().upper())


def _begun(
    tree: Tree, polynomials: list[Any], frame: Array, since: Ball, begin: Fraction, before: _Bounds | None
) -> tuple[Ball, Ball]:
    """Bounds of the distance of the motion from the polynomials at the begin of a step."""
    inverse = arb_mat([[arb(value) for value in row] for row in frame.tolist()]).inv()
    size = len(frame)
    now = [[p(since) for p in polynomials], [p.derivative()(since) for p in polynomials]]
    if before is None:
        was = [[ball(link.start) for link in tree.links], [ball(link.velocity) for link in tree.links]]
        apart = rate = arb(0)
    else:
        then = ball(begin - before.centre)
        was = [[p(then) for p in before.polynomials], [p.derivative()(then) for p in before.polynomials]]
        old = arb_mat([[arb(value) for value in row] for row in before.frame.tolist()])
        change = inverse * old
        factor = _spectral(change)
        apart, rate = factor * before.apart, factor * before.rate
    jumps = []
    for one, other in zip(now, was, strict=True):
        jump = inverse * arb_mat([[x - y] for x, y in zip(one, other, strict=True)])
        jumps.append(_norm([jump[i, 0] for i in range(size)]))
    return arb((apart + jumps[0]).upper()), arb((rate + jumps[1]).upper())


def _spectral(matrix: Any) -> Ball:
    """An upper bound of the spectral norm of a matrix: the root of the product of its largest sums of rows and of columns."""
    size = matrix.nrows()
    entries = [[abs(matrix[i, j]).upper() for j in range(size)] for i in range(size)]
    rows = max((sum(row, arb(0)) for row in entries), key=lambda value: float(value.mid()))
    columns = max((sum(column, arb(0)) for column in zip(*entries, strict=True)), key=lambda value: float(value.mid()))
    return arb((rows * columns).upper().sqrt().upper())


def _grown(apart: Ball, rate: Ball, g: Ball, c: Ball, defect: Ball, t: Ball) -> tuple[Ball, Ball]:
    """The bounds after a time, from Y' = V, V' = g Y + c V + defect.

    The exponential grows with time, so that a defect does not more than if it acted all at once in the beginning.
    """
    flow = arb_mat(2, 2, [arb(0), t, g * t, c * t]).exp()
    begin = rate + defect * t
    after = [flow[i, 0] * apart + flow[i, 1] * begin for i in (0, 1)]
    return arb(after[0].upper()), arb(after[1].upper())
