"""Trees whose joints have dry friction, by Taylor's method with events (heyoka; Linux only).

Each such joint slips forwards, slips backwards or sticks. While it slips, friction is a constant force against its velocity;
while it sticks, its coordinate does not move, and the force of friction is whatever keeps it at rest, up to the size of the
friction. A joint slips until its velocity is zero, and sticks until the required force exceeds the friction. Both events are
roots of functions of the state, which heyoka finds within the step of the series to the rounding of the arithmetic.

When joints are at rest at the start, or a joint comes to rest, `sticking` decides about all joints at rest.
"""

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import heyoka as hy
import numpy as np

from bodycheck.reference.errors import OutOfReach, Stopped
from bodycheck.reference.exact.numbers import MP, FloatType, Real, WideArray, exactly, real
from bodycheck.reference.integration.heyoka_solver import compiled, integrator_lock
from bodycheck.reference.mechanisms.friction.sticking import EQUAL, EXACT, Modes, settled, sign, with_modes
from bodycheck.reference.mechanisms.link_states import Change, Course, Decision, places_of_rates, split, start
from bodycheck.reference.mechanisms.tree import Tree
from bodycheck.reference.mechanisms.tree_equations import Shape, most_steps, parameters, shape_of, written

#: The largest number of changes between sticking and slipping, and of those at one instant.
MOST_CHANGES, MOST_AT_ONCE = 10_000, 100

#: The first part of a step, as a fraction, in which a joint that has just begun to slip does not count as having come to rest
#: again: its velocity there is zero except for rounding.
JUST_BEGUN = 2.0**-20

#: The number of roundings, relative to the largest velocity of a joint with dry friction, up to which a velocity is zero.
STOPPED = 2.0**5

#: The unused part of the friction below which a joint that sticks is watched: heyoka may not find a root at the beginning of a
#: step.
WATCHED = 1e-9


@dataclass(frozen=True, eq=False)
class _Solver:
    """heyoka's integrator, the list to which it appends the index of a link and the time at each change, and its rounding."""

    solver: Any
    crossings: list[tuple[int, Any]]
    eps: float

    def output(self, time: Any) -> WideArray:
        """The state at a time within the last step."""
        self.solver.update_d_output(time)
        return np.array(self.solver.d_output)


@dataclass(frozen=True, eq=False)
class _Phase:
    """The beginning of a phase without changes: time, state, modes of the links, and the links that have just begun to slip."""

    time: Any
    state: WideArray
    modes: Modes
    begun: frozenset[int]


def followed(tree: Tree, times: WideArray, kind: FloatType) -> Course:
    """The motion of the links of a tree at times (n,) >= 0, s, in any order.

    Raises `OutOfReach` if Taylor's method fails or takes too many steps, there are too many changes, or rounding leaves
    undecided which joints stick.
    """
    shape = shape_of(tree)
    instants, order = np.unique(np.append(0.0, times), return_inverse=True)
    with integrator_lock:
        rows, changes, decisions = _rows(tree, kind.array(instants), kind, _solver(shape, kind))
    return Course(split(tree, rows[order[1:]], times, kind), changes, decisions)


@functools.cache
def _solver(shape: Shape, kind: FloatType) -> _Solver:
    equations, crossings = written(shape), list[tuple[int, Any]]()
    events = [
        hy.nt_event(margin, _noting(crossings, index), direction=hy.event_direction.negative, fp_type=kind.dtype)
        for index, margin in zip(shape.dry, equations.margins, strict=True)
    ]
    solver = compiled(equations.system, kind.dtype, kind.bits, large=shape.large, events=events)
    return _Solver(solver, crossings, kind.eps)


def _noting(crossings: list[tuple[int, Any]], index: int) -> Callable[[Any, Any, int], None]:
    def note(_: Any, time: Any, __: int) -> None:
        crossings.append((index, time))

    return note


def _rows(
    tree: Tree, instants: WideArray, kind: FloatType, solver: _Solver
) -> tuple[WideArray, tuple[Change, ...], tuple[Decision, ...]]:
    """The states (n, k) at ascending times (n,), s, the first of which is 0, the changes, and the decisions."""
    begin, changes = start(tree), list[Change]()
    moving = {index: sign(begin[at]) for index, at in _velocities(tree).items()}
    modes = settled(tree, begin, moving, EXACT)
    phase = _Phase(instants[0], kind.array(begin), modes, _slipping(modes, moving))
    decisions = [Decision(tree, 0.0, begin, frozenset(range(len(begin))), modes, _at_rest(moving))]
    rows, left, at_once = [phase.state], most_steps(solver.solver), 0
    still = {index for index, mode in modes.items() if not mode}
    while len(rows) < len(instants):
        crossing, left = _advanced(tree, kind, solver, phase, instants, rows, left)
        if crossing is None:
            break
        index, time = crossing
        at_once = at_once + 1 if time == phase.time else 0
        if len(changes) >= MOST_CHANGES or at_once > MOST_AT_ONCE:
            sentence = f"too many changes between sticking and slipping until t = {float(time):.6g} s"
            raise OutOfReach(sentence, "dry friction")
        state, before = solver.output(time), phase.modes
        if before[index]:
            state, moving = _stopped(tree, state, before, index, solver.eps)
            exact = frozenset(at - step for each, at in _velocities(tree).items() if each in still for step in (0, 1))
            numbers = [begin[at] if at in exact else exactly(value) for at, value in enumerate(state)]
            modes = settled(tree, numbers, moving, real(EQUAL * solver.eps))
            decisions.append(Decision(tree, float(time), numbers, exact, modes, _at_rest(moving)))
        else:
            # Its acceleration begins at zero, so that the modes of the other links do not change at this instant.
            modes = {**before, index: sign(_strains(tree, state, before)[index])}
        changes += [Change(time, tree.links[each].joint, mode) for each, mode in modes.items() if mode != before[each]]
        phase = _Phase(time, state, modes, _slipping(modes, before))
        still = {each for each in still if not modes[each]}
    return np.array(rows), tuple(changes), tuple(decisions)


