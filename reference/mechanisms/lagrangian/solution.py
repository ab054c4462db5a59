"""The witness of the motion of a mechanism: its Lagrangian in joint coordinates.

The equations follow from L = T - V by differentiation alone (`lagrangian.equations`), and are solved by Taylor's method in the
widest type of NumPy (heyoka), or by DOP853 in double precision if heyoka is not installed. This code starts from the mechanism
and shares no formula with the recursion, from which the truth comes.
"""

import functools
import math
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from bodycheck.reference.errors import NotModelled
from bodycheck.reference.independent.arithmetic import Wide, wide
from bodycheck.reference.independent.border import MP, Number
from bodycheck.reference.integration.rotation import WideArray
from bodycheck.reference.mechanisms.lagrangian import phases
from bodycheck.reference.mechanisms.lagrangian.border import Border, Element, border
from bodycheck.reference.mechanisms.lagrangian.closing import independent
from bodycheck.reference.mechanisms.lagrangian.differentiation import Node, Tape
from bodycheck.reference.mechanisms.lagrangian.equations import parts_of, rows_of
from bodycheck.reference.mechanisms.lagrangian.laws import Law
from bodycheck.reference.mechanisms.lagrangian.poses import WideMotion, motion
from bodycheck.reference.mechanisms.lagrangian.reaching import with_reached_stops
from bodycheck.reference.mechanisms.lagrangian.structure import Structure, Units, numbers
from bodycheck.reference.mechanisms.lagrangian.system import System
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array

#: The name of the way in results, where it precedes the name of the solver.
NAME = "Euler-Lagrange"


@dataclass(frozen=True, eq=False)
class Prepared:
    """The input of a mechanism's equations: its elements, their structure, the units, the parameters and the start."""

    border: Border
    structure: Structure
    units: Units
    parameters: list[Number]
    start: list[Number]


def follow(mechanism: Mechanism, times: Array, dtype: Any = Wide) -> WideMotion:
    """The motion of a mechanism at ascending times (n,) >= 0, s, by Taylor's method in a type of NumPy (heyoka).

    Raises `NotModelled` for free bodies in loops and for stops in a mechanism with loops, `OutOfReach` if the integration fails
    or takes too many steps, and `ImportError` if heyoka is not installed.
    """
    return with_reached_stops(mechanism, times, lambda reduced, instants: _by_taylor(reduced, instants, dtype))


def _by_taylor(mechanism: Mechanism, times: Array, dtype: Any) -> WideMotion:
    from bodycheck.reference.mechanisms.lagrangian import taylor

    ready = prepared(mechanism)
    if not _switches(mechanism):
        return _followed(ready, mechanism, times, dtype, taylor.solve)
    with taylor.lock:
        return _in_phases(ready, mechanism, times.astype(dtype), taylor.stepper(ready.structure, dtype))


def begun(mechanism: Mechanism, threads: Executor, dtype: Any = Wide) -> Callable[[Array], Callable[[], WideMotion]]:
    """Compile the equations of a mechanism without switches in a thread, and return what begins to solve them there.

    The returned function takes ascending times (n,) >= 0, s, and returns another one, which waits for the motion of `follow` at
    these times. Everything else is computed in the thread of the caller, since the arithmetic of many digits is not made for
    threads.
    """
    from bodycheck.reference.mechanisms.lagrangian import taylor

    if _switches(mechanism):
        return lambda times: lambda: follow(mechanism, times, dtype)
    ready = prepared(mechanism)
    groups = _rounded_groups(ready, dtype)
    for group in groups:
        threads.submit(taylor.first_integrator, group.structure, dtype, len(group.start))

    def begin(times: Array) -> Callable[[], WideMotion]:
        solving = threads.submit(_solved, ready, groups, times, dtype, taylor.solve)
        return lambda: _motion(ready, mechanism, times, solving.result())

    return begin


