"""The modes of joints with dry friction in the Lagrangian: which of the joints at rest stick, by Gauss's principle.

Of all accelerations a, the true ones minimise the constraint (a - b)^T M (a - b) / 2 plus the sum of f |a_i| over the joints at
rest, where M b are the forces without friction. The forces of friction solve the dual problem, in which each is at most f. It
is solved in double precision by projected Gauss-Seidel iteration. Its solution is a guess: arithmetic of a hundred digits tests
it, and tries other modes, those with the fewest changes first, if it is wrong. This code shares nothing with the decisions of
the recursion (`sticking`).
"""

import functools
import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.independent.border import MP, Number
from bodycheck.reference.mechanisms.lagrangian.border import Border
from bodycheck.reference.mechanisms.lagrangian.differentiation import Node, made
from bodycheck.reference.mechanisms.lagrangian.equations import derived
from bodycheck.reference.mechanisms.lagrangian.structure import Structure, Units, friction_parameters
from bodycheck.reference.trajectory import Array

#: The mode of each element with dry friction, by its index: 1 or -1 if it slips forwards or backwards, 0 if it sticks.
Modes = dict[int, int]

#: The largest number of joints at rest for which all combinations of modes, 3 to this power, are tried if the guess is wrong.
MOST_TRIED = 8

#: The largest number of rounds of the iteration, and the change of a force, in units of the friction, below which it ends.
ROUNDS, UNCHANGED = 2000, 1e-13

#: Rounding of doubles in accelerations, relative to the largest terms; only the guess depends on it.
NEAR = 1e-11

#: The part of the friction that rounding of a hundred digits may hide.
EXACT = MP.mpf(10) ** -75


@dataclass(frozen=True, eq=False)
class Slipping:
    """A mechanism with dry friction: its elements, their structure, the units of the equations, and the parameters."""

    border: Border
    structure: Structure
    units: Units
    parameters: list[Number]

    @functools.cached_property
    def frictions(self) -> dict[int, Number]:
        """The friction of each element that has some, in the units of the equations, by the index of the element."""
        units, sizes = self.units, dict[int, Number]()
        for index, element in enumerate(self.border.elements):
            if element.friction:
                inertia = MP.mpf(units.mass) * (MP.mpf(units.length) if element.kind == "slide" else MP.mpf(units.length) ** 2)
                sizes[index] = MP.mpf(element.friction) * MP.mpf(units.time) ** 2 / inertia
        return sizes

    def velocity(self, index: int) -> int:
        """The index in a state of the velocity of an element with one coordinate."""
        places = self.structure.places
        coordinates: int = places[-1][0].stop
        return coordinates + int(places[index][1].start)

    def with_modes(self, modes: Modes) -> list[Number]:
        """The parameters for given modes."""
        values = list(self.parameters)
        for index, mode in modes.items():
            force, moves = friction_parameters(self.structure, index)
            values[force], values[moves] = -mode * self.frictions[index], MP.mpf(abs(mode))
        return values


@dataclass(frozen=True, eq=False)
class Reaction:
    """The result of the equations for one element: its acceleration, the friction that its motion requires, its inertia."""

    acceleration: Any
    friction: Any
    inertia: Any


def reactions(
    slipping: Slipping, state: Sequence[Any], parameters: Sequence[Any], number: Callable[[Any], Any], functions: Any
) -> dict[int, Reaction]:
    """The reactions of the elements with dry friction in a state, in the arithmetic of `number` and `functions`."""
    equations = derived(slipping.structure)
    dry = list(slipping.frictions)
    nodes: list[Node] = [equations.rates[slipping.velocity(index)] for index in dry]
    nodes += [node for pair in equations.strains for node in pair]
    sources: dict[str, Callable[[Any], Any]] = {
        "number": number,
        "parameter": lambda index: number(parameters[index]),
        "variable": lambda index: number(state[index]),
    }
    values = made(equations.tape, nodes, lambda kind, value: sources[kind](value), functions.sin, functions.cos)
    pairs = values[len(dry) :]
    return {index: Reaction(values[row], pairs[2 * row], pairs[2 * row + 1]) for row, index in enumerate(dry)}


def decided(slipping: Slipping, state: Sequence[Number], moving: Modes, slack: Number) -> Modes:
    """Return the modes of all elements with dry friction in a state of a hundred digits.

    moving: the sign of each velocity, 0 for an element at rest. slack: the part of the forces up to which a required friction
    may exceed the friction of an element that sticks. Raises `OutOfReach` if no modes agree with the accelerations.
    """
    rest = [index for index, mode in moving.items() if not mode]
    if not rest:
        return dict(moving)
    for modes in _candidates(_guess(slipping, state, moving, rest), rest):
        trial = {**moving, **modes}
        outcome = reactions(slipping, state, slipping.with_modes(trial), MP.mpf, MP)
        if all(_agrees(outcome[index], trial[index], slipping.frictions[index], slack) for index in rest):
            return trial
    raise OutOfReach("rounding leaves undecided which joints with dry friction stick, in the Lagrangian")


def _agrees(outcome: Reaction, mode: int, friction: Number, slack: Number) -> bool:
    """Return whether an element at rest can have a mode."""
    if mode:
        return bool(mode * outcome.acceleration * outcome.inertia > slack * friction)
    return bool(abs(outcome.friction) <= friction + slack * (friction + abs(outcome.friction)))


def _candidates(guess: Modes, rest: Sequence[int]) -> Iterator[Modes]:
    """The guess, and then all other modes of few elements at rest, those with the fewest differences from it first."""
    yield guess
    if len(rest) <= MOST_TRIED:
        others = (dict(zip(rest, trial, strict=True)) for trial in itertools.product((0, 1, -1), repeat=len(rest)))
        yield from sorted(others, key=lambda modes: sum(modes[index] != guess[index] for index in rest))[1:]


def _guess(slipping: Slipping, state: Sequence[Number], moving: Modes, rest: Sequence[int]) -> Modes:
    """The modes of elements at rest in double precision, from the forces of friction that solve the dual problem."""

    def accelerations(pushed: int | None) -> Array:
        # An element at rest is not held here, since its acceleration without friction is needed.
        values = slipping.with_modes(moving)
        for index in rest:
            force, moves = friction_parameters(slipping.structure, index)
            values[force], values[moves] = slipping.frictions[index] if index == pushed else MP.zero, MP.one
        outcome = reactions(slipping, state, values, float, math)
        return np.array([outcome[index].acceleration for index in rest])

    free = accelerations(None)
    across = np.stack([accelerations(index) - free for index in rest], axis=1)
    force = np.zeros(len(rest))
    for _ in range(ROUNDS):
        before = force.copy()
        for i, row in enumerate(across):
            force[i] = np.clip(force[i] - (free[i] + row @ force) / row[i], -1.0, 1.0)
        if np.abs(force - before).max() < UNCHANGED:
            break
    acceleration, scale = free + across @ force, np.abs(free) + np.abs(across).sum(axis=1)
    slips = (np.abs(force) == 1) & (np.abs(acceleration) > NEAR * scale)
    return dict(zip(rest, (int(mode) for mode in np.where(slips, -np.sign(force), 0)), strict=True))
