"""The motion of a tree of links in balls, by polynomials that are proved to be near to it.

A candidate for the motion, which may come from anywhere, is interpolated by a polynomial p in each of many steps. Its defect is
the effort r(t) that the motion p(t) needs beyond those that act. The defect is bounded by its Taylor series in balls, and what
follows after the last term by Cauchy's estimate: the effort is an entire function of time. The distance e of the exact motion
from p obeys

    M e'' + C e' + G e = -r,

with the derivatives M, C and G of the effort by accelerations, velocities and coordinates at points between both motions.
Polynomials P near to the solutions of M P'' + C P' + G P = 0 (`flow`) have a defect R likewise. The coefficients u with
e = P u and e' = P' u obey P u' = 0 and M P' u' = -r - R u, and are nearly constant in a step. From step to step they lie in a
parallelepiped, whose axes are made orthogonal at each step in the order of their lengths (Lohner, 1987).
"""

import math
import time
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from flint import acb, arb, arb_mat, arb_poly, arb_series, ctx, fmpq

from bodycheck.reference.proof.balls import Ball, ball, precision
from bodycheck.reference.proof.derivatives import along, each_alone
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.flow import flows
from bodycheck.reference.proof.trees import Tree, efforts
from bodycheck.reference.trajectory import Array

#: The number of nodes of the polynomial in a step, for each bit of the precision.
NODES_PER_BIT = 0.36

#: The bits of a polynomial's coefficients that its interpolation loses, for each node: those of (1 + sqrt(2)).
LOSS = 1.3

#: Half of the length of a step, as a part of the time in which the fastest coordinate changes by one, and rounds of halving.
HALF, ROUNDS = 0.22, 4

#: Bits of the nodes and of the lengths of steps, so that all times are doubles.
NODE_BITS, LENGTH_BITS = 20, 12

#: The radius of the disc of Cauchy's estimate, in units of half a step.
DISC = 2.5

#: The order of the polynomials and series, and the bits, with which defects of motions beside the motion are bounded.
ORDER, TERMS, COARSE_BITS = 24, 32, 64

#: The numbers of parts of a step in which a matrix is inverted.
PARTS = (4, 16, 64)

#: The largest distance (rad or m, and per s) of the exact motion from the polynomials, which the bounds assume.
TUBE = 2.0**-40

#: A candidate: a function from ascending times (n,), s, and a number of bits to the coordinates of links (n, k), as balls.
Candidate = Callable[[Array, int], list[list[Ball]]]


class TooLong(Exception):
    """A step is too long for its bounds."""


class TooFar(Exception):
    """Errors grow beyond what the proof assumes."""


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


@dataclass(frozen=True, eq=False)
class Step:
    """The motion in a step: its distance from the polynomials is P (axes box + u), with |u| at most `slack`."""

    part: Part
    axes: Any
    box: Any
    slack: Ball

    @property
    def end(self) -> Fraction:
        """The end of the step (s)."""
        return self.part.end

    def at(self, t: Fraction) -> tuple[list[Ball], list[Ball]]:
        """The coordinates and their velocities at a time within the step."""
        x, size = ball((t - self.part.centre) / self.part.half), len(self.part.motion)
        states = self.part.states(x)
        with precision(COARSE_BITS):
            deviations = self.part.deviations(x)
            off = deviations * self.axes * self.box + deviations * _cube(2 * size, self.slack)
        states += off
        return [states[i, 0] for i in range(size)], [states[size + i, 0] / ball(self.part.half) for i in range(size)]


def steps(tree: Tree, duration: Fraction, pace: Callable[[float, float], float], candidate: Candidate, bits: int, deadline: float) -> list[Step]:
    """Return the steps of a motion from 0 to a duration (s), with the precision of the context.

    They end earlier where errors grow too much for this precision, or the deadline has passed. pace: the rate (1/s) at which
    coordinates change between two times. candidate: see `Candidate`. deadline: the last time of `time.perf_counter` (s). Raises
    `NotEnclosed` if no step length leads to bounds.
    """
    half = HALF
    for _ in range(ROUNDS):
        try:
            return _carried(tree, _parts(tree, _mesh(duration, pace, half), candidate, bits), deadline)
        except TooLong:
            half /= 2
    raise NotEnclosed("a mass matrix that changes too much within the shortest step")