def follow_in_doubles(mechanism: Mechanism, times: Array) -> WideMotion:
    """The motion of a mechanism at ascending times (n,) >= 0, s, as by `follow`, by DOP853 in double precision."""
    from bodycheck.reference.mechanisms.lagrangian import scipy_solver

    ready = prepared(mechanism)
    if not _switches(mechanism):
        return _followed(ready, mechanism, times, np.float64, scipy_solver.solve)
    end = float(times[-1]) / ready.units.time if len(times) else 0.0
    return _in_phases(ready, mechanism, times, scipy_solver.stepper(ready.structure, end))


def _switches(mechanism: Mechanism) -> bool:
    """Return whether the equations of a mechanism switch, or depend on time."""
    return bool(mechanism.controllers) or any(joint.friction or joint.stops for joint in mechanism.joints)


def _in_phases(ready: Prepared, mechanism: Mechanism, times: WideArray, stepper: phases.Stepper) -> WideMotion:
    """The motion of a mechanism whose equations switch. Raises `NotModelled` where the Lagrangian has no model of this."""
    if mechanism.loops and any(joint.stops for joint in mechanism.joints):
        raise NotModelled("stops in a mechanism with loops")
    if any(law is not None and law.holds and leader is not None for law, leader in _with_leaders(ready.structure)):
        raise NotModelled("rigid stops and dry friction of joints that follow others")
    until = None if mechanism.stops_until is None else Fraction(mechanism.stops_until)
    system = System(ready.border, ready.structure, ready.units, ready.parameters, until)
    states = np.empty((0, len(ready.start)), times.dtype)
    if len(times):
        states = phases.solve(system, ready.start, times / times.dtype.type(ready.units.time), stepper)
    return _motion(ready, mechanism, times, states)


def _with_leaders(structure: Structure) -> list[tuple[Law | None, int | None]]:
    return list(zip(structure.laws, structure.follows, strict=True))


def _followed(ready: Prepared, mechanism: Mechanism, times: Array, dtype: Any, solve: Any) -> WideMotion:
    """The motion of a mechanism whose equations do not switch."""
    return _motion(ready, mechanism, times, _solved(ready, _rounded_groups(ready, dtype), times, dtype, solve))


@dataclass(frozen=True, eq=False)
class _Group:
    """Elements that no others act on: their columns in the states of a mechanism, structure, start and parameters."""

    columns: list[int]
    structure: Structure
    start: WideArray
    parameters: WideArray


def _rounded_groups(ready: Prepared, dtype: Any) -> list[_Group]:
    """The groups of elements that move, in a floating-point type."""
    coordinates = ready.structure.places[-1][0].stop if ready.structure.places else 0
    groups = []
    for indices in _groups(ready.border):
        group = _prepared(_part(ready.border, indices), ready.units)
        start, parameters = _rounded(group, dtype)
        slices = [ready.structure.places[index] for index in indices]
        columns = [column for held, _ in slices for column in range(held.start, held.stop)]
        columns += [coordinates + column for _, moving in slices for column in range(moving.start, moving.stop)]
        if len(start):
            groups.append(_Group(columns, group.structure, start, parameters))
    return groups


def _solved(ready: Prepared, groups: list[_Group], times: Array, dtype: Any, solve: Any) -> WideArray:
    """The states at times (n,), s. Groups are solved apart, each with steps of its own."""
    states = np.empty((len(times), len(ready.start)), dtype)
    for group in groups:
        states[:, group.columns] = solve(group.structure, group.start, group.parameters, times / ready.units.time)
    return states


def _groups(parts: Border) -> list[list[int]]:
    """The indices of elements in groups, so that no element acts on one of another group; of loops, one group has them all."""
    elements = parts.elements
    if parts.loops:
        return [list(range(len(elements)))]
    index_of = {element.joint: index for index, element in enumerate(elements)}
    names = list(range(len(elements)))
    for index, element in enumerate(elements):
        for other in (element.parent, None if element.rule is None else index_of[element.rule[0]]):
            if other is not None:
                one, two = names[index], names[other]
                names = [two if name == one else name for name in names]
    return [[index for index, each in enumerate(names) if each == name] for name in dict.fromkeys(names)]


