"""Power series of forces and motions in a step, and where they change their sign."""

import bisect
import itertools
from collections.abc import Sequence

from bodycheck.reference.independent.arithmetic import Real
from bodycheck.reference.independent.border import MP
from bodycheck.reference.mechanisms.control import Samples, Signal, Sine

#: The number of terms of a series after the first.
TERMS = 30

#: The number of equal parts of a step in which a change of sign is looked for, and the halvings that begin to locate it.
PARTS, HALVINGS = 16, 50

#: The steps of Newton's method that follow: each doubles the digits.
NEWTON_STEPS = 5

#: The size of a value of a series, relative to its terms, from which on double precision tells its sign.
CERTAIN = 1e-8

#: The size of a term of a series, relative to the largest, that is rounding.
ROUNDED = MP.mpf(10) ** -70

#: A power series of the time since the start of a step.
Series = list[Real]


def falls(series: Series, step: Real) -> Real | None:
    """The time within a step (s) at which a series becomes negative, after it has been positive; None if it does not."""
    if _stays(series, step):
        return None
    zero = ROUNDED * max(abs(term) * step**order for order, term in enumerate(series))
    rate = rate_of(series)
    edges = [step * number / PARTS for number in range(PARTS + 1)]
    for low, high in itertools.pairwise(edges):
        lowest = _crossed(rate, low, high, rising=True) if value(rate, low) < 0 < value(rate, high) else high
        if value(series, lowest) < -zero:
            highest = low if value(series, low) > zero else _crossed(rate, low, lowest, rising=False)
            return _crossed(series, highest, lowest, rising=False)
        if value(series, high) < -zero:
            return _crossed(series, lowest, high, rising=False)
    return None


def _stays(series: Series, step: Real) -> bool:
    """Return whether a series is certainly positive within a step (s), by its first terms in double precision."""
    terms = [abs(float(term * step**order)) for order, term in enumerate(series)]
    return float(series[0]) > (1 + CERTAIN) * sum(terms[1:]) + CERTAIN * terms[0]


def _crossed(series: Series, low: Real, high: Real, *, rising: bool) -> Real:
    """The place between two others at which a series changes its sign, from negative on if it rises."""
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if (value(series, middle) < 0) == rising else (low, middle)
    rate, root = rate_of(series), high
    for _ in range(NEWTON_STEPS):
        steep = value(rate, root)
        root -= value(series, root) / steep if steep else MP.mpf(0)
    return root if low <= root <= high else high


def series_of(signal: Signal, time: Real) -> Series:
    """The power series of a signal about a time (s), for later times."""
    match signal:
        case Sine():
            a, w, p = MP.mpf(signal.amplitude), MP.mpf(signal.angular_frequency), MP.mpf(signal.phase)
            sine, cosine = a * MP.sin(w * time + p), a * MP.cos(w * time + p)
            terms, factor = [], MP.mpf(1)
            for order in range(TERMS + 1):
                terms.append(factor * (sine, cosine, -sine, -cosine)[order % 4])
                factor = factor * w / (order + 1)
            terms[0] += MP.mpf(signal.offset)
            return terms
        case Samples():
            index = bisect.bisect_right(signal.times, time) - 1
            here = MP.mpf(signal.values[max(index, 0)])
            if index < 0 or signal.between == "hold" or index + 1 == len(signal.times):
                return constant(here)
            begin, end = (MP.mpf(each) for each in signal.times[index : index + 2])
            slope = (MP.mpf(signal.values[index + 1]) - here) / (end - begin)
            return [here + slope * (time - begin), slope, *[MP.mpf(0)] * (TERMS - 1)]
        case _:
            return constant(signal)


def constant(number: Real) -> Series:
    """The series of a constant."""
    return [MP.mpf(number), *[MP.mpf(0)] * TERMS]


def times(series: Series, factor: Real) -> Series:
    """A series times a number."""
    return [factor * term for term in series]


def plus(one: Series, other: Series) -> Series:
    """The sum of two series."""
    return [a + b for a, b in zip(one, other, strict=True)]


def integral(series: Series, start: Real) -> Series:
    """The integral of a series, which begins at a number."""
    return [start, *(term / (order + 1) for order, term in enumerate(series[:-1]))]


def rate_of(series: Series) -> Series:
    """The derivative of a series."""
    return [*(order * term for order, term in enumerate(series) if order), MP.mpf(0)]


def value(series: Series, time: Real) -> Real:
    """The value of a series at a time (s)."""
    total = MP.mpf(0)
    for term in reversed(series):
        total = total * time + term
    return total


def breaks(edges: Sequence[Real], time: Real) -> list[Real]:
    """The time (s) from a time until the next of some ascending ones; empty if there is none."""
    return [edge - time for edge in edges[bisect.bisect_right(edges, time) :][:1]]
