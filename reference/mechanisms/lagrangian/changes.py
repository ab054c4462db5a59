"""The changes between the phases of a motion by the Lagrangian, and the modes after them."""

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.independent.border import MP, Number
from bodycheck.reference.integration.rotation import WideArray
from bodycheck.reference.mechanisms.lagrangian.friction import EXACT, Reaction, decided, reactions
from bodycheck.reference.mechanisms.lagrangian.impacts import struck
from bodycheck.reference.mechanisms.lagrangian.laws import Guard, switching
from bodycheck.reference.mechanisms.lagrangian.sampled import Sampler
from bodycheck.reference.mechanisms.lagrangian.system import Modes, System, rounded, values_of

#: The numbers of roundings up to which forces in an integrated state are equal, and up to which velocities are zero.
ROUNDINGS, STOPPED = 2.0**12, 2.0**5

#: The number of roundings of the terms of a guard up to which it is zero.
NOISE = 2.0**8

#: The part of the bounds of a force, or of its inertia, within which doubles do not tell whether an element is held.
DOUBTFUL = 1e-9


@dataclass(frozen=True, eq=False)
class Phase:
    """The beginning of a phase.

    Attributes
    ----------
    time, state, modes
        Its time and state in the units of the equations, and its modes. Signs of guards without effect change in the phase.
    begun
        The guards that are zero at the beginning, by element and name.
    tested
        The guards whose signs have been corrected at this time.
    """

    time: Any
    state: WideArray
    modes: Modes
    begun: frozenset[tuple[int, str]] = frozenset()
    tested: frozenset[tuple[int, str]] = frozenset()


def exact_state(state: WideArray) -> list[Number]:
    """A state in numbers of a hundred digits, without rounding."""
    if not np.isfinite(state.astype(float)).all():
        raise OutOfReach("the motion exceeds the range of floating-point numbers")
    return [_exact(value) for value in state]


def _exact(value: Any) -> Number:
    total = MP.zero
    while value:
        part = float(value)
        total, value = total + MP.mpf(part), value - part
    return total


def guard_values(system: System, parameters: WideArray, state: WideArray) -> dict[tuple[int, str], tuple[Any, float]]:
    """The values of the guards of limits and stops in a state, and what may be rounding of each, by element and name."""
    chosen = {pair: node for pair, node in system.guards.items() if pair[1] not in ("high", "low", "rest")}
    if not chosen:
        return {}
    values = values_of(system.structure, list(chosen.values()), state, parameters, (state.dtype.type, np))
    sizes = values_of(system.structure, list(chosen.values()), state, parameters, (_Size.of, _Size))
    rounding = NOISE * float(np.finfo(state.dtype).eps)
    return {pair: (value, rounding * size.value) for pair, value, size in zip(chosen, values, sizes, strict=True)}


@dataclass(frozen=True)
class _Size:
    """The size of the terms of an expression: of all sums and differences the sum of the sizes."""

    value: float

    @staticmethod
    def of(value: Any) -> "_Size":
        return _Size(abs(float(value)))

    @staticmethod
    def sin(angle: "_Size") -> "_Size":
        return _Size(max(1.0, angle.value))

    cos = sin

    def __add__(self, other: "_Size") -> "_Size":
        return _Size(self.value + other.value)

    __sub__ = __add__

    def __mul__(self, other: "_Size") -> "_Size":
        return _Size(self.value * other.value)

    def __neg__(self) -> "_Size":
        return self


def started(system: System, start: list[Number], samplers: list[Sampler], like: WideArray) -> Phase:
    """The first phase, after impacts at t = 0. like: an array of the type of the phase's numbers.

    Raises `OutOfReach` if a joint starts beyond a rigid stop, or if the modes are not certain.
    """
    moves, sides, hits = {}, {}, {}
    for index in system.structure.holding:
        q, u = start[system.coordinate(index)], start[system.velocity(index)]
        at = {(1 if side == "upper" else -1): stop for (each, side), stop in system.stops.items() if each == index}
        if any(side * (q - stop) > 0 for side, stop in at.items()):
            raise OutOfReach("a joint starts beyond its rigid stop")
        side = next((side for side, stop in at.items() if q == stop and side * u >= 0), 0)
        if side and u:
            hits[index] = side
        moves[index] = _sign(u) if u or not (side or system.frictions[index]) else 0
        moves[index] = moves[index] or int(not side and not system.frictions[index])
        sides[index] = side if not u else 0
    modes = Modes(moves, sides, pieces=system.pieces_at(Fraction(0)))
    if hits:
        start, modes = struck(system, start, modes, hits)
    state = np.array([rounded(value, like.dtype.type) for value in start], like.dtype)
    return _with_forces(system, Phase(like.dtype.type(0), state, modes), samplers, Fraction(0), start, EXACT)


