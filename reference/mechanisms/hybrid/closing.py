"""Which joints stay at rest: joints with dry friction, and joints at rigid stops.

Each such joint either does not accelerate, and its force is within what friction and stops can hold, or it accelerates in a
direction that they allow. This complementarity problem is solved by pivots, as in `friction.sticking`.
"""

from collections.abc import Mapping

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.numbers import Real, real
from bodycheck.reference.mechanisms.friction.sticking import EQUAL, MOST_PIVOTS, sign
from bodycheck.reference.mechanisms.hybrid.equations import Shape
from bodycheck.reference.mechanisms.hybrid.phases import Number, Phase, in_numbers, rates_in
from bodycheck.reference.mechanisms.tree import Tree

#: The part of the forces by which a decision in double precision is clear.
CLEAR = 1e-9


def closed(tree: Tree, shape: Shape, phase: Phase, resting: Mapping[int, int], eps: float) -> dict[int, int]:
    """Return the modes of all links that may be held, in which those at rest neither stick nor move against their forces.

    Parameters
    ----------
    tree, shape, phase
        A tree and its phase.
    resting
        The side of each link at rest: 1 or -1 if it is at its upper or lower stop, otherwise 0.
    eps
        The size of a rounding of the state; 0 if it is exact.
    """
    if not resting:
        return phase.rest
    guess = _pivoted(tree, shape, phase, resting, float, CLEAR)
    if guess is not None and _is_clear(tree, shape, phase, guess, resting):
        return guess
    modes = _pivoted(tree, shape, phase, resting, real, EQUAL * eps)
    if modes is None:
        raise OutOfReach("rounding leaves undecided which joints stay at rest")
    return modes


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


def _is_clear(tree: Tree, shape: Shape, phase: Phase, modes: dict[int, int], resting: Mapping[int, int]) -> bool:
    """Return whether no strain is near the value at which the mode of a link at rest changes."""
    strains = rates_in(tree, shape, phase, in_numbers(phase.state, float), phase.time, float, modes).strains
    largest = max(abs(strains[index]) for index in resting)
    for index, side in resting.items():
        friction, strain = float(tree.links[index].friction), strains[index]
        margin = modes[index] * strain if modes[index] else friction + side * strain if side else friction - abs(strain)
        if margin < 2 * CLEAR * (friction + largest):
            return False
    return True
