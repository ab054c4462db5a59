"""Impacts on rigid stops in the Lagrangian: M(q) (v+ - v-) = J^T lambda, with an impulse lambda on each stop that acts.

J has a row for each such element, with the sign of its way outwards. Forces have no part in an impact, since it takes no time:
an element that dry friction holds is free. An element that rests at another stop does not move outwards, and no impulse pulls
it: either its velocity remains zero, or the impulse on it is zero and it leaves the stop.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.independent.border import MP, Number
from bodycheck.reference.mechanisms.lagrangian.equations import derived
from bodycheck.reference.mechanisms.lagrangian.structure import friction_parameters
from bodycheck.reference.mechanisms.lagrangian.system import Modes, System, values_of

#: The part of a velocity, or of a response to an impulse, that may be rounding of a hundred digits.
ROUNDED = MP.mpf(10) ** -70


@dataclass(frozen=True, eq=False)
class _Impact:
    """An impact: the elements at stops with the sides of these, and what a unit impulse on each does to the velocities.

    before: the velocities outwards. coupling: for two elements, the velocity of the first outwards for a unit impulse outwards
    on the second.
    """

    sides: dict[int, int]
    before: dict[int, Number]
    responses: dict[int, dict[int, Number]]
    coupling: dict[tuple[int, int], Number]

    def couples(self, one: int, other: int) -> bool:
        """Return whether an impulse on one element changes the velocity of the other."""
        product = abs(self.coupling[one, one] * self.coupling[other, other])
        return bool(abs(self.coupling[one, other]) > ROUNDED * MP.sqrt(product))


def struck(system: System, state: Sequence[Number], modes: Modes, hits: dict[int, int]) -> tuple[list[Number], Modes]:
    """The state of a hundred digits after an impact, and the modes with 0 for all elements that are at rest and can be held.

    hits: for each element that hits a stop, 1 for the upper one and -1 for the lower one.

    Raises `OutOfReach` if the order of several impacts matters.
    """
    resting = {index: side for index, side in modes.sides.items() if side and index not in hits}
    impact = _impact(system, state, modes, hits | resting)
    if any(impact.couples(one, other) for one, other in itertools.combinations(hits, 2)):
        raise OutOfReach("two joints reach their stops at one instant, and the order of the two impacts matters")
    impulses = _impulses(impact, {index: -_restitution(system, index) * impact.before[index] for index in hits})
    after = list(state)
    for index, impulse in impulses.items():
        for slot, response in impact.responses[index].items():
            after[slot] += impact.sides[index] * impulse * response
    moves, sides = dict(modes.moves), dict(modes.sides)
    for index, side in hits.items():
        after[system.velocity(index)] = -side * _restitution(system, index) * impact.before[index]
        after[system.coordinate(index)] = system.stops[index, "upper" if side > 0 else "lower"]
        sides[index] = 0 if after[system.velocity(index)] else side
    for index, side in resting.items():
        if index in impulses or not any(impact.couples(index, other) for other in impulses):
            after[system.velocity(index)] = MP.zero
        sides[index] = 0 if after[system.velocity(index)] else side
    for index in moves:
        velocity = after[system.velocity(index)]
        held = not velocity and (sides[index] or system.frictions[index])
        moves[index] = 0 if held else (-1 if velocity < 0 else 1)
    return after, replace(modes, moves=moves, sides=sides)


def _impact(system: System, state: Sequence[Number], modes: Modes, sides: dict[int, int]) -> _Impact:
    responses = _responses(system, state, modes, list(sides))
    coupling = {(i, j): sides[i] * sides[j] * responses[j][system.velocity(i)] for i in sides for j in sides}
    return _Impact(sides, {i: side * state[system.velocity(i)] for i, side in sides.items()}, responses, coupling)


def _impulses(impact: _Impact, wanted: dict[int, Number]) -> dict[int, Number]:
    """The impulses on the elements on which one acts. wanted: the velocities outwards, after the impact, of those that hit.

    The problem has one solution, since the mass matrix is positive definite.
    """
    resting = [index for index in impact.sides if index not in wanted]
    for count in range(len(resting) + 1):
        for chosen in itertools.combinations(resting, count):
            active = [*wanted, *chosen]
            matrix = MP.matrix([[impact.coupling[one, other] for other in active] for one in active])
            right = MP.matrix([wanted.get(index, MP.zero) - impact.before[index] for index in active])
            impulses = dict(zip(active, MP.lu_solve(matrix, right), strict=True))
            size = max(abs(impulse) for impulse in impulses.values())
            pulled = any(impulses[index] > ROUNDED * size for index in chosen)
            if not pulled and not any(_leaves(impact, impulses, index) for index in resting if index not in chosen):
                return impulses
    raise OutOfReach("rounding leaves undecided which stops act in an impact")


def _leaves(impact: _Impact, impulses: dict[int, Number], index: int) -> bool:
    """Return whether impulses on others push an element that rests at its stop outwards."""
    return (
        any(impact.couples(index, other) for other in impulses)
        and sum(impact.coupling[index, other] * impulse for other, impulse in impulses.items()) > 0
    )


def _restitution(system: System, index: int) -> Number:
    stops = system.border.elements[index].stops
    assert stops is not None
    return MP.mpf(stops.restitution or 0.0)


def _responses(system: System, state: Sequence[Number], modes: Modes, chosen: Sequence[int]) -> dict[int, dict[int, Number]]:
    """The change of each velocity, by its index in the state, for a unit impulse on each of the chosen elements.

    It is the change of the acceleration for a unit force, while no element is held.
    """
    structure = system.structure
    free = replace(modes, moves=dict.fromkeys(modes.moves, 1), sides=dict.fromkeys(modes.sides, 0))
    parameters, slots = system.with_modes(free), range(structure.places[-1][0].stop, len(state) - structure.further)
    nodes = [derived(structure).rates[slot] for slot in slots]

    def accelerations(force: dict[int, Number]) -> list[Number]:
        values = list(parameters)
        for index, amount in force.items():
            values[friction_parameters(structure, index)[0]] += amount
        return values_of(structure, nodes, state, values, (MP.mpf, MP))

    rest, result = accelerations({}), {}
    for index in chosen:
        pushed = accelerations({index: MP.one})
        result[index] = {slot: one - other for slot, one, other in zip(slots, pushed, rest, strict=True)}
    return result
