"""The equations of a tree in heyoka's expressions, their parameters, and their solution by Taylor's method (Linux only).

One compilation serves all mechanisms whose trees have the same kinds of links on the same parents, dry friction at the same
joints, and zeros in the same places: all other numbers are parameters. heyoka keeps compiled code on disk. Importing this
module raises `ImportError` if heyoka is not installed.
"""

import contextlib
import functools
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, TypeVar

import heyoka as hy
import numpy as np

from bodycheck.reference.errors import Stopped
from bodycheck.reference.exact.numbers import MP, FloatType, Real, WideArray
from bodycheck.reference.integration.dop853 import MAX_STEPS
from bodycheck.reference.integration.heyoka_solver import Equations, dense, integrator, integrator_lock, solve, vectorised
from bodycheck.reference.mechanisms.articulation.articulated import Constants
from bodycheck.reference.mechanisms.growth import LARGEST, NUDGE, SMALL, UNSCALED
from bodycheck.reference.mechanisms.link_states import (
    Course,
    Form,
    LinkForm,
    derivatives,
    floating,
    forms_of,
    places_of_rates,
    sizes,
    split,
    start,
)
from bodycheck.reference.mechanisms.tree import Link, Tree
from bodycheck.reference.trajectory import Array

#: A solution of equations: states at times, or a function of times.
Solution = TypeVar("Solution")

#: The value of a number that is known when the equations are written: 0, 1 or -1, and None for a parameter.
Mark = int | None

#: The fields of `Constants` with several numbers, and the number of these.
_SIZES = {"turn": 9, "offset": 3, "moment": 3, "tensor": 6, "differences": 3}

#: The fields in which the numbers 1 and -1 are written into the equations, and the fields that change with the mode of a joint
#: with dry friction.
_WITH_ONES = ("turn", "ratio", "moves")
_CHANGING = ("force", "moves")

#: The largest number of coordinates for which the code is optimised, which takes up to ten seconds. For forty hinges in space
#: it would take half a minute, and for two hundred several minutes; without optimisation, these compile in fifteen seconds.
MOST_OPTIMISED = 24

#: The largest number of coordinates for which an integration begins with code that is not optimised, and the steps after which
#: it begins again with optimised code. Optimising takes a second, in which such code makes some 3,000 steps.
MOST_QUICK, QUICK_STEPS = 14, 512

#: The number of operations (steps times the length of the equations) after which an integration stops: some ten seconds in
#: 80 bits. A joint whose damping or spring makes it much faster than all other joints needs that many.
MAX_OPERATIONS = 40_000_000

#: The largest size of the motion of a tree that is kept: 2,000 steps of thirty coordinates and velocities.
KEPT_BYTES = 2**25

#: The number of motions that are followed together: one vector of the largest size has eight doubles.
LANES = 8

#: The largest number of instants after which the deviations of nudged motions are looked at.
WIDEST = 8

#: Velocity (rad/s or m/s) that is added to the velocity of a joint in its event function, since a joint begins to slip from
#: zero, and heyoka does not find further roots of a function that has a root at the very beginning of a step.
_BEGINNING = 1e-60


@dataclass(frozen=True)
class Shape:
    """The properties of a tree that its compiled equations depend on.

    links: the form of each link. marks: the marks of each link's numbers. gravity: the marks of gravity. dry: the indices of
    the links with dry friction.
    """

    links: tuple[LinkForm, ...]
    marks: tuple[tuple[Mark, ...], ...]
    gravity: tuple[Mark, ...]
    dry: tuple[int, ...]

    @property
    def large(self) -> bool:
        """True if there are too many equations for optimised code."""
        return self._rates > MOST_OPTIMISED

    @property
    def quick(self) -> bool:
        """True if there are so few equations that a short motion takes less time than optimising the code."""
        return self._rates <= MOST_QUICK

    @property
    def _rates(self) -> int:
        return sum(sizes(link)[1] for link in self.links) + 3 * sum(link.kind == "free" for link in self.links)