def _part(parts: Border, indices: list[int]) -> Border:
    """Some elements of a mechanism, without those of other groups."""
    at = {index: position for position, index in enumerate(indices)}
    elements = [parts.elements[index] for index in indices]
    chosen = [replace(each, parent=None if each.parent is None else at[each.parent]) for each in elements]
    return replace(parts, elements=tuple(chosen))


def _rounded(ready: Prepared, dtype: Any) -> tuple[WideArray, WideArray]:
    """The start and the parameters in a floating-point type."""
    rounded = float if dtype is np.float64 else wide
    start, parameters = (np.array([rounded(value) for value in values], dtype) for values in (ready.start, ready.parameters))
    return start, parameters


def _motion(ready: Prepared, mechanism: Mechanism, times: Array, states: WideArray) -> WideMotion:
    return motion(ready.border, ready.structure, ready.units, times.astype(states.dtype), states, len(mechanism.bodies))


def prepared(mechanism: Mechanism) -> Prepared:
    """Return the input of a mechanism's equations. Raises `NotModelled` if free bodies are in loops, as they fall."""
    parts = border(mechanism)
    if any(index is not None and parts.elements[index].falls for ends in parts.loops for index, _ in ends):
        raise NotModelled("free bodies in loops, in the Lagrangian in joint coordinates")
    return _prepared(parts, _units(parts))


def _prepared(parts: Border, units: Units) -> Prepared:
    structure, parameters = numbers(parts, units)
    alone = [element for element in parts.elements if element.rule is None]
    start = [value for element in alone for value in _scaled_start(element, units)]
    start += [value for element in alone for value in _scaled_velocity(element, units)]
    start += [MP.zero] * structure.further
    if structure.loops:
        chosen = independent(*_all_rows(structure), [float(value) for value in start], [float(value) for value in parameters])
        structure = replace(structure, rows=chosen)
    return Prepared(parts, structure, units, parameters, start)


@functools.lru_cache(maxsize=8)
def _all_rows(structure: Structure) -> tuple[Tape, list[list[Node]]]:
    """A tape, and on it the rows of J of `closing` for all components of the gaps of loops."""
    tape = Tape()
    return tape, rows_of(tape, structure, parts_of(tape, structure))


def _scaled_start(element: Element, units: Units) -> list[Number]:
    lengths = {"slide": 1, "free": 3}.get(element.kind, 0)
    return [value / units.length if index < lengths else value for index, value in enumerate(element.start)]


def _scaled_velocity(element: Element, units: Units) -> list[Number]:
    lengths = {"slide": 1, "free": 3}.get(element.kind, 0)
    return [
        value * units.time / units.length if index < lengths else value * units.time
        for index, value in enumerate(element.velocity)
    ]


def _units(parts: Border) -> Units:
    """The units of a mechanism: powers of two near its largest length and mass, and the time of its fastest initial motion."""
    elements = parts.elements
    lengths = [abs(value) for element in elements for value in element.origin]
    lengths += [abs(value) for element in elements for body in element.carried for value in body.centre]
    lengths += [abs(value) for element in elements if element.kind == "slide" for value in element.start]
    for body in (body for element in elements for body in element.carried):
        if body.mass:
            lengths.append((sum(body.tensor[axis][axis] for axis in range(3)) / body.mass) ** 0.5)
    length = _power_of_two(max(lengths, default=0))
    mass = _power_of_two(max((body.mass for element in elements for body in element.carried), default=0))
    rates = [parts.gravity / length] if not all(element.falls for element in elements) else []
    rates = [math.sqrt(rate) for rate in rates]
    for element in elements:
        sliding = {"slide": 1, "free": 3}.get(element.kind, 0)
        rates += [float(abs(u)) / (length if index < sliding else 1) for index, u in enumerate(element.velocity)]
    return Units(length, mass, 1 / _power_of_two(max(rates, default=0)))


def _power_of_two(size: Any) -> float:
    """The power of two near a size; 1 for zero."""
    return float(2.0 ** round(math.log2(float(size)))) if size else 1.0
