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
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from flint import arb, arb_mat

from bodycheck.reference.proof.balls import Ball, ball, precision
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.trees.defects import TooFar, TooLong, slack
from bodycheck.reference.proof.trees.polynomials import COARSE_BITS, Candidate, Part, doubles_of, identity, mesh, parts
from bodycheck.reference.proof.trees.tree import Tree
from bodycheck.reference.trajectory import Array

#: Rounds in which all steps are halved.
ROUNDS = 3

#: The part of the steps in which the time for a candidate is measured, and the part of the remaining time that it may take.
SAMPLE, SHARE = 1 / 16, 0.5


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


def steps(tree: Tree, duration: Fraction, candidate: Candidate, bits: int, deadline: float) -> list[Step]:
    """Return the steps of a motion from 0 to a duration (s), with the precision of the context.

    They end earlier where errors grow too much for this precision, or the deadline has passed. candidate: see `Candidate`.
    deadline: the last time of `time.perf_counter` (s). Raises `NotEnclosed` if no step length leads to bounds.
    """
    lengths = mesh(tree, duration, candidate)
    for _ in range(ROUNDS):
        try:
            return _carried(tree, parts(tree, _affordable(tree, lengths, candidate, bits, deadline), candidate, bits), deadline)
        except TooLong:
            lengths = [(centre + side * half / 2, half / 2) for centre, half in lengths for side in (-1, 1)]
    raise NotEnclosed("a mass matrix that changes too much within the shortest step")


def _affordable(
    tree: Tree, lengths: list[tuple[Fraction, Fraction]], candidate: Candidate, bits: int, deadline: float
) -> list[tuple[Fraction, Fraction]]:
    """The first steps for which there is time to compute a candidate, which cannot be interrupted."""
    parts(tree, lengths[:1], candidate, bits)  # the first call may compile the equations
    few = math.ceil(SAMPLE * len(lengths))
    begin = time.perf_counter()
    parts(tree, lengths[:few], candidate, bits)
    now = time.perf_counter()
    allowed = SHARE * (deadline - now) / (now - begin)
    return lengths if allowed >= len(lengths) / few else lengths[: max(few, int(allowed * few))]


def _carried(tree: Tree, parts: list[Part], deadline: float) -> list[Step]:
    """The steps with the polynomials of `parts`, as far as there are bounds and time."""
    done: list[Step] = []
    start = [value for link in tree.links for value in link.start]
    start += [value * ball(parts[0].half) for link in tree.links for value in link.velocity]
    last: Step | None = None
    for part in parts:
        try:
            axes, box = _begun(part, arb_mat([[value] for value in start]) if last is None else last)
            bound = slack(tree, part, axes * box)
        except (TooFar, ZeroDivisionError):  # the latter is that of a matrix of balls without an inverse
            break
        last = Step(part, axes, box, bound)
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
            return identity(2 * size), part.deviations(arb(-1)).solve(jump)
    scale = [arb(1)] * size + [ball(part.half / before.part.half)] * size
    ends = before.part.states(arb(1))
    jump = arb_mat([[factor * ends[i, 0]] for i, factor in enumerate(scale)]) - part.states(arb(-1))
    with precision(COARSE_BITS):
        now, ends = part.deviations(arb(-1)), before.part.deviations(arb(1))
        ends = arb_mat([[factor * ends[i, j] for j in range(2 * size)] for i, factor in enumerate(scale)])
        change = now.solve(ends)
        carried = change * before.axes
        axes = arb_mat(_orthogonal(doubles_of(carried), [float(before.box[i, 0].abs_upper()) for i in range(2 * size)]))
        back = axes.inv()
        box = (back * carried) * before.box + (back * change) * _cube(2 * size, before.slack) + back * now.solve(jump)
    return axes, box


def _orthogonal(axes: Array, lengths: list[float]) -> list[list[float]]:
    """Orthogonal axes near to some axes, the longest first."""
    scaled = axes * np.maximum(np.array(lengths), 1e-300)
    order = np.argsort(-np.linalg.norm(scaled, axis=0))
    return np.linalg.qr(axes[:, order])[0].tolist()  # type: ignore[no-any-return]


def _cube(size: int, half: Ball) -> Any:
    """A vector of balls about 0."""
    return arb_mat([[arb(0, half.upper())] for _ in range(size)])
