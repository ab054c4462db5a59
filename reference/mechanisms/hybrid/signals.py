"""The values of signals, in exact arithmetic, and the times at which equations with controllers begin anew."""

import bisect
import heapq
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import count, takewhile

from bodycheck.reference.exact.numbers import MP, Real, real
from bodycheck.reference.mechanisms.control import Controller, Samples, Signal, Sine


@dataclass(frozen=True)
class Piece:
    """A signal until its next break: constant + slope t + amplitude sin(angular_frequency t + phase)."""

    constant: Real
    slope: Real = 0
    amplitude: Real = 0
    angular_frequency: Real = 0
    phase: Real = 0

    def value(self, time: Real) -> Real:
        """The value at a time (s), exact to a hundred digits."""
        wave = self.amplitude * MP.sin(self.angular_frequency * time + self.phase) if self.amplitude else 0
        return self.constant + self.slope * time + wave

    def rate(self, time: Real) -> Real:
        """The derivative at a time (s)."""
        turning = self.amplitude * self.angular_frequency
        return self.slope + (turning * MP.cos(self.angular_frequency * time + self.phase) if turning else 0)


def piece(signal: Signal, time: Real) -> Piece:
    """Return the piece of a signal that begins at a time (s) or contains it."""
    if isinstance(signal, Sine):
        amplitude, frequency, phase, offset = (
            MP.mpf(value) for value in (signal.amplitude, signal.angular_frequency, signal.phase, signal.offset)
        )
        return Piece(offset, MP.mpf(0), amplitude, frequency, phase)
    if not isinstance(signal, Samples):
        return Piece(MP.mpf(signal))
    after = bisect.bisect_right(signal.times, time)
    if after in (0, len(signal.times)) or signal.between == "hold":
        return Piece(MP.mpf(signal.values[max(after - 1, 0)]))
    (begin, end), (first, last) = (
        [MP.mpf(value) for value in values[after - 1 : after + 1]] for values in (signal.times, signal.values)
    )
    slope = (last - first) / (end - begin)
    return Piece(first - slope * begin, slope)


def value(signal: Signal, time: Real) -> Real:
    """Return the value of a signal at a time (s)."""
    return signal if isinstance(signal, float | int) else piece(signal, time).value(time)


def signals(controller: Controller) -> tuple[Signal, Signal, Signal]:
    """Return the target, the target's velocity and the effort of a controller."""
    return controller.target, controller.target_velocity, controller.effort


def breaks(controllers: Sequence[Controller], end: Real, further: Sequence[Fraction] = ()) -> Iterator[Fraction]:
    """Yield the times before `end` (s), ascending, at which a controller computes its law or a piece of a signal ends.

    further: other times (s), ascending, which are yielded too.
    """
    streams: list[Iterator[Fraction]] = [iter(further)]
    for controller in controllers:
        if controller.rate is not None:
            streams.append(instants(controller.rate))
        else:
            tables = [signal.times for signal in signals(controller) if isinstance(signal, Samples)]
            streams += [(Fraction(time) for time in times if time > 0) for times in tables]
    last = Fraction(-1)
    for time in takewhile(lambda time: real(time) < end, heapq.merge(*streams)):
        if time > last:
            yield time
        last = time


def instants(rate: float) -> Iterator[Fraction]:
    """Yield the instants of a controller (s): k / rate for k = 0, 1, 2, ..., exactly."""
    exact = Fraction(rate)
    return (k / exact for k in count())
