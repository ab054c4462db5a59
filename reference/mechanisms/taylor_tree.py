"""The links of a tree by Taylor's method in any floating-point type (heyoka; Linux only).

One compilation serves all mechanisms whose trees have the same kinds of links on the same parents and zeros in the same
places: all other numbers are parameters. heyoka keeps compiled code on disk. Importing this raises `ImportError` where heyoka
is not installed.
"""

import functools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from typing import Any

import heyoka as hy

from bodycheck.reference.exact.numbers import Real
from bodycheck.reference.integration.heyoka_solver import Equations, integrator, solve
from bodycheck.reference.mechanisms.articulated import Constants, Kind
from bodycheck.reference.mechanisms.link_states import SIZES, Form, LinkStates, derivatives, split, start
from bodycheck.reference.mechanisms.rounding import FloatType, WideArray
from bodycheck.reference.mechanisms.tree import Tree

#: What is known of a number when the equations are written: 0, 1 and -1 themselves, and None for a parameter.
Mark = int | None

#: The fields of `Constants` with several numbers, and how many there are.
_SIZES = {"turn": 9, "offset": 3, "moment": 3, "tensor": 6, "differences": 3}


@dataclass(frozen=True)
class Shape:
    """What compiled equations depend on: the kind and the parent of each link, and the marks of its numbers and of gravity."""

    links: tuple[tuple[Kind, int], ...]
    marks: tuple[tuple[Mark, ...], ...]
    gravity: tuple[Mark, ...]


def followed(tree: Tree, times: WideArray, kind: FloatType) -> list[LinkStates]:
    """The states of the links of a tree at times (n,) >= 0, s, in any order. Raises `OutOfReach`."""
    solver = integrator(_equations(_shape(tree)), kind.dtype, kind.bits)
    rows = solve(solver, kind.array(start(tree)), kind.array(_parameters(tree)), times)
    return split(tree, rows, times, kind)


def _numbers(constants: Constants) -> Iterator[tuple[Mark, Real]]:
    """The numbers of a link in order, with their marks: only those of a rotation can be marked as one."""
    for field in fields(Constants):
        value = getattr(constants, field.name)
        for number in value if field.name in _SIZES else [value]:
            yield _mark(number, ones=field.name == "turn"), number


def _mark(number: Real, *, ones: bool) -> Mark:
    return int(number) if number == 0 or (ones and abs(number) == 1) else None


def _shape(tree: Tree) -> Shape:
    links = tuple((link.kind, link.parent) for link in tree.links)
    marks = tuple(tuple(mark for mark, _ in _numbers(link.constants)) for link in tree.links)
    return Shape(links, marks, tuple(_mark(part, ones=False) for part in tree.gravity))


def _parameters(tree: Tree) -> list[Real]:
    """The values of the parameters, in the order of the equations."""
    own = [number for link in tree.links for mark, number in _numbers(link.constants) if mark is None]
    return own + [part for part in tree.gravity if part]


@functools.cache
def _equations(shape: Shape) -> functools.partial[Equations]:
    """A function that gives the equations, always the same one, since compiled integrators are known by it."""
    return functools.partial(_written, shape)


def _written(shape: Shape) -> Equations:
    """The equations in heyoka's form; the parameters are numbered in the order of `_parameters`."""
    taken = 0

    def symbols(marks: Sequence[Mark]) -> list[Any]:
        nonlocal taken
        found: list[Any] = []
        for mark in marks:
            found.append(hy.par[taken] if mark is None else mark)
            taken += mark is None
        return found

    constants = [_named(symbols(marks)) for marks in shape.marks]
    form = Form(shape.links, constants, symbols(shape.gravity))
    count = sum(sum(SIZES[kind]) for kind, _ in shape.links) + 6 * form.floats
    state = [hy.make_vars(f"x{place}") for place in range(count)]
    # A derivative that is zero is a number here, which heyoka takes only as an expression.
    return [(x, hy.expression(0.0) + rate) for x, rate in zip(state, derivatives(form, state, hy), strict=True)]


def _named(symbols: list[Any]) -> Constants:
    """The numbers of a link from their symbols in order."""
    values, taken = dict[str, Any](), 0
    for field in fields(Constants):
        size = _SIZES.get(field.name, 1)
        own = symbols[taken : taken + size]
        values[field.name] = own if field.name in _SIZES else own[0]
        taken += size
    return Constants(**values)
