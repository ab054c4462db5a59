"""The motion of a mechanism whose equations switch, by its Lagrangian, from change to change.

A phase ends at an instant at which a controller computes, at a time of a table, or at the root of a guard (`laws.Guard`): a
limit begins or ceases to act, an elastic stop is reached, a joint comes to rest against dry friction, the force that holds a
joint at rest exceeds its bounds, or a rigid stop is hit. The modes after a change follow from the equations: see `changes`. No
phase is taken from another way.

The sign of a guard changes where the guard has a root. A guard that is zero at the beginning of a phase has no certain sign
there: the sign is tested in the middle of the step, before the first root.
"""

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, Protocol

import numpy as np

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.independent.border import MP, Number
from bodycheck.reference.integration.rotation import WideArray
from bodycheck.reference.mechanisms.lagrangian import changes
from bodycheck.reference.mechanisms.lagrangian.changes import Phase
from bodycheck.reference.mechanisms.lagrangian.equations import derived
from bodycheck.reference.mechanisms.lagrangian.friction import reactions
from bodycheck.reference.mechanisms.lagrangian.laws import Guard, switched, switching
from bodycheck.reference.mechanisms.lagrangian.sampled import Sampler, exact
from bodycheck.reference.mechanisms.lagrangian.system import System, rounded

#: The largest number of changes, without those at known times.
MOST_CHANGES = 10_000

#: The part of the friction that may be unused where an element that sticks is watched after every step.
WATCHED = 1e-9

#: The part of its first step in which a root of a guard that was zero at the beginning is rounding.
BEGINNING = 2.0**-16


class Stepper(Protocol):
    """An integrator of the equations of a structure that finds the roots of its guards.

    most: the largest number of steps of a motion. time, state: what is reached, in the units of the equations.
    """

    @property
    def most(self) -> int: ...

    @property
    def time(self) -> Any: ...

    @property
    def state(self) -> WideArray: ...

    def begin(self, time: Any, state: WideArray, parameters: WideArray) -> None:
        """Begin at a time and a state, with all parameters of the structure."""

    def step(self, until: Any) -> list[tuple[Any, int]]:
        """Take a step, at most to a time, and return the times and guards of its roots in their order."""

    def at(self, time: Any) -> WideArray:
        """The state at a time in the last step."""


@dataclass(frozen=True, eq=False)
class _Change:
    """The end of a phase at a change: its time, and the guards that change there."""

    time: Any
    guards: tuple[Guard, ...]


@dataclass(frozen=True, eq=False)
class _Course:
    """A motion that is followed: a system, an integrator, and the times of the states.

    rows: the states at the times so far.
    """

    system: System
    stepper: Stepper
    times: WideArray
    rows: list[WideArray]


def solve(system: System, start: list[Number], times: WideArray, stepper: Stepper) -> WideArray:
    """The states (n, k) at ascending times (n,) >= 0, in the unit of time of the equations and in the type of the times.

    Raises `OutOfReach` if the integration fails or takes too many steps, or there are too many changes.
    """
    course = _Course(system, stepper, times, [])
    samplers = [
        Sampler(index, element.controller)
        for index, element in enumerate(system.border.elements)
        if element.controller is not None and element.controller.rate is not None
    ]
    phase = changes.started(system, start, samplers, times)
    left, count = stepper.most, 0
    while True:
        instant = _next(system, samplers, phase)
        until = times[-1]
        if instant is not None:
            until = min(rounded(exact(instant) / system.units.time, times.dtype.type), until)
        change, left = _advanced(course, phase, until, left)
        if len(course.rows) == len(times):
            return np.array(course.rows).reshape(len(times), len(start))
        if change is None:
            assert instant is not None
            phase = changes.renewed(system, replace(phase, time=until, state=stepper.state), samplers, instant)
            continue
        phase, count = changes.switched(system, phase, change.guards, change.time, stepper.at(change.time)), count + 1
        if count > MOST_CHANGES:
            raise OutOfReach(f"more than {MOST_CHANGES} changes between modes of motion, in the Lagrangian")


