"""The beginning of a phase: impacts, the instants of controllers, cells, and the joints that stay at rest."""

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from bodycheck.reference.errors import OutOfReach, Stopped
from bodycheck.reference.exact.numbers import MP, FloatType, Real, WideArray, exactly, real
from bodycheck.reference.mechanisms.friction.sticking import sign
from bodycheck.reference.mechanisms.hybrid.cells import elastic, saturation
from bodycheck.reference.mechanisms.hybrid.closing import CLEAR, closed
from bodycheck.reference.mechanisms.hybrid.equations import Shape
from bodycheck.reference.mechanisms.hybrid.impacts import blow, restitution
from bodycheck.reference.mechanisms.hybrid.phases import Phase, in_numbers, joint_state, places, rates_in, wanted
from bodycheck.reference.mechanisms.hybrid.sampled import Memory, computed, signals_at
from bodycheck.reference.mechanisms.hybrid.signals import piece, signals
from bodycheck.reference.mechanisms.link_states import start
from bodycheck.reference.mechanisms.tree import Tree

#: The time by which a motion is continued to find the cell that it enters from a border, as a part of the duration.
AHEAD = 2.0**-30

#: The number of roundings, relative to 1 or the place of a stop, up to which a joint is at its stop.
AT_STOP = 2.0**10

#: The time that all further rebounds take together, as a part of the duration, below which they accumulate, and the least part
#: of its velocity that a joint loses in each of them by friction or damping if it does not rebound without end.
ACCUMULATED, LOST = 2.0**-20, 2.0**-4


@dataclass(frozen=True, eq=False)
class Problem:
    """A tree, its shape, the floating-point type in which it is followed, and the duration (s)."""

    tree: Tree
    shape: Shape
    kind: FloatType
    duration: float

    def joint(self, phase: Phase, index: int) -> tuple[Any, Any]:
        """The coordinate and the velocity of a link's joint in the state of a phase, as they are stored."""
        rate_at = places(self.tree)[index]
        return phase.state[rate_at - 1], phase.state[rate_at]

    def limits(self, index: int) -> list[tuple[int, Real]]:
        """The sides of a link's stops, -1 or 1, and their coordinates."""
        stops = self.tree.links[index].stops
        assert stops is not None
        return [(side, MP.mpf(stop)) for side, stop in ((-1, stops.lower), (1, stops.upper)) if stop is not None]


@dataclass(frozen=True, eq=False)
class Hit:
    """An impact: the index of the link, its velocity before it, and the change (k,) of the state."""

    link: int
    speed: float
    change: tuple[float, ...]
    held: frozenset[int]


def first_phase(problem: Problem) -> Phase:
    """The state at t = 0, before impacts and before the first instants of controllers."""
    tree, shape, kind = problem.tree, problem.shape, problem.kind
    state = kind.array([*start(tree), *[MP.mpf(0)] * len(shape.integrals)])
    sampled = [
        index for index, link in enumerate(tree.links) if link.controller is not None and link.controller.rate is not None
    ]
    rest = {part.link: 1 for part in shape.parts if part.may_rest}
    zero = 0.0 if kind.dtype is np.float64 else MP.mpf(0)
    memories = {index: Memory(total=zero, acting=zero) for index in sampled}
    return Phase(MP.mpf(0), state, rest, {}, {}, {}, {}, memories)


@dataclass(frozen=True, eq=False)
class Begun:
    """A phase with all its modes, the impacts at its beginning, and how far another decision about joints at rest is."""

    phase: Phase
    hits: tuple[Hit, ...] = ()
    room: float = math.inf


