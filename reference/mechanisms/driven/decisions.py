"""The mode that follows from a state of a driven joint."""

from collections.abc import Iterator
from itertools import product

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.mechanisms.driven.linear import State, applied, value, zero
from bodycheck.reference.mechanisms.driven.modes import (
    POSITION,
    VELOCITY,
    Contact,
    DrivenJoint,
    Mode,
    beyond,
    edges,
    phase_of,
    place_of,
    sides,
    stops_of,
)


def mode_of(joint: DrivenJoint, z: State) -> Mode:
    """The mode that follows from a state: the first one whose conditions begin to hold."""
    for mode in _candidates(joint, z):
        if begins(joint, mode, z):
            return mode
    raise OutOfReach("the forces on a driven joint cancel so closely that its next phase is not determined")


def begins(joint: DrivenJoint, mode: Mode, z: State) -> bool:
    """Return whether the conditions of a mode hold just after a state.

    Of each condition, the first derivative that is not zero decides.
    """
    phase = phase_of(joint, mode)
    mp, rows = joint.mp, phase.linear.rows
    sizes = [{column: abs(part) for column, part in row.items()} for row in rows]
    state, size = list(z), [abs(part) for part in z]
    waiting = phase.conditions
    for _ in range(joint.size + 1):
        undecided = []
        for condition in waiting:
            number = value(mp, condition, state)
            if abs(number) <= zero(mp) * value(mp, {column: abs(part) for column, part in condition.items()}, size):
                undecided.append(condition)
            elif number < 0:
                return False
        if not undecided:
            return True
        waiting, state, size = undecided, applied(mp, rows, state), applied(mp, sizes, size)
    return True


def _candidates(joint: DrivenJoint, z: State) -> Iterator[Mode]:
    """Yield the modes that the direction of the velocity and the coordinate beyond a stop allow."""
    controller = joint.continuous
    cuts = (0, 1, -1) if controller is not None and controller.effort_limit is not None else (0,)
    bands = range(len(edges(joint)) + 1)
    slips: tuple[int | None, ...] = (None,)
    if joint.plant.friction:
        slips = (int(joint.mp.sign(z[VELOCITY])),) if z[VELOCITY] else (0, 1, -1)
    for (contact, side), band, slip, cut in product(_contacts(joint, z), bands, slips, cuts):
        yield Mode(cut, band, None if contact == "closed" else slip, contact, side)


def _contacts(joint: DrivenJoint, z: State) -> Iterator[tuple[Contact, int]]:
    for side in sides(joint):
        depth = value(joint.mp, beyond(joint, side), z)
        if stops_of(joint).rigid:
            if not depth and not z[VELOCITY]:
                yield "closed", side
        elif depth >= -zero(joint.mp) * (abs(z[POSITION]) + abs(place_of(joint, side))):
            yield "pushing", side
            yield "slack", side
    yield "free", 0