def _next(system: System, samplers: list[Sampler], phase: Phase) -> Fraction | None:
    """The next time (s) at which a controller computes, a table changes or stops cease to act; None if there is none."""
    ends = [part.until for part in phase.modes.pieces.values() if part.until is not None]
    if system.stops_until is not None and not phase.modes.released:
        ends.append(system.stops_until)
    return min([*ends, *(sampler.next for sampler in samplers)], default=None)


def _advanced(course: _Course, phase: Phase, until: Any, most: int) -> tuple[_Change | None, int]:
    """Follow a phase to the next change, at most to a time, and append the states at the times in it.

    Returns the change, or None at that time, and the number of steps that are left.
    """
    system, stepper, modes = course.system, course.stepper, phase.modes
    parameters = system.in_type(modes, phase.state.dtype.type)
    stepper.begin(phase.time, phase.state, parameters)
    watching = bool(_watched(course.system, phase, phase.state))
    time = phase.time
    for left in reversed(range(most)):
        _record(course, time, first=time == phase.time, state=phase.state)
        if time >= until or len(course.rows) == len(course.times):
            return None, left
        begin, roots = time, stepper.step(until)
        time = stepper.time
        early = begin + BEGINNING * (time - begin) if begin == phase.time else begin
        change, flips = _first(
            course, phase, [root for root in roots if not (root[0] <= early and _begun(course, phase, root))]
        )
        span = begin, time if change is None else change.time
        if wrong := _overlooked(course, phase, parameters, span, flips) or _exceeded(course, phase, span[1], watching):
            change = _Change(begin, wrong)
        else:
            modes.signs.update({pair: sign for _, pair, sign in flips})
        if change is not None:
            _record(course, change.time, first=False, state=phase.state)
            return change, left
        watching = watching and bool(_watched(system, phase, stepper.state))
    raise OutOfReach("the integration stopped, since the motion needs too many steps")


def _record(course: _Course, time: Any, *, first: bool, state: WideArray) -> None:
    """Append the states at the times up to a time in the last step. first: whether it is the beginning of a phase."""
    rows, times = course.rows, course.times
    while len(rows) < len(times) and times[len(rows)] <= time:
        rows.append(state if first else course.stepper.at(times[len(rows)]))


def _begun(course: _Course, phase: Phase, root: tuple[Any, int]) -> bool:
    guard = derived(course.system.structure).guards[root[1]]
    return (guard.element, guard.name) in phase.begun


#: The time, the guard by element and name, and the new sign of a guard where it has a root.
_Flip = tuple[Any, tuple[int, str], int]


def _first(course: _Course, phase: Phase, roots: list[tuple[Any, int]]) -> tuple[_Change | None, list[_Flip]]:
    """The first root in a step that ends the phase, and the guards whose signs change before it without any effect."""
    system, modes = course.system, phase.modes
    signs, flips = dict(modes.signs), list[_Flip]()
    for time, number in roots:
        guard = derived(system.structure).guards[number]
        index, law = guard.element, system.laws[guard.element]
        if _same_as_rest(system, (index, guard.name)):
            continue
        if guard.name in switching(law):
            before, pair = _effects(system, index, signs), (index, guard.name)
            signs[pair] = -signs[pair]
            if _effects(system, index, signs) != before:
                return _Change(time, (guard,)), flips
            flips.append((time, pair, signs[pair]))
        elif guard.name in law.rigid:
            if modes.released:
                continue
            side = 1 if guard.name == "upper" else -1
            if modes.sides[index] != side and side * course.stepper.at(time)[system.velocity(index)] > 0:
                return _Change(time, (guard, *_together(course, roots, time, number))), flips
        elif (modes.moves[index] != 0) == (guard.name == "rest"):
            return _Change(time, (guard,)), flips
    return None, flips


