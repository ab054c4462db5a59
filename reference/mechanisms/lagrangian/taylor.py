"""The solution of the Lagrangian's equations by Taylor's method (heyoka)."""

import contextlib
import functools
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import heyoka as hy
import numpy as np

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.integration.dop853 import MAX_STEPS
from bodycheck.reference.integration.heyoka_solver import OPTIMISATION, prepare_heyoka, step_tolerance
from bodycheck.reference.integration.rotation import WideArray
from bodycheck.reference.mechanisms.lagrangian.differentiation import Node, made
from bodycheck.reference.mechanisms.lagrangian.equations import derived
from bodycheck.reference.mechanisms.lagrangian.structure import Structure

#: The number of operations (steps times the length of the equations) after which an integration stops: some 20 s in 80 bits.
MAX_OPERATIONS = 60_000_000

#: The largest number of coordinates and velocities for which equations are first solved by code that is not optimised, and the
#: number of steps after which the solution begins again with optimised code, whose compilation takes a second longer.
MOST_BRIEF, BRIEF_STEPS = 28, 512

#: The same for a mechanism with loops, whose steps become ever shorter near a position in which it can change to another mode
#: of motion.
MAX_OPERATIONS_OF_LOOPS = 10_000_000

#: The lock that is held while an integrator runs, since an integrator contains its state and is shared by all threads.
lock = threading.Lock()


def system(structure: Structure, further: Sequence[Node] = ()) -> tuple[list[Any], list[Any], list[Any]]:
    """The variables of a structure's equations, their rates, and further nodes of its tape, as heyoka's expressions."""
    equations = derived(structure)
    variables = [hy.expression(f"s{index}") for index in range(equations.states)]
    leaves: dict[str, Callable[[Any], Any]] = {
        "number": lambda value: hy.expression(value),
        "parameter": lambda number: hy.par[equations.used.index(number)],
        "variable": lambda number: variables[number],
    }
    nodes = [*equations.rates, *further]
    expressions = made(equations.tape, nodes, lambda kind, value: leaves[kind](value), hy.sin, hy.cos)
    return variables, expressions[: equations.states], expressions[equations.states :]


def compiled(
    variables: Sequence[Any],
    rates: Sequence[Any],
    dtype: Any,
    parameters: int,
    events: Sequence[Any] = (),
    optimised: bool = True,
) -> tuple[Any, int]:
    """A compiled integrator of equations with a number of parameters, and the length of the equations."""
    prepare_heyoka()
    solver = hy.taylor_adaptive(
        list(zip(variables, rates, strict=True)),
        np.zeros(len(variables), dtype),
        pars=np.zeros(parameters, dtype),
        tol=dtype(step_tolerance(dtype)),
        fp_type=dtype,
        # Code that is not compact takes much longer to compile.
        compact_mode=True,
        opt_level=OPTIMISATION if optimised else 0,
        nt_events=list(events),
    )
    return solver, len(solver.decomposition)


