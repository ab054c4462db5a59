"""Integration by Gauss-Legendre collocation in the widest type of NumPy, all nodes of a step at once.

A step is solved for the derivatives at its nodes by Picard's iteration, accelerated by Anderson's method (J. ACM 12, 547,
1965), which also converges where a few directions of the iteration do not contract, such as close to a singular position of a
mechanism. Within a step, the derivatives are a series of Legendre polynomials; the decrease of its terms determines the size of
the next step.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.polynomial import legendre

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.numbers import MP, Wide, wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.trajectory import Array

#: A function from states (s, k) to their derivatives (s, k).
Derivatives = Callable[[WideArray], WideArray]

#: A function that corrects a state (k,), for instance by moving it back onto constraints.
Corrected = Callable[[WideArray], WideArray]

#: Largest number of iterations of a step, and number of the last iterations that Anderson's method combines by default.
_ITERATIONS, _MEMORY = 80, 25

#: The smallest tolerance: relative size of the last terms of the series of a step that rounding in the wide type allows.
FINEST = 2 * float(np.finfo(Wide).eps)

#: The change of an iteration below which a step has converged, and the size of the last terms of its series below which it is
#: accepted, both in units of the tolerance.
_CHANGE, _TAKEN = 5, 30

#: Relative size of a column after the columns before it are projected out, up to which it counts as dependent on them.
_DEPENDENT = 1e-13

#: Relative size of terms of a series below which rounding hides them.
_HIDDEN = 1e-15

#: Smallest and largest ratio of the sizes of consecutive steps, and the ratios of sizes that are tried to solve a step.
_SMALLER, _LARGER = 0.4, 2.5
_SIZES = (1.0, 0.62, 0.38, 1.45, 0.8, 0.23, 0.14, 0.07, 0.03, 0.01, 1e-3, 1e-4, 1e-5)

#: Relative size, in a step that is accepted, of rounding errors that a singular position has magnified.
_MAGNIFIED = 1e-11


@dataclass(frozen=True, eq=False)
class Rule:
    """Gauss-Legendre collocation with s nodes in [0, 1].

    Attributes
    ----------
    nodes
        (s,) the nodes.
    inside, across
        (s, s) integrals from 0 to each node, and (s,) integrals from 0 to 1, of the polynomials that are 1 at one node and 0 at
        the other nodes.
    series
        (s, s) the coefficients of the Legendre series of these polynomials.
    """

    nodes: WideArray
    inside: WideArray
    across: WideArray
    series: WideArray


@cache
def rule(stages: int) -> Rule:
    """The rule with the given number of nodes. It is computed from Legendre series, whose integrals are known."""
    x = np.array([MP.mpf(float(node)) for node in legendre.leggauss(stages)[0]])
    for _ in range(4):
        # Newton's iteration with a hundred digits; the derivative follows from the polynomials of the two highest degrees.
        values = _polynomials(x, stages)
        x = x - values[stages] * (x * x - 1) / (stages * (x * values[stages] - values[stages - 1]))
    values = _polynomials(x, stages)
    weights = 2 * (1 - x * x) / (stages * values[stages - 1]) ** 2
    series = np.array([(2 * n + 1) * values[n] * weights / 2 for n in range(stages)])
    return Rule(*(_rounded(each) for each in ((x + 1) / 2, _integrals(x, stages) @ series, weights / 2, series)))


def _rounded(values: Any) -> WideArray:
    return np.array([wide(value) for value in values.ravel()], dtype=Wide).reshape(values.shape)


def _polynomials(x: Any, degree: int) -> Any:
    """The Legendre polynomials (degree + 1, n) at points x (n,)."""
    values = [x * 0 + 1, x]
    for n in range(1, degree):
        values.append(((2 * n + 1) * x * values[n] - n * values[n - 1]) / (n + 1))
    return np.array(values)


def _integrals(x: Any, count: int) -> Any:
    """The integrals (n, count) of the first Legendre polynomials from -1 to x (n,), halved for the interval [0, 1]."""
    values = _polynomials(x, count + 1)
    first = (values[1] + 1) / 2
    rest = [(values[n + 1] - values[n - 1]) / (2 * (2 * n + 1)) for n in range(1, count)]
    return np.array([first, *rest]).T


class _Counted:
    """Equations that count how often they are evaluated."""

    def __init__(self, derivatives: Derivatives) -> None:
        self.derivatives, self.calls = derivatives, 0

    def __call__(self, states: WideArray) -> WideArray:
        self.calls += 1
        return self.derivatives(states)


@dataclass(frozen=True, eq=False)
class Step:
    """A solved step.

    Attributes
    ----------
    start, size
        The instant at which the step begins, and its length (s).
    state
        (k,) the state at its beginning.
    slopes
        (s, k) the derivatives at its nodes.
    error
        Relative size of the last terms of the series of the derivatives.
    """

    start: np.longdouble
    size: np.longdouble
    state: WideArray
    slopes: WideArray
    error: float

    @property
    def end(self) -> np.longdouble:
        """The instant at which the step ends (s)."""
        return self.start + self.size

    def at(self, times: WideArray) -> WideArray:
        """The states (n, k) at instants (n,) of the step."""
        used = rule(len(self.slopes))
        inside = 2 * (times - self.start) / self.size - 1
        states: WideArray = self.state + self.size * (_integrals(inside, len(self.slopes)) @ (used.series @ self.slopes))
        return states

    def last(self) -> WideArray:
        """The state (k,) at the end of the step."""
        state: WideArray = self.state + self.size * (rule(len(self.slopes)).across @ self.slopes)
        return state


@dataclass(frozen=True, eq=False)
class Integrated:
    """States (n, k), and the sum (n,) of the errors that the steps up to each instant have made, without their growth."""

    states: WideArray
    errors: Array


def integrate(
    derivatives: Derivatives,
    start: WideArray,
    times: Array | WideArray,
    *,
    stages: int,
    first: float,
    most: int,
    tolerance: float = FINEST,
    corrected: Corrected | None = None,
    memory: int = _MEMORY,
) -> Integrated:
    """The motion at ascending times (n,) >= 0, s, from a state (k,) at t = 0. See `steps` for the other parameters."""
    states, errors = np.empty((len(times), len(start)), dtype=Wide), np.empty(len(times))
    row = int(np.searchsorted(times, 0.0, side="right"))
    states[:row], errors[:row] = start, 0.0
    if row == len(times):
        return Integrated(states, errors)
    error_so_far = 0.0
    solved = steps(
        derivatives, start, stages=stages, first=first, most=most, tolerance=tolerance, corrected=corrected, memory=memory
    )
    for step in solved:
        error_so_far += max(step.error, FINEST) * float(step.size * np.abs(step.slopes).max())
        inside = int(np.searchsorted(times, step.end, side="right"))
        states[row:inside], errors[row:inside] = step.at(times[row:inside].astype(Wide)), error_so_far
        row = inside
        if row == len(times):
            break
    return Integrated(states, errors)


def steps(
    derivatives: Derivatives,
    start: WideArray,
    *,
    stages: int,
    first: float,
    most: int,
    tolerance: float = FINEST,
    corrected: Corrected | None = None,
    memory: int = _MEMORY,
) -> Iterator[Step]:
    """The endless sequence of steps from a state (k,) at t = 0.

    Parameters
    ----------
    derivatives
        The equations.
    start
        The state at t = 0.
    stages
        Number of nodes of a step.
    first
        The size at which the first step is tried (s).
    most
        Evaluations of the equations, of all nodes at once, after which the integration is given up.
    tolerance
        Relative size of the last terms of the series of a step.
    corrected
        A function that corrects the state after each step, such as a projection on constraints; None for no correction.
    memory
        Number of the last iterations that are combined. With 1, the iteration is Picard's, which is cheaper where it converges.

    Raises `OutOfReach` where no step can be solved or too many are needed.
    """
    used, state, t, h = rule(stages), start, Wide(0), Wide(first)
    guess: WideArray | None = None
    counted = _Counted(derivatives)
    while counted.calls < most:
        size, slopes, error = _step(counted, used, state, h, guess, tolerance, memory)
        step = Step(t, size, state, slopes, error)
        yield step
        state, t = step.last(), step.end
        state = corrected(state) if corrected else state
        grown = Wide(_factor(used, slopes, tolerance))
        guess, h = _continued(used, slopes, grown), size * grown
    raise OutOfReach(f"the motion needs more than {most} evaluations of its equations")


#: A solved step: its size (s), the derivatives (s, k) at its nodes, and the relative size of the last terms of their series.
_Solved = tuple[np.longdouble, WideArray, float]


def _step(
    derivatives: Derivatives,
    used: Rule,
    state: WideArray,
    h: np.longdouble,
    guess: WideArray | None,
    tolerance: float,
    memory: int,
) -> _Solved:
    """Solve a step from a state, with a size near h (s).

    Close to a singular position the accelerations have few digits, and a smaller step does not make its series shorter. Then
    the larger step, which has fewer nodes close to that position, is taken.
    """
    best: _Solved | None = None
    for factor in _SIZES:
        size = h * Wide(factor)
        slopes, error = _solved(derivatives, used, state, size, guess, _CHANGE * tolerance, memory)
        guess = None
        if slopes is None:
            continue
        if error < _TAKEN * tolerance:
            return size, slopes, error
        if best is not None and size < best[0] and best[2] < _MAGNIFIED and error > best[2] / 30:
            return best
        best = (size, slopes, error) if best is None or error < best[2] else best
    if best is None or best[2] > 1000 * _MAGNIFIED:
        raise OutOfReach("the motion cannot be continued: no step can be solved")
    return best


def _factor(used: Rule, slopes: WideArray, tolerance: float) -> float:
    """The factor by which the next step is larger, from the decrease of the terms of the series that rounding does not hide."""
    scale = np.abs(slopes).max(axis=0) + np.abs(slopes).max() / 20 + Wide(1e-300)
    terms = (np.abs(used.series @ slopes) / scale).max(axis=1).astype(float)
    # Terms of even and odd degree may differ.
    logarithms = np.log(np.maximum(terms[:-1], terms[1:]) + 1e-30)
    seen = int(np.max(np.flatnonzero(logarithms > math.log(_HIDDEN)), initial=4))
    half = seen // 2
    slope = (logarithms[seen] - logarithms[half]) / (seen - half)
    last = logarithms[seen] + slope * (len(logarithms) - seen) - math.log(2 * len(terms) * tolerance)
    # A step that is g times as large has terms of degree k that are g^k times as large.
    return float(np.clip(0.9 * math.exp(-last / len(terms)), _SMALLER, _LARGER))


def _continued(used: Rule, slopes: WideArray, grown: np.longdouble) -> WideArray:
    """The derivatives at the nodes of a step, extrapolated from the low terms of the series of the step before."""
    few = 6
    at = 1 + 2 * used.nodes * grown
    extended: WideArray = _polynomials(at, few)[:few].T @ (used.series @ slopes)[:few]
    return extended


def _solved(
    derivatives: Derivatives,
    used: Rule,
    state: WideArray,
    h: np.longdouble,
    guess: WideArray | None,
    enough: float,
    memory: int,
) -> tuple[WideArray | None, float]:
    """The derivatives at the nodes of a step, or None, and the relative size of the last terms of their series."""
    slopes = np.tile(derivatives(state[None]), (len(used.nodes), 1)) if guess is None else guess
    points: list[WideArray] = []
    residuals: list[WideArray] = []
    best = np.inf
    for iteration in range(_ITERATIONS):
        renewed = derivatives(state + h * (used.inside @ slopes))
        residual = renewed - slopes
        # The scale of a component is at least a twentieth of the largest scale, so that rounding errors of zero do not count.
        scale = np.abs(renewed).max(axis=0) + np.abs(renewed).max() / 20 + Wide(1e-300)
        change = float((np.abs(residual) / scale).max())
        if not np.isfinite(change):
            return None, np.inf
        if change < enough or (iteration > 8 and change < 200 * enough and change > 0.3 * best):
            terms = np.abs(used.series @ renewed)
            return renewed, float((terms[-2:] / scale).max()) / (2 * len(terms))
        if iteration > 10 and change > 1e3 * max(best, 1e-3):
            return None, np.inf
        best = min(best, change)
        points.append(slopes.ravel())
        residuals.append(residual.ravel())
        slopes = _mixed(points[-memory:], residuals[-memory:], np.tile(scale, len(used.nodes))).reshape(slopes.shape)
    return None, np.inf


def _mixed(points: list[WideArray], residuals: list[WideArray], scale: WideArray) -> WideArray:
    """The next iterate of Anderson's method: the combination of the last iterates whose linear residual is smallest."""
    latest = points[-1] + residuals[-1]
    if len(points) == 1:
        return latest
    steps = np.array([residuals[-1] - other for other in residuals[:-1]])
    sizes = np.abs(steps / scale).max(axis=1)
    steps, kept = steps[sizes > 0], [other for other, size in zip(range(len(points) - 1), sizes, strict=True) if size > 0]
    largest = np.abs(residuals[-1] / scale).max()
    if not (kept and largest):
        return latest
    unit = np.array([Wide(1) / size for size in sizes[sizes > 0]])
    weights = _fitted(steps / scale * unit[:, None], residuals[-1] / scale / largest) * largest * unit
    moves = np.array([latest - (points[other] + residuals[other]) for other in kept])
    mixed: WideArray = latest - weights @ moves
    return mixed


def _fitted(columns: WideArray, target: WideArray) -> WideArray:
    """The weights (k,) with which the sum of columns (k, n) is closest to a target (n,), by Gram and Schmidt's method.

    A column that is a linear combination of the columns before it has the weight zero.
    """
    count = len(columns)
    # Columns of the triangular factor; the last column belongs to the target.
    factor, rest = np.zeros((count, count + 1), dtype=Wide), np.concatenate([columns, target[None]])
    for index in range(count):
        direction = rest[index].copy()
        size = np.sqrt((direction * direction).sum())
        if size <= _DEPENDENT * np.sqrt((columns[index] * columns[index]).sum()):
            continue
        direction = direction / size
        factor[index, index:] = rest[index:] @ direction
        rest[index + 1 :] -= factor[index, index + 1 :, None] * direction
    weights = np.zeros(count, dtype=Wide)
    for index in reversed(range(count)):
        if factor[index, index]:
            weights[index] = (factor[index, count] - factor[index, :count] @ weights) / factor[index, index]
    return weights
