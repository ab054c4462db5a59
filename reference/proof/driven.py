"""The motion of a joint without gravity and dry friction that a controller drives, in balls.

A continuous law without limits is linear: constants, lines and the law itself are in the exponential of a matrix, and a sine is
answered by the particular solution with its frequency. A sampled law is a map from one period to the next, with the effort held
within; its saturation is continuous in the state, so that nothing is decided by it.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import acb, acb_mat, arb, arb_mat

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


def coordinate(plant: Plant, controller: Controller) -> Coordinate:
    """Return the coordinate of a driven joint. Raises `NotEnclosed` for a continuous law with a limit."""
    if controller.rate is not None:
        return _sampled(plant, controller)
    if controller.effort_limit is not None:
        raise NotEnclosed("a continuous law with a limit")
    return _continuous(plant, controller)


def _gains(controller: Controller) -> tuple[Fraction, Fraction, Fraction]:
    if controller.law == "effort":
        return Fraction(0), Fraction(0), Fraction(0)
    return Fraction(controller.kp), Fraction(controller.kd), Fraction(controller.ki)


def _sampled(plant: Plant, controller: Controller) -> Coordinate:
    """The motion under a sampled law. The states at its instants are computed as far as they are asked for."""
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
    kp, kd, ki = _gains(controller)
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
            value, slope, since = _line(signal, t)
            return ball(value + slope * (t - since))
        case _:
            return ball(signal)


def _line(signal: Samples, t: Fraction) -> tuple[Fraction, Fraction, Fraction]:
    """The line of a table at a time: its value at an earlier time, its slope, and that time."""
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


@dataclass(frozen=True, eq=False)
class _Piece:
    """A piece of time in which signals are constants, lines and sines: its begin, and the state q, v and integral there."""

    begin: Fraction
    state: tuple[Ball, Ball, Ball]


def _continuous(plant: Plant, controller: Controller) -> Coordinate:
    """The motion under a continuous law without limits, piece by piece between the times of tables."""
    breaks = sorted({*_breaks(controller)})
    pieces = [_Piece(Fraction(0), (ball(plant.start), ball(plant.velocity), arb(0)))]

    def at(t: Fraction) -> tuple[Ball, Ball]:
        while len(pieces) <= len(breaks) and breaks[len(pieces) - 1] < t:
            end = breaks[len(pieces) - 1]
            pieces.append(_Piece(end, _driven(plant, controller, pieces[-1], end)))
        piece = next(each for each in reversed(pieces) if each.begin <= t)
        q, v, _ = _driven(plant, controller, piece, t)
        return q, v

    return at


def _breaks(controller: Controller) -> Iterator[Fraction]:
    for signal in (controller.target, controller.target_velocity, controller.effort):
        if isinstance(signal, Samples):
            yield from (Fraction(time) for time in signal.times if time > 0)


def _driven(plant: Plant, controller: Controller, piece: _Piece, t: Fraction) -> tuple[Ball, Ball, Ball]:
    """The coordinate, its velocity and the integral of the error at a time within a piece."""
    kp, kd, ki = _gains(controller)
    one, since = 1 / ball(plant.inertia), ball(t - piece.begin)
    system = [
        [arb(0), arb(1), arb(0)],
        [-ball(plant.stiffness + kp) * one, -ball(plant.damping + kd) * one, ball(ki) * one],
        [arb(-1), arb(0), arb(0)],
    ]
    constant, slope = [arb(0)] * 3, [arb(0)] * 3
    constant[1] = (as_ball(plant.force) + ball(plant.stiffness * plant.rest)) * one
    state, answers = list(piece.state), [arb(0)] * 3
    for signal, push, into in (
        (controller.target, ball(kp) * one, arb(1)),
        (controller.target_velocity, ball(kd) * one, arb(0)),
        (controller.effort, one, arb(0)),
    ):
        if isinstance(signal, Sine):
            constant[1], constant[2] = constant[1] + push * ball(signal.offset), constant[2] + into * ball(signal.offset)
            before, after = (_answer(system, (push, into), signal, time) for time in (piece.begin, t))
            state = [value - part for value, part in zip(state, before, strict=True)]
            answers = [value + part for value, part in zip(answers, after, strict=True)]
            continue
        value, rise, at = _line(signal, piece.begin) if isinstance(signal, Samples) else (Fraction(signal), Fraction(0), t)
        begin = ball(value + rise * (piece.begin - at)) if rise else ball(value)
        constant[1], constant[2] = constant[1] + push * begin, constant[2] + into * begin
        slope[1], slope[2] = slope[1] + push * ball(rise), slope[2] + into * ball(rise)
    rows = [entry * since for row, c, s in zip(system, constant, slope, strict=True) for entry in (*row, c, s)]
    zero = arb(0)
    flow = arb_mat(5, 5, [*rows, *[zero] * 5, *[zero] * 3, since, zero]).exp()  # the last state is the time
    full = [*state, arb(1), zero]
    q, v, integral = (sum((flow[i, j] * full[j] for j in range(5)), answers[i]) for i in range(3))
    return q, v, integral


def _answer(system: list[list[Ball]], pushes: tuple[Ball, Ball], signal: Sine, t: Fraction) -> list[Ball]:
    """The particular solution with the frequency of a sine, at a time, without the offset of the sine."""
    rate = acb(0, 1) * acb(ball(signal.angular_frequency))
    left = acb_mat([[(rate if i == j else acb(0)) - acb(system[i][j]) for j in range(3)] for i in range(3)])
    right = acb_mat([[acb(0)], [acb(pushes[0])], [acb(pushes[1])]])
    try:
        solution = left.solve(right)
    except ZeroDivisionError:
        raise NotEnclosed("a sine with the frequency of the joint itself") from None
    angle = ball(Fraction(signal.angular_frequency) * t + Fraction(signal.phase))
    turning = acb(angle.cos(), angle.sin()) * acb(ball(signal.amplitude))
    return [(solution[i, 0] * turning).imag for i in range(3)]
