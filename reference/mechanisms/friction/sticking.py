"""The modes of joints with dry friction that are at rest: whether they stick or begin to slip, and how sure this is.

Each such joint either does not accelerate, and its force is within the friction, or it accelerates against the full friction.
This complementarity problem has one solution, as the mass matrix is positive definite. It is found by pivots: the first joint
whose mode contradicts the accelerations gets the mode that they demand, until there is none (Murty, Linear Complementarity,
1988, section 4.2; with two bounds Judice and Pires, J. Optim. Theory Appl. 74, 1992). Double precision only makes the first
guess; arithmetic of a hundred digits decides.

At t = 0 the state is exact, and so is the decision: a joint whose strain is equal to its friction sticks. A later state has
errors. If the decision could be another one within them, the accelerations of the joints are uncertain: see `doubts`.

A joint may begin to slip under a load that is hardly larger than its friction. Then the forces cancel, and the rounding of each
is large beside the acceleration, from which the sizes of rounding errors are estimated otherwise: see `cancellations`.
"""

import functools
import math
import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from bodycheck.reference.bounds import EPS
from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.numbers import MP, Real, real
from bodycheck.reference.mechanisms.link_states import (
    Decision,
    Form,
    Rates,
    derivatives,
    floating,
    in_arithmetic,
    places_of_rates,
    sizes,
)
from bodycheck.reference.mechanisms.tree import Tree

#: The mode of each link with dry friction, by its index: 1 or -1 if it slips forwards or backwards, 0 if it sticks.
Modes = dict[int, int]

#: The part of the forces by which a strain at t = 0 may exceed the friction without slip: rounding of a hundred digits.
EXACT = MP.mpf(10) ** -70

#: The number of roundings, relative to the forces, up to which a strain in a state that was integrated equals the friction.
EQUAL = 2.0**12

#: The part of the forces that double precision does not resolve.
IN_DOUBLES = EQUAL * EPS

#: The largest number of pivots.
MOST_PIVOTS = 2000

#: The part of the forces, in units of the relative error of a state, above which a margin certainly exceeds its error.
CLEAR = 1e6

#: The number of roundings of the terms of an acceleration, and the number and the size of random variations of all numbers from
#: which the sizes of these terms are measured: large beside a rounding of doubles, and small beside 1.
ROUNDINGS, VARIATIONS, VARIATION = 8.0, 4, 2.0**-26


@dataclass(frozen=True, eq=False)
class Doubt:
    """An uncertain acceleration from a time on (s): whether it is that of a turn, and its error, in rad/s^2 or m/s^2."""

    since: float
    turns: bool
    acceleration: float


def settled(tree: Tree, state: Sequence[Real], moving: Modes, slack: Real) -> Modes:
    """Return the modes of links with dry friction: moving links keep their modes, and accelerations decide for links at rest.

    Parameters
    ----------
    tree, state
        A tree and its state, in numbers of a hundred digits.
    moving
        The sign of each link's velocity, 0 for a link at rest.
    slack
        The part of the forces by which a strain may exceed the friction without slip.

    Raises
    ------
    OutOfReach
        If no modes agree with the accelerations.
    """
    rest = [index for index, mode in moving.items() if not mode]
    if not rest:
        return dict(moving)
    guess = _pivoted(tree, state, moving, rest, IN_DOUBLES, float, math)
    if guess is not None and slack >= IN_DOUBLES:
        return guess
    modes = _pivoted(tree, state, guess or moving, rest, slack, real, MP)
    if modes is None:
        raise OutOfReach("rounding leaves undecided which joints with dry friction stick", "dry friction")
    return modes


def _pivoted(
    tree: Tree,
    state: Sequence[Real],
    modes: Modes,
    rest: Sequence[int],
    slack: Real,
    number: Callable[[Any], Any],
    functions: Any,
) -> Modes | None:
    """The modes after the pivots from given modes of the links at rest; None if there are too many pivots."""
    for _ in range(MOST_PIVOTS):
        strains = with_modes(tree, state, modes, number, functions).strains
        frictions = {index: number(tree.links[index].friction) for index in rest}
        demanded = {index: _demanded(strains[index], modes[index], frictions[index], slack) for index in rest}
        wrong = next((index for index in rest if demanded[index] != modes[index]), None)
        if wrong is None:
            return modes
        modes = {**modes, wrong: demanded[wrong]}
    return None


def _demanded(strain: Any, mode: int, friction: Any, slack: Any) -> int:
    """Return the mode of a link at rest that its strain demands, if it has the given mode."""
    allowed = slack * (friction + abs(strain))
    if mode:
        return mode if mode * strain > allowed else 0
    return 0 if abs(strain) <= friction + allowed else sign(strain)


def sign(value: Any) -> int:
    """Return the sign of a number of any type."""
    return int(value > 0) - int(value < 0)


