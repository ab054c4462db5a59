"""Functions of time with a hundred digits: polynomials plus sines, and the first instant at which one becomes negative."""

import bisect
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.numbers import MP, NEGLIGIBLE, Real, wide
from bodycheck.reference.mechanisms.control import Samples, Signal, Sine
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import WideArray

#: The length of an interval, relative to the whole, in which a function does not change its sign for longer.
SHORTEST = MP.mpf(10) ** -40

#: The largest number of steps that locate a root, each of Newton's method or a halving.
MOST_HALVINGS = 400

#: The largest number of intervals that are searched, which takes some ten seconds.
MOST_INTERVALS = 100_000


@dataclass(frozen=True, eq=False)
class Wave:
    """A function of time: the sum of powers of the time with coefficients, and of amplitude sin(frequency t + phase).

    Attributes
    ----------
    powers
        The coefficients of the powers, from the constant on.
    sines
        The amplitude, the angular frequency (rad/s) and the phase (rad) of each sine.
    """

    powers: tuple[Real, ...] = ()
    sines: tuple[tuple[Real, Real, Real], ...] = ()

    def at(self, time: Real) -> Real:
        """Return the value at a time (s)."""
        total = MP.zero
        for coefficient in reversed(self.powers):
            total = total * time + coefficient
        return total + sum((a * MP.sin(w * time + p) for a, w, p in self.sines), MP.zero)

    def from_time(self, start: Real) -> "Wave":
        """Return the function of the time since a start (s)."""
        powers = list(self.powers)
        for first in range(len(powers) - 1):
            for index in reversed(range(first, len(powers) - 1)):
                powers[index] += start * powers[index + 1]
        return Wave(tuple(powers), tuple((a, w, p + w * start) for a, w, p in self.sines))

    def times(self, factor: Real) -> "Wave":
        """Return the function times a number."""
        return Wave(tuple(factor * power for power in self.powers), tuple((factor * a, w, p) for a, w, p in self.sines))

    def plus(self, other: "Wave") -> "Wave":
        """Return the sum of two functions."""
        longer, shorter = sorted((self.powers, other.powers), key=len, reverse=True)
        powers = tuple(power + (shorter[index] if index < len(shorter) else 0) for index, power in enumerate(longer))
        sines: dict[tuple[Real, Real], Real] = {}
        for a, w, p in (*self.sines, *other.sines):
            sines[w, p] = sines.get((w, p), MP.zero) + a
        return Wave(powers, tuple((a, w, p) for (w, p), a in sines.items() if a))

    def rate(self) -> "Wave":
        """Return the derivative."""
        powers = tuple(order * power for order, power in enumerate(self.powers))[1:]
        return Wave(powers, tuple((a * w, w, p + MP.pi / 2) for a, w, p in self.sines))

    def summed(self, start: Real) -> "Wave":
        """Return the integral whose value at t = 0 is given."""
        powers = (MP.zero, *(power / (order + 1) for order, power in enumerate(self.powers)))
        integral = Wave(powers, tuple((a / w, w, p - MP.pi / 2) for a, w, p in self.sines))
        return integral.plus(Wave((start - integral.at(MP.zero),)))

    def size(self, until: Real) -> Real:
        """Return a bound of the absolute value from 0 until a time (s)."""
        powers = sum((abs(power) * until**order for order, power in enumerate(self.powers)), MP.zero)
        return powers + sum((abs(a) for a, _, _ in self.sines), MP.zero)


#: A function of time in pieces: the instant (s) from which on each counts, in ascending order from 0, and the function of t.
Pieces = tuple[tuple[Real, Wave], ...]


def constant(value: Real) -> Wave:
    """Return a function that is constant."""
    return Wave((value,))


def pieces_of(signal: Signal) -> Pieces:
    """Return the pieces of a signal."""
    match signal:
        case Sine():
            a, w, p, offset = map(MP.mpf, (signal.amplitude, signal.angular_frequency, signal.phase, signal.offset))
            if not (a and w):
                return ((MP.zero, constant(offset + a * MP.sin(p))),)
            return ((MP.zero, Wave((offset,), ((a, w, p),))),)
        case Samples():
            return _of_samples(signal)
        case _:
            return ((MP.zero, constant(MP.mpf(signal))),)


