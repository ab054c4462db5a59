"""The motion of trees with controllers and stops, from event to event, by Taylor's method (heyoka; Linux only).

A phase ends at an event, which is a root of a function of the state that heyoka finds within a step of the series, or at a time
at which a controller computes its law or a piece of a signal ends.
"""

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

import heyoka as hy
import numpy as np

from bodycheck.reference.errors import Stopped
from bodycheck.reference.exact.numbers import FloatType, Real, WideArray, exactly, real
from bodycheck.reference.integration.heyoka_solver import compiled, integrator_lock
from bodycheck.reference.mechanisms.friction.sticking import EQUAL, sign
from bodycheck.reference.mechanisms.hybrid.beginning import ACCUMULATED, Begun, Hit, Problem, first_phase, settled, with_cells
from bodycheck.reference.mechanisms.hybrid.criticals import NEAR, of_beginnings, touch
from bodycheck.reference.mechanisms.hybrid.equations import Event, Shape, shape_of, written
from bodycheck.reference.mechanisms.hybrid.phases import Phase, in_numbers, parameters, places, rates_in, require_consistent
from bodycheck.reference.mechanisms.hybrid.shadows import Shadow, after_event, after_instant, carried, nudged, shadow
from bodycheck.reference.mechanisms.hybrid.signals import breaks
from bodycheck.reference.mechanisms.link_states import Course, Critical, split
from bodycheck.reference.mechanisms.tree import Tree
from bodycheck.reference.mechanisms.tree_equations import most_steps
from bodycheck.reference.trajectory import Array

#: The largest number of events, and of impacts of one joint within a time `ACCUMULATED`.
MOST_EVENTS, MOST_REPEATED = 20_000, 3

#: The first part of a step, as a fraction, in which the events of a joint that has just had one do not count: the functions are
#: zero there except for rounding.
JUST_BEGUN = 2.0**-20

#: The part of a step that is tried again if heyoka has missed a root in it, as it may near the beginning, and how often.
SHORTER, TRIES = 2.0**-3, 12

#: The part of a step within which two events may be one.
SAME = 2.0**-40


@dataclass(frozen=True, eq=False)
class _Solver:
    """heyoka's integrator, the list to which it appends the events and their times, and the parameters that it has now."""

    solver: Any
    crossings: list[tuple[Event, Any]]
    present: list[Real] = field(default_factory=list)

    def output(self, time: Any) -> WideArray:
        """The state at a time within the last step."""
        self.solver.update_d_output(time)
        return np.array(self.solver.d_output)

    def begin(self, kind: FloatType, time: Any, state: WideArray, values: list[Real]) -> None:
        """Set the time, the state and the parameters, of which those that have not changed are not converted."""
        self.solver.time, self.solver.state[:] = time, state
        if not self.present:
            self.present.extend([None] * len(self.solver.pars))
        for index, (old, new) in enumerate(zip(self.present, values, strict=False)):
            if new is not old and (old is None or new != old):
                self.solver.pars[index] = kind.number(new)
                self.present[index] = new


@functools.cache
def _solver(shape: Shape, kind: FloatType) -> _Solver:
    equations, crossings = written(shape), list[tuple[Event, Any]]()
    events = [
        hy.nt_event(
            function,
            _noting(crossings, event),
            direction=hy.event_direction.any if event.kind == "turn" else hy.event_direction.negative,
            fp_type=kind.dtype,
        )
        for event, function in equations.events
    ]
    return _Solver(compiled(equations.system, kind.dtype, kind.bits, large=shape.large, events=events), crossings)


def _noting(crossings: list[tuple[Event, Any]], event: Event) -> Callable[[Any, Any, int], None]:
    def note(_: Any, time: Any, __: int) -> None:
        crossings.append((event, time))

    return note


def followed(tree: Tree, times: WideArray, kind: FloatType) -> Course:
    """The motion of the links of a tree at times (n,) >= 0, s, in any order.

    Raises `Stopped` if Taylor's method fails or takes too many steps, there are too many events, or an event is undecided.
    """
    instants, order = np.unique(np.append(0.0, times), return_inverse=True)
    run = _followed(tree, instants, kind, [])
    rows = np.array(run.rows)[:, : run.problem.shape.components]
    criticals = [*of_beginnings(run.problem, run.beginnings), *run.touches]
    return Course(split(tree, rows[order[1:]], times, kind), criticals=tuple(criticals))


