"""Nudged motions beside the motion of a tree with controllers and stops, in double precision.

A nudged motion goes through the same phases as the motion itself, with controllers that compute their laws from the nudged
state. It reaches an event earlier or later; to first order, the jump of its deviation there follows from the derivatives before
and after the event (the saltation matrix: Leine and Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems,
2004, chapter 7). So both motions are compared at the same instants in the same phases, and the deviation is scaled back to the
size of a nudge as often as it leaves it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from bodycheck.reference.exact.numbers import Real
from bodycheck.reference.mechanisms.growth import LARGEST, NUDGE, UNSCALED
from bodycheck.reference.mechanisms.hybrid.beginning import Hit, Problem, memories_at
from bodycheck.reference.mechanisms.hybrid.equations import Event
from bodycheck.reference.mechanisms.hybrid.impacts import struck
from bodycheck.reference.mechanisms.hybrid.phases import Phase, joint_state, margins_of, places, rates_in
from bodycheck.reference.mechanisms.hybrid.sampled import Memory
from bodycheck.reference.trajectory import Array

#: The time by which a nudged motion reaches an event earlier or later, as a part of the duration, up to which its deviation is
#: proportional to the nudge.
NEAR = 1e-6


@dataclass(frozen=True, eq=False)
class Shadow:
    """A nudged motion: its state, what its controllers remember, and its deviation at the instants of the motion.

    Attributes
    ----------
    first
        The index of the instant at which it begins.
    nudge
        (k,) the deviation with which it begins.
    units
        (k,) the sizes of the components of a state.
    deviations
        (n, k) deviations at the instants, each in units of its factor; zero before the first one.
    factors
        (n,) the factors.
    """

    first: int
    nudge: Array
    units: Array
    deviations: Array
    factors: Array
    state: Array | None = None
    memories: dict[int, Memory] | None = None
    factor: float = 1.0


#: A function that follows the equations of a phase from a state at a time to other times, and returns the states there.
Carry = Callable[[Phase, Array, float, Sequence[float]], list[Array]]


def shadow(first: int, nudge: Array, units: Array, count: int) -> Shadow:
    """A nudged motion that has not begun. count: the number of instants."""
    return Shadow(first, nudge, units, np.zeros((count, len(nudge))), np.zeros(count))


def nudged(problem: Problem, phase: Phase, base: Array, each: Shadow, instant: Fraction | None = None) -> Shadow:
    """Return a nudged motion at its beginning. base: the state of the motion. instant: at which its controllers compute."""
    deviation = NUDGE * each.nudge
    _hold(problem, phase, deviation)
    memories = phase.memories if instant is None else memories_at(problem, phase, base + deviation, instant)
    return replace(each, state=base + deviation, memories=memories)


def carried(
    problem: Problem,
    phase: Phase,
    each: Shadow,
    begin: float,
    rows: Sequence[tuple[int, float, Array]],
    end: float,
    carry: Carry,
) -> Shadow:
    """Follow a nudged motion through a phase, and keep its deviations at the instants in it.

    rows: the index, the time and the state of the motion at each of these instants.
    """
    state, memories = each.state, each.memories
    if state is None or memories is None:
        started = next((row for row in rows if row[0] == each.first), None)
        if started is None:
            return each
        each, begin = nudged(problem, phase, started[2], each), started[1]
        return carried(problem, phase, each, begin, [row for row in rows if row[0] >= each.first], end, carry)
    states = carry(replace(phase, memories=memories), state, begin, [*(time for _, time, _ in rows), end])
    for (row, _, base), there in zip(rows, states[:-1], strict=True):
        each.deviations[row], each.factors[row] = there - base, each.factor
    return replace(each, state=states[-1])


def after_instant(problem: Problem, before: Phase, after: Phase, base: Array, each: Shadow, instant: Fraction) -> Shadow:
    """Let the controllers of a nudged motion compute their laws. base: the state of the motion."""
    if each.state is None or each.memories is None:
        return each
    memories = memories_at(problem, replace(before, memories=each.memories), each.state, instant)
    return _scaled(problem, after, base, replace(each, memories=memories))


def after_event(
    problem: Problem, before: Phase, after: Phase, event: Event, hits: Sequence[Hit], base: Array, each: Shadow
) -> Shadow:
    """Lead a nudged motion through an event of the motion, whose state before the event is `base`."""
    if each.state is None or each.factor >= LARGEST:
        return each
    if event.kind == "law" or (event.kind == "rest" and not before.rest[event.link]):
        return _scaled(problem, after, base, each)
    rates = np.array(_rates(problem, before, base))
    later = np.array(_rates(problem, after, after.state))
    deviation = each.state - base
    early = -_margin(problem, before, event, base, deviation) / _margin(problem, before, event, base, rates)
    if not abs(early) <= NEAR * problem.duration:
        return replace(each, factor=LARGEST)
    moved = each.state + early * rates
    rate_at = places(problem.tree)[event.link]
    if event.kind == "stop":
        moved[rate_at - 1] = after.state[rate_at - 1]
        for hit in hits:
            moved[: problem.shape.components] += struck(problem.tree, moved.tolist(), hit.link, hit.held, float)
    return _scaled(problem, after, after.state, replace(each, state=moved - early * later))


def _rates(problem: Problem, phase: Phase, state: Array) -> list[Any]:
    return rates_in(problem.tree, problem.shape, phase, state.tolist(), phase.time, float).state


def _margin(problem: Problem, phase: Phase, event: Event, base: Array, change: Array) -> float:
    """The change of the function whose root is an event, for a change of the state."""
    tree, rate_at = problem.tree, places(problem.tree)[event.link]
    if tree.links[event.link].follows is None:
        q, v = float(change[rate_at - 1]), float(change[rate_at])
    else:
        (q, v), (q_base, v_base) = (joint_state(tree, state.tolist(), event.link, float) for state in (base + change, base))
        q, v = q - q_base, v - v_base
    if event.kind == "stop":
        return q
    if event.kind == "rest":
        return v
    part = next(part for part in problem.shape.parts if part.link == event.link)
    margin = margins_of(tree, phase, part)[part.margins + event.index]
    return float(margin.slope) * q + float(margin.rate) * v


def _scaled(problem: Problem, phase: Phase, base: Array, each: Shadow) -> Shadow:
    """Return a nudged motion whose deviation has the size of a nudge."""
    assert each.state is not None
    assert each.memories is not None
    deviation = each.state - base
    _hold(problem, phase, deviation)
    size = float(np.max(np.abs(deviation) / each.units, initial=0.0)) / NUDGE
    if not size or 1 / UNSCALED < size < UNSCALED:
        return replace(each, state=base + deviation)
    memories = {index: _between(phase.memories[index], memory, 1 / size) for index, memory in each.memories.items()}
    return replace(each, state=base + deviation / size, memories=memories, factor=min(each.factor * size, LARGEST))


def _hold(problem: Problem, phase: Phase, deviation: Array) -> None:
    """Remove from a deviation what joints at rest do not allow."""
    for index, rate_at in enumerate(places(problem.tree)):
        if phase.rest.get(index) == 0:
            deviation[rate_at] = 0.0
            if index in phase.sides:
                deviation[rate_at - 1] = 0.0


def _between(base: Memory, other: Memory, part: float) -> Memory:
    """The memories of controllers whose states are between two states. part: 0 for `base`, 1 for `other`."""

    def mixed(one: Real, two: Real) -> float:
        return float(one) + part * (float(two) - float(one))

    waiting = tuple(mixed(one, two) for one, two in zip(base.waiting, other.waiting, strict=True))
    return Memory(base.count, mixed(base.total, other.total), waiting, mixed(base.acting, other.acting))
