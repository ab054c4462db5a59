"""The coupled sliding and spinning of a flat body until it rests, integrated in two formulations.

The two formulations share only the law of friction. The coordinates are x, y, psi, with L = m (x'^2 + y'^2)/2 + C psi'^2/2
[G, Example 2.2] and the generalized forces of friction. Close to rest the direction of the motion changes ever faster, while
the speed |u|, |u|^2 = v^2 + (C/m) w^2, falls to zero in a finite time. `in_log_time` solves for the logarithm of the speed and
for its direction, with dt = |u| ds/(mu g), in the world frame; in s the rest is at infinity and the approach to it is smooth.
`in_plain_time` solves for the velocities in the body frame, with time as the independent variable.

In both, time advances more slowly with the independent variable near points where friction is not smooth, by the factor
1/(1 + nearness/`HALF_PACE_NEARNESS`).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.integration.dop853 import Derivative
from bodycheck.reference.sliding import budget
from bodycheck.reference.sliding.footprint import STUCK_SLIP
from bodycheck.reference.sliding.friction import Law
from bodycheck.reference.sliding.panels import Panels
from bodycheck.reference.sliding.stepping import Stage, Steps, integrate_until_rest
from bodycheck.reference.trajectory import Array

#: Fraction of the initial speed below which the log-time integration ends; the remaining path to the stop is extrapolated with
#: the deceleration at that instant.
LOG_TIME_STOP_FRACTION = 1e-15

#: The same for the plain-time integration, where the speed is then accurate to six digits; the error of the extrapolation is of
#: second order in this fraction.
PLAIN_TIME_STOP_FRACTION = 1e-9

#: Fraction of the initial speed below which the panels of a motion may be long.
NEAR_REST_FRACTION = 1e-5

#: Longest steps in log time and in plain time, in units of the time in which the deceleration mu g would take away the initial
#: speed. With them the interpolant, which is of order 7, is as accurate as the steps. Neither is a multiple of the other, so
#: that the two solutions do not share their steps.
LONGEST_LOG_TIME_STEP, LONGEST_PLAIN_TIME_STEP = 0.2, 0.13

#: Nearness to a point where friction is not smooth at which time advances at half its pace.
HALF_PACE_NEARNESS = 4.0


@dataclass(frozen=True, eq=False)
class Flat:
    """A body that slides on a plane.

    Attributes
    ----------
    mass
        Mass (kg).
    gyration
        Radius of gyration sqrt(C/m) about the vertical (m).
    deceleration
        Deceleration mu g of a straight slide (m/s^2).
    law
        The law of friction.
    nearness
        Maps v1, v2 (m/s) and w (rad/s), body frame, to the nearness to a state where friction is not smooth; see
        `footprint.nearness`.
    """

    mass: float
    gyration: float
    deceleration: float
    law: Law
    nearness: Callable[[float, float, float], float]


@dataclass(frozen=True, eq=False)
class Motion:
    """A planar motion.

    Attributes
    ----------
    rows
        (n, 6) x, y, psi, dx/dt, dy/dt, dpsi/dt (m, rad, s), world frame.
    stop
        (4,) t, x, y, psi (s, m, rad) of the stop, or None where the body still moves at the last instant.
    panels
        The motion in panels, from t = 0 until about the stop or the last instant.
    """

    rows: Array
    stop: Array | None
    panels: Panels


@dataclass(frozen=True, eq=False)
class _Scales:
    """Units of a motion: the metric (3,) in which its velocity has the length |u|, and its initial speed, time and length."""

    metric: Array
    speed: float
    time: float
    length: float


def _scales(flat: Flat, start: Array) -> _Scales:
    """The units of a motion from its initial x, y, psi, dx/dt, dy/dt, dpsi/dt (6,)."""
    metric = np.array([1.0, 1.0, flat.gyration])
    speed = float(np.linalg.norm(start[3:] * metric))
    time = speed / flat.deceleration
    return _Scales(metric, speed, time, speed * time)


def rotate_in_plane(angle: float, x: float, y: float) -> tuple[float, float]:
    """The components of a plane vector after a rotation.

    Parameters
    ----------
    angle
        Angle of the rotation, counter-clockwise (rad).
    x, y
        Components of the vector.

    Returns
    -------
    tuple of float
        Components of the rotated vector.
    """
    c, s = math.cos(angle), math.sin(angle)
    return c * x - s * y, s * x + c * y


def in_log_time(flat: Flat, start: Array, times: Array, on_step: Callable[[float, float, float, float], None]) -> Motion:
    """The motion of a flat body, in log time.

    The unknowns are t, x, y, psi, the unit vector (v_x, v_y, sqrt(C/m) w)/|u|, and ln(|u|/|u0|), which follows from the balance
    of energy.

    Parameters
    ----------
    flat
        The body.
    start
        (6,) initial x, y, psi, dx/dt, dy/dt, dpsi/dt (m, rad, s), world frame.
    times
        (n,) ascending times >= 0 (s).
    on_step
        Called at every step with t (s) and, for the speed |u| = 1, with v1, v2 and w in the body frame. It may raise.

    Returns
    -------
    Motion
        The motion at the times, at rest after the stop.

    Raises
    ------
    OutOfReach
        If one of several points comes to rest while the others slide, or if the integration takes too many steps.
    """
    scales = _scales(flat, start)

    def clock(y: Array) -> float:
        return scales.time * math.exp(y[7]) / _slowdown(flat, *_unit_velocity(flat, y))

    def stage(y: Array) -> Stage:
        velocity = _unit_velocity(flat, y)
        on_step(float(y[0]), *velocity)
        if flat.nearness(*velocity) > 0.1 / STUCK_SLIP:
            raise OutOfReach(f"one point of the body comes to rest at t = {y[0]:.6g} s while others slide")
        return _stage(math.exp(y[7]), LOG_TIME_STOP_FRACTION)

    def velocities(y: Array) -> Array:
        return np.asarray(scales.speed * np.exp(y[:, 7:]) * y[:, 4:7] / scales.metric)

    state = np.array([0.0, *start[:3], *(start[3:] * scales.metric / scales.speed), 0.0])
    sizes = np.array([scales.time, scales.length, scales.length, scales.length / flat.gyration, 1.0, 1.0, 1.0, 1.0])
    derivative = _log_time_derivative(flat, scales)
    _refuse_stiff(flat, start, float(times[-1]) / scales.time if len(times) else 0.0)

    def ahead(y: Array) -> float:
        return _turning_ahead(flat, velocities(y[None])[0], times[-1] - y[0])

    steps = integrate_until_rest(derivative, clock, stage, state, times, sizes, LONGEST_LOG_TIME_STEP, ahead)
    rows, panels, last = _rows(steps.samples, velocities), _panels(steps, velocities), steps.ends[-1]
    if len(rows) == len(times):
        return Motion(rows, None, panels)
    acceleration = _unit_friction(flat, last) * flat.deceleration / scales.metric
    return Motion(*complete_with_rest(rows, times, last[:4], velocities(last[None])[0], acceleration, scales.metric), panels)


def _log_time_derivative(flat: Flat, scales: _Scales) -> Derivative:
    """The right-hand side of the equations in log time."""
    unit_force, gyration = flat.mass * flat.deceleration, flat.gyration

    def derivative(_s: float, y: Array) -> Array:
        try:
            return rates(*y.tolist())
        except (ArithmeticError, ValueError):  # beyond the range of doubles: not a number, and the solver tries a shorter step
            return np.full(len(y), np.nan)

    # In plain numbers, because NumPy takes longer for arrays of three.
    def rates(_t: float, _x: float, _y: float, psi: float, x: float, y_: float, spin: float, log: float) -> Array:
        c, s, speed = math.cos(psi), math.sin(psi), math.exp(log)
        velocity = c * x + s * y_, c * y_ - s * x, spin / gyration
        f1, f2, torque = flat.law(*velocity)
        a1, a2, a3 = (c * f1 - s * f2) / unit_force, (s * f1 + c * f2) / unit_force, torque / gyration / unit_force
        # Divided by the squared length of the direction, whose rounding errors would otherwise grow as the speed falls.
        power = (a1 * x + a2 * y_ + a3 * spin) / (x * x + y_ * y_ + spin * spin)
        pace = 1 / _slowdown(flat, *velocity)
        way = pace * scales.length * speed * speed
        turning = pace * (a1 - power * x), pace * (a2 - power * y_), pace * (a3 - power * spin)
        return np.array([pace * speed * scales.time, way * x, way * y_, way * spin / gyration, *turning, pace * power])

    return derivative


def _unit_velocity(flat: Flat, y: Array) -> tuple[float, float, float]:
    """v1, v2 and w in the body frame for the speed |u| = 1, from a state (8,) in log time."""
    v1, v2 = rotate_in_plane(-float(y[3]), float(y[4]), float(y[5]))
    return v1, v2, float(y[6]) / flat.gyration


def _unit_friction(flat: Flat, y: Array) -> Array:
    """Rates (3,) of v_x, v_y and sqrt(C/m) w by friction, divided by mu g, from a state (8,) in log time."""
    f1, f2, torque = flat.law(*_unit_velocity(flat, y))
    return np.array([*rotate_in_plane(float(y[3]), f1, f2), torque / flat.gyration]) / (flat.mass * flat.deceleration)


def _slowdown(flat: Flat, v1: float, v2: float, w: float) -> float:
    """The factor by which time advances more slowly near a point where friction is not smooth."""
    return 1 + flat.nearness(v1, v2, w) / HALF_PACE_NEARNESS


def in_plain_time(flat: Flat, start: Array, times: Array) -> Motion:
    """The motion of a flat body, in plain time.

    The unknowns are t, x, y, psi and the velocities in the body frame, which follow from the balance of momentum.

    Parameters
    ----------
    flat
        The body.
    start
        (6,) initial x, y, psi, dx/dt, dy/dt, dpsi/dt (m, rad, s), world frame.
    times
        (n,) ascending times >= 0 (s).

    Returns
    -------
    Motion
        The motion at the times, at rest after the stop.

    Raises
    ------
    OutOfReach
        If the integration fails or takes too many steps.
    """
    scales = _scales(flat, start)
    moment = flat.mass * flat.gyration**2

    def clock(y: Array) -> float:
        return scales.time / _slowdown(flat, *y[4:].tolist())

    def stage(y: Array) -> Stage:
        return _stage(float(np.linalg.norm(y[4:] * scales.metric)) / scales.speed, PLAIN_TIME_STOP_FRACTION)

    def derivative(_s: float, y: Array) -> Array:
        _, _, _, psi, v1, v2, w = y.tolist()
        f1, f2, torque = flat.law(v1, v2, w)
        accelerations = f1 / flat.mass + w * v2, f2 / flat.mass - w * v1, torque / moment
        return clock(y) * np.array([1, *rotate_in_plane(psi, v1, v2), w, *accelerations])

    def velocities(y: Array) -> Array:
        c, s = np.cos(y[:, 3]), np.sin(y[:, 3])
        return np.column_stack([c * y[:, 4] - s * y[:, 5], s * y[:, 4] + c * y[:, 5], y[:, 6]])

    state = np.array([0.0, *start[:3], *rotate_in_plane(-start[2], *start[3:5]), start[5]])
    length, speed = scales.length, scales.speed
    sizes = np.array([scales.time, length, length, length / flat.gyration, speed, speed, speed / flat.gyration])

    def ahead(y: Array) -> float:
        return _turning_ahead(flat, velocities(y[None])[0], times[-1] - y[0])

    steps = integrate_until_rest(derivative, clock, stage, state, times, sizes, LONGEST_PLAIN_TIME_STEP, ahead)
    rows, panels, last = _rows(steps.samples, velocities), _panels(steps, velocities), steps.ends[-1]
    if len(rows) == len(times):
        return Motion(rows, None, panels)
    f1, f2, torque = flat.law(*last[4:].tolist())
    acceleration = np.array([*rotate_in_plane(float(last[3]), f1 / flat.mass, f2 / flat.mass), torque / moment])
    return Motion(*complete_with_rest(rows, times, last[:4], velocities(last[None])[0], acceleration, scales.metric), panels)


def _refuse_stiff(flat: Flat, start: Array, duration: float) -> None:
    """Raise `OutOfReach` for a motion that is too stiff; duration: in units of the time in which a straight slide stops."""
    lasting = -math.log(max(1 - duration, LOG_TIME_STOP_FRACTION))
    v1, v2 = rotate_in_plane(-float(start[2]), float(start[3]), float(start[4]))
    budget.refuse_stiff(flat.law, flat.mass, flat.gyration, flat.deceleration, v1, v2, lasting)


def _turning_ahead(flat: Flat, velocity: Array, duration: float) -> float:
    """An estimate of the angle (rad) through which a body turns in a duration (s); velocity: (3,) rates of x, y and psi."""
    vx, vy, spin = velocity.tolist()
    return budget.turning_ahead(
        flat.law, flat.mass, flat.gyration, flat.deceleration, math.hypot(vx, vy), spin, float(duration)
    )


def _stage(fraction: float, stop_fraction: float) -> Stage:
    """The stage of a motion at a fraction of its initial speed; it is integrated down to `stop_fraction`."""
    if fraction > NEAR_REST_FRACTION:
        return Stage.MOVING
    return Stage.NEAR_REST if fraction > stop_fraction else Stage.AT_REST


def _rows(states: Array, velocities: Callable[[Array], Array]) -> Array:
    """The rows (n, 6) of a motion from its states (n, m), whose first components are t, x, y and psi."""
    return np.concatenate([states[:, 1:4], velocities(states)], axis=1)


def _panels(steps: Steps, velocities: Callable[[Array], Array]) -> Panels:
    """The panels of a motion, from the steps of its integration."""
    nodes = _rows(steps.nodes.reshape(-1, steps.ends.shape[1]), velocities)
    shape = *steps.nodes.shape[:2], 6
    return Panels(steps.ends[:, 0], _rows(steps.ends, velocities), steps.nodes[:, :, 0], nodes.reshape(shape))


def complete_with_rest(
    rows: Array, times: Array, at: Array, velocity: Array, acceleration: Array, metric: Array
) -> tuple[Array, Array | None]:
    """Complete a motion by its stop and the rest after it.

    From the last integrated state the body slows down evenly along the direction of its motion until it stops.

    Parameters
    ----------
    rows
        (k, 6) rows of the motion at the first k times.
    times
        (n,) all times (s).
    at
        (4,) t, x, y, psi of the last integrated state.
    velocity, acceleration
        (3,) rates of x, y, psi and of these rates at that state, world frame.
    metric
        (3,) weights 1, 1 and the radius of gyration (m), which make velocity and acceleration comparable.

    Returns
    -------
    tuple
        (n, 6) rows, and the stop (4,) or None if it is after the last time.
    """
    speed = velocity * metric
    remaining = -float(speed @ speed) / float(speed @ (acceleration * metric))
    stop = at + remaining * np.array([1, *(velocity / 2)])
    resting = np.tile([*stop[1:], 0.0, 0.0, 0.0], (len(times) - len(rows), 1))
    return np.concatenate([rows, resting]), stop if times[-1] >= stop[0] else None
