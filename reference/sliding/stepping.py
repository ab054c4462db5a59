"""Integration of a motion until it rests, with time among the unknowns."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, auto
from typing import Any

import numpy as np

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.integration.dop853 import Derivative, advance, dop853
from bodycheck.reference.sliding import budget
from bodycheck.reference.sliding.panels import NODES
from bodycheck.reference.trajectory import Array

#: Relative difference of two instants that counts as rounding.
TIME_ROUNDING = 4 * float(np.finfo(float).eps)


#: Number of steps in a panel near the end of a motion. There the error of a panel's rule, relative to the speed, may be large.
STEPS_NEAR_REST = 4


@dataclass(frozen=True, eq=False)
class Steps:
    """The steps of an integration.

    Attributes
    ----------
    samples
        (k, m) states at the requested times before the end of the integration.
    ends
        (n + 1, m) the initial state, and the states at the ends of n panels, each of one step or a few.
    nodes
        (n, q, m) states at the nodes of `panels.NODES` within each panel.
    """

    samples: Array
    ends: Array
    nodes: Array


class Stage(Enum):
    """The progress of a motion after a step."""

    MOVING = auto()
    NEAR_REST = auto()
    AT_REST = auto()


def integrate_until_rest(
    derivative: Derivative,
    clock: Callable[[Array], float],
    stage: Callable[[Array], Stage],
    state: Array,
    times: Array,
    scale: Array,
    longest_step: float,
    ahead: Callable[[Array], float],
) -> Steps:
    """Solve y' = derivative(s, y), whose first unknowns are t, x, y and psi, until the body rests or all times are passed.

    Parameters
    ----------
    derivative
        Right-hand side of the equations.
    clock
        Maps a state to t' > 0, the rate of time.
    stage
        Maps a state to the stage of the motion; called at the start and after each step.
    state
        (m,) initial state.
    times
        (n,) ascending times (s).
    scale
        (m,) typical sizes of the components of the state.
    longest_step
        Longest step in the independent variable s.
    ahead
        Maps a state to an estimate of the angle (rad) through which the body turns from there until it rests or all times are
        passed.

    Returns
    -------
    Steps
        The states at the times before the end of the integration, and the steps.

    Raises
    ------
    OutOfReach
        If the integration fails, or would take too many steps; see `budget`.
    """
    solver = dop853(derivative, 0.0, state, np.inf, scale, max_step=longest_step)
    done = int(np.searchsorted(times, 0.0, side="right"))
    chosen, taken = [np.repeat(state[None], done, axis=0)], 0
    ends, nodes, panel, now = [state], [], [], stage(state)
    while now is not Stage.AT_REST and done < len(times):
        if taken == budget.PROBED_STEPS:
            budget.refuse_long(taken, abs(float(state[3] - ends[0][3])), ahead(state))
        if taken >= budget.PATIENCE * budget.MAX_SLIDE_STEPS:
            raise OutOfReach(f"the slide takes more than {taken} integration steps; {budget.MAX_SLIDE_STEPS} are the limit")
        taken = advance(solver, taken, float(state[0]), float(times[-1]))
        before, state = state, solver.y
        dense = solver.dense_output()
        passed = int(np.searchsorted(times, state[0], side="right"))
        if passed > done:
            chosen.append(interpolate(dense, clock, before, state, times[done:passed]))
            done = passed
        panel.append(dense)
        now = stage(state)
        if now is not Stage.NEAR_REST or len(panel) == STEPS_NEAR_REST or done == len(times):
            ends.append(state)
            nodes.append(at_nodes(panel))
            panel = []
    shape = len(nodes), len(NODES), len(state)
    return Steps(np.concatenate(chosen), np.array(ends), np.array(nodes).reshape(shape))


def at_nodes(panel: list[Any]) -> Array:
    """The states (q, m) at the nodes of a panel of successive steps, given by their interpolants."""
    first, last = panel[0].t_old, panel[-1].t
    parameters = first + (last - first) * NODES
    if len(panel) == 1:
        return np.asarray(panel[0](parameters).T)
    chosen = np.searchsorted([dense.t for dense in panel[:-1]], parameters)
    return np.array([panel[i](s) for i, s in zip(chosen.tolist(), parameters.tolist(), strict=True)])


def interpolate(dense: Any, clock: Callable[[Array], float], before: Array, after: Array, times: Array) -> Array:
    """States within a step, from its interpolant.

    Parameters
    ----------
    dense
        SciPy's interpolant of the step, a function of the independent variable s.
    clock
        Maps a state to t' > 0, the rate of time.
    before, after
        (m,) states before and after the step.
    times
        (n,) times within the step (s).

    Returns
    -------
    Array
        (n, m) states at the times.
    """
    start, length = float(dense.t_old), float(dense.t) - float(dense.t_old)
    rows = np.empty((len(times), len(after)))
    for row, time in zip(rows, times.tolist(), strict=True):
        s = start + length * (time - before[0]) / (after[0] - before[0])
        row[:] = dense(s)
        # Newton's method converges quickly, since t(s) is nearly quadratic within a step.
        for _ in range(5):
            late = row[0] - time
            if abs(late) <= TIME_ROUNDING * time:
                break
            s = min(max(s - late / clock(row), start), start + length)
            row[:] = dense(s)
    return rows