def _slipping(modes: Modes, before: Modes) -> frozenset[int]:
    """The links that have begun to slip."""
    return frozenset(index for index, mode in modes.items() if mode and mode != before[index])


def _at_rest(moving: Modes) -> tuple[int, ...]:
    return tuple(index for index, mode in moving.items() if not mode)


def _velocities(tree: Tree) -> dict[int, int]:
    """The indices in a state of the velocities of links with dry friction, by the indices of the links."""
    places = places_of_rates(tree.links)
    return {index: places[index] for index, link in enumerate(tree.links) if link.friction}


def _advanced(
    tree: Tree, kind: FloatType, solver: _Solver, phase: _Phase, instants: WideArray, rows: list[WideArray], most: int
) -> tuple[tuple[int, Any] | None, int]:
    """Follow a phase to its end, and append the states at the instants in it to `rows`.

    Returns the change that ends the phase, or None in the last phase, and the number of steps that are left of `most`.
    """
    inner, first = solver.solver, True
    inner.time, inner.state[:] = phase.time, phase.state
    inner.pars[:] = kind.array(parameters(tree, phase.modes))[: len(inner.pars)]
    watched = _nearly_slipping(tree, phase.state, phase.modes)
    for left in reversed(range(most)):
        solver.crossings.clear()
        begin = inner.time
        outcome, step = inner.step(max_delta_t=instants[-1] - begin, write_tc=True)
        if outcome not in (hy.taylor_outcome.success, hy.taylor_outcome.time_limit):
            raise Stopped(f"Taylor's method stopped at t = {float(begin):.6g} s: {outcome.name}", float(begin))
        ignored = phase.begun if first else frozenset[int]()
        crossings = [each for each in solver.crossings if each[0] not in ignored or each[1] - begin > JUST_BEGUN * step]
        crossing = min(crossings, key=lambda each: each[1], default=None)
        if missed := _missed(tree, solver, phase.modes, watched, begin, inner.time if crossing is None else crossing[1]):
            crossing = missed[0], begin
        until = inner.time if crossing is None else crossing[1]
        while len(rows) < len(instants) and instants[len(rows)] <= until:
            rows.append(solver.output(instants[len(rows)]))
        if crossing is not None or len(rows) == len(instants):
            return crossing, left
        watched, first = _nearly_slipping(tree, inner.state, phase.modes) if watched else [], False
    last = float(inner.time)
    raise Stopped(f"Taylor's method stopped at t = {last:.6g} s, since the motion needs too many steps", last)


def _missed(tree: Tree, solver: _Solver, modes: Modes, watched: Sequence[int], begin: Any, until: Any) -> list[int]:
    """The links that contradict their modes between the beginning of a step and a time in it, before which there is no root.

    Their velocity, or the unused part of their friction, was zero at the beginning except for rounding, where heyoka does not
    find a root. The velocities are those in the middle: at the end other joints may come to rest at the same time.
    """
    middle = solver.output(begin + (until - begin) / 2)
    velocities = {index: modes[index] * float(middle[at]) for index, at in _velocities(tree).items()}
    back = [index for index, velocity in velocities.items() if velocity < 0]
    if any(velocities[index] < -WATCHED * float(np.abs(middle.astype(float)).max()) for index in back):
        raise OutOfReach("rounding leaves undecided whether a joint with dry friction slips", "dry friction")
    if not watched:
        return back
    strains = with_modes(tree, [exactly(value) for value in solver.output(until)], modes, real, MP).strains
    over = {index: abs(strains[index]) / tree.links[index].friction for index in watched}
    return back + [index for index, used in over.items() if used > 1 + EQUAL * solver.eps]


def _stopped(tree: Tree, state: WideArray, modes: Modes, index: int, eps: float) -> tuple[WideArray, Modes]:
    """The state in which the link `index` and those that stop with it are at rest, and the modes of the links that move on."""
    state, velocities = state.copy(), _velocities(tree)
    largest = float(max(abs(state[at]) for at in velocities.values()))
    moving = dict(modes)
    for each, at in velocities.items():
        if each == index or modes[each] * float(state[at]) <= STOPPED * eps * largest:
            state[at], moving[each] = state[at] * 0, 0
    return state, moving


def _strains(tree: Tree, state: WideArray, modes: Modes) -> list[Real]:
    """The strains of all links, in double precision."""
    return with_modes(tree, state.astype(float).tolist(), modes, float, math).strains


def _nearly_slipping(tree: Tree, state: WideArray, modes: Modes) -> list[int]:
    """The links that stick and use all of their friction, within `WATCHED`."""
    sticking = [index for index, mode in modes.items() if not mode]
    if not sticking:
        return []
    strains = _strains(tree, state, modes)
    return [index for index in sticking if abs(strains[index]) > (1 - WATCHED) * float(tree.links[index].friction)]
