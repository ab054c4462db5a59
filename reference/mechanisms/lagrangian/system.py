"""The modes of a mechanism whose equations switch: what is held or slips, what is saturated, and what controllers exert."""

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np

from bodycheck.reference.independent.arithmetic import wide
from bodycheck.reference.independent.border import MP, Number
from bodycheck.reference.integration.rotation import WideArray
from bodycheck.reference.mechanisms.control import Samples
from bodycheck.reference.mechanisms.lagrangian.border import Border
from bodycheck.reference.mechanisms.lagrangian.differentiation import Node, made
from bodycheck.reference.mechanisms.lagrangian.equations import derived
from bodycheck.reference.mechanisms.lagrangian.laws import SIGNALS, Law, constants, switched, switching
from bodycheck.reference.mechanisms.lagrangian.sampled import Piece, exact, piece
from bodycheck.reference.mechanisms.lagrangian.structure import (
    Structure,
    Units,
    effort_parameter,
    friction_parameters,
    scales,
)


@dataclass(frozen=True, eq=False)
class Modes:
    """The modes of all elements.

    Attributes
    ----------
    moves
        For each element that can be held: 1 or -1 if it slips forwards or backwards, or only moves, and 0 if it is held.
    sides
        For each of them 1 or -1 if it rests at its upper or lower rigid stop, else 0.
    signs
        The sign of each guard that decides where a limit or an elastic stop acts, by element and name.
    efforts
        The efforts (N m or N) of controllers with a rate, by element.
    pieces
        The pieces of the tables of continuous controllers, by element and signal.
    released
        Whether rigid stops no longer act.
    """

    moves: dict[int, int] = field(default_factory=dict)
    sides: dict[int, int] = field(default_factory=dict)
    signs: dict[tuple[int, str], int] = field(default_factory=dict)
    efforts: dict[int, Number] = field(default_factory=dict)
    pieces: dict[tuple[int, str], Piece] = field(default_factory=dict)
    released: bool = False