def beside(tree: Tree, t: Array, nudges: Sequence[tuple[int, Array]], units: Array) -> tuple[Array, list[Shadow]]:
    """The states (m, k) of a tree in double precision at ascending instants (m,), s, from 0 on, and nudged motions beside them.

    nudges: for each, the index of the instant at which it begins, and its nudge (k,). units: the sizes of the components.
    """
    run = _followed(tree, t, FloatType(np.float64), [shadow(first, nudge, units, len(t)) for first, nudge in nudges])
    return np.array(run.rows), run.shadows


def _followed(tree: Tree, instants: WideArray, kind: FloatType, shadows: list[Shadow]) -> "_Run":
    shape = shape_of(tree)
    problem = Problem(tree, shape, kind, float(instants[-1]))
    with integrator_lock:
        run = _Run(problem, _solver(shape, kind), kind.array(instants), shadows)
        _follow(run)
    return run


@dataclass(frozen=True, eq=False)
class _Run:
    """An integration.

    instants: ascending, the first of which is 0. shadows: nudged motions. rows: the states at the instants so far. beginnings:
    the times and beginnings of phases with impacts or joints at rest. touches: where joints turn back near stops.
    """

    problem: Problem
    solver: _Solver
    instants: WideArray
    shadows: list[Shadow]
    rows: list[WideArray] = field(default_factory=list)
    beginnings: list[tuple[Real, Begun]] = field(default_factory=list)
    touches: list[Critical] = field(default_factory=list)

    def change_shadows(self, change: Callable[[Shadow], Shadow]) -> None:
        """Replace all nudged motions."""
        self.shadows[:] = [change(each) for each in self.shadows]


def _follow(run: _Run) -> None:
    """Append the states at all instants."""
    problem, kind, end = run.problem, run.problem.kind, run.instants[-1]
    controllers = [link.controller for link in problem.tree.links if link.controller is not None]
    released = None if problem.tree.stops_until is None else Fraction(problem.tree.stops_until)
    ahead, start = breaks(controllers, exactly(end), [] if released is None else [released]), first_phase(problem)
    instant = next(ahead, None)
    now, instant = (instant, next(ahead, None)) if instant == 0 else (None, instant)
    run.rows.append(start.state)
    phase = settled(problem, start, 0.0, now).phase
    begun = replace(phase, memories=start.memories)
    run.change_shadows(lambda each: nudged(problem, begun, phase.state, each, now) if each.first == 0 else each)
    left, events = most_steps(run.solver.solver), 0
    while len(run.rows) < len(run.instants):
        until = end if instant is None else kind.number(real(instant))
        first = len(run.rows)
        event, time, state, left = _advanced(run, phase, until, left)
        _carry_shadows(run, phase, range(first, len(run.rows)), time)
        before = phase
        if event is not None:
            events += 1
            if events > MOST_EVENTS:
                raise Stopped(f"too many events of controllers and stops until t = {float(time):.6g} s", float(time))
            ended = replace(phase, time=exactly(time), state=state, begun=frozenset({event.link}), watched=frozenset())
            if event.kind == "stop":
                _note_depth(run, ended, event)
            next_one = _after(problem, ended, event)
            phase = next_one.phase
            _note(run, next_one)
            _require_progress(run, next_one.hits)
            _lead_shadows(run, before, phase, event, next_one.hits, state)
        elif instant is not None:
            ended = replace(phase, time=real(instant), state=state, begun=frozenset(), watched=frozenset())
            if instant == released:
                ended = replace(ended, sides={}, released=True)
            next_one = settled(problem, ended, kind.eps, instant)
            if next_one.hits:
                reason = f"a joint reaches its stop at an instant of a controller, t = {float(time):.9g} s"
                raise Stopped(reason, float(time), "stops")
            phase = next_one.phase
            _note(run, next_one)
            _update_shadows(run, before, phase, state, instant)
            instant = next(ahead, None)