def renewed(system: System, phase: Phase, samplers: list[Sampler], instant: Fraction) -> Phase:
    """The phase after an instant (s) at which controllers compute, tables change or stops cease to act, with its state."""
    if instant == system.stops_until:
        phase = replace(phase, modes=_released(system, phase.modes))
    slack = MP.mpf(ROUNDINGS * float(np.finfo(phase.state.dtype).eps))
    return _with_forces(system, phase, samplers, instant, exact_state(phase.state), slack)


def _released(system: System, modes: Modes) -> Modes:
    """The modes without rigid stops. Elements with dry friction that were at rest may remain so."""
    moves = {index: mode or int(not system.frictions[index]) for index, mode in modes.moves.items()}
    return replace(modes, moves=moves, sides=dict.fromkeys(modes.sides, 0), released=True)


def _with_forces(
    system: System, phase: Phase, samplers: list[Sampler], instant: Fraction, state: list[Number], slack: Number
) -> Phase:
    """A phase that begins at an instant (s), with the forces of controllers from this instant on."""
    efforts = dict(phase.modes.efforts)
    for sampler in samplers:
        if sampler.next == instant:
            efforts[sampler.element] = sampler.effort(*system.in_si(sampler.element, lambda slot: state[slot]))
    pieces = system.pieces_at(instant)
    modes = replace(phase.modes, efforts=efforts)
    if instant == 0 or pieces != modes.pieces:
        modes = signed(system, replace(modes, pieces=pieces), phase.state)
    begun = _zero(guard_values(system, system.in_type(modes, phase.state.dtype.type), phase.state))
    return _decided(system, Phase(phase.time, phase.state, modes, begun), state, slack)


def signed(system: System, modes: Modes, state: WideArray) -> Modes:
    """The modes with the signs of guards in a state, -1 for a guard that is zero."""
    values = guard_values(system, system.in_type(modes, state.dtype.type), state)
    signs = {pair: _sign(value) or -1 for pair, (value, _) in values.items() if pair[1] in switching(system.laws[pair[0]])}
    return replace(modes, signs=signs)


def _zero(values: dict[tuple[int, str], tuple[Any, float]]) -> frozenset[tuple[int, str]]:
    """The guards that are zero up to rounding."""
    return frozenset(pair for pair, (value, room) in values.items() if abs(value) <= room)


def _decided(system: System, phase: Phase, state: list[Number], slack: Number) -> Phase:
    """The phase with the modes of elements at rest that its forces demand."""
    before = phase.modes
    held = [index for index, mode in before.moves.items() if not mode]
    if not held or (slack != EXACT and _certain(system, before, phase.state, held)):
        return phase
    modes, begun = _leaving(before, decided(system, state, before, slack))
    return replace(phase, modes=modes, begun=phase.begun | begun)


def _certain(system: System, modes: Modes, state: WideArray, held: list[int]) -> bool:
    """Return whether doubles suffice to tell that all held elements remain so."""
    outcome = in_doubles(system, modes, state)
    for index in held:
        low, high = (float(bound) for bound in system.bounds(index, modes.sides[index]))
        room = DOUBTFUL * (float(system.frictions[index]) + abs(outcome[index].force))
        if not low + room <= outcome[index].force <= high - room:
            return False
    return True


def in_doubles(system: System, modes: Modes, state: WideArray) -> dict[int, Reaction]:
    """The reactions of the elements that can be held, in double precision."""
    return reactions(system, state.astype(float).tolist(), system.in_type(modes, np.float64).tolist(), float, math)


