"""Impacts on rigid stops in the Lagrangian: M(q) (v+ - v-) = J^T lambda, with an impulse lambda on each stop that is hit.

J has a row for each such element, with the sign of its way outwards. Forces have no part in an impact, since it takes no time:
an element that dry friction holds is free. An element that rests at another stop takes part if the impulse pushes it outwards.
Which of the two stops acts first matters then, unless neither gives anything back: the velocities of both become zero.
"""

from collections.abc import Sequence
from dataclasses import replace

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.independent.border import MP, Number
from bodycheck.reference.mechanisms.lagrangian.equations import derived
from bodycheck.reference.mechanisms.lagrangian.structure import friction_parameters
from bodycheck.reference.mechanisms.lagrangian.system import Modes, System, values_of

#: The largest part of a response of a velocity to an impulse that is rounding of a hundred digits.
UNCOUPLED = MP.mpf(10) ** -70


def struck(system: System, state: Sequence[Number], modes: Modes, hits: dict[int, int]) -> tuple[list[Number], Modes]:
    """The state of a hundred digits after an impact, and the modes in which all elements move except those at rest at a stop.

    hits: for each element that hits a stop, 1 for the upper one and -1 for the lower one.

    Raises `OutOfReach` if the order of several impacts matters.
    """
    resting = {index: side for index, side in modes.sides.items() if side and index not in hits}
    sides = {**hits, **resting}
    responses = _responses(system, state, modes, list(sides))
    coupling = {
        (one, other): sides[one] * sides[other] * responses[other][system.velocity(one)] for one in sides for other in sides
    }
    _require_order(hits, coupling)
    pushed = [index for index in resting if any(_couples(coupling, index, hit) and coupling[index, hit] < 0 for hit in hits)]
    if pushed and any(_restitution(system, index) for index in (*hits, *pushed)):
        raise OutOfReach("an impact pushes another joint against its stop, and the order of the two impacts matters")
    active = [*hits, *pushed]
    velocities = [sides[index] * state[system.velocity(index)] for index in active]
    wanted = [-_restitution(system, index) * velocity for index, velocity in zip(active, velocities, strict=True)]
    matrix = MP.matrix([[coupling[one, other] for other in active] for one in active])
    right = MP.matrix([after - before for before, after in zip(velocities, wanted, strict=True)])
    after = list(state)
    for index, impulse in zip(active, MP.lu_solve(matrix, right), strict=True):
        for slot, response in responses[index].items():
            after[slot] += sides[index] * impulse * response
    for index, velocity in zip(active, wanted, strict=True):
        after[system.velocity(index)] = sides[index] * velocity
        after[system.coordinate(index)] = system.stops[index, "upper" if sides[index] > 0 else "lower"]
    return after, _after(system, modes, sides, after, coupling, hits)


def _restitution(system: System, index: int) -> Number:
    stops = system.border.elements[index].stops
    assert stops is not None and stops.restitution is not None
    return MP.mpf(stops.restitution)


def _couples(coupling: dict[tuple[int, int], Number], one: int, other: int) -> bool:
    return bool(abs(coupling[one, other]) > UNCOUPLED * MP.sqrt(abs(coupling[one, one] * coupling[other, other])))


def _require_order(hits: dict[int, int], coupling: dict[tuple[int, int], Number]) -> None:
    """Raise `OutOfReach` if two of several impacts at one instant act on each other."""
    if any(_couples(coupling, one, other) for one in hits for other in hits if one != other):
        raise OutOfReach("two joints reach their stops at one instant, and the order of the two impacts matters")


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


def _after(
    system: System,
    modes: Modes,
    sides: dict[int, int],
    state: Sequence[Number],
    coupling: dict[tuple[int, int], Number],
    hits: dict[int, int],
) -> Modes:
    """The modes after an impact: an element rests at a stop if its velocity is zero, or if no impulse acts on it."""
    moves, at = dict(modes.moves), dict(modes.sides)
    for index in moves:
        velocity = state[system.velocity(index)]
        side = sides.get(index, 0)
        still = not velocity or (index not in hits and side and not any(_couples(coupling, index, hit) for hit in hits))
        at[index] = side if still else 0
        rubs = bool(system.frictions[index])
        moves[index] = 0 if still and (side or rubs) else (1 if velocity > 0 else -1)
    return replace(modes, moves=moves, sides=at)