def _note(run: _Run, begun: Begun) -> None:
    """Keep the beginning of a phase with impacts, or with joints at rest that almost move."""
    if begun.hits or begun.room < NEAR:
        run.beginnings.append((begun.phase.time, begun))


def _require_progress(run: _Run, hits: Sequence[Hit]) -> None:
    """Raise `Stopped` if a joint hits its stop again and again within a very short time, as others push it away from there."""
    for hit in hits:
        beginnings = run.beginnings[-MOST_REPEATED * len(run.problem.shape.parts) :]
        times = [float(time) for time, each in beginnings if any(other.link == hit.link for other in each.hits)]
        recent = times[-MOST_REPEATED:]
        if len(recent) == MOST_REPEATED and recent[-1] - recent[0] < ACCUMULATED * run.problem.duration:
            raise Stopped(f"impacts of joints at their stops accumulate at t = {recent[0]:.6g} s", recent[0], "stops")


def _carry_shadows(run: _Run, phase: Phase, rows: Sequence[int], end: Any) -> None:
    """Follow the nudged motions through a phase."""
    problem, inner = run.problem, run.solver.solver

    def carry(each: Phase, state: Array, begin: float, times: Sequence[float]) -> list[Array]:
        run.solver.begin(problem.kind, begin, state, parameters(problem.tree, problem.shape, each))
        states = []
        for time in times:
            if time > inner.time and inner.propagate_until(time)[0] != hy.taylor_outcome.time_limit:
                raise Stopped(f"Taylor's method stopped at t = {inner.time:.6g} s", float(inner.time))
            states.append(np.array(inner.state))
        return states

    begin, here = float(phase.time), [(row, float(run.instants[row]), run.rows[row]) for row in rows]
    run.change_shadows(lambda each: carried(problem, phase, each, begin, here, float(end), carry))


def _lead_shadows(run: _Run, before: Phase, after: Phase, event: Event, hits: Sequence[Hit], base: Array) -> None:
    """Lead the nudged motions through an event. base: the state of the motion before it."""
    at = replace(before, time=after.time)
    run.change_shadows(lambda each: after_event(run.problem, at, after, event, hits, base, each))


def _update_shadows(run: _Run, before: Phase, after: Phase, base: Array, instant: Fraction) -> None:
    """Let the controllers of the nudged motions compute their laws."""
    run.change_shadows(lambda each: after_instant(run.problem, before, after, base, each, instant))


def _advanced(run: _Run, phase: Phase, until: Any, left: int) -> tuple[Event | None, Any, WideArray, int]:
    """Follow a phase to its end or to a time, and append the states at the instants in it.

    Returns the event that ends the phase, or None, the time and the state there, and how many steps are left.
    """
    solver, inner, kind = run.solver, run.solver.solver, run.problem.kind
    begin = kind.number(phase.time)
    if not begin < until:
        return None, until, phase.state, left
    solver.begin(kind, begin, phase.state, parameters(run.problem.tree, run.problem.shape, phase))
    first, longest, tries = True, until - begin, 0
    while left > 0:
        solver.crossings.clear()
        begin, before = inner.time, np.array(inner.state)
        outcome, step = inner.step(max_delta_t=min(longest, until - begin), write_tc=True)
        if outcome not in (hy.taylor_outcome.success, hy.taylor_outcome.time_limit):
            raise Stopped(f"Taylor's method stopped at t = {float(begin):.6g} s: {outcome.name}", float(begin))
        soon = begin + JUST_BEGUN * step
        crossings = [each for each in solver.crossings if not (first and each[0].link in phase.begun and each[1] <= soon)]
        ends = [each for each in crossings if each[0].kind != "turn"]
        event, time = _first(ends, SAME * step) or (None, inner.time)
        state = np.array(inner.state) if event is None else solver.output(time)
        if first and phase.watched and (moved := _moved(run.problem, phase, state, time)) is not None:
            return Event(moved, "rest"), begin, phase.state, left
        left -= 1
        try:
            require_consistent(run.problem.tree, run.problem.shape, phase, state, time)
        except Stopped:
            if tries == TRIES:
                raise
            inner.time, inner.state[:] = begin, before
            longest, tries = SHORTER * step, tries + 1
            continue
        while len(run.rows) < len(run.instants) and run.instants[len(run.rows)] <= time:
            run.rows.append(solver.output(run.instants[len(run.rows)]))
        _note_touches(
            run,
            [
                each
                for each in crossings
                if each[0].kind == "turn" and phase.rest.get(each[0].link) != 0 and each[1] < time and not phase.released
            ],
        )
        if event is not None or (outcome == hy.taylor_outcome.time_limit and not tries):
            return event, until if event is None else time, state, left
        first, longest, tries = False, until - inner.time, 0
    last = float(inner.time)
    raise Stopped(f"Taylor's method stopped at t = {last:.6g} s, since the motion needs too many steps", last)


