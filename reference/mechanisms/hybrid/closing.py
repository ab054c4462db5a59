"""The decision which joints stay at rest: joints with dry friction, and joints at rigid stops.

Each such joint either does not accelerate, and its force is within what friction and stops can hold, or it accelerates in a
direction that they allow. This complementarity problem is solved by pivots, as in `friction.sticking`.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from bodycheck.reference.errors import Cause, Stopped
from bodycheck.reference.exact.numbers import Real, real
from bodycheck.reference.mechanisms.friction.sticking import EXACT, MOST_PIVOTS, sign
from bodycheck.reference.mechanisms.hybrid.equations import Shape
from bodycheck.reference.mechanisms.hybrid.phases import Number, Phase, in_numbers, rates_in
from bodycheck.reference.mechanisms.tree import Tree

#: The part of the forces by which a decision in double precision is clear.
CLEAR = 1e-9


@dataclass(frozen=True, eq=False)
class Closed:
    """The modes of the links that may be held, and how far another decision is, as a part of the forces on joints at rest."""

    modes: dict[int, int]
    room: float


def closed(tree: Tree, shape: Shape, phase: Phase, resting: Mapping[int, int], *, exact: bool) -> Closed:
    """Return the modes of all links that may be held, in which those at rest neither stick nor move against their forces.

    Parameters
    ----------
    tree, shape, phase
        A tree and its phase.
    resting
        The side of each link at rest: 1 or -1 if it is at its upper or lower stop, otherwise 0.
    exact
        Whether the state is exact. If not, `Stopped` is raised where another decision is within `CLEAR`.
    """
    if not resting:
        return Closed(phase.rest, math.inf)
    guess = _pivoted(tree, shape, phase, resting, float, CLEAR)
    room = 0.0 if guess is None else _room(tree, shape, phase, guess, resting)
    if guess is not None and room > 2 * CLEAR:
        return Closed(guess, room)
    modes = _pivoted(tree, shape, phase, resting, real, EXACT) if exact else None
    if modes is None:
        cause: Cause = "dry friction" if any(tree.links[index].friction for index in resting) else "stops"
        time = float(phase.time)
        raise Stopped(f"rounding leaves undecided which joints stay at rest at t = {time:.6g} s", time, cause)
    return Closed(modes, room)


def _pivoted(
    tree: Tree, shape: Shape, phase: Phase, resting: Mapping[int, int], number: Number, slack: Real
) -> dict[int, int] | None:
    modes, state = phase.rest, in_numbers(phase.state, number)
    for _ in range(MOST_PIVOTS):
        strains = rates_in(tree, shape, phase, state, phase.time, number, modes).strains
        largest = max(abs(strains[index]) for index in resting)
        wrong = None
        for index, side in resting.items():
            friction = number(tree.links[index].friction)
            allowed = slack * (friction + largest)
            if (mode := _demanded(strains[index], modes[index], friction, side, allowed)) != modes[index]:
                wrong = index, mode
                break
        if wrong is None:
            return modes
        modes = {**modes, wrong[0]: wrong[1]}
    return None


def _demanded(strain: Real, mode: int, friction: Real, side: int, allowed: Real) -> int:
    """Return the mode that a strain demands of a link at rest that has the given mode."""
    if mode:
        return mode if mode * strain > allowed else 0
    if -(friction + allowed) <= strain <= friction + allowed or side * strain > 0:
        return 0
    return sign(strain)


def _room(tree: Tree, shape: Shape, phase: Phase, modes: dict[int, int], resting: Mapping[int, int]) -> float:
    """The smallest distance of a strain from the value at which the mode of a link at rest changes, as a part of the forces."""
    strains = rates_in(tree, shape, phase, in_numbers(phase.state, float), phase.time, float, modes).strains
    largest, room = max(abs(strains[index]) for index in resting), math.inf
    for index, side in resting.items():
        friction, strain = float(tree.links[index].friction), strains[index]
        margin = modes[index] * strain if modes[index] else friction + side * strain if side else friction - abs(strain)
        if friction or largest:  # without any force nothing moves, whatever the decision
            room = min(room, margin / (friction + largest))
    return room
