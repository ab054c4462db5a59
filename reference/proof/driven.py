"""The motion of a joint without gravity and dry friction that a controller with a sampled law drives, in balls.

A sampled law is a map from one period to the next, with the effort held within; its saturation is continuous in the state, so
that nothing is decided by it.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import arb, arb_mat

from bodycheck.reference.mechanisms.control import SLACK, Controller, Samples, Signal, Sine
from bodycheck.reference.proof.balls import Ball, ball
from bodycheck.reference.proof.bodies import as_ball
from bodycheck.reference.proof.enclosure import NotEnclosed

#: A function from a time (s) to the coordinate and its velocity.
Coordinate = Callable[[Fraction], tuple[Ball, Ball]]

#: The largest number of instants of a sampled law.
MOST_PERIODS = 100_000


@dataclass(frozen=True, eq=False)
class Plant:
    """A joint with the equation J q'' = force - damping q' - stiffness (q - rest) + the effort of a controller."""

    inertia: Fraction
    force: Any
    damping: Fraction
    stiffness: Fraction
    rest: Fraction
    start: Fraction
    velocity: Fraction


def gains(controller: Controller) -> tuple[Fraction, Fraction, Fraction]:
    """Return the gains of a law."""
    if controller.law == "effort":
        return Fraction(0), Fraction(0), Fraction(0)
    return Fraction(controller.kp), Fraction(controller.kd), Fraction(controller.ki)


def sampled(plant: Plant, controller: Controller) -> Coordinate:
    """Return the motion under a sampled law. The states at its instants are computed as far as they are asked for."""
    assert controller.rate is not None
    rate = Fraction(controller.rate)
    states = [(ball(plant.start), ball(plant.velocity))]
    efforts: list[Ball] = []
    errors = [arb(0)]  # the sum of all errors so far
    whole = _flow(plant, ball(1 / rate))

    def acting(period: int) -> Ball:
        return efforts[period - controller.delay] if period >= controller.delay else arb(0)

    def compute() -> None:
        """The effort that is computed at the last known instant."""
        number = len(efforts)
        q, v = states[number]
        law, errors[0] = _law(controller, Fraction(number) / rate, q, v, errors[0], rate)
        efforts.append(law)

    def at(t: Fraction) -> tuple[Ball, Ball]:
        period = int(t * rate)
        if period > MOST_PERIODS:
            raise NotEnclosed("too many instants of a sampled law")
        while len(efforts) <= period:
            compute()
            states.append(_after(plant, whole, *states[-1], acting(len(efforts) - 1)))
        return _after(plant, _flow(plant, ball(t - period / rate)), *states[period], acting(period))

    return at


def _law(controller: Controller, t: Fraction, q: Ball, v: Ball, summed: Ball, rate: Fraction) -> tuple[Ball, Ball]:
    """The effort of a sampled law at an instant, after saturation, and the new sum of its errors."""
    kp, kd, ki = gains(controller)
    signals = (controller.target, controller.target_velocity, controller.effort)
    target, speed, effort = (_value(signal, t, SLACK / rate) for signal in signals)
    summed = summed + target - q
    law = ball(kp) * (target - q) + ball(kd) * (speed - v) + ball(ki / rate) * summed + effort
    if controller.effort_limit is None:
        return law, summed
    most = ball(controller.effort_limit)
    forwards = backwards = most
    if controller.no_load_speed is not None:
        share = v / ball(controller.no_load_speed)
        forwards, backwards = (most * (1 - side.max(arb(0))).max(arb(0)) for side in (share, -share))
    return law.min(forwards).max(-backwards), summed


def _value(signal: Signal, t: Fraction, slack: Fraction) -> Ball:
    """The value of a signal at a time; a held value counts from a slack before its time."""
    match signal:
        case Sine(amplitude, angular_frequency, phase, offset):
            angle = ball(Fraction(angular_frequency) * t + Fraction(phase))
            return ball(offset) + ball(amplitude) * angle.sin()
        case Samples(times, values, "hold"):
            exact = [Fraction(time) - slack for time in times]
            return ball(values[max(bisect_right(exact, t) - 1, 0)])
        case Samples():
            value, slope, since = line(signal, t)
            return ball(value + slope * (t - since))
        case _:
            return ball(signal)


def line(signal: Samples, t: Fraction) -> tuple[Fraction, Fraction, Fraction]:
    """Return the line of a table at a time: its value at an earlier time, its slope, and that time."""
    times, values = [list(map(Fraction, part)) for part in (signal.times, signal.values)]
    index = bisect_right(times, t) - 1
    if signal.between == "hold" or index < 0 or index + 1 == len(times):
        return values[max(index, 0)], Fraction(0), times[max(index, 0)]
    return values[index], (values[index + 1] - values[index]) / (times[index + 1] - times[index]), times[index]


def _flow(plant: Plant, t: Ball) -> Any:
    """The matrix by which coordinate, velocity and acceleration of a constant force are changed in a time."""
    spring, damper = ball(plant.stiffness / plant.inertia), ball(plant.damping / plant.inertia)
    return arb_mat(3, 3, [arb(0), t, arb(0), -spring * t, -damper * t, t, arb(0), arb(0), arb(0)]).exp()


def _after(plant: Plant, flow: Any, q: Ball, v: Ball, effort: Ball) -> tuple[Ball, Ball]:
    push = (as_ball(plant.force) + ball(plant.stiffness * plant.rest) + effort) / ball(plant.inertia)
    return tuple(flow[i, 0] * q + flow[i, 1] * v + flow[i, 2] * push for i in (0, 1))


def breaks(controller: Controller) -> Iterator[Fraction]:
    """Yield the times of tables of signals (s)."""
    for signal in (controller.target, controller.target_velocity, controller.effort):
        if isinstance(signal, Samples):
            yield from (Fraction(time) for time in signal.times if time > 0)
