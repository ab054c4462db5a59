"""The motion of a mechanism with dry friction by its Lagrangian, from change to change (heyoka; Linux only).

Each element with dry friction slips one way or sticks. While it slips, friction is a constant force against its velocity; while
it sticks, its velocity is zero. A change is a root of the velocity, or of the difference of the squares of the friction and of
the friction that the motion requires. After a change the modes follow from the equations: see `friction`. No phase is taken
from another way.
"""

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import heyoka as hy
import numpy as np

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.independent.arithmetic import wide
from bodycheck.reference.independent.border import MP, Number
from bodycheck.reference.integration.rotation import WideArray
from bodycheck.reference.mechanisms.lagrangian import taylor
from bodycheck.reference.mechanisms.lagrangian.equations import derived
from bodycheck.reference.mechanisms.lagrangian.friction import EXACT, Modes, Slipping, decided, reactions
from bodycheck.reference.mechanisms.lagrangian.structure import Structure, friction_parameters

#: The largest number of changes.
MOST_CHANGES = 10_000

#: The numbers of roundings up to which forces in an integrated state are equal, and velocities are zero.
ROUNDINGS, STOPPED = 2.0**12, 2.0**5

#: The part of the friction that may be unused where an element that sticks is watched after every step.
WATCHED = 1e-9

#: The part of its first step in which a root of an element that has begun to slip is rounding: its velocity is near zero there.
BEGINNING = 2.0**-16

#: A number that is added to velocities in event functions: an element begins to slip from zero, and heyoka does not find
#: further roots of a function that is zero at the beginning of a step.
_ABOVE_ZERO = 1e-60


@dataclass(frozen=True, eq=False)
class _Solver:
    """heyoka's integrator, the times and elements of the roots in its last step, and the most steps that it may take."""

    inner: Any
    roots: list[tuple[Any, int]]
    most: int

    def at(self, time: Any) -> WideArray:
        """The state at a time in the last step."""
        self.inner.update_d_output(time)
        return np.array(self.inner.d_output)


@dataclass(frozen=True, eq=False)
class _Phase:
    """The beginning of a phase: its time, state and modes, and the elements that begin to slip."""

    time: Any
    state: WideArray
    modes: Modes
    begun: frozenset[int]


@functools.lru_cache(maxsize=8)
def _solver(structure: Structure, dtype: Any) -> _Solver:
    equations, roots = derived(structure), list[tuple[Any, int]]()
    dry = [index for index, rubs in enumerate(structure.dry) if rubs]
    required = [pair[0] for pair in equations.strains]
    variables, rates, strains = taylor.system(structure, required)
    events = []
    for number, (index, strain) in enumerate(zip(dry, strains, strict=True)):
        force, moves = (hy.par[equations.used.index(each)] for each in friction_parameters(structure, index))
        friction = hy.par[len(equations.used) + number]
        velocity = variables[structure.places[-1][0].stop + structure.places[index][1].start]
        margin = moves * (_ABOVE_ZERO - force * velocity) + (1.0 - moves) * (friction - strain) * (friction + strain)
        falling = hy.event_direction.negative
        events.append(hy.nt_event(margin, _noting(roots, index), direction=falling, fp_type=dtype))
    inner, length = taylor.compiled(variables, rates, dtype, len(equations.used) + len(dry), events)
    return _Solver(inner, roots, taylor.most_steps(length, structure))


def _noting(roots: list[tuple[Any, int]], index: int) -> Callable[[Any, Any, int], None]:
    # heyoka copies the callback of an event: a function as it is, but an object with all its members, such as a list.
    def note(_: Any, time: Any, __: int) -> None:
        roots.append((time, index))

    return note


def solve(slipping: Slipping, start: list[Number], times: WideArray) -> WideArray:
    """The states (n, k) at ascending times (n,) >= 0, in the unit of time of the equations and in the type of the times.

    Raises `OutOfReach` if the integration fails or takes too many steps, or there are too many changes.
    """
    dtype: Any = times.dtype.type
    solver, rows = _solver(slipping.structure, dtype), list[WideArray]()
    moving = {index: _sign(start[slipping.velocity(index)]) for index in slipping.frictions}
    modes = decided(slipping, start, moving, EXACT)
    phase = _Phase(dtype(0), np.array([_rounded(value, dtype) for value in start]), modes, _begun(modes, moving))
    left = solver.most
    with taylor.lock:
        for _ in range(MOST_CHANGES):
            change, left = _advanced(slipping, solver, phase, times, rows, left)
            if change is None:
                return np.array(rows).reshape(len(times), len(start))
            time, index = change
            state, modes = solver.at(time), phase.modes
            if modes[index]:
                state, modes = _stopped(slipping, state, modes, index)
            else:
                required = reactions(slipping, state.tolist(), slipping.with_modes(modes), float, math)[index].friction
                modes = {**modes, index: -_sign(required)}
            phase = _Phase(time, state, modes, _begun(modes, phase.modes))
    raise OutOfReach(f"more than {MOST_CHANGES} changes between sticking and slipping, in the Lagrangian")


