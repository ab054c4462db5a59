"""The coupled sliding and spinning of a flat body until it rests, solved in two ways that share only the law of friction.

Coordinates x, y, psi; L = m (x'^2 + y'^2)/2 + C psi'^2/2 [G, Example 2.2] with the generalized forces of friction. Close to
rest the direction of the motion changes ever faster while the speed |u|, |u|^2 = v^2 + (C/m) w^2, falls to zero in a finite
time. `in_log_time` solves for the logarithm of that speed and its direction in dt = |u| ds/(mu g), in the world frame; there
rest lies at infinity and the approach to it is smooth. `in_plain_time` solves for the velocities in the body frame in time.

Both slow down where friction itself is not smooth, by the factor 1/(1 + nearness/`HALF_PACE_NEARNESS`).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.integration.dop853 import Derivative, advance, dop853
from bodycheck.reference.sliding.footprint import STUCK_SLIP
from bodycheck.reference.sliding.friction import Law
from bodycheck.reference.trajectory import Array

#: Fraction of its first speed at which a body in log time is taken to its stop with the deceleration that it has reached.
LOG_TIME_STOP_FRACTION = 1e-15

#: The same in plain time, where the speed keeps six of its digits; what is left out is of second order.
PLAIN_TIME_STOP_FRACTION = 1e-9

#: Longest steps, where 1 is what the first speed takes to be lost at the deceleration mu g: they keep the interpolant, of order
#: 7, as good as the steps, and are no multiples of each other, so that the two solutions share no step.
LONGEST_LOG_TIME_STEP, LONGEST_PLAIN_TIME_STEP = 0.2, 0.13

#: Relative disagreement of two instants that is one of roundings.
TIME_ROUNDING = 4 * float(np.finfo(float).eps)

#: Nearness at which time goes at half its pace.
HALF_PACE_NEARNESS = 4.0


@dataclass(frozen=True, eq=False)
class Flat:
    """A body that slides on a plane: mass (kg), radius of gyration sqrt(C/m) (m), deceleration mu g of a straight slide
    (m/s^2), its law of friction and, of the same variables, how near friction is to where it is not smooth."""

    mass: float
    gyration: float
    deceleration: float
    law: Law
    nearness: Callable[[float, float, float], float]


@dataclass(frozen=True, eq=False)
class Motion:
    """Rows (n, 6) of x, y, psi, dx/dt, dy/dt, dpsi/dt (m, rad, s), world frame, and the stop as t, x, y, psi (4,), if any."""

    rows: Array
    stop: Array | None


def rotated(angle: float, x: float, y: float) -> tuple[float, float]:
    """A plane vector turned by an angle (rad)."""
    c, s = math.cos(angle), math.sin(angle)
    return c * x - s * y, s * x + c * y


def in_log_time(flat: Flat, start: Array, times: Array, reached: Callable[[float, float, float, float], None]) -> Motion:
    """The motion from x, y, psi, dx/dt, dy/dt, dpsi/dt (6,) at ascending times (n,) >= 0 s, at rest after the stop.

    reached is told t and, of a speed |u| = 1, the body's v1, v2, w at every step.
    Unknowns: t, x, y, psi, the unit vector (v_x, v_y, sqrt(C/m) w)/|u| and ln(|u|/|u0|), the last by the balance of energy.

    Raises `OutOfReach` where one of several points comes to rest while the others slide, or for too many steps.
    """
    metric = np.array([1.0, 1.0, flat.gyration])
    first = float(np.linalg.norm(start[3:] * metric))
    unit = first / flat.deceleration
    travel = first * unit

    def body_rates(y: Array) -> tuple[float, float, float]:
        v1, v2 = rotated(-float(y[3]), float(y[4]), float(y[5]))
        return v1, v2, float(y[6]) / flat.gyration

    def pull(y: Array) -> Array:
        """Rates of v_x, v_y, sqrt(C/m) w over mu g."""
        f1, f2, torque = flat.law(*body_rates(y))
        return np.array([*rotated(float(y[3]), f1, f2), torque / flat.gyration]) / (flat.mass * flat.deceleration)

    def clock(y: Array) -> float:
        return unit * math.exp(y[7]) / (1 + flat.nearness(*body_rates(y)) / HALF_PACE_NEARNESS)

    def derivative(_s: float, y: Array) -> Array:
        direction, speed = y[4:7], math.exp(y[7])
        change = pull(y)
        # Over its length, of which the rounding errors would otherwise grow as the speed falls.
        power = float(change @ direction) / float(direction @ direction)
        velocity = travel * speed * speed * direction / metric
        rates = np.array([speed * unit, *velocity, *(change - power * direction), power])
        return np.asarray(rates / (1 + flat.nearness(*body_rates(y)) / HALF_PACE_NEARNESS))

    def watched(y: Array) -> bool:
        rates = body_rates(y)
        reached(float(y[0]), *rates)
        if flat.nearness(*rates) > 0.1 / STUCK_SLIP:
            raise OutOfReach(f"one point of the body comes to rest at t = {y[0]:.6g} s while others slide")
        return bool(y[7] > math.log(LOG_TIME_STOP_FRACTION))

    state = np.array([0.0, *start[:3], *(start[3:] * metric / first), 0.0])
    scale = np.array([unit, travel, travel, travel / flat.gyration, 1.0, 1.0, 1.0, 1.0])
    sampled, last = followed(derivative, clock, watched, state, times, scale, LONGEST_LOG_TIME_STEP)

    def velocities(y: Array) -> Array:
        return np.asarray(first * np.exp(y[:, 7:]) * y[:, 4:7] / metric)

    rows = np.concatenate([sampled[:, 1:4], velocities(sampled)], axis=1)
    if len(rows) == len(times):
        return Motion(rows, None)
    return stopped(rows, times, last[:4], velocities(last[None])[0], pull(last) * flat.deceleration / metric, metric)


def in_plain_time(flat: Flat, start: Array, times: Array) -> Motion:
    """The motion from x, y, psi, dx/dt, dy/dt, dpsi/dt (6,) at ascending times (n,) >= 0 s, at rest after the stop.

    Unknowns: t, x, y, psi and the velocities in the body frame, by the balance of momentum.

    Raises `OutOfReach` for too many steps.
    """
    metric = np.array([1.0, 1.0, flat.gyration])
    first = float(np.linalg.norm(start[3:] * metric))
    unit = first / flat.deceleration
    travel = first * unit
    moment = flat.mass * flat.gyration**2

    def clock(y: Array) -> float:
        return unit / (1 + flat.nearness(*y[4:].tolist()) / HALF_PACE_NEARNESS)

    def derivative(_s: float, y: Array) -> Array:
        _, _, _, psi, v1, v2, w = y.tolist()
        f1, f2, torque = flat.law(v1, v2, w)
        accelerations = f1 / flat.mass + w * v2, f2 / flat.mass - w * v1, torque / moment
        return clock(y) * np.array([1, *rotated(psi, v1, v2), w, *accelerations])

    state = np.array([0.0, *start[:3], *rotated(-start[2], *start[3:5]), start[5]])
    scale = np.array([unit, travel, travel, travel / flat.gyration, first, first, first / flat.gyration])
    sampled, last = followed(
        derivative,
        clock,
        lambda y: bool(np.linalg.norm(y[4:] * metric) > PLAIN_TIME_STOP_FRACTION * first),
        state,
        times,
        scale,
        LONGEST_PLAIN_TIME_STEP,
    )

    def velocities(y: Array) -> Array:
        c, s = np.cos(y[:, 3]), np.sin(y[:, 3])
        return np.column_stack([c * y[:, 4] - s * y[:, 5], s * y[:, 4] + c * y[:, 5], y[:, 6]])

    rows = np.concatenate([sampled[:, 1:4], velocities(sampled)], axis=1)
    if len(rows) == len(times):
        return Motion(rows, None)
    f1, f2, torque = flat.law(*last[4:].tolist())
    acceleration = np.array([*rotated(float(last[3]), f1 / flat.mass, f2 / flat.mass), torque / moment])
    return stopped(rows, times, last[:4], velocities(last[None])[0], acceleration, metric)


def stopped(rows: Array, times: Array, at: Array, velocity: Array, acceleration: Array, metric: Array) -> Motion:
    """Rows (k, 6) of a motion completed by rest: from t, x, y, psi on (4,) it slows down evenly along its direction.

    metric: 1, 1 and the radius of gyration, in which velocity and acceleration (3,) of x, y, psi have a length.
    """
    speed = velocity * metric
    remaining = -float(speed @ speed) / float(speed @ (acceleration * metric))
    stop = at + remaining * np.array([1, *(velocity / 2)])
    resting = np.tile([*stop[1:], 0.0, 0.0, 0.0], (len(times) - len(rows), 1))
    return Motion(np.concatenate([rows, resting]), stop if times[-1] >= stop[0] else None)


def followed(
    derivative: Derivative,
    clock: Callable[[Array], float],
    moving: Callable[[Array], bool],
    state: Array,
    times: Array,
    scale: Array,
    longest: float,
) -> tuple[Array, Array]:
    """States (k, m) of y' = derivative(s, y) at those of the times (n,) that come before its end, and the last state (m,).

    The first unknown is t, with t' = clock(y) > 0. moving is asked at the start and after each step.
    """
    solver = dop853(derivative, 0.0, state, np.inf, scale, max_step=longest)
    done = int(np.searchsorted(times, 0.0, side="right"))
    chosen, taken = [np.repeat(state[None], done, axis=0)], 0
    while moving(state) and done < len(times):
        taken = advance(solver, taken, float(state[0]), float(times[-1]))
        before, state = state, solver.y
        passed = int(np.searchsorted(times, state[0], side="right"))
        if passed > done:
            chosen.append(interpolated(solver, clock, before, state, times[done:passed]))
            done = passed
    return np.concatenate(chosen), state


def interpolated(solver: Any, clock: Callable[[Array], float], before: Array, after: Array, times: Array) -> Array:
    """States (n, m) at times (n,) within the solver's last step: its interpolant, where it has those times."""
    dense = solver.dense_output()
    start, end = float(solver.t_old), float(solver.t)
    rows = np.empty((len(times), len(after)))
    for row, time in zip(rows, times.tolist(), strict=True):
        s = start + (end - start) * (time - before[0]) / (after[0] - before[0])
        row[:] = dense(s)
        for _ in range(5):  # Newton's method, from within a step in which t(s) is nearly quadratic
            late = row[0] - time
            if abs(late) <= TIME_ROUNDING * time:
                break
            s = min(max(s - late / clock(row), start), end)
            row[:] = dense(s)
    return rows