@dataclass(frozen=True, eq=False)
class System:
    """A mechanism whose equations switch: its elements, their structure, the units of the equations, and the parameters.

    stops_until: the time (s) from which on rigid stops no longer act; None if they always act.
    """

    border: Border
    structure: Structure
    units: Units
    parameters: list[Number]
    stops_until: Fraction | None = None

    @functools.cached_property
    def laws(self) -> dict[int, Law]:
        """The laws by the indices of their elements."""
        return {index: law for index, law in enumerate(self.structure.laws) if law is not None}

    @functools.cached_property
    def frictions(self) -> dict[int, Number]:
        """The dry friction of each element that can be held, in the units of the equations."""
        units = {index: scales(self.border.elements[index], self.units).of_signal("effort") for index in self.structure.holding}
        return {index: MP.mpf(self.border.elements[index].friction) / unit for index, unit in units.items()}

    @functools.cached_property
    def stops(self) -> dict[tuple[int, str], Number]:
        """The coordinates of rigid stops in the units of the equations, by element and side."""
        return {(index, side): self.constants[index][side] for index, law in self.laws.items() for side in law.rigid}

    @functools.cached_property
    def guards(self) -> dict[tuple[int, str], Node]:
        """The nodes of the guards, by element and name."""
        return {(guard.element, guard.name): guard.node for guard in derived(self.structure).guards}

    @functools.cached_property
    def constants(self) -> dict[int, dict[str, Number]]:
        """The numbers of laws that never change, by the names of their parameters, for each element with a law."""
        elements = self.border.elements
        return {index: constants(elements[index], law, scales(elements[index], self.units)) for index, law in self.laws.items()}

    @functools.cached_property
    def _places(self) -> list[dict[str, int]]:
        return self.structure.law_places

    @functools.cached_property
    def _of_forces(self) -> dict[int, tuple[int, int]]:
        return {index: friction_parameters(self.structure, index) for index in self.structure.holding}

    def coordinate(self, index: int) -> int:
        """The index in a state of the coordinate of an element with one coordinate."""
        return int(self.structure.places[index][0].start)

    def velocity(self, index: int) -> int:
        """The index in a state of the velocity of an element with one coordinate."""
        places = self.structure.places
        coordinates: int = places[-1][0].stop
        return coordinates + int(places[index][1].start)

    def in_si(self, index: int, state: Callable[[int], Number]) -> tuple[Number, Number]:
        """The coordinate and velocity of an element in SI units. state: returns a component of the state by its index."""
        element, leader = self.border.elements[index], self.structure.follows[index]
        if element.rule is not None and leader is not None:
            q, u = self.in_si(leader, state)
            return element.rule[1] * q + element.rule[2], element.rule[1] * u
        size = scales(element, self.units).size
        return size * state(self.coordinate(index)), size / self.units.time * state(self.velocity(index))

    def bounds(self, index: int, side: int) -> tuple[Number, Number]:
        """The least and the largest force that can hold an element at rest. side: at which rigid stop it is."""
        friction = self.frictions[index]
        return (-MP.inf if side > 0 else -friction), (MP.inf if side < 0 else friction)

    def changed(self, modes: Modes) -> dict[int, Number]:
        """The values of the parameters that depend on modes, by their indices."""
        values: dict[int, Number] = {}
        for index, effort in modes.efforts.items():
            unit = scales(self.border.elements[index], self.units).of_signal("effort")
            values[effort_parameter(self.structure, index)] = (MP.mpf(self.border.elements[index].effort) + effort) / unit
        for (index, name), part in modes.pieces.items():
            scale, places = scales(self.border.elements[index], self.units), self._places[index]
            unit = scale.of_signal(name)
            values[places[f"{name}.value"]] = part.value / unit
            values[places[f"{name}.slope"]] = part.slope / unit * scale.time
            values[places[f"{name}.since"]] = exact(part.since) / scale.time
        for index, law in self.laws.items():
            signs = {name: modes.signs.get((index, name), -1) for name in switching(law)}
            named = switched(law, signs, self.constants[index])
            values |= {self._places[index][name]: value for name, value in named.items()}
        for index, mode in modes.moves.items():
            values |= self._held(index, mode, modes.sides[index])
        return values

    def _held(self, index: int, mode: int, side: int) -> dict[int, Number]:
        """The parameters of an element that slips or is held, and of the guards of the force that holds it."""
        (force, moves), places = self._of_forces[index], self._places[index]
        values = {force: -mode * self.frictions[index], moves: MP.mpf(abs(mode))}
        for name, bound, unreached in zip(("low", "high"), self.bounds(index, side), (-MP.one, MP.one), strict=True):
            watched = not mode and MP.isfinite(bound)
            values[places[f"{name}.share"]] = MP.mpf(watched)
            values[places[name]] = bound if watched else unreached
        return values

    def with_modes(self, modes: Modes) -> list[Number]:
        """The parameters for given modes."""
        values = list(self.parameters)
        for index, value in self.changed(modes).items():
            values[index] = value
        return values

    def in_type(self, modes: Modes, dtype: Any) -> WideArray:
        """The parameters for given modes in a floating-point type."""
        if dtype not in self._stated:
            self._stated[dtype] = np.array([rounded(value, dtype) for value in self.parameters], dtype)
        values = self._stated[dtype].copy()
        for index, value in self.changed(modes).items():
            values[index] = rounded(value, dtype)
        return values

    @functools.cached_property
    def _stated(self) -> dict[Any, WideArray]:
        """The parameters without those that depend on modes, in floating-point types."""
        return {}

    def pieces_at(self, time: Fraction) -> dict[tuple[int, str], Piece]:
        """The pieces of the tables of continuous controllers at a time (s)."""
        parts = {}
        for index, law in self.laws.items():
            controller = self.border.elements[index].controller
            for name, kind in zip(SIGNALS, law.signals, strict=True):
                if kind == "table" and isinstance(table := getattr(controller, name), Samples):
                    parts[index, name] = piece(table, time)
        return parts


def rounded(value: Number, dtype: Any) -> Any:
    """A number of a hundred digits in a floating-point type."""
    return float(value) if dtype is np.float64 else wide(value)


def values_of(
    structure: Structure,
    nodes: Sequence[Node],
    state: Sequence[Any] | WideArray,
    parameters: Sequence[Any] | WideArray,
    arithmetic: tuple[Callable[[Any], Any], Any],
) -> list[Any]:
    """The values of nodes of a structure's tape in a state. arithmetic: the type of numbers, and a module with sin and cos."""
    number, functions = arithmetic
    sources: dict[str, Callable[[Any], Any]] = {
        "number": number,
        "parameter": lambda index: number(parameters[index]),
        "variable": lambda index: number(state[index]),
    }
    return made(derived(structure).tape, nodes, lambda kind, value: sources[kind](value), functions.sin, functions.cos)