def _of_samples(signal: Samples) -> Pieces:
    times, values = ([MP.mpf(each) for each in row] for row in (signal.times, signal.values))
    pieces = [(MP.zero, constant(values[0]))]
    for index, (time, value) in enumerate(zip(times, values, strict=True)):
        function = constant(value)
        if signal.between == "linear" and index + 1 < len(times):
            slope = (values[index + 1] - value) / (times[index + 1] - time)
            function = Wave((value - slope * time, slope))
        pieces.append((time, function))
    started = [piece for piece in pieces if piece[0] <= 0][-1]
    return ((MP.zero, started[1]), *(piece for piece in pieces if piece[0] > 0))


def added(one: Pieces, other: Pieces, factor: Real) -> Pieces:
    """Return the pieces of one function plus a factor times another."""
    starts = sorted({start for start, _ in (*one, *other)})
    return tuple((start, piece_at(one, start).plus(piece_at(other, start).times(factor))) for start in starts)


def piece_at(pieces: Pieces, time: Real) -> Wave:
    """Return the piece that counts from a time (s) on."""
    return pieces[bisect.bisect_right(pieces, time, key=lambda piece: piece[0]) - 1][1]


def first_negative(function: Wave, until: Real) -> Real | None:
    """Return the time, from 0 until another (s), from which on a function is negative, if it is not before; None if none is.

    The function is enclosed in intervals by its value and slope in the middle and a bound of its second derivative. One that
    touches zero does not become negative.
    """
    if function.at(MP.zero) < -NEGLIGIBLE * function.size(until):
        return MP.zero
    slope = function.rate()
    bend, zero = slope.rate().size(until), NEGLIGIBLE * function.size(until)
    waiting = [(MP.zero, until)]
    for _ in range(MOST_INTERVALS):
        if not waiting:
            return None
        low, high = waiting.pop()
        half = (high - low) / 2
        middle = low + half
        value, steep = function.at(middle), abs(slope.at(middle))
        if value >= steep * half + bend * half * half / 2 - zero:
            continue
        if steep > bend * half:
            if function.at(high) < -zero:
                return _changed(function, low, high)
        elif half > SHORTEST * until:
            waiting += [(middle, high), (low, middle)]
    raise OutOfReach(f"a force that changes its sign within one of more than {MOST_INTERVALS} intervals")


def _changed(function: Wave, low: Real, high: Real) -> Real:
    """Return the place between two others from which on a function, which falls monotonically there, is negative."""
    slope, root = function.rate(), low
    for _ in range(MOST_HALVINGS):
        value, steep = function.at(root), slope.at(root)
        low, high = (low, root) if value < 0 else (root, high)
        newton = root - value / steep if steep < 0 else low
        inside = low < newton < high
        moved = newton if inside else (low + high) / 2
        if abs(moved - root) <= NEGLIGIBLE * high:
            break
        root = moved
    return moved


def breaks(functions: Sequence[Pieces], until: Real) -> list[Real]:
    """Return the instants (s) before another at which a piece of any function begins, from 0 on."""
    return sorted({start for pieces in functions for start, _ in pieces if start < until})


def values(wave: Wave, times: WideArray) -> tuple[WideArray, Array]:
    """The values (n,) of a function at times (n,), and the sums (n,) of the sizes of its terms, each with its roundings."""
    values, sizes = np.zeros_like(times), np.zeros_like(times)
    for order, power in enumerate(wave.powers):
        term = wide(power) * times**order
        values, sizes = values + term, sizes + np.abs(term)
    for a, w, p in wave.sines:
        amplitude, angle = wide(a), wide(w) * times + wide(MP.fmod(p, 2 * MP.pi))
        values, sizes = values + amplitude * np.sin(angle), sizes + np.abs(amplitude) * (1 + np.abs(angle))
    return values, sizes.astype(float)