def most_steps(length: int, structure: Structure) -> int:
    """Return the largest number of steps of an integration. length: of its equations."""
    return min(MAX_STEPS, (MAX_OPERATIONS_OF_LOOPS if structure.loops else MAX_OPERATIONS) // length)


#: A number that is added to the functions of events: heyoka does not find further roots of one that is zero at the beginning of
#: a step, such as the velocity of an element that begins to slip.
_ABOVE_ZERO = 1e-60


@dataclass(frozen=True, eq=False)
class Stepper:
    """heyoka's integrator with the guards of a structure, and the times and guards of the roots in its last step.

    most: the largest number of steps of a motion.
    """

    inner: Any
    roots: list[tuple[Any, int]]
    used: list[int]
    most: int

    @property
    def time(self) -> Any:
        """The time that is reached, in the unit of time of the equations."""
        return self.inner.time

    @property
    def state(self) -> WideArray:
        """The state at this time."""
        return np.array(self.inner.state)

    def begin(self, time: Any, state: WideArray, parameters: WideArray) -> None:
        """Begin at a time and a state, with all parameters of the structure."""
        self.inner.time, self.inner.state[:] = time, state
        self.inner.pars[:] = parameters[self.used]

    def step(self, until: Any) -> list[tuple[Any, int]]:
        """Take a step, at most to a time, and return the times and guards of its roots. Raises `OutOfReach` if it fails."""
        self.roots.clear()
        begin = self.inner.time
        outcome, _ = self.inner.step(max_delta_t=until - begin, write_tc=True)
        if outcome not in (hy.taylor_outcome.success, hy.taylor_outcome.time_limit):
            raise OutOfReach(f"Taylor's method stopped at {float(begin):.6g} units of time: {outcome.name}")
        if outcome == hy.taylor_outcome.time_limit:
            self.inner.time = until
        return sorted(self.roots)

    def at(self, time: Any) -> WideArray:
        """The state at a time in the last step."""
        self.inner.update_d_output(time)
        return np.array(self.inner.d_output)


@functools.lru_cache(maxsize=8)
def stepper(structure: Structure, dtype: Any) -> Stepper:
    """The compiled integrator of a structure with its guards as events."""
    equations, roots = derived(structure), list[tuple[Any, int]]()
    variables, rates, guards = system(structure, [guard.node for guard in equations.guards])
    events = [hy.nt_event(guard + _ABOVE_ZERO, _noting(roots, number), fp_type=dtype) for number, guard in enumerate(guards)]
    inner, length = compiled(variables, rates, dtype, len(equations.used), events)
    return Stepper(inner, roots, list(equations.used), most_steps(length, structure))


def _noting(roots: list[tuple[Any, int]], index: int) -> Callable[[Any, Any, int], None]:
    # heyoka copies the callback of an event: a function as it is, but an object with all its members, such as a list.
    def note(_: Any, time: Any, __: int) -> None:
        roots.append((time, index))

    return note


@functools.lru_cache(maxsize=8)
def integrator(structure: Structure, dtype: Any, optimised: bool) -> tuple[Any, int]:
    """The compiled integrator of a structure, and the length of its equations."""
    variables, rates, _ = system(structure)
    return compiled(variables, rates, dtype, len(derived(structure).used), optimised=optimised)


def first_integrator(structure: Structure, dtype: Any, states: int) -> tuple[Any, int]:
    """The integrator with which `solve` begins where there are so many states."""
    return integrator(structure, dtype, optimised=states > MOST_BRIEF)


def solve(structure: Structure, start: WideArray, parameters: WideArray, times: WideArray) -> WideArray:
    """The states (n, k) at times (n,) >= 0 in any order, in the unit of time of the equations and in the type of the start.

    Raises `OutOfReach` if the integration fails or takes too many steps.
    """
    if len(start) <= MOST_BRIEF:
        with contextlib.suppress(OutOfReach):
            return _solved(structure, start, parameters, times, optimised=False)
    return _solved(structure, start, parameters, times, optimised=True)


def _solved(structure: Structure, start: WideArray, parameters: WideArray, times: WideArray, *, optimised: bool) -> WideArray:
    dtype: Any = start.dtype.type
    solver, length = integrator(structure, dtype, optimised)
    most = most_steps(length, structure) if optimised else BRIEF_STEPS
    instants, rows = np.unique(np.append(0.0, times), return_inverse=True)
    grid = instants.astype(start.dtype)
    with lock:
        solver.time = grid[0]
        solver.state[:] = start
        solver.pars[:] = parameters[list(derived(structure).used)]
        outcome, _, _, steps, _, solution = solver.propagate_grid(grid, max_steps=most)
    if outcome != hy.taylor_outcome.time_limit:
        raise OutOfReach(f"Taylor's method stopped after {steps} steps: {outcome.name}")
    return np.asarray(solution[rows[1:]])
