"""Signals of controllers in the Lagrangian's arithmetic of a hundred digits, and controllers that compute at instants.

Times are fractions, so that an instant k / rate is neither early nor late. A table changes exactly at its times, but held
values change at an instant that is earlier by at most `SLACK` of a period.
"""

import bisect
from dataclasses import dataclass, field
from fractions import Fraction

from bodycheck.reference.independent.border import MP, Number
from bodycheck.reference.mechanisms.control import SLACK, Controller, Samples, Signal, Sine


def exact(value: Fraction) -> Number:
    """A fraction with a hundred digits."""
    return MP.mpf(value.numerator) / value.denominator


@dataclass(frozen=True)
class Piece:
    """A piece of a table: the value at the time `since` (s), its slope (per s), and the time until which this is so."""

    value: Number
    slope: Number
    since: Fraction
    until: Fraction | None


def piece(table: Samples, time: Fraction) -> Piece:
    """The piece of a table that begins at or before a time (s) and contains the times just after it."""
    after = bisect.bisect_right(table.times, time)
    if after == 0:
        return Piece(MP.mpf(table.values[0]), MP.zero, Fraction(0), Fraction(table.times[0]))
    since, value = Fraction(table.times[after - 1]), MP.mpf(table.values[after - 1])
    if after == len(table.times):
        return Piece(value, MP.zero, since, None)
    until, slope = Fraction(table.times[after]), MP.zero
    if table.between == "linear":
        slope = (MP.mpf(table.values[after]) - value) / exact(until - since)
    return Piece(value, slope, since, until)


def value_at(signal: Signal, time: Fraction, rate: Fraction) -> Number:
    """The value of a signal at a time (s), which is an instant of a controller with a rate (Hz)."""
    match signal:
        case Sine():
            phase = MP.mpf(signal.angular_frequency) * exact(time) + MP.mpf(signal.phase)
            return MP.mpf(signal.offset) + MP.mpf(signal.amplitude) * MP.sin(phase)
        case Samples():
            part = piece(signal, time if signal.between == "linear" else time + SLACK / rate)
            return part.value + part.slope * exact(time - part.since)
    return MP.mpf(signal)


@dataclass
class Sampler:
    """A controller that computes at instants: the number of the next one, the errors so far, and the results not yet applied.

    element: the index of the element that it drives.
    """

    element: int
    controller: Controller
    number: int = 0
    errors: Number = MP.zero
    waiting: list[Number] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.waiting = [MP.zero] * self.controller.delay

    @property
    def next(self) -> Fraction:
        """The next instant (s)."""
        assert self.controller.rate is not None
        return self.number / Fraction(self.controller.rate)

    def effort(self, q: Number, v: Number) -> Number:
        """The effort (N m or N) from the next instant on, which is passed. q, v: coordinate and velocity at this instant."""
        time = self.next
        self.number += 1
        self.waiting.append(self._computed(time, q, v))
        return self.waiting.pop(0)

    def _computed(self, time: Fraction, q: Number, v: Number) -> Number:
        law = self.controller
        assert law.rate is not None
        rate = Fraction(law.rate)
        total = value_at(law.effort, time, rate)
        if law.law == "pd":
            error = value_at(law.target, time, rate) - q
            self.errors += error
            total += MP.mpf(law.kp) * error + MP.mpf(law.kd) * (value_at(law.target_velocity, time, rate) - v)
            if law.ki:
                total += MP.mpf(law.ki) * self.errors / MP.mpf(law.rate)
        if law.effort_limit is None:
            return total
        limit = MP.mpf(law.effort_limit)
        along = limit
        if law.no_load_speed is not None:
            along = max(MP.zero, limit * (1 - abs(v) / MP.mpf(law.no_load_speed)))
        most, least = (along, -limit) if v > 0 else (limit, -along) if v < 0 else (limit, -limit)
        return min(max(total, least), most)
