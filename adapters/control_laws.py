"""The laws of controllers and elastic stops in doubles, for efforts that an engine is given.

The laws are those of `bodycheck.reference.mechanisms.control`. The functions are for one joint and one instant; scripts for
engines alone contain them.
"""

import math
from bisect import bisect_right
from fractions import Fraction

from bodycheck.reference.mechanisms.control import Controller, Samples, Signal, Sine, Stops


def value_of(signal: Signal, time: float | Fraction, slack: float | Fraction = 0) -> float:
    """Return the value of a signal at a time (s).

    slack: the time (s) by which a time of a table with held values may be later and counts as reached.
    """
    if isinstance(signal, Sine):
        return signal.offset + signal.amplitude * math.sin(signal.angular_frequency * float(time) + signal.phase)
    if not isinstance(signal, Samples):
        return signal
    times, values = signal.times, signal.values
    after = bisect_right(times, time + slack if signal.between == "hold" else time)
    if after == 0 or after == len(times) or signal.between == "hold":
        return values[max(after - 1, 0)]
    part = (float(time) - times[after - 1]) / (times[after] - times[after - 1])
    return values[after - 1] + part * (values[after] - values[after - 1])


def integral_of(signal: Signal, start: float, end: float) -> float:
    """Return the integral of a signal from a time (s) to a later one."""
    if isinstance(signal, Sine):
        rate, middle = signal.angular_frequency, (start + end) / 2
        half = rate * (end - start) / 2
        mean = math.sin(half) / half if half else 1.0
        return (end - start) * (signal.offset + signal.amplitude * mean * math.sin(rate * middle + signal.phase))
    if not isinstance(signal, Samples):
        return signal * (end - start)
    within = [time for time in signal.times[bisect_right(signal.times, start) :] if time < end]
    total, before = 0.0, start
    for after in (*within, end):  # between two times of the table the signal is linear, so that its mean is the value midway
        total += (after - before) * value_of(signal, (before + after) / 2)
        before = after
    return total


def effort_of(
    controller: Controller,
    time: float | Fraction,
    position: float,
    velocity: float,
    integral: float,
    slack: float | Fraction = 0,
) -> float:
    """Return the saturated effort of a controller (N m or N).

    Parameters
    ----------
    controller
        The controller.
    time, position, velocity
        The time (s), and the coordinate and the velocity of the joint.
    integral
        The integral of the error, or the sum of the errors divided by the rate.
    slack
        As for `value_of`.
    """
    effort = value_of(controller.effort, time, slack)
    if controller.law == "pd":
        effort += controller.kp * (value_of(controller.target, time, slack) - position)
        effort += controller.kd * (value_of(controller.target_velocity, time, slack) - velocity)
        effort += controller.ki * integral
    return saturated(controller, effort, velocity)


def saturated(controller: Controller, effort: float, velocity: float) -> float:
    """Return an effort (N m or N), cut to the limits of a controller at a velocity (rad/s or m/s)."""
    limit = controller.effort_limit
    if limit is None:
        return effort
    if controller.no_load_speed is None:
        return min(max(effort, -limit), limit)
    along = limit * max(0.0, 1 - abs(velocity) / controller.no_load_speed)
    upper = along if velocity > 0 else limit
    lower = -along if velocity < 0 else -limit
    return min(max(effort, lower), upper)


def push_of(stops: Stops, position: float, velocity: float) -> float:
    """Return the effort (N m or N) of elastic stops, which push back and never pull."""
    if stops.lower is not None and position < stops.lower:
        return max(0.0, stops.stiffness * (stops.lower - position) - stops.damping * velocity)
    if stops.upper is not None and position > stops.upper:
        return -max(0.0, stops.stiffness * (position - stops.upper) + stops.damping * velocity)
    return 0.0