def with_modes(
    tree: Tree, state: Sequence[Any], modes: Mapping[int, int], number: Callable[[Any], Any], functions: Any
) -> Rates:
    """The derivative of a state and the strains of links in given modes.

    number: the function that converts numbers to an arithmetic. functions: the `sin` and `cos` of this arithmetic.
    """
    return _in_modes(_form(tree, number), tree, state, modes, number, functions)


def _in_modes(
    form: Form, tree: Tree, state: Sequence[Any], modes: Mapping[int, int], number: Callable[[Any], Any], functions: Any
) -> Rates:
    constants = list(form.constants)
    for index, mode in modes.items():
        link = tree.links[index]
        force = number(link.constants.force - mode * link.friction)
        constants[index] = replace(constants[index], force=force, moves=abs(mode))
    return derivatives(Form(form.links, constants, form.gravity), [number(value) for value in state], functions)


@functools.lru_cache(maxsize=32)
def _form(tree: Tree, number: Callable[[Any], Any]) -> Form:
    return in_arithmetic(tree, number)


def doubts(decision: Decision, relative: float, errors: Sequence[float]) -> Iterator[Doubt]:
    """Yield the uncertain accelerations where the mode of a link may be another one within the errors of the state.

    The force on such a link is uncertain by its margin, which is the distance of its strain from the value at which its mode
    changes, and the error of its strain. This force accelerates all links.

    Parameters
    ----------
    decision
        The decision.
    relative
        The relative error of the state.
    errors
        The errors of the components of the state.
    """
    if not any(errors):
        return
    tree, state, modes = decision.tree, decision.state, decision.modes
    near = with_modes(tree, state, modes, float, math)
    if not any(margin <= (CLEAR * relative + IN_DOUBLES) * size for margin, size in _margins(decision, near)):
        return
    exactly = with_modes(tree, state, modes, real, MP)
    moved = []
    for component, error in enumerate(errors):
        if not error:
            continue
        beside = [value + error if index == component else value for index, value in enumerate(state)]
        moved.append(with_modes(tree, beside, modes, real, MP).strains)
    for index, (margin, _) in zip(decision.rest, _margins(decision, exactly), strict=True):
        error = sum(abs(strains[index] - exactly.strains[index]) for strains in moved)
        if margin <= error and (slack := abs(margin) + error):
            yield from _under_force(decision, index, slack)


def _under_force(decision: Decision, index: int, force: Real) -> Iterator[Doubt]:
    """Yield the accelerations that a force on a link causes, by the difference of its slips forwards and backwards."""
    tree, state, modes = decision.tree, decision.state, decision.modes
    forwards, backwards = (with_modes(tree, state, {**modes, index: mode}, real, MP) for mode in (1, -1))
    part = force / (2 * tree.links[index].friction)
    for component, turns in _accelerations(tree):
        if error := float(part * abs(forwards.state[component] - backwards.state[component])):
            yield Doubt(decision.time, turns, error)


def cancellations(decision: Decision, eps: float, roundings: float) -> Iterator[Doubt]:
    """Yield the accelerations that are uncertain by the rounding of forces that cancel where a link begins to slip.

    Parameters
    ----------
    decision
        The decision.
    eps
        The size of a rounding.
    roundings
        The number of roundings, relative to the largest acceleration, that the errors of the motion include otherwise.
    """
    modes = decision.modes
    if not any(modes[index] for index in decision.rest):
        return
    tree, state, chance = decision.tree, decision.state, random.Random(0)

    def varied(value: Real) -> float:
        return float(value) * (1 + VARIATION * chance.uniform(-1, 1))

    rates = with_modes(tree, state, modes, float, math).state
    others = [_in_modes(in_arithmetic(tree, varied), tree, state, modes, varied, math).state for _ in range(VARIATIONS)]
    components = list(_accelerations(tree))
    for kind in (True, False):
        chosen = [component for component, turns in components if turns == kind]
        largest = max((abs(rates[component]) for component in chosen), default=0.0)
        for component in chosen:
            terms = max(abs(other[component] - rates[component]) for other in others) / VARIATION
            if (error := ROUNDINGS * terms - roundings * largest) > 0:
                yield Doubt(decision.time, kind, eps * error)


def _accelerations(tree: Tree) -> Iterator[tuple[int, bool]]:
    """Yield the index of each acceleration in the derivative of a state, and whether it is that of a turn."""
    for link, first in zip(tree.links, places_of_rates(tree.links), strict=True):
        for component in range(first, first + sizes(link)[1]):
            yield component, link.kind != "prismatic"
    count = sum(sum(sizes(link)) for link in tree.links)
    for _ in floating(tree.links):
        yield from ((component, False) for component in range(count + 3, count + 6))
        count += 6


def _margins(decision: Decision, rates: Rates) -> Iterator[tuple[Any, Any]]:
    """For each link that was at rest, the distance of its strain from a change of its mode, and the size of its forces."""
    for index in decision.rest:
        mode, strain, friction = decision.modes[index], rates.strains[index], decision.tree.links[index].friction
        yield mode * strain if mode else friction - abs(strain), friction + abs(strain)
