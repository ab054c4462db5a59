"""Signals of controllers in arithmetic of many digits: at the instants of a sampled law, and as parts of a linear system.

Between two breaks a signal y is a solution of y'' = omega^2 (offset - y) with a constant omega, which is zero for constants and
for lines.
"""

from bisect import bisect_right
from collections.abc import Iterator
from itertools import repeat
from typing import Any

from bodycheck.reference.exact.numbers import Real
from bodycheck.reference.mechanisms.control import SLACK, Samples, Signal, Sine


def constant(signal: Signal) -> float | None:
    """The value of a signal that never changes; None if it may change."""
    match signal:
        case Sine(amplitude, angular_frequency, phase, offset):
            return offset if not amplitude or (not angular_frequency and not phase) else None
        case Samples(_, values, _):
            return values[0] if len(set(values)) == 1 else None
        case _:
            return float(signal)


def frequency(signal: Signal) -> float:
    """The angular frequency of a signal (rad/s); zero unless it is a sine."""
    return signal.angular_frequency if isinstance(signal, Sine) else 0.0


def breaks(signal: Signal) -> tuple[float, ...]:
    """The times > 0 at which a signal or its derivative may jump (s)."""
    return tuple(time for time in signal.times if time > 0) if isinstance(signal, Samples) else ()


def begun(mp: Any, signal: Signal, time: float) -> tuple[Real, Real]:
    """The value of a signal and its derivative just after a time (s), which is 0 or one of its breaks."""
    match signal:
        case Sine(amplitude, angular_frequency, phase, offset):
            size, rate = mp.mpf(amplitude), mp.mpf(angular_frequency)
            angle = rate * mp.mpf(time) + mp.mpf(phase)
            return mp.mpf(offset) + size * mp.sin(angle), size * rate * mp.cos(angle)
        case Samples(times, _, _):
            value, slope, since = _piece(mp, signal, bisect_right(times, time) - 1)
            return value + slope * (mp.mpf(time) - since), slope
        case _:
            return mp.mpf(signal), mp.zero


def at_instants(mp: Any, signal: Signal, rate: float) -> Iterator[Real]:
    """Yield the values of a signal at the instants k / rate, k = 0, 1, ...; whether one is past a break is decided exactly.

    A break of held values that is later by at most `SLACK` of a period counts as passed.
    """
    match signal:
        case Sine():
            yield from _sine_at_instants(mp, signal, rate)
        case Samples(times, _, _):
            index, instant = -1, 0
            slack = mp.mpf(SLACK.numerator) / SLACK.denominator if signal.between == "hold" else 0
            scaled = [mp.mpf(time) * mp.mpf(rate) - slack for time in times]
            value, slope, since = _piece(mp, signal, index)
            while True:
                while index + 1 < len(times) and scaled[index + 1] <= instant:
                    index += 1
                    value, slope, since = _piece(mp, signal, index)
                yield value + slope * (instant / mp.mpf(rate) - since) if slope else value
                instant += 1
        case _:
            yield from repeat(mp.mpf(signal))


def _sine_at_instants(mp: Any, signal: Sine, rate: float) -> Iterator[Real]:
    """Yield the values of a sine by turns through a constant angle."""
    size, turn = mp.mpf(signal.amplitude), mp.mpf(signal.angular_frequency) / mp.mpf(rate)
    across, along = mp.sin(turn), mp.cos(turn)
    sine, cosine = size * mp.sin(mp.mpf(signal.phase)), size * mp.cos(mp.mpf(signal.phase))
    offset = mp.mpf(signal.offset)
    while True:
        yield offset + sine
        sine, cosine = sine * along + cosine * across, cosine * along - sine * across


def _piece(mp: Any, signal: Samples, index: int) -> tuple[Real, Real, Real]:
    """The value at the start of the piece after the time of an index, its slope, and its start (s)."""
    times, values = signal.times, signal.values
    if index < 0:
        return mp.mpf(values[0]), mp.zero, mp.zero
    value, since = mp.mpf(values[index]), mp.mpf(times[index])
    if signal.between == "hold" or index + 1 == len(times):
        return value, mp.zero, since
    return value, (mp.mpf(values[index + 1]) - value) / (mp.mpf(times[index + 1]) - since), since
