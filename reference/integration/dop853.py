"""SciPy's DOP853 driven near machine precision, landing on every requested instant instead of interpolating to it."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

Derivative = Callable[[float, Array], Array]

#: The tightest that DOP853 accepts: 100 rounding units.
RELATIVE_TOLERANCE = 2.3e-14

#: Relative to the scale of each component, so that components passing through zero do not stop the integration.
ABSOLUTE_TOLERANCE = 1e-15

#: Steps after which an integration is given up: about 1.5e5 turns, some minutes.
MAX_STEPS = 1_000_000


def dop853(derivative: Derivative, start: float, state: Array, end: float, scale: Array, **steps: Any) -> Any:
    """SciPy's solver at the tolerances above; steps: its own arguments for the length of steps.

    The stubs of SciPy know neither real equations nor a tolerance for each component.
    """
    # Imported when it is needed: `scipy.integrate` is slow to import, and Taylor's method does without it.
    from scipy.integrate import DOP853

    solver: Any = DOP853
    return solver(derivative, start, state, end, rtol=RELATIVE_TOLERANCE, atol=ABSOLUTE_TOLERANCE * scale, **steps)


def advance(solver: Any, taken: int, time: float, end: float) -> int:
    """Let a solver take one step, from a time to an end (s), and count it. Raises `OutOfReach`."""
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
    """Solutions (n, k) of y' = derivative(t, y), y(0) = start, at ascending times (n,) >= 0.

    scale: typical sizes (k,) of the components. after_step may answer a step's result with a new equation and the same
    state in its coordinates; at_sample is called as each row is taken.

    Dense output is one order lower than the steps themselves, so each instant is the end of a step.
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
    """Typical sizes of position (m), angle (rad), velocity (m/s) and angular velocity (rad/s) in a free flight; none is 0."""
    reach = float(times[-1]) if len(times) else 0.0
    speed = math.hypot(*scene.initial.velocity) + scene.gravity * reach
    length = math.hypot(*scene.initial.position) + speed * reach
    return length or 1.0, 1.0, speed or 1.0, math.hypot(*scene.initial.angular_velocity) or 1.0
