"""Trees whose joints have dry friction, by Taylor's method with events (heyoka; Linux only).

Each such joint slips forwards, slips backwards or sticks. While it slips, friction is a constant force against its velocity;
while it sticks, its coordinate does not move, and the force of friction is whatever keeps it at rest, up to the size of the
friction. A joint slips until its velocity is zero, and sticks until the required force exceeds the friction. Both events are
roots of functions of the state, which heyoka finds within the step of the series to the rounding of the arithmetic.

When joints are at rest at the start, or a joint comes to rest, the modes of all joints at rest follow from their accelerations,
which are linear in the forces of friction: a joint either does not accelerate, and its force is within the friction, or it
accelerates against the full friction. This complementarity problem has one solution, as the mass matrix is positive definite.
"""

import functools
import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import heyoka as hy
import numpy as np

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.numbers import FloatType, WideArray
from bodycheck.reference.integration.heyoka_solver import compiled, integrator_lock
from bodycheck.reference.mechanisms.link_states import (
    Change,
    Course,
    Form,
    derivatives,
    in_doubles,
    places_of_rates,
    split,
    start,
)
from bodycheck.reference.mechanisms.tree import Tree
from bodycheck.reference.mechanisms.tree_equations import Shape, most_steps, parameters, shape_of, written
from bodycheck.reference.trajectory import Array

#: The largest number of joints at rest for which all combinations of modes, 3 to this power, are tried if the iteration fails.
MOST_TRIED = 8

#: The largest number of rounds of the iteration, and the change of a force, in units of the friction, below which it ends.
ROUNDS, UNCHANGED = 2000, 1e-13

#: The largest number of changes between sticking and slipping.
MOST_CHANGES = 10_000

#: The first part of a step, as a fraction, in which a joint that has just begun to slip does not count as having come to rest
#: again: its velocity there is zero except for rounding.
JUST_BEGUN = 2.0**-20

#: Rounding of doubles in accelerations and forces, relative to the largest terms. A joint that sticks is watched if the unused
#: part of its friction is smaller than this.
NEAR = 1e-11

#: The mode of each link with dry friction, by its index: 1 or -1 if it slips forwards or backwards, 0 if it sticks.
Modes = dict[int, int]


@dataclass(frozen=True, eq=False)
class _Solver:
    """heyoka's integrator, and the list to which it appends the index of a link and the time at each change."""

    solver: Any
    crossings: list[tuple[int, Any]]

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
        rows, changes = _rows(tree, kind.array(instants), kind, _solver(shape, kind))
    return Course(split(tree, rows[order[1:]], times, kind), changes)


@functools.cache
def _solver(shape: Shape, kind: FloatType) -> _Solver:
    equations, crossings = written(shape), list[tuple[int, Any]]()
    events = [
        hy.nt_event(margin, _noting(crossings, index), direction=hy.event_direction.negative, fp_type=kind.dtype)
        for index, margin in zip(shape.dry, equations.margins, strict=True)
    ]
    return _Solver(compiled(equations.system, kind.dtype, kind.bits, large=shape.large, events=events), crossings)


def _noting(crossings: list[tuple[int, Any]], index: int) -> Callable[[Any, Any, int], None]:
    def note(_: Any, time: Any, __: int) -> None:
        crossings.append((index, time))

    return note


def _rows(tree: Tree, instants: WideArray, kind: FloatType, solver: _Solver) -> tuple[WideArray, tuple[Change, ...]]:
    """The states (n, k) at ascending times (n,), s, the first of which is 0, and the changes between sticking and slipping."""
    state, changes = kind.array(start(tree)), list[Change]()
    moving = {index: int(np.sign(float(state[at]))) for index, at in _velocities(tree).items()}
    modes = settled(tree, state, moving)
    phase = _Phase(instants[0], state, modes, _slipping(modes, moving))
    rows, left = [state], most_steps(solver.solver)
    while len(rows) < len(instants):
        crossing, left = _advanced(tree, kind, solver, phase, instants, rows, left)
        if crossing is None:
            break
        index, time = crossing
        if len(changes) >= MOST_CHANGES:
            raise OutOfReach(f"more than {MOST_CHANGES} changes between sticking and slipping before t = {float(time):.6g} s")
        before, modes = phase.modes, phase.modes
        slope = _slope(tree, solver, phase, index, time)
        state, modes = _changed(tree, solver.output(time), before, index)
        changes += [Change(time, tree.links[each].joint, mode, slope) for each, mode in modes.items() if mode != before[each]]
        phase = _Phase(time, state, modes, _slipping(modes, before))
    return np.array(rows), tuple(changes)