def _mesh(duration: Fraction, pace: Callable[[float, float], float], half: float) -> list[tuple[Fraction, Fraction]]:
    """The centres and halves of steps that cover a duration (s)."""
    end = float(duration)
    count = max(1, math.ceil(end * pace(0.0, end) / (2 * half)))
    slowest = min(pace(end * i / count, end * (i + 1) / count) for i in range(count))
    count = max(1, math.ceil(end * slowest / (2 * half)))
    unit = Fraction(2) ** (math.frexp(end / count)[1] - LENGTH_BITS)
    width = math.ceil(Fraction(end) / count / unit) * unit
    mesh: list[tuple[Fraction, Fraction]] = []
    waiting = [(width * i, width) for i in range(count)][::-1]
    while waiting:
        begin, width = waiting.pop()
        if begin >= duration:
            break
        if float(width) * pace(float(begin), float(begin + width)) > 2 * half:
            waiting += [(begin + width / 2, width / 2), (begin, width / 2)]
        else:
            mesh.append((begin + width / 2, width / 2))
    return mesh


def _parts(tree: Tree, mesh: list[tuple[Fraction, Fraction]], candidate: Candidate, bits: int) -> list[Part]:
    """The polynomials in all steps."""
    count = max(12, round(NODES_PER_BIT * bits))
    cosines = np.cos(np.pi * (2 * np.arange(count) + 1) / (2 * count))[::-1]
    nodes = [Fraction(round(value * 2**NODE_BITS), 2**NODE_BITS) for value in cosines.tolist()]
    times = np.array([float(centre + half * node) for centre, half in mesh for node in nodes])
    digits = bits + round(LOSS * count)
    with precision(digits):
        values = candidate(times, digits)
    size = len(tree.links)
    with precision(2 * digits):
        powers = arb_mat([[ball(node**power) for power in range(count)] for node in nodes])
        columns = [[values[step * count + node][i] for step in range(len(mesh)) for i in range(size)] for node in range(count)]
        coefficients = (powers.inv() * arb_mat(columns)).mid()
    rows = coefficients.transpose().tolist()
    doubles = np.array([[float(value) for value in row[: ORDER + 1]] for row in rows]).reshape(len(mesh), size, -1)
    beside = flows(tree, doubles, np.array([float(half) for _, half in mesh]))
    return [
        Part(
            *where,
            [arb_poly(row) for row in rows[size * step : size * (step + 1)]],
            [[arb_poly(beside[step, :, i, j].tolist()) for j in range(2 * size)] for i in range(size)],
        )
        for step, where in enumerate(mesh)
    ]


def _carried(tree: Tree, parts: list[Part], deadline: float) -> list[Step]:
    """The steps with the polynomials of `parts`, as far as there are bounds and time."""
    done: list[Step] = []
    size = len(tree.links)
    start = [ball(link.start) for link in tree.links] + [ball(link.velocity * parts[0].half) for link in tree.links]
    last: Step | None = None
    for part in parts:
        axes, box = _begun(part, arb_mat([[value] for value in start]) if last is None else last)
        try:
            slack = _slack(tree, part, axes * box)
        except TooFar:
            break
        last = Step(part, axes, box, slack)
        done.append(last)
        if time.perf_counter() > deadline:
            break
    return done


def _begun(part: Part, before: Any) -> tuple[Any, Any]:
    """The axes and the box of a step from the step before it, or from the state at the start."""
    size = len(part.motion)
    if not isinstance(before, Step):
        jump = before - part.states(arb(-1))
        with precision(COARSE_BITS):
            return _identity(2 * size), part.deviations(arb(-1)).solve(jump)
    scale = [arb(1)] * size + [ball(part.half / before.part.half)] * size
    ends = before.part.states(arb(1))
    jump = arb_mat([[factor * ends[i, 0]] for i, factor in enumerate(scale)]) - part.states(arb(-1))
    with precision(COARSE_BITS):
        now, ends = part.deviations(arb(-1)), before.part.deviations(arb(1))
        ends = arb_mat([[factor * ends[i, j] for j in range(2 * size)] for i, factor in enumerate(scale)])
        change = now.solve(ends)
        carried = change * before.axes
        axes = arb_mat(_orthogonal(_doubles(carried), [float(before.box[i, 0].abs_upper()) for i in range(2 * size)]))
        back = axes.inv()
        box = (back * carried) * before.box + (back * change) * _cube(2 * size, before.slack) + back * now.solve(jump)
    return axes, box