def _leaving(before: Modes, after: Modes) -> tuple[Modes, frozenset[tuple[int, str]]]:
    """The modes with the signs of the velocities of elements that begin to move, and the guards that are zero with these."""
    moving = {index: mode for index, mode in after.moves.items() if mode and not before.moves[index]}
    signs = {(index, "forwards"): mode for index, mode in moving.items() if (index, "forwards") in after.signs}
    begun = frozenset((index, name) for index in moving for name in ("rest", "upper", "lower", "forwards"))
    return replace(after, signs=after.signs | signs), begun


def switched(system: System, phase: Phase, guards: tuple[Guard, ...], time: Any, state: WideArray) -> Phase:
    """The phase after a change of guards at a time and in a state.

    Raises `OutOfReach` if rounding leaves the modes uncertain, or if rebounds from a stop accumulate.
    """
    again = phase.begun if time == phase.time else frozenset()
    phase = replace(phase, time=time, state=state, tested=phase.tested if time == phase.time else frozenset())
    after = _switched(system, phase, guards, again)
    return replace(
        after, begun=after.begun | _zero(guard_values(system, system.in_type(after.modes, state.dtype.type), after.state))
    )


def _switched(system: System, phase: Phase, guards: tuple[Guard, ...], again: frozenset[tuple[int, str]]) -> Phase:
    """The phase after a change of guards. again: the guards that were zero at the beginning of a phase without a length."""
    for guard in guards:
        law, index = system.laws[guard.element], guard.element
        if guard.name in law.rigid:
            if again & {(each.element, each.name) for each in guards}:
                raise OutOfReach("rebounds from a stop accumulate, in the Lagrangian")
            return _hit(system, phase, [each for each in guards if each.name in system.laws[each.element].rigid])
        if guard.name == "rest":
            return _stopped(system, phase, index)
        if guard.name in ("high", "low"):
            moves = phase.modes.moves | {index: -1 if guard.name == "high" else 1}
            free = replace(phase.modes, moves=moves, sides=phase.modes.sides | {index: 0})
            modes, begun = _leaving(phase.modes, free)
            return replace(phase, modes=modes, begun=begun, tested=frozenset())
    pairs = frozenset((guard.element, guard.name) for guard in guards)
    if pairs & phase.tested:
        raise OutOfReach("rounding leaves undecided whether a limit or a stop acts, in the Lagrangian")
    signs = phase.modes.signs | {pair: -phase.modes.signs[pair] for pair in pairs}
    return replace(phase, modes=replace(phase.modes, signs=signs), begun=pairs, tested=phase.tested | pairs)


def _stopped(system: System, phase: Phase, index: int) -> Phase:
    """The phase in which an element, and those that stop with it, are at rest."""
    state, moving, rounding = phase.state.copy(), dict(phase.modes.moves), float(np.finfo(phase.state.dtype).eps)
    dry = [each for each, friction in system.frictions.items() if friction]
    velocities = {each: moving[each] * float(state[system.velocity(each)]) for each in dry}
    zero = STOPPED * rounding * max(abs(velocity) for velocity in velocities.values())
    for each, velocity in velocities.items():
        if each == index or velocity <= zero:
            state[system.velocity(each)], moving[each] = 0, 0
    before = replace(phase.modes, moves=moving)
    modes, begun = _leaving(before, decided(system, exact_state(state), before, MP.mpf(ROUNDINGS * rounding)))
    return Phase(phase.time, state, modes, begun)


def _hit(system: System, phase: Phase, guards: list[Guard]) -> Phase:
    """The phase after impacts on rigid stops."""
    hits = {guard.element: 1 if guard.name == "upper" else -1 for guard in guards}
    exact, after = struck(system, exact_state(phase.state), phase.modes, hits)
    state = np.array([rounded(value, phase.state.dtype.type) for value in exact], phase.state.dtype)
    modes = signed(system, after, state)
    begun = frozenset((guard.element, guard.name) for guard in guards)
    slack = MP.mpf(ROUNDINGS * float(np.finfo(state.dtype).eps))
    return _decided(system, Phase(phase.time, state, modes, begun), exact_state(state), slack)


def _sign(value: Any) -> int:
    return int(value > 0) - int(value < 0)
