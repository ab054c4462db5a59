"""The Lagrangian of a mechanism with dry friction, in phases in which each joint slips one way or sticks.

The beginnings of the phases and the modes of the joints in them are given. In a phase, friction is a constant force against a
joint that slips, and the force that holds a joint that sticks. The result is checked against the phases: a joint that slips
must keep its direction, and come to rest at the end of its phase; a joint that sticks must need no more than its friction, and
all of it at the end of its phase. Contradictions are reported as errors of velocities: see `Stray`.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bodycheck.reference.independent.border import MP
from bodycheck.reference.integration.rotation import WideArray
from bodycheck.reference.mechanisms.lagrangian.border import Border, Element
from bodycheck.reference.mechanisms.lagrangian.differentiation import made
from bodycheck.reference.mechanisms.lagrangian.equations import derived
from bodycheck.reference.mechanisms.lagrangian.structure import Structure, Units, friction_parameters
from bodycheck.reference.trajectory import Array

#: The number of evenly spaced instants of a phase at which joints are checked.
CHECKS = 9

#: The error by rounding in double precision of the force that holds a joint, as a fraction of the friction.
ROUNDED = 1e-10

#: The number of roundings of the largest velocity up to which a velocity counts as zero.
STOPPED = 256.0

#: A function that returns the states (n, k) of the equations of a structure from a start, parameters and times.
Solve = Callable[[Structure, WideArray, WideArray, WideArray], WideArray]


@dataclass(frozen=True, eq=False)
class Phase:
    """The beginning of a phase (s), and the mode of each joint with dry friction: 1 or -1 if it slips, 0 if it sticks."""

    begin: Any
    modes: dict[int, int]


@dataclass(frozen=True, eq=False)
class Stray:
    """A possible error of a joint's velocity: the time from which it exists (s), its size, and whether the joint turns.

    The size is in rad/s for a joint that turns, else in m/s.
    """

    since: float
    rate: float
    turns: bool


@dataclass(frozen=True, eq=False)
class Slipping:
    """A mechanism with dry friction: its elements, their structure, and the units of the equations."""

    border: Border
    structure: Structure
    units: Units

    @property
    def dry(self) -> list[tuple[int, Element]]:
        """The elements with dry friction, each after its index."""
        return [(index, element) for index, element in enumerate(self.border.elements) if element.friction]

    def friction(self, element: Element) -> float:
        """The friction of an element in the units of the equations."""
        units = self.units
        inertia = units.mass * (units.length if element.kind == "slide" else units.length**2)
        return float(MP.mpf(element.friction) * MP.mpf(units.time) ** 2 / MP.mpf(inertia))


def in_phases(
    slipping: Slipping, start: WideArray, parameters: WideArray, times: Array, phases: Sequence[Phase], solve: Solve
) -> tuple[WideArray, list[Stray]]:
    """The states (n, k) at ascending times (n,), s, and the contradictions to the phases."""
    dtype: Any = start.dtype.type
    rows, strays, state = np.empty((len(times), len(start)), dtype), list[Stray](), start.copy()
    last = dtype(times[-1]) if len(times) else dtype(0)
    first = 0
    for number, phase in enumerate(phases):
        after = phases[number + 1] if number + 1 < len(phases) else None
        end = last if after is None else dtype(after.begin)
        begin = dtype(phase.begin)
        until = len(times) if after is None else int(np.searchsorted(times, float(end)))
        state, phase_parameters = _begun(slipping, state, parameters, phase)
        checks = np.linspace(0, 1, CHECKS).astype(dtype) * (end - begin)
        local = np.concatenate([times[first:until].astype(dtype) - begin, checks]) / dtype(slipping.units.time)
        states = solve(slipping.structure, state, phase_parameters, np.maximum(local, 0))
        rows[first:until] = states[: until - first]
        seen = states[until - first :]
        strays += _strays(slipping, seen, phase_parameters, phase, after, float(end - begin), float(last - begin))
        first, state = until, seen[-1]
    return rows, strays


def _begun(slipping: Slipping, state: WideArray, parameters: WideArray, phase: Phase) -> tuple[WideArray, WideArray]:
    """The state at the beginning of a phase, in which joints that stick are at rest, and the parameters of the phase."""
    state, phase_parameters = state.copy(), parameters.copy()
    coordinates = slipping.structure.places[-1][0].stop
    for index, element in slipping.dry:
        assert element.joint is not None  # a free body has no friction
        mode = phase.modes[element.joint]
        force, moves = friction_parameters(slipping.structure, index)
        phase_parameters[force] = -mode * phase_parameters.dtype.type(slipping.friction(element))
        phase_parameters[moves] = abs(mode)
        if not mode:
            state[coordinates + slipping.structure.places[index][1].start] = 0
    return state, phase_parameters


def _strays(
    slipping: Slipping, states: WideArray, parameters: WideArray, phase: Phase, after: Phase | None, lasts: float, rest: float
) -> list[Stray]:
    """Return the contradictions to a phase.

    states: at `CHECKS` instants of the phase. after: the next phase. lasts: the length of the phase (s). rest: the time from
    its beginning to the end of the motion (s).
    """
    equations = derived(slipping.structure)
    values = states.astype(float).T
    leaves: dict[str, Callable[[Any], Any]] = {
        "number": lambda value: np.full(len(states), float(value)),
        "parameter": lambda index: np.full(len(states), float(parameters[index])),
        "variable": lambda index: values[index],
    }
    nodes = [node for pair in equations.strains for node in pair]
    evaluated = made(equations.tape, nodes, lambda kind, value: leaves[kind](value), np.sin, np.cos)
    coordinates, units, strays = slipping.structure.places[-1][0].stop, slipping.units, list[Stray]()
    for number, (index, element) in enumerate(slipping.dry):
        assert element.joint is not None  # a free body has no friction
        strain, inertia = evaluated[2 * number], evaluated[2 * number + 1]
        rate = values[coordinates + slipping.structure.places[index][1].start]
        mode, friction = phase.modes[element.joint], slipping.friction(element)
        changes = after is not None and after.modes[element.joint] != mode
        if mode:
            wrong = max(float(np.max(-mode * rate)), abs(float(rate[-1])) if changes else 0.0)
            wrong = max(wrong - STOPPED * float(np.finfo(states.dtype).eps) * float(np.max(np.abs(values[coordinates:]))), 0.0)
        else:
            over = np.maximum(np.abs(strain) - friction * (1 + ROUNDED), 0.0) / inertia
            short = abs(abs(strain[-1]) - friction) / inertia[-1]
            early = short if changes and short * inertia[-1] > ROUNDED * friction else 0.0
            wrong = float(np.max(over)) * lasts / units.time + early * rest / units.time
        if wrong:
            size = units.length if element.kind == "slide" else 1.0
            strays.append(Stray(float(phase.begin), wrong * size / units.time, element.kind == "turn"))
    return strays