@dataclass(frozen=True, eq=False)
class Written:
    """Equations in heyoka's form, and for each link with dry friction a margin that becomes negative when its mode must change.

    The margin of a link that slips is its velocity in the direction of slipping; the margin of a link that sticks is the
    difference of the squares of the friction and of the required force.
    """

    system: Equations
    margins: list[Any]


@functools.lru_cache(maxsize=32)
def most_steps(solver: Any) -> int:
    """The number of steps after which an integrator of heyoka gives up."""
    return max(1, min(MAX_STEPS, MAX_OPERATIONS // len(solver.decomposition)))


def followed(tree: Tree, times: WideArray, kind: FloatType) -> Course:
    """The motion of the links of a tree without dry friction at times (n,) >= 0, s, in any order.

    The motion of a tree in 80 bits is kept, since the truth and the search for limits of joints ask for it at several instants.

    Raises `OutOfReach` if the integration fails or takes too many steps.
    """
    end = float(times.max(initial=0.0))
    motion = _kept(tree, end, MAX_OPERATIONS) if kind.dtype is np.longdouble and end else None
    if motion is not None:
        return Course(split(tree, motion(times.astype(np.longdouble)), times, kind))
    state, numbers = kind.array(start(tree)), kind.array(parameters(tree))
    rows = _patient(tree, kind, lambda solver, most: solve(solver, state, numbers, times, most=most))
    return Course(split(tree, rows, times, kind))


@functools.lru_cache(maxsize=8)
def _kept(tree: Tree, end: float, operations: int) -> Any:
    """The states of a tree from 0 to `end` (s) in 80 bits as a function of times; None if they are too many to keep.

    operations: `MAX_OPERATIONS`, on which the result depends.
    """
    kind = FloatType(np.longdouble)
    state, numbers = kind.array(start(tree)), kind.array(parameters(tree))
    return _patient(tree, kind, lambda solver, most: dense(solver, state, numbers, np.longdouble(end), most, KEPT_BYTES))


def beside(tree: Tree, t: Array, nudges: Sequence[tuple[int, Array]], units: Array) -> tuple[Array, Array, Array]:
    """The motion of a tree in double precision at ascending instants (m,), s, from 0 on, and nudged motions beside it.

    All are followed together in the lanes of vectors. A deviation that leaves the size of a nudge is scaled back to it.

    nudges: for each of at most `LANES` - 1 motions, the index of the instant at which it begins, and the deviation (k,) with
    which it begins. units: (k,) the sizes of the components of a state.

    Returns the states (m, k), and the deviations (n, m, k) of the nudged motions with the factors (n, m) by which they were
    divided; both are zero before the first instant of a nudged motion, and after it has failed or grown by more than `LARGEST`.
    """
    kind = FloatType(np.float64)
    solver, numbers = vectorised(_equations(shape_of(tree)), LANES), kind.array(parameters(tree))
    rows = np.tile(kind.array(start(tree)), (len(t), 1))
    deviations, factors = np.zeros((len(nudges), *rows.shape)), np.zeros((len(nudges), len(t)))
    offsets, grown = np.zeros((LANES, rows.shape[1])), np.zeros(len(nudges))
    begin, width, left, waiting = 0, WIDEST, most_steps(solver), dict(enumerate(nudges))
    while True:
        for lane, (first, nudge) in tuple(waiting.items()):
            if first == begin:
                del waiting[lane]
                offsets[lane], grown[lane] = nudge, 1.0
                deviations[lane, begin], factors[lane, begin] = nudge, 1.0
        if begin + 1 == len(t):
            return rows, deviations, factors
        end = min([begin + width, len(t) - 1, *(first for first, _ in waiting.values())])
        states, steps, failed = _carried(solver, rows[begin] + offsets, numbers, t[begin : end + 1], left)
        left -= steps
        if failed:
            offsets[failed], grown[failed] = 0.0, 0.0
            continue
        off = states[:, : len(nudges)] - states[:, LANES - 1 :]
        if end > begin + 1 and np.max(np.abs(off) / units, initial=0.0) > SMALL:
            width = (end - begin) // 2
            continue
        running = grown > 0
        rows[begin + 1 : end + 1] = states[:, -1]
        deviations[running, begin + 1 : end + 1] = np.swapaxes(off, 0, 1)[running]
        factors[running, begin + 1 : end + 1] = grown[running, None]
        size = np.where(running, np.max(np.abs(off[-1]) / units, axis=1, initial=0.0) / NUDGE, 1.0)
        scale = np.where((size > UNSCALED) | ((size < 1 / UNSCALED) & (size > 0)), size, 1.0)
        offsets[: len(nudges)], grown = off[-1] / scale[:, None], grown * scale
        ended = grown >= LARGEST
        offsets[: len(nudges)][ended], grown[ended] = 0.0, 0.0
        begin, width = end, min(2 * width, WIDEST)


def _carried(solver: Any, start: Array, numbers: Array, times: Array, most: int) -> tuple[Array, int, list[int]]:
    """The states (n, lanes, k) of all lanes at times (n + 1,) after the first one, the number of steps, and lanes that failed.

    start: (lanes, k) the states at the first time; the last lane has the motion that is not nudged.

    Raises `Stopped` if this motion cannot be followed, or takes more than `most` steps.
    """
    with integrator_lock:
        solver.set_time(times[0])
        solver.state[:] = start.T
        solver.pars[:] = numbers[: len(solver.pars), None]
        _, states = solver.propagate_grid(np.tile(times[:, None], (1, LANES)), max_steps=max(most, 1))
        outcomes = [outcome for outcome, *_ in solver.propagate_res]
        steps, time = max(each[3] for each in solver.propagate_res), float(solver.time[-1])
    failed = [lane for lane, outcome in enumerate(outcomes) if outcome == hy.taylor_outcome.err_nf_state]
    if LANES - 1 in failed or (not failed and any(outcome != hy.taylor_outcome.time_limit for outcome in outcomes)):
        raise Stopped(f"Taylor's method stopped after {steps} steps: {outcomes[-1].name}", time)
    return np.asarray(np.swapaxes(states[1:], 1, 2)), steps, failed


def _patient(tree: Tree, kind: FloatType, solved: Callable[[Any, int], Solution]) -> Solution:
    """The solution of the equations of a tree by code that is optimised only if the solution has many steps.

    solved: the function that returns the solution by an integrator with at most a number of steps, or raises `Stopped`.
    """
    shape = shape_of(tree)
    if shape.quick:
        with contextlib.suppress(Stopped):
            return solved(first_integrator(shape, kind), QUICK_STEPS)
    solver = integrator(_equations(shape), kind.dtype, kind.bits, large=shape.large)
    return solved(solver, most_steps(solver))


def first_integrator(shape: Shape, kind: FloatType) -> Any:
    """The integrator with which a tree is first followed, by code that is not optimised if the tree is small, or very large."""
    return integrator(_equations(shape), kind.dtype, kind.bits, large=shape.quick or shape.large)


@functools.cache
def _equations(shape: Shape) -> functools.partial[Equations]:
    """A function that returns the equations: the same object for the same shape, as compiled integrators are cached by it."""
    return functools.partial(_system, shape)


def _system(shape: Shape) -> Equations:
    return written(shape).system


def shape_of(tree: Tree) -> Shape:
    """Return the properties of a tree that its compiled equations depend on."""
    return Shape(
        tuple(forms_of(tree)),
        tuple(tuple(each for each, _ in numbers(link.constants, _changing(link))) for link in tree.links),
        tuple(mark(part, ones=False) for part in tree.gravity),
        tuple(index for index, link in enumerate(tree.links) if link.friction),
    )


def parameters(tree: Tree, modes: Mapping[int, int] | None = None) -> list[Real]:
    """The exact values of the parameters, in the order of the equations.

    modes: the mode of each link with dry friction, by its index: 1 or -1 if it slips forwards or backwards, 0 if it sticks.
    """
    modes = modes or {}
    values: list[Real] = []
    for index, link in enumerate(tree.links):
        constants = with_mode(link, modes[index]) if link.friction else link.constants
        values += [number for each, number in numbers(constants, _changing(link)) if each is None]
    values += [part for part in tree.gravity if part]
    for index, mode in modes.items():
        values += [tree.links[index].friction, MP.mpf(mode)]
    return values


def with_mode(link: Link, mode: int) -> Constants:
    """The constants of a link whose joint with dry friction slips forwards (1) or backwards (-1) or sticks (0)."""
    constants = link.constants
    return replace(constants, force=constants.force - mode * link.friction, moves=MP.mpf(abs(mode)))


def _changing(link: Link) -> tuple[str, ...]:
    return _CHANGING if link.friction else ()


def field_sizes() -> list[tuple[str, int]]:
    """The names of the fields of `Constants`, and how many numbers each has, in the order of `numbers`."""
    return [(field.name, _SIZES.get(field.name, 1)) for field in fields(Constants)]


def numbers(constants: Constants, changing: Collection[str]) -> Iterator[tuple[Mark, Real]]:
    """The numbers of a link in order, with their marks. changing: the fields that are parameters whatever their values are."""
    for field in fields(Constants):
        value = getattr(constants, field.name)
        for number in value if field.name in _SIZES else [value]:
            yield None if field.name in changing else mark(number, ones=field.name in _WITH_ONES), number


def mark(number: Real, *, ones: bool) -> Mark:
    """Return what is known of a number when the equations are written."""
    return int(number) if number == 0 or (ones and abs(number) == 1) else None


def numbering() -> Callable[[Sequence[Mark]], list[Any]]:
    """Return a function from marks to numbers and parameters, which are numbered from call to call."""
    taken = 0

    def symbols(marks: Sequence[Mark]) -> list[Any]:
        nonlocal taken
        entries: list[Any] = []
        for each in marks:
            entries.append(hy.par[taken] if each is None else each)
            taken += each is None
        return entries

    return symbols


def written(shape: Shape) -> Written:
    """The equations and margins of trees with a shape; the parameters are numbered in the order of `parameters`."""
    symbols = numbering()
    constants = [named(symbols(marks)) for marks in shape.marks]
    form = Form(shape.links, constants, symbols(shape.gravity))
    count = sum(sum(sizes(link)) for link in shape.links) + 6 * len(floating(shape.links))
    state = [hy.make_vars(f"x{index}") for index in range(count)]
    rates, velocities = derivatives(form, state, hy), places_of_rates(shape.links)
    margins = []
    for index in shape.dry:
        friction, mode = symbols((None, None))
        slips, strain = constants[index].moves, rates.strains[index]
        left = (friction - strain) * (friction + strain)
        margins.append(slips * (mode * state[velocities[index]] + _BEGINNING) + (1 - slips) * left)
    # A derivative that is zero is the number 0 here, but heyoka requires an expression.
    system = [(x, hy.expression(0.0) + rate) for x, rate in zip(state, rates.state, strict=True)]
    return Written(system, margins)


def named(symbols: list[Any]) -> Constants:
    """The constants of a link from the symbols of all its numbers, in order."""
    values, taken = dict[str, Any](), 0
    for field in fields(Constants):
        size = _SIZES.get(field.name, 1)
        numbers = symbols[taken : taken + size]
        values[field.name] = numbers if field.name in _SIZES else numbers[0]
        taken += size
    return Constants(**values)