def _orthogonal(axes: Array, lengths: list[float]) -> list[list[float]]:
    """Orthogonal axes near to some axes, the longest first."""
    scaled = axes * np.maximum(np.array(lengths), 1e-300)
    order = np.argsort(-np.linalg.norm(scaled, axis=0))
    return np.linalg.qr(axes[:, order])[0].tolist()  # type: ignore[no-any-return]


def _slack(tree: Tree, part: Part, begin: Any) -> Ball:
    """A bound of the changes of the coefficients u within a step, in which they are `begin` at first."""
    defects = arb_mat([[value] for value in _defects(tree, part)])
    with precision(COARSE_BITS):
        motion = _coarse(part)
        beside, by_r, by_u = _defects_beside(tree, part, motion), arb(0), arb(0)
        for inverse, rest in _inverses(tree, part, motion[0]):
            by_r = _larger(by_r, _norm(inverse * defects) / rest)
            by_u = _larger(by_u, _norm(inverse * beside) / rest)
        if not by_u < 0.2:
            raise TooLong
        most = (_norm(begin) + 2 * by_r) / (1 - 2 * by_u)
        rate = ball(1 / part.half)
        for row in part.beside:
            position = sum((_bound(p.coeffs(), arb(1)) for p in row), arb(0)) * most
            velocity = sum((_bound(p.derivative().coeffs(), arb(1)) for p in row), arb(0)) * most * rate
            if not (position < TUBE and velocity < TUBE):
                raise TooFar
        return arb((2 * (by_r + by_u * most)).upper())


def _inverses(tree: Tree, part: Part, coordinates: list[Any]) -> list[tuple[Any, Ball]]:
    """For parts of a step that cover it, the entries of a matrix A and a lower bound of 1 - |A K - 1|, where K = [P; M P'].

    The entries are the absolute values of the columns of A that belong to M P', times half^2.
    """
    for count in PARTS:
        pairs = [_inverse(tree, part, coordinates, arb((2 * i + 1) / count - 1, 1 / count)) for i in range(count)]
        if all(rest > 0.1 for _, rest in pairs):
            return pairs
    raise TooLong


def _inverse(tree: Tree, part: Part, coordinates: list[Any], x: Ball) -> tuple[Any, Ball]:
    size = len(coordinates)
    q = [p(x) for p in coordinates]
    slopes = along(tree, (q, [0] * size, [0] * size), _turns(q), each_alone(size, 2))
    mass = arb_mat([[arb(row.get(i, 0)) for i in range(size)] for row in slopes])
    rows = part.deviations(x).tolist()
    whole = arb_mat(rows[:size] + (mass * arb_mat(rows[size:])).tolist())
    near = np.linalg.pinv(_doubles(whole))
    square = ball(part.half**2)
    return arb_mat((np.abs(near[:, size:])).tolist()) * square, 1 - _norm(arb_mat(near.tolist()) * whole - _identity(2 * size))


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

    series = _in_series(TERMS, lambda: slopes(lambda p: arb_series(p.coeffs(), TERMS)))
    largest = slopes(_on_disc)
    return arb_mat([[_whole(series[i].get(j, 0), largest[i].get(j, 0), TERMS) for j in range(2 * size)] for i in range(size)])


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
    coefficients = series.coeffs() if isinstance(series, arb_series) else [arb(series)]
    top = arb(abs(largest)) if isinstance(largest, int) else arb(abs(largest).upper())
    tail = arb(DISC) ** -terms / (1 - 1 / arb(DISC))
    return arb((_bound(coefficients, arb(1)) + top * tail).upper())


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


def _identity(size: int) -> Any:
    return arb_mat(size, size, [int(i == j) for i in range(size) for j in range(size)])


def _cube(size: int, half: Ball) -> Any:
    """A vector of balls about 0."""
    return arb_mat([[arb(0, half.upper())] for _ in range(size)])


def _doubles(matrix: Any) -> Array:
    return np.array([[float(value) for value in row] for row in matrix.tolist()])


def _norm(matrix: Any) -> Ball:
    """An upper bound of the largest sum of absolute values in a row."""
    whole = arb(0)
    for row in matrix.tolist():
        whole = _larger(whole, sum((abs(value) for value in row), arb(0)))
    return whole


def _larger(one: Ball, other: Ball) -> Ball:
    """The larger of two upper bounds."""
    return arb(one.max(other).upper())
