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
from bodycheck.reference.integration.heyoka_solver import Equations, dense, integrator, solve
from bodycheck.reference.mechanisms.articulation.articulated import Constants
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


def in_parts(tree: Tree, parts: Sequence[Array], kind: FloatType) -> Iterator[Course]:
    """Yield the motion of `followed` at ascending times (n,) >= 0, s, part by part, each from the end of the one before."""
    state, numbers, begin = kind.array(start(tree)), kind.array(parameters(tree)), 0.0
    for part in parts:

        def solved(solver: Any, most: int, state: WideArray = state, times: Array = part - begin) -> WideArray:
            return solve(solver, state, numbers, times, most=most)

        rows = _patient(tree, kind, solved)
        yield Course(split(tree, rows, part, kind))
        state, begin = rows[-1], float(part[-1])


@functools.lru_cache(maxsize=8)
def _kept(tree: Tree, end: float, operations: int) -> Any:
    """The states of a tree from 0 to `end` (s) in 80 bits as a function of times; None if they are too many to keep.

    operations: `MAX_OPERATIONS`, on which the result depends.
    """
    kind = FloatType(np.longdouble)
    state, numbers = kind.array(start(tree)), kind.array(parameters(tree))
    return _patient(tree, kind, lambda solver, most: dense(solver, state, numbers, np.longdouble(end), most, KEPT_BYTES))


def _patient(tree: Tree, kind: FloatType, solved: Callable[[Any, int], Solution]) -> Solution:
    """The solution of the equations of a tree by code that is optimised only if the solution has many steps.

    solved: the function that returns the solution by an integrator with at most a number of steps, or raises `Stopped`.
    """
    shape = shape_of(tree)
    if shape.quick:
        with contextlib.suppress(Stopped):
            return solved(integrator(_equations(shape), kind.dtype, kind.bits, large=True), QUICK_STEPS)
    solver = integrator(_equations(shape), kind.dtype, kind.bits, large=shape.large)
    return solved(solver, most_steps(solver))


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
