"""Impacts at rigid stops: impulses along joints, with the joints that stops hold at that instant.

An impact may push a joint that another stop holds against this stop, which then takes up an impulse too. If neither stop has a
restitution, both joints are at rest afterwards, in whatever order the impacts follow one another. Otherwise the order matters,
and the impact is refused. Dry friction is a bounded force and takes up no impulse.
"""

from collections.abc import Collection, Mapping, Sequence
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


def blow(tree: Tree, state: Sequence[Any], index: int, sides: Mapping[int, int], others: Sequence[int], number: Number) -> Blow:
    """Return the impact of a link at its stop.

    sides: of the links that stops hold, which take up impulses. others: the links that meet their stops at the same instant.
    """
    held, at = frozenset(sides), places(tree)
    for _ in range(MOST_PIVOTS):
        unit = response(tree, state, index, held, number)
        impulse = _impulse(tree, state, index, unit, number)
        wrong = next((each for each in sides if _wrong(impulse, unit, each, sides[each], at[each], each in held)), None)
        if wrong is None:
            change = [impulse * part for part in unit.state]
            pushed = {each for each in held if unit.strains[each]} | {each for each in others if change[at[each]]}
            _require_order_not_to_matter(tree, index, pushed)
            return Blow(change, held)
        held = held ^ {wrong}
    raise OutOfReach("an impact leaves undecided which joints leave their stops", "stops")


def _require_order_not_to_matter(tree: Tree, index: int, others: Collection[int]) -> None:
    """Raise `OutOfReach` if other joints take part in an impact, and one of all their stops has a restitution."""
    if others and any(restitution(tree, each) for each in (index, *others)):
        raise OutOfReach("two stops take up an impact, and the result depends on the order,", "stops")


def restitution(tree: Tree, index: int) -> float:
    """The restitution of the rigid stops of a link."""
    stops = tree.links[index].stops
    assert stops is not None, "rigid stops have a restitution"
    assert stops.restitution is not None, "rigid stops have a restitution"
    return stops.restitution


def _wrong(impulse: Any, unit: Rates, index: int, side: int, rate_at: int, held: bool) -> bool:
    """Return whether a held joint would have to be pulled by its stop, or one that is not held would move beyond it."""
    return bool(side * impulse * (unit.strains[index] if held else -unit.state[rate_at]) < 0)


def struck(tree: Tree, state: Sequence[Any], index: int, held: frozenset[int], number: Number) -> list[Any]:
    """The change of a state by the impact of a link at its stop while some links are held."""
    unit = response(tree, state, index, held, number)
    impulse = _impulse(tree, state, index, unit, number)
    return [impulse * part for part in unit.state]


def _impulse(tree: Tree, state: Sequence[Any], index: int, unit: Rates, number: Number) -> Any:
    """The impulse of the impact of a link, whose response to a unit impulse is given."""
    rate_at = places(tree)[index]
    return -(1 + number(restitution(tree, index))) * state[rate_at] / unit.state[rate_at]
