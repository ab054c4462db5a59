"""Linear systems z' = A z in balls: their states, and the first time at which a linear function of the state is zero.

States are exponentials of matrices. Between two times a linear function of the state is a Taylor polynomial, whose remainder is
bounded by a norm of A in which each component is measured in a unit of its own. Halving intervals shows where there is no root,
and the interval Newton method encloses the first one.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from flint import arb, arb_mat, arb_poly, ctx

from bodycheck.reference.proof.balls import Ball, dot
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.roots import Function, first_change, root_near

#: The number of steps in which a root is searched at once.
STEPS = 64

#: The length of a step in characteristic times of the system, and the part of it by which a root may be beyond its end.
STEP, BEYOND = 1.0, 1.25

Row = Sequence[Ball]


@dataclass(frozen=True, eq=False)
class System:
    """A matrix by its rows, and the units of the components of the state in which its norm is small."""

    rows: Sequence[Row]
    units: Sequence[Ball]

    @cached_property
    def matrix(self) -> arb_mat:
        """The matrix."""
        return arb_mat(len(self.rows), len(self.rows), [entry for row in self.rows for entry in row])

    @cached_property
    def norm(self) -> Ball:
        """The largest sum of the sizes of a row, in the units of the components."""
        sums = [
            sum((abs(entry) * unit for entry, unit in zip(row, self.units, strict=True)), arb(0)) / unit_of_row
            for row, unit_of_row in zip(self.rows, self.units, strict=True)
        ]
        return max((each.upper() for each in sums), key=float)

    @cached_property
    def step(self) -> Ball:
        """The exact length of a step of the search for a root (s); infinite if nothing changes."""
        norm = self.norm
        return arb.pos_inf() if norm.is_zero() else (arb(STEP) / norm).mid()

    def after(self, state: Row, t: Ball) -> list[Ball]:
        """The state after a time (s)."""
        flow = (self.matrix * t).exp() * arb_mat(len(state), 1, list(state))
        return list(flow.entries())

    def derivative(self, row: Row) -> list[Ball]:
        """The row of the derivative of a linear function of the state."""
        return list((arb_mat(1, len(row), list(row)) * self.matrix).entries())


@dataclass(frozen=True, eq=False)
class Guard:
    """A linear function of the state that is positive; at first, it and its derivatives may be zero, `zeros` in number."""

    name: str
    row: Row
    zeros: int = 0


def first_root(system: System, state: Row, guards: Sequence[Guard], end: Ball) -> tuple[Ball, Guard] | None:
    """Return the first time until an end (s) at which one of some functions is zero, with the function; None without one.

    Raises `NotEnclosed` if two are zero at times that are not known to be different, or if one may only touch zero.
    """
    step, terms = system.step, max(30, ctx.prec // 3)
    begin = arb(0)
    while guards and step.is_finite() and not begin > end:
        here = system.after(state, begin)
        each_root = ((_root_in_step(system, here, guard, terms, at_start=begin.is_zero()), guard) for guard in guards)
        roots = sorted(((root, guard) for root, guard in each_root if root is not None), key=lambda each: float(each[0].mid()))
        if roots:
            (first, guard), *later = roots
            if any(not first < each for each, _ in later):
                raise NotEnclosed("two changes of a motion whose order is not decided")
            if begin + first < end:
                return begin + first, guard
            if begin + first > end:
                return None
            raise NotEnclosed("a change of a motion at an instant at which a signal changes")
        begin = begin + step
    return None


def at_root(system: System, state: Row, row: Row, t: Ball) -> tuple[Ball, list[Ball]]:
    """Return the time and the state at a root of a function that is near to a time (s) for each state in some balls.

    The root is computed for the midpoints of the balls. The derivative by the state of what is at the root moves their radii,
    so that balls do not grow if errors do not: it is (1 - f g / (g f)) exp(A t) with the function g and the rate f there.
    """
    middle, around = [part.mid() for part in state], [arb(0, part.rad()) for part in state]
    slope = system.derivative(row)
    root = root_near(lambda s: dot(row, system.after(middle, s)), lambda s: dot(slope, system.after(middle, s)), t)
    ends, moved = system.after(state, t), system.after(around, t)
    rates = [dot(line, ends) for line in system.rows]
    earlier = dot(row, moved) / dot(row, rates)
    parts = zip(system.after(middle, root), moved, rates, strict=True)
    return root - earlier, [part + change - rate * earlier for part, change, rate in parts]


def _root_in_step(system: System, state: Row, guard: Guard, terms: int, *, at_start: bool) -> Ball | None:
    """The first root of a function in a step, from its begin; None if there is none."""
    step, norm = system.step, system.norm
    reach = arb(BEYOND) * step
    size = max((abs(value).upper() / unit for value, unit in zip(state, system.units, strict=True)), key=float)
    scale = dot([abs(entry) for entry in guard.row], list(system.units)) * size * (norm * reach).exp()
    zeros = guard.zeros if at_start else 0
    coefficients, row, factor = [], list(guard.row), arb(1)
    for order in range(terms):
        coefficients.append(dot(row, state) / factor)
        row, factor = system.derivative(row), factor * (order + 1)
    rest = scale * (norm * reach) ** terms / factor  # the factorial of the number of terms
    polynomial = arb_poly(coefficients[zeros:])
    error = arb(0, (rest / reach**zeros).upper())
    slope_error = arb(0, (rest * (terms + zeros) / reach ** (zeros + 1)).upper())
    slope = polynomial.derivative()
    value: Function = lambda t: polynomial(t) + error  # noqa: E731
    steepness: Function = lambda t: slope(t) + slope_error  # noqa: E731
    near = first_change(value, steepness, step)
    return None if near is None else root_near(value, steepness, near)
