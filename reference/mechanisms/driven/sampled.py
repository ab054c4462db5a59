"""The law of a controller at its instants k / rate, k = 0, 1, ..."""

from collections import deque
from collections.abc import Callable
from typing import Any

from bodycheck.reference.exact.numbers import Real
from bodycheck.reference.mechanisms.control import Controller
from bodycheck.reference.mechanisms.driven import signals

#: The function from the coordinate and the velocity at the next instant to the effort that acts from this instant on.
Sampler = Callable[[Real, Real], Real]


def sampler(mp: Any, controller: Controller) -> Sampler:
    """The law of a controller with a rate, to be called at each of its instants in turn."""
    assert controller.rate is not None
    kp, kd, ki = mp.mpf(controller.kp), mp.mpf(controller.kd), mp.mpf(controller.ki) / mp.mpf(controller.rate)
    targets, target_velocities, efforts = (
        signals.at_instants(mp, signal, controller.rate)
        for signal in (controller.target, controller.target_velocity, controller.effort)
    )
    waiting = deque([mp.zero] * controller.delay)
    errors = mp.zero

    def act(q: Real, v: Real) -> Real:
        nonlocal errors
        error, rate_error, effort = next(targets) - q, next(target_velocities) - v, next(efforts)
        if kp:
            effort += kp * error
        if kd:
            effort += kd * rate_error
        if ki:
            errors += error
            effort += ki * errors
        waiting.append(saturated(mp, controller, effort, v))
        return waiting.popleft()

    return act


def saturated(mp: Any, controller: Controller, effort: Real, velocity: Real) -> Real:
    """The effort after saturation at a velocity."""
    if controller.effort_limit is None:
        return effort
    most = mp.mpf(controller.effort_limit)
    if controller.no_load_speed is not None and velocity and (effort > 0) == (velocity > 0):
        most *= max(mp.zero, 1 - abs(velocity) / mp.mpf(controller.no_load_speed))
    return max(-most, min(most, effort))


def reads_velocity(controller: Controller) -> bool:
    """Return whether the effort depends on the velocity at the instants."""
    return bool(controller.kd) or controller.no_load_speed is not None