def _slipping(modes: Modes, before: Modes) -> frozenset[int]:
    """The links that have begun to slip."""
    return frozenset(index for index, mode in modes.items() if mode and mode != before[index])


def _velocities(tree: Tree) -> dict[int, int]:
    """The indices in a state of the velocities of links with dry friction, by the indices of the links."""
    places = places_of_rates([(link.kind, link.parent) for link in tree.links])
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
            raise OutOfReach(f"Taylor's method stopped at t = {float(begin):.6g} s: {outcome.name}")
        ignored = phase.begun if first else frozenset[int]()
        crossings = [each for each in solver.crossings if each[0] not in ignored or each[1] - begin > JUST_BEGUN * step]
        if first and not crossings:
            crossings = [(index, begin) for index in watched if _left(tree, inner.state, phase.modes, index) < -NEAR]
        crossing = min(crossings, key=lambda each: each[1], default=None)
        until = inner.time if crossing is None else crossing[1]
        while len(rows) < len(instants) and instants[len(rows)] <= until:
            rows.append(solver.output(instants[len(rows)]))
        if crossing is not None or len(rows) == len(instants):
            return crossing, left
        _check_directions(tree, inner.state, phase.modes, float(begin))
        first = False
    raise OutOfReach(f"Taylor's method stopped at t = {float(inner.time):.6g} s, since the motion needs too many steps")


def _changed(tree: Tree, state: WideArray, modes: Modes, index: int) -> tuple[WideArray, Modes]:
    """The state after a change of the link `index`, and the modes of all links from then on."""
    if not modes[index]:
        # Its acceleration begins at zero, so that the modes of the other links do not change at this instant.
        return state, {**modes, index: int(np.sign(_strains(tree, state, modes)[index]))}
    state, velocities = state.copy(), _velocities(tree)
    largest = float(max(abs(state[at]) for at in velocities.values()))
    moving = dict(modes)
    for each, at in velocities.items():
        if each == index or not modes[each] or abs(float(state[at])) <= NEAR**1.5 * largest:
            state[at], moving[each] = state[at] * 0, 0
    return state, settled(tree, state, moving)


def settled(tree: Tree, state: WideArray, moving: Modes) -> Modes:
    """Return the modes of links with dry friction: moving links keep their modes, and accelerations decide for links at rest.

    moving: the sign of each link's velocity, 0 for a link at rest.

    Raises
    ------
    OutOfReach
        If rounding leaves no solution.
    """
    rest = [index for index, mode in moving.items() if not mode]
    if not rest:
        return dict(moving)
    free, across = _responses(tree, state, moving, rest)
    scale = np.abs(free) + np.abs(across).sum(axis=1)
    every = itertools.product((0, 1, -1), repeat=len(rest)) if len(rest) <= MOST_TRIED else ()
    for trial in itertools.chain([_guess(free, across)], every):
        modes = np.array(trial)
        held = modes == 0
        force = -modes.astype(float)
        force[held] = np.linalg.solve(across[np.ix_(held, held)], -(free + across @ force)[held])
        acceleration = free + across @ force
        if (np.abs(force) <= 1 + NEAR).all() and (modes * acceleration >= -NEAR * scale).all():
            return {**moving, **dict(zip(rest, trial, strict=True))}
    raise OutOfReach("rounding leaves undecided which joints with dry friction stick")