def _first(crossings: Sequence[tuple[Event, Any]], same: Any) -> tuple[Event, Any] | None:
    """The first of the events that end a phase, and its time.

    Of those within a very short time `same` (s), it is one of a joint that stops or meets its stop: where a joint stops, the
    saturation of its law may enter another cell, which such an event takes into account.
    """
    if not crossings:
        return None
    earliest = min(time for _, time in crossings)
    near = [each for each in crossings if each[1] <= earliest + same]
    return next((each for each in near if each[0].kind in ("rest", "stop")), min(near, key=lambda each: each[1]))


def _note_touches(run: _Run, turns: Sequence[tuple[Event, Any]]) -> None:
    """Keep where joints turn back near their stops."""
    for event, time in turns:
        q = float(run.solver.output(time)[places(run.problem.tree)[event.link] - 1])
        if (near := touch(run.problem, event.link, float(time), q)) is not None:
            run.touches.append(near)


def _note_depth(run: _Run, phase: Phase, event: Event) -> None:
    """Keep that a joint which meets its stop would turn back a little beyond it if there were no stop."""
    problem, state = run.problem, in_numbers(phase.state, float)
    rates = rates_in(problem.tree, problem.shape, phase, state, phase.time, float).state
    rate_at = places(problem.tree)[event.link]
    speed, acceleration = state[rate_at], rates[rate_at]
    if speed * acceleration < 0:
        q = state[rate_at - 1] - speed * speed / (2 * acceleration)
        if (near := touch(problem, event.link, float(phase.time), q)) is not None:
            run.touches.append(near)


def _moved(problem: Problem, phase: Phase, state: WideArray, time: Any) -> int | None:
    """The link that is held at the beginning of a phase although its forces exceed what can hold it shortly afterwards."""
    strains = rates_in(problem.tree, problem.shape, phase, in_numbers(state, float), exactly(time), float).strains
    for index in phase.watched:
        side, friction, strain = phase.sides.get(index, 0), float(problem.tree.links[index].friction), strains[index]
        if (side * strain if side else -abs(strain)) < -(1 + EQUAL * problem.kind.eps) * friction:
            return index
    return None


def _after(problem: Problem, phase: Phase, event: Event) -> Begun:
    """Return the phase after an event."""
    index, state = event.link, phase.state.copy()
    rate_at, eps = places(problem.tree)[index], problem.kind.eps
    if event.kind in ("law", "elastic"):
        return Begun(with_cells(problem, phase))
    if event.kind == "rest" and not phase.rest[index]:
        # Its acceleration begins at zero, so that the modes of the other links do not change at this instant.
        strain = rates_in(problem.tree, problem.shape, phase, in_numbers(state, float), phase.time, float).strains[index]
        mode = -phase.sides[index] if index in phase.sides else sign(strain)
        sides = {each: side for each, side in phase.sides.items() if each != index}
        return Begun(replace(phase, rest={**phase.rest, index: mode}, sides=sides))
    if event.kind == "stop":
        state[rate_at - 1] = problem.kind.number(dict(problem.limits(index))[(-1, 1)[event.index]])
    else:
        state[rate_at] = state[rate_at] * 0
    return settled(problem, replace(phase, state=state), eps)
