"""SciPy's DOP853 near machine precision, with a step that ends at every requested instant."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

#: The right-hand side of y' = f(t, y).
Derivative = Callable[[float, Array], Array]

#: Relative tolerance of a step: the smallest that DOP853 accepts, 100 times the machine epsilon.
RELATIVE_TOLERANCE = 2.3e-14

#: Absolute tolerance of a step, relative to the typical size of each component, so that the steps do not become arbitrarily
#: small where a component passes through zero.
ABSOLUTE_TOLERANCE = 1e-15

#: Largest number of steps of one integration, which is about 1.5e5 turns of a body and takes a few minutes.
MAX_STEPS = 1_000_000


def dop853(derivative: Derivative, start: float, state: Array, end: float, scale: Array, **steps: Any) -> Any:
    """SciPy's DOP853 solver with the tolerances of this module.

    Parameters
    ----------
    derivative
        Right-hand side of the equations.
    start
        Initial value of the independent variable.
    state
        (k,) initial state.
    end
        Value of the independent variable at which the integration ends.
    scale
        (k,) typical sizes of the components of the state.
    **steps
        Arguments of SciPy's solver for the size of its steps, such as `max_step`.

    Returns
    -------
    scipy.integrate.DOP853
        The solver.
    """
    # Imported here because `scipy.integrate` is slow to import and Taylor's method does not need it.
    from scipy.integrate import DOP853

    # SciPy's type stubs admit neither real equations nor one tolerance for each component.
    solver: Any = DOP853
    return solver(derivative, start, state, end, rtol=RELATIVE_TOLERANCE, atol=ABSOLUTE_TOLERANCE * scale, **steps)


def advance(solver: Any, taken: int, time: float, end: float) -> int:
    """Take one step of a solver.

    Parameters
    ----------
    solver
        The solver, from `dop853`.
    taken
        Number of steps before this one.
    time, end
        Time before the step, and end of the integration (s), for error messages.

    Returns
    -------
    int
        Number of steps including this one.

    Raises
    ------
    OutOfReach
        If the step fails, the state is not finite, or there are more than `MAX_STEPS` steps.
    """
    message = solver.step()
    if solver.status == "failed" or not np.isfinite(solver.y).all():
        raise OutOfReach(f"the integration cannot go on at t = {time:.6g} s: {message}")
    if taken + 1 > MAX_STEPS:
        raise OutOfReach(f"more than {MAX_STEPS} integration steps before t = {end:.6g} s")
    return taken + 1


def solve(
    derivative: Derivative,
    start: Array,
    times: Array,
    scale: Array,
    after_step: Callable[[Array], tuple[Derivative, Array] | None] = lambda y: None,
    at_sample: Callable[[], None] = lambda: None,
) -> Array:
    """Solve y' = derivative(t, y), y(0) = start.

    A step ends at each instant, because the dense output of DOP853 is one order lower than its steps.

    Parameters
    ----------
    derivative
        Right-hand side of the equations.
    start
        (k,) initial state.
    times
        (n,) ascending times >= 0.
    scale
        (k,) typical sizes of the components of the state.
    after_step
        Called with the state after each step. It may return a new right-hand side and the same state in the coordinates of this
        right-hand side, with which the integration continues.
    at_sample
        Called each time a row is stored.

    Returns
    -------
    Array
        (n, k) states at the times.

    Raises
    ------
    OutOfReach
        If the integration fails or takes too many steps.
    """
    rows = np.empty((len(times), len(start)))
    time, state, stride, taken = 0.0, start, None, 0
    end = float(times[-1]) if len(times) else 0.0

    def begin() -> Any:
        return dop853(derivative, time, state, end, scale, first_step=stride)

    solver = begin() if end > 0 else None
    for row, target in zip(rows, times.tolist(), strict=True):
        while solver is not None and time < target:
            solver.t_bound, solver.status = target, "running"
            taken = advance(solver, taken, time, end)
            time, state = float(solver.t), solver.y
            if (changed := after_step(state)) is not None:
                derivative, state = changed
                stride = min(solver.h_abs, end - time) if time < end else None
                solver = begin() if time < end else None
        row[:] = state
        at_sample()
    return rows


def scales(scene: Scene, times: Array) -> tuple[float, float, float, float]:
    """Typical sizes of position (m), angle (rad), velocity (m/s) and angular velocity (rad/s) of a flight until the last time.

    A size that would be zero is 1.
    """
    reach = float(times[-1]) if len(times) else 0.0
    speed = math.hypot(*scene.initial.velocity) + scene.gravity * reach
    length = math.hypot(*scene.initial.position) + speed * reach
    return length or 1.0, 1.0, speed or 1.0, math.hypot(*scene.initial.angular_velocity) or 1.0