def _guess(free: Array, across: Array) -> tuple[int, ...]:
    """Return the modes of joints at rest by the projected Gauss-Seidel iteration, which converges to the solution.

    free: (m,) accelerations without friction. across: (m, m) change of each joint's acceleration by each joint's full friction.
    """
    force = np.zeros(len(free))
    for _ in range(ROUNDS):
        before = force.copy()
        for index, row in enumerate(across):
            force[index] = np.clip(force[index] - (free[index] + row @ force) / row[index], -1.0, 1.0)
        if np.abs(force - before).max() < UNCHANGED:
            break
    acceleration, scale = free + across @ force, np.abs(free) + np.abs(across).sum(axis=1)
    slips = (np.abs(force) == 1) & (np.abs(acceleration) > NEAR * scale)
    return tuple(int(sign) for sign in np.where(slips, -np.sign(force), 0))


def _responses(tree: Tree, state: WideArray, moving: Modes, rest: Sequence[int]) -> tuple[Array, Array]:
    """The accelerations (m,) of links at rest without their friction, and their changes (m, m) by the full friction of each."""
    form, places = _with_modes(tree, moving), [_velocities(tree)[index] for index in rest]
    # A joint at rest is not held fixed here, since its acceleration without friction is needed.
    constants = [
        replace(each, moves=1) if index in moving and not moving[index] else each for index, each in enumerate(form.constants)
    ]

    def accelerations(pushed: int | None) -> Array:
        pushed_constants = list(constants)
        if pushed is not None:
            pushed_constants[pushed] = replace(
                pushed_constants[pushed], force=pushed_constants[pushed].force + float(tree.links[pushed].friction)
            )
        rates = derivatives(Form(form.links, pushed_constants, form.gravity), state.astype(float).tolist(), math).state
        return np.array([float(rates[at]) for at in places])

    free = accelerations(None)
    return free, np.stack([accelerations(index) - free for index in rest], axis=1)


def _with_modes(tree: Tree, modes: Mapping[int, int]) -> Form:
    """A tree in double precision, with the friction and the held joints that the modes of its links imply."""
    form = in_doubles(tree)
    constants = list(form.constants)
    for index, mode in modes.items():
        force = constants[index].force - mode * float(tree.links[index].friction)
        constants[index] = replace(constants[index], force=force, moves=abs(mode))
    return Form(form.links, constants, form.gravity)


def _strains(tree: Tree, state: WideArray, modes: Modes) -> list[float]:
    return [float(strain) for strain in derivatives(_with_modes(tree, modes), state.astype(float).tolist(), math).strains]


def _left(tree: Tree, state: WideArray, modes: Modes, index: int) -> float:
    """Return the speed of a link if it slips, or the unused part of its friction, in units of the friction, if it sticks."""
    if modes[index]:
        return abs(float(state[_velocities(tree)[index]]))
    return 1 - abs(_strains(tree, state, modes)[index]) / float(tree.links[index].friction)


def _nearly_slipping(tree: Tree, state: WideArray, modes: Modes) -> list[int]:
    """The links that stick and use all of their friction, within `NEAR`."""
    sticking = [index for index, mode in modes.items() if not mode]
    return [index for index in sticking if _left(tree, state, modes, index) < NEAR]


def _slope(tree: Tree, solver: _Solver, phase: _Phase, index: int, time: Any) -> float:
    """Return the rate at which the velocity of a link, or its unused friction, became zero at a time within the last step."""
    lapse = time - phase.time
    if lapse <= 0:
        return 0.0
    begin = time - min(lapse, abs(solver.solver.last_h)) * 2.0**-13
    unit = 1.0 if phase.modes[index] else float(tree.links[index].friction)
    return _left(tree, solver.output(begin), phase.modes, index) * unit / float(time - begin)


def _check_directions(tree: Tree, state: WideArray, modes: Modes, time: float) -> None:
    """Raise `OutOfReach` if a link moves against the direction of its mode by more than rounding. time: for the message, s."""
    for index, at in _velocities(tree).items():
        if modes[index] * float(state[at]) < -NEAR * float(np.abs(state.astype(float)).max()):
            raise OutOfReach(f"rounding leaves undecided whether a joint with dry friction slips after t = {time:.6g} s")