def _same_as_rest(system: System, pair: tuple[int, str]) -> bool:
    """Return whether a guard is the velocity of an element with dry friction, which has the guard "rest"."""
    return pair[1] == "forwards" and system.laws[pair[0]].dry


def _together(course: _Course, roots: list[tuple[Any, int]], time: Any, number: int) -> list[Guard]:
    """The guards of other rigid stops whose roots are at the same time, up to rounding."""
    near, guards = changes.NOISE * np.finfo(course.times.dtype).eps * abs(time), derived(course.system.structure).guards
    others = {other for at, other in roots if other != number and abs(at - time) <= near}
    return [guards[other] for other in sorted(others) if guards[other].name in course.system.laws[guards[other].element].rigid]


def _effects(system: System, index: int, signs: dict[tuple[int, str], int]) -> dict[str, Number]:
    law = system.laws[index]
    return switched(law, {name: signs[index, name] for name in switching(law)}, system.constants[index])


def _watched(system: System, phase: Phase, state: WideArray) -> list[int]:
    """The elements that are held by almost all of the force that can hold them, within `WATCHED`."""
    held = [index for index, mode in phase.modes.moves.items() if not mode]
    if not held:
        return []
    outcome, near = changes.in_doubles(system, phase.modes, state), []
    for index in held:
        low, high = (float(bound) for bound in system.bounds(index, phase.modes.sides[index]))
        room = WATCHED * (float(system.frictions[index]) or outcome[index].inertia)
        if not low + room <= outcome[index].force <= high - room:
            near.append(index)
    return near


def _overlooked(
    course: _Course, phase: Phase, parameters: WideArray, span: tuple[Any, Any], flips: list[_Flip]
) -> tuple[Guard, ...]:
    """The guards that contradict the modes in a span of a step without a change: they had roots at its beginning.

    In the middle of the span, no velocity is zero because an element is about to come to rest.
    """
    system, modes = course.system, phase.modes
    guards = {(guard.element, guard.name): guard for guard in derived(system.structure).guards}
    middle = (span[0] + span[1]) / 2
    halfway = course.stepper.at(middle)
    rest = [index for index, mode in modes.moves.items() if mode * halfway[system.velocity(index)] < 0]
    wrong = [guards[index, "rest"] for index in rest if (index, "rest") in guards]
    signs = modes.signs | {pair: sign for time, pair, sign in flips if time <= middle}
    for pair, (value, room) in changes.guard_values(system, parameters, halfway).items():
        if _same_as_rest(system, pair):
            continue
        rigid = pair[1] in system.laws[pair[0]].rigid
        idle = modes.released or (modes.sides[pair[0]] and not modes.moves[pair[0]]) if rigid else False
        sign = (0 if idle else -1) if rigid else signs[pair]
        if sign * value < -room:
            wrong.append(guards[pair])
    return tuple(wrong)


def _exceeded(course: _Course, phase: Phase, time: Any, watching: bool) -> tuple[Guard, ...]:
    """The guards of the forces on held elements that exceed their bounds at a time in the last step, if they are watched."""
    if not watching:
        return ()
    system, modes, state = course.system, phase.modes, course.stepper.at(time)
    guards = {(guard.element, guard.name): guard for guard in derived(system.structure).guards}
    outcome = reactions(system, changes.exact_state(state), system.with_modes(modes), MP.mpf, MP)
    exceeded, rounding = list[tuple[int, str]](), changes.ROUNDINGS * float(np.finfo(state.dtype).eps)
    for index in (index for index, mode in modes.moves.items() if not mode):
        low, high = system.bounds(index, modes.sides[index])
        room = rounding * (system.frictions[index] or outcome[index].inertia)
        if outcome[index].force > high + room:
            exceeded.append((index, "high"))
        if outcome[index].force < low - room:
            exceeded.append((index, "low"))
    return tuple(guards[pair] for pair in exceeded)