def _begun(modes: Modes, before: Modes) -> frozenset[int]:
    return frozenset(index for index, mode in modes.items() if mode and not before[index])


def _sign(value: Any) -> int:
    return int(value > 0) - int(value < 0)


def _rounded(value: Number, dtype: Any) -> Any:
    return float(value) if dtype is np.float64 else wide(value)


def _exact(state: WideArray) -> list[Number]:
    """A state in numbers of a hundred digits, without rounding."""
    if not np.isfinite(state.astype(float)).all():
        raise OutOfReach("the motion exceeds the range of floating-point numbers")
    total, rest = [MP.zero] * len(state), state
    while rest.any():
        part = rest.astype(float)
        total, rest = [whole + MP.mpf(each) for whole, each in zip(total, part.tolist(), strict=True)], rest - part
    return total


def _advanced(
    slipping: Slipping,
    solver: _Solver,
    phase: _Phase,
    times: WideArray,
    rows: list[WideArray],
    most: int,
) -> tuple[tuple[Any, int] | None, int]:
    """Follow a phase to the next change, and append the states at the times in it.

    Returns the time and the element of the change, or None after the last of the times, and the number of steps that are left.
    """
    time, state, modes, begun = phase.time, phase.state, phase.modes, phase.begun
    dtype: Any = times.dtype.type
    values = slipping.with_modes(modes)
    used = [values[index] for index in derived(slipping.structure).used]
    inner = solver.inner
    inner.time, inner.state[:] = time, state
    inner.pars[:] = [_rounded(value, dtype) for value in (*used, *slipping.frictions.values())]
    watching = bool(_watched(slipping, state, modes))
    for left in reversed(range(most)):
        while len(rows) < len(times) and times[len(rows)] <= inner.time:
            rows.append(solver.at(times[len(rows)]) if inner.time > time else np.array(inner.state))
        if len(rows) == len(times):
            return None, left
        solver.roots.clear()
        begin = inner.time
        outcome, step = inner.step(max_delta_t=times[-1] - begin, write_tc=True)
        if outcome not in (hy.taylor_outcome.success, hy.taylor_outcome.time_limit):
            raise OutOfReach(f"Taylor's method stopped at {float(begin):.6g} units of time: {outcome.name}")
        early = begin + BEGINNING * step if begin == time else begin
        changes = [(at, index) for at, index in solver.roots if at > early or index not in begun]
        until = min(changes)[0] if changes else inner.time
        changes = [(begin, index) for index in _overlooked(slipping, solver, modes, watching, (begin, until))] or changes
        if changes:
            change = min(changes)
            while len(rows) < len(times) and times[len(rows)] <= change[0]:
                rows.append(solver.at(times[len(rows)]))
            return change, left
        watching = watching and bool(_watched(slipping, inner.state, modes))
    raise OutOfReach("Taylor's method stopped, since the motion needs too many steps")


def _watched(slipping: Slipping, state: WideArray, modes: Modes) -> list[int]:
    """The elements that stick and use all of their friction, within `WATCHED`."""
    if all(modes.values()):
        return []
    outcome = reactions(slipping, state.tolist(), slipping.with_modes(modes), float, math)
    limits = {index: (1 - WATCHED) * float(friction) for index, friction in slipping.frictions.items()}
    return [index for index, mode in modes.items() if not mode and abs(outcome[index].friction) > limits[index]]


def _overlooked(slipping: Slipping, solver: _Solver, modes: Modes, watching: bool, span: tuple[Any, Any]) -> list[int]:
    """The elements that contradict their modes in a span of a step without a root: they had a root at its beginning.

    In the middle of the span, no velocity is zero because an element is about to come to rest.
    """
    halfway = solver.at((span[0] + span[1]) / 2)
    back = [index for index, mode in modes.items() if mode * halfway[slipping.velocity(index)] < 0]
    if back or not watching:
        return back
    state = solver.at(span[1])
    outcome = reactions(slipping, _exact(state), slipping.with_modes(modes), MP.mpf, MP)
    most = 1 + ROUNDINGS * float(np.finfo(state.dtype).eps)
    return [
        index for index, mode in modes.items() if not mode and abs(outcome[index].friction) > most * slipping.frictions[index]
    ]


def _stopped(slipping: Slipping, state: WideArray, modes: Modes, index: int) -> tuple[WideArray, Modes]:
    """The state in which an element, and those that stop with it, are at rest, and the modes of all elements from then on."""
    state, moving, rounding = state.copy(), dict(modes), float(np.finfo(state.dtype).eps)
    velocities = {each: modes[each] * float(state[slipping.velocity(each)]) for each in modes}
    zero = STOPPED * rounding * max(abs(velocity) for velocity in velocities.values())
    for each, velocity in velocities.items():
        if each == index or velocity <= zero:
            state[slipping.velocity(each)], moving[each] = 0, 0
    return state, decided(slipping, _exact(state), moving, MP.mpf(ROUNDINGS * rounding))