def settled(problem: Problem, phase: Phase, eps: float, instant: Fraction | None = None) -> Begun:
    """Return the phase that begins in a state.

    eps: the size of a rounding of the state; 0 if it is exact. instant: the time, if controllers with a rate compute their laws
    or a piece of a signal ends.
    """
    phase, hits = _struck(problem, phase, eps)
    if instant is not None or not phase.pieces:
        phase = _computed(problem, phase, instant)
    resting, moving = _resting(problem, phase)
    phase = with_cells(problem, replace(phase, rest=moving))
    decided = closed(problem.tree, problem.shape, phase, resting, exact=not eps)
    modes = decided.modes
    sides = {index: side for index, side in resting.items() if side and not modes[index]}
    phase = with_cells(problem, replace(phase, rest=modes, sides=sides))
    begun = frozenset(index for index in resting if modes[index])
    watched = frozenset(index for index in resting if not modes[index] and decided.room <= CLEAR)
    for hit in hits:
        _require_rebounds_to_last(problem, phase, hit)
    return Begun(replace(phase, begun=phase.begun | begun, watched=watched), tuple(hits), decided.room)


def _struck(problem: Problem, phase: Phase, eps: float) -> tuple[Phase, list[Hit]]:
    """Apply the impacts of all joints that move beyond their rigid stops; which of them comes first must not matter."""
    hits, tree, at = list[Hit](), problem.tree, places(problem.tree)
    while not phase.released and (outside := _outside(problem, phase, eps)):
        index, *others = outside
        state = in_numbers(phase.state, real)
        try:
            here = blow(tree, state, index, phase.sides, others, real)
        except OutOfReach as error:
            time = float(phase.time)
            raise Stopped(f"{error} at t = {time:.6g} s", time, error.cause) from error
        hits.append(Hit(index, float(state[at[index]]), tuple(float(part) for part in here.change), here.held))
        changed = [value + part for value, part in zip(state, here.change, strict=False)] + state[len(here.change) :]
        side = 1 if state[at[index]] > 0 else -1
        changed[at[index] - 1] = dict(problem.limits(index))[side]
        changed[at[index]] = -restitution(tree, index) * state[at[index]]
        for each in here.held:
            changed[at[each]] = MP.mpf(0)
        sides = {each: phase.sides[each] for each in here.held}
        if not restitution(tree, index):
            sides[index] = side
        phase = replace(phase, state=problem.kind.array(changed), sides=sides)
    return phase, hits


def _outside(problem: Problem, phase: Phase, eps: float) -> list[int]:
    """The links at a rigid stop that move beyond it."""
    beyond = list[int]()
    for part in problem.shape.parts:
        if not part.rigid or part.link in phase.sides:
            continue
        q, v = (exactly(value) for value in problem.joint(phase, part.link))
        for side, stop in problem.limits(part.link):
            gap, near = side * (stop - q), AT_STOP * eps * (1 + abs(stop))
            if gap < -near:
                time = float(phase.time)
                raise Stopped(f"a joint is beyond its stop at t = {time:.6g} s", time, "stops")
            if gap <= near and side * v > 0:
                beyond.append(part.link)
    return beyond


def _computed(problem: Problem, phase: Phase, instant: Fraction | None) -> Phase:
    """Let the controllers compute their laws that have an instant now, and begin new pieces of the signals of the others."""
    pieces = {
        index: tuple(piece(signal, phase.time) for signal in signals(link.controller))
        for index, link in enumerate(problem.tree.links)
        if link.controller is not None and link.controller.rate is None
    }
    memories = phase.memories if instant is None else memories_at(problem, phase, phase.state, instant)
    return replace(phase, pieces=pieces, memories=memories)


def memories_at(problem: Problem, phase: Phase, state: WideArray, instant: Fraction) -> dict[int, Memory]:
    """The memories of controllers after an instant at which some of them compute their laws from a state."""
    memories, number = dict(phase.memories), float if problem.kind.dtype is np.float64 else real
    for index, memory in phase.memories.items():
        controller = problem.tree.links[index].controller
        assert controller is not None
        assert controller.rate is not None
        if memory.count / Fraction(controller.rate) == instant:
            target, target_velocity, effort = (number(value) for value in signals_at(controller, real(instant)))
            joint = joint_state(problem.tree, state, index, number)
            memories[index] = computed(controller, memory, (target, target_velocity, effort), *joint)
    return memories


