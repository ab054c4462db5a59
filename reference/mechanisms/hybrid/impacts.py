"""Impacts at rigid stops: impulses along joints, with the joints that stops hold at that instant."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.mechanisms.friction.sticking import MOST_PIVOTS
from bodycheck.reference.mechanisms.hybrid.phases import Number, form_of, functions_of, places
from bodycheck.reference.mechanisms.link_states import Form, Rates, derivatives, floating, sizes
from bodycheck.reference.mechanisms.tree import Tree


@dataclass(frozen=True, eq=False)
class Blow:
    """An impact: the change (k,) of a state, and the links that remain held by their stops."""

    change: list[Any]
    held: frozenset[int]


def response(tree: Tree, state: Sequence[Any], index: int, held: frozenset[int], number: Number) -> Rates:
    """The change of a state under a unit impulse along the joint of a link, and the strains, which are impulses, of all links.

    held: the links whose joints cannot move.
    """
    constants = []
    for each, base in enumerate(form_of(tree, number).constants):
        force, moves = number(1) if each == index else 0, 0 if each in held else 1
        constants.append(replace(base, force=force, stiffness=0, damping=0, moves=moves))
    return derivatives(Form(form_of(tree, number).links, constants, (0, 0, 0)), _stopped(tree, state), functions_of(number))


def _stopped(tree: Tree, state: Sequence[Any]) -> list[Any]:
    """A state with the same coordinates, in which nothing moves."""
    still, first = list(state), 0
    for link in tree.links:
        held, moving = sizes(link)
        still[first + held : first + held + moving] = [0] * moving
        first += held + moving
    for _ in floating(tree.links):
        still[first + 3 : first + 6] = [0] * 3
        first += 6
    return still


def blow(tree: Tree, state: Sequence[Any], index: int, sides: Mapping[int, int], number: Number) -> Blow:
    """Return the impact of a link at its stop. sides: of the links that stops hold, which take up impulses."""
    held, at = frozenset(sides), places(tree)
    for _ in range(MOST_PIVOTS):
        change = struck(tree, state, index, held, number)
        unit = response(tree, state, index, held, number)
        impulse = change[at[index]] / unit.state[at[index]]
        wrong = next((each for each in sides if _wrong(impulse, unit, each, sides[each], at[each], each in held)), None)
        if wrong is None:
            return Blow(change, held)
        held = held ^ {wrong}
    raise OutOfReach("an impact leaves undecided which joints leave their stops")


def _wrong(impulse: Any, unit: Rates, index: int, side: int, place: int, held: bool) -> bool:
    """Return whether a held joint would have to be pulled by its stop, or one that is not held would move beyond it."""
    return bool(side * impulse * (unit.strains[index] if held else -unit.state[place]) < 0)


def struck(tree: Tree, state: Sequence[Any], index: int, held: frozenset[int], number: Number) -> list[Any]:
    """The change of a state by the impact of a link at its stop while some links are held."""
    stops = tree.links[index].stops
    assert stops is not None and stops.restitution is not None, "rigid stops have a restitution"
    unit, place = response(tree, state, index, held, number), places(tree)[index]
    impulse = -(1 + number(stops.restitution)) * state[place] / unit.state[place]
    return [impulse * part for part in unit.state]
