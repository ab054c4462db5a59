"""The decision which joints are held at rest in the Lagrangian, by dry friction or at a stop: by Gauss's principle.

Of all accelerations a, the true ones minimise the constraint (a - b)^T M (a - b) / 2 plus the sum of f |a_i| over the joints at
rest, where M b are the forces without friction, and a joint at a rigid stop does not accelerate outwards. The forces that hold
the joints solve the dual problem, in which each is between two bounds: at most f either way, and inwards without bound at a
stop. It is solved in double precision by projected Gauss-Seidel iteration. Its solution is a guess: arithmetic of a hundred
digits tests it, and tries other modes, those with the fewest changes first, if it is wrong. This code shares nothing with the
decisions of the recursion.
"""

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.independent.border import MP, Number
from bodycheck.reference.mechanisms.lagrangian.differentiation import Node
from bodycheck.reference.mechanisms.lagrangian.equations import derived
from bodycheck.reference.mechanisms.lagrangian.structure import friction_parameters
from bodycheck.reference.mechanisms.lagrangian.system import Modes, System, values_of
from bodycheck.reference.trajectory import Array

#: The largest number of joints at rest for which all combinations of modes, 3 to this power, are tried if the guess is wrong.
MOST_TRIED = 8

#: The largest number of rounds of the iteration, and the change of a force, relative to the largest, below which it ends.
ROUNDS, UNCHANGED = 2000, 1e-13

#: Rounding of doubles in accelerations, relative to the largest terms; only the guess depends on it.
NEAR = 1e-11

#: The part of the friction that rounding of a hundred digits may hide.
EXACT = MP.mpf(10) ** -75


@dataclass(frozen=True, eq=False)
class Reaction:
    """The result of the equations for one element: its acceleration, the force that holds it in its motion, its inertia."""

    acceleration: Any
    force: Any
    inertia: Any


def reactions(
    system: System, state: Sequence[Any], parameters: Sequence[Any], number: Callable[[Any], Any], functions: Any
) -> dict[int, Reaction]:
    """The reactions of the elements that can be held, in the arithmetic of `number` and `functions`."""
    equations, holding = derived(system.structure), system.structure.holding
    nodes: list[Node] = [equations.rates[system.velocity(index)] for index in holding]
    nodes += [node for pair in equations.strains for node in pair]
    values = values_of(system.structure, nodes, state, parameters, (number, functions))
    pairs = values[len(holding) :]
    return {index: Reaction(values[row], pairs[2 * row], pairs[2 * row + 1]) for row, index in enumerate(holding)}


def decided(system: System, state: Sequence[Number], modes: Modes, slack: Number) -> Modes:
    """Return the modes in which the elements at rest are held or begin to move, in a state of a hundred digits.

    modes: the modes, with 0 for each element at rest that can be held, and the sign of its velocity for any other. slack: the
    part of the forces up to which a force may exceed the bounds of an element that is held. Raises `OutOfReach` if no modes
    agree with the accelerations.
    """
    rest = [index for index, mode in modes.moves.items() if not mode]
    if not rest:
        return modes
    for trial in _candidates(_guess(system, state, modes, rest), rest):
        if all(trial[index] in (0, -side) for index, side in modes.sides.items() if side and index in trial):
            moved = replace(modes, moves={**modes.moves, **trial})
            outcome = reactions(system, state, system.with_modes(moved), MP.mpf, MP)
            if all(agrees(system, moved, index, outcome[index], slack) for index in rest):
                return _left(moved)
    raise OutOfReach("rounding leaves undecided which joints are held at rest, in the Lagrangian")


def _left(modes: Modes) -> Modes:
    """The modes without the stops from which elements move away."""
    return replace(modes, sides={index: 0 if modes.moves[index] else side for index, side in modes.sides.items()})


def agrees(system: System, modes: Modes, index: int, outcome: Reaction, slack: Any) -> bool:
    """Return whether an element at rest can have its mode."""
    mode, friction = modes.moves[index], system.frictions[index]
    if mode:
        return bool(mode * outcome.acceleration * outcome.inertia > slack * friction)
    low, high = system.bounds(index, modes.sides[index])
    room = slack * (friction + abs(outcome.force))
    return bool(low - room <= outcome.force <= high + room)


def _candidates(guess: dict[int, int], rest: Sequence[int]) -> Iterator[dict[int, int]]:
    """The guess, and then all other modes of few elements at rest, those with the fewest differences from it first."""
    yield guess
    if len(rest) <= MOST_TRIED:
        others = (dict(zip(rest, trial, strict=True)) for trial in itertools.product((0, 1, -1), repeat=len(rest)))
        yield from sorted(others, key=lambda modes: sum(modes[index] != guess[index] for index in rest))[1:]


def accelerations(
    system: System, state: Sequence[Any], modes: Modes, chosen: Sequence[int], arithmetic: tuple[Callable[[Any], Any], Any]
) -> tuple[list[Any], list[list[Any]]]:
    """The accelerations of chosen elements that can be held, with no force on them, and for a unit force on each of them.

    modes: the modes, in which the chosen elements are not held.
    """
    parameters = system.with_modes(modes)

    def at(pushed: Mapping[int, Number]) -> list[Any]:
        values = list(parameters)
        for index in chosen:
            force, moves = friction_parameters(system.structure, index)
            values[force], values[moves] = pushed.get(index, MP.zero), MP.one
        outcome = reactions(system, state, values, *arithmetic)
        return [outcome[index].acceleration for index in chosen]

    free = at({})
    pushed = [at({index: MP.one}) for index in chosen]
    return free, [[value - rest for value, rest in zip(each, free, strict=True)] for each in pushed]


def _guess(system: System, state: Sequence[Number], modes: Modes, rest: Sequence[int]) -> dict[int, int]:
    """The modes of elements at rest in double precision, from the forces that solve the dual problem."""
    outcome = accelerations(system, state, modes, rest, (float, math))
    free, across = np.array(outcome[0]), np.array(outcome[1]).T
    pairs = [[float(bound) for bound in system.bounds(index, modes.sides[index])] for index in rest]
    (low, high), force = np.array(pairs).T, np.zeros(len(rest))
    for _ in range(ROUNDS):
        before = force.copy()
        for i, row in enumerate(across):
            force[i] = np.clip(force[i] - (free[i] + row @ force) / row[i], low[i], high[i])
        if np.abs(force - before).max() <= UNCHANGED * np.abs(force).max():
            break
    acceleration, scale = free + across @ force, np.abs(free) + np.abs(across) @ np.abs(force)
    return dict(zip(rest, _slipping(force, (low, high), acceleration, scale), strict=True))


def _slipping(force: Array, bounds: tuple[Array, Array], acceleration: Array, scale: Array) -> list[int]:
    """The modes of elements with given forces and accelerations: those at a bound that accelerate away slip."""
    backwards = (force == bounds[1]) & (acceleration < -NEAR * scale)
    forwards = (force == bounds[0]) & (acceleration > NEAR * scale)
    return [int(mode) for mode in forwards.astype(int) - backwards.astype(int)]