def _resting(problem: Problem, phase: Phase) -> tuple[dict[int, int], dict[int, int]]:
    """The sides of the links that are at rest and may be held, and the modes of all links if those at rest were held."""
    resting, modes, number = dict[int, int](), dict[int, int](), problem.kind.number
    for part in problem.shape.parts:
        if not part.may_rest:
            continue
        q, v = problem.joint(phase, part.link)
        modes[part.link] = sign(v) if part.dry else 1
        if v != 0:
            continue
        limits = problem.limits(part.link) if part.rigid and not phase.released else []
        sides = [side for side, stop in limits if q == number(stop)]
        if sides or part.dry:
            resting[part.link], modes[part.link] = sides[0] if sides else 0, 0
    return resting, modes


def with_cells(problem: Problem, phase: Phase) -> Phase:
    """Choose the cells of continuous laws and elastic stops that the motion enters or is in."""
    parts = [part for part in problem.shape.parts if part.continuous or part.elastic]
    if not parts:
        return phase
    phase = _with_cells(problem, phase, None)
    if any(part.margins or part.elastic for part in parts):
        phase = _with_cells(problem, phase, AHEAD * problem.duration)
    return phase


def _with_cells(problem: Problem, phase: Phase, ahead: float | None) -> Phase:
    """Choose cells from the state, or from the state that follows by its derivative after a short time `ahead` (s)."""
    tree, shape = problem.tree, problem.shape
    state, time = in_numbers(phase.state, real), phase.time
    beyond = {
        part.link: _beyond(problem, part.link, joint_state(tree, state, part.link, real)[0])
        for part in shape.parts
        if part.elastic
    }
    if ahead is not None:
        rates = [real(rate) for rate in rates_in(tree, shape, phase, in_numbers(phase.state, float), time, float).state]
        for index, (lower, upper) in beyond.items():
            _, v = joint_state(tree, state, index, real)
            a = joint_state(tree, rates, index, real)[1]
            moved = ahead * v + ahead**2 / 2 * a
            beyond[index] = lower - moved, upper + moved
        state = [value + ahead * rate for value, rate in zip(state, rates, strict=True)]
        time = time + ahead
    laws, springs = dict(phase.laws), dict(phase.springs)
    for part in shape.parts:
        q, v = joint_state(tree, state, part.link, real)
        controller, stops = tree.links[part.link].controller, tree.links[part.link].stops
        if part.continuous and controller is not None:
            laws[part.link] = saturation(controller, wanted(tree, shape, phase, part.link, state, q, v, time, real), v)
        if part.elastic and stops is not None:
            springs[part.link] = elastic(stops, beyond[part.link], v)
    return replace(phase, laws=laws, springs=springs)


def _beyond(problem: Problem, index: int, q: Real) -> tuple[Real, Real]:
    """The distances of a coordinate beyond the lower and the upper stop of a link; -1 where there is no stop."""
    limits = dict(problem.limits(index))
    lower, upper = (side * (q - limits[side]) if side in limits else MP.mpf(-1) for side in (-1, 1))
    return lower, upper


def _require_rebounds_to_last(problem: Problem, phase: Phase, hit: Hit) -> None:
    """Raise `Stopped` if the rebounds of a joint that has hit its stop end within a very short time."""
    kept = restitution(problem.tree, hit.link)
    if not kept:
        return
    state = in_numbers(phase.state, float)
    rates, rate_at = (
        rates_in(problem.tree, problem.shape, phase, state, phase.time, float).state,
        places(problem.tree)[hit.link],
    )
    speed, acceleration = state[rate_at], rates[rate_at]
    if speed * acceleration < 0 and 2 * abs(speed / acceleration) < max(1 - kept, LOST) * ACCUMULATED * problem.duration:
        time = float(phase.time)
        raise Stopped(f"the rebounds of a joint at its stop accumulate at t = {time:.6g} s", time, "stops")
