"""Integration of a translation with quadratic drag by heyoka's Taylor series in the wide type (Linux only).

|v| v is analytic except where v is zero. At its apex, a nearly vertical path passes close to zero velocity, and a step of
Taylor's method across it would follow the other branch of the square root without notice. Steps therefore end before an apex,
each at most half as far from it as the one before, and a small constant is added to the square of the speed, so that the apex
of a vertical path is reached as well.

Importing this module raises `ImportError` if heyoka is not installed.
"""

import heyoka as hy
import numpy as np

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.flight.elliptic import WideArray
from bodycheck.reference.integration import heyoka_solver

#: Name of the backend in results.
BACKEND = heyoka_solver.EXTENDED_NAME

#: Smallest speed in the force law if gravity may reverse the path, in the witness's unit. Its effect on the motion is of second
#: order, some 1e-24.
SMALLEST_SPEED = 2.0**-40

#: Speed, in terminal speeds, above which an apex is far.
FAST = 4

#: Largest number of steps that end before an apex; about 90 are needed.
MAX_HOPS = 1000


def equations() -> heyoka_solver.Equations:
    """dx/dt = v, dv/dt = -p0 |v| v - p1 k in heyoka's form, with the state x, y, z and its rates and the parameters p0, p1, p2.

    p2 is the square of the smallest speed.
    """
    places, rates = hy.make_vars("x", "y", "z"), hy.make_vars("vx", "vy", "vz")
    slowing = hy.par[0] * hy.sqrt(hy.sum([*(rate**2.0 for rate in rates), hy.par[2]]))
    forces = [-slowing * rates[0], -slowing * rates[1], -slowing * rates[2] - hy.par[1]]
    return [*zip(places, rates, strict=True), *zip(rates, forces, strict=True)]


def solve(resistance: Wide, gravity: Wide, start: WideArray, times: WideArray) -> WideArray:
    """States (n, 6) at ascending times (n,) >= 0 from a start (6,), in the witness's units. Raises `OutOfReach`."""
    smallest = Wide(SMALLEST_SPEED if gravity else 0)
    parameters, solver = np.array([resistance, gravity, smallest**2]), heyoka_solver.integrator(equations, Wide)
    rows, state, now, done = np.empty((len(times), 6), dtype=Wide), start, Wide(0), 0
    for _ in range(MAX_HOPS):
        step = times[-1] - now
        if rises := bool(gravity > 0 and state[5] > -2 * np.sqrt((state[3:5] ** 2).sum() + smallest**2)):
            step = min(step, _safe_step(resistance, gravity, np.sqrt((state[3:] ** 2).sum() + smallest**2)))
        ahead = int(np.searchsorted(times, now + step, side="right")) if rises else len(times)
        # The equations are autonomous, so that every step may begin at time zero.
        states = heyoka_solver.solve(solver, state, parameters, np.append(times[done:ahead] - now, step))
        rows[done:ahead], state, now, done = states[:-1], states[-1], now + step, ahead
        if done == len(times):
            return rows
    raise OutOfReach(f"no apex after {MAX_HOPS} steps")


def _safe_step(resistance: Wide, gravity: Wide, speed: Wide) -> Wide:
    """A step that ends before the apex of a path that rises at this speed: half the time to stop at the present deceleration.

    Where drag is much larger than gravity, the step is the time in which drag alone reduces the speed to `FAST` terminal
    speeds.
    """
    terminal = np.sqrt(gravity / resistance)
    if speed > 2 * FAST * terminal:
        return Wide((1 / (FAST * terminal) - 1 / speed) / resistance)
    return Wide(speed / (2 * (gravity + resistance * speed**2)))
