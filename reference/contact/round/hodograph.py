"""A slip across the fall line of an inclined plane, in closed form.

The slip u of a round body obeys du/dt = g - c u/|u|, with g downhill along x. With the angle f of u from x, w = |u| and
dq = dt/w, the equations dw/dq = w (g cos f - c) and df/dq = -g sin f have the solution

    u_x = A exp(-(c - g) q) - B exp(-(c + g) q),    |u_y| = 2 sqrt(A B) exp(-c q),    w = A exp(-(c - g) q) + B exp(-(c + g) q)

where A = w cos^2(f/2) and B = w sin^2(f/2) at the start. Time and path are integrals of exponentials over q.
"""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.witness import WideArray

#: The largest number of steps of the search. A Newton step is at most half the step before it; any other step halves the
#: interval.
MAX_STEPS = 200

#: The largest exponent that counts: exp(-64) is less than a rounding of 1.
FARTHEST = Wide(64)


@dataclass(frozen=True, eq=False)
class Hodograph:
    """A slip across the fall line: see the docstring of the module.

    Attributes
    ----------
    downhill, slowing
        g and c (m/s^2).
    along, against
        A and B (m/s).
    across
        u_y at the start (m/s), not zero.
    """

    downhill: Wide
    slowing: Wide
    along: Wide
    against: Wide
    across: Wide

    @property
    def rates(self) -> tuple[Wide, Wide]:
        """c - g and c + g (m/s^2)."""
        return self.slowing - self.downhill, self.slowing + self.downhill

    @property
    def duration(self) -> Wide:
        """The time (s) after which the slip has ended; infinite if it does not end."""
        less, more = self.rates
        return self.along / less + self.against / more if less > 0 else Wide(np.inf)


def hodograph(downhill: Wide, slowing: Wide, sliding: WideArray) -> Hodograph:
    """The hodograph of a slip (3,) that begins across the fall line."""
    x, y = sliding[0], sliding[1]
    size = np.hypot(x, y)
    larger = (size + abs(x)) / 2
    smaller = y * (y / larger) / 4  # the difference of size and |x| would cancel
    along, against = (larger, smaller) if x > 0 else (smaller, larger)
    return Hodograph(downhill, slowing, along, against, y)


def elapsed(hodograph: Hodograph, q: WideArray) -> WideArray:
    """The times (n,) at which the parameter is q (n,), s^2/m."""
    less, more = hodograph.rates
    return np.asarray(hodograph.along * grown(less, q) + hodograph.against * grown(more, q))


def parameters(hodograph: Hodograph, times: WideArray) -> WideArray:
    """The parameters q (n,) at times (n,), s, from the start of the slip, by Newton's method within a shrinking interval."""
    less, more = hodograph.rates
    low = np.zeros_like(times)
    high = np.minimum(_reached(less, times / hodograph.along), _reached(more, times / hodograph.against))
    if less > 0:
        high = np.minimum(high, FARTHEST / less)
    q, last = low.copy(), high - low
    for _ in range(MAX_STEPS):
        missing = elapsed(hodograph, q) - times
        low, high = np.where(missing < 0, q, low), np.where(missing < 0, high, q)
        pace = hodograph.along * np.exp(-less * q) + hodograph.against * np.exp(-more * q)
        newton = q - missing / pace
        trusted = (newton >= low) & (newton <= high) & (np.abs(newton - q) <= last / 2)
        improved = np.where(trusted, newton, (low + high) / 2)
        last = np.abs(improved - q)
        if np.all(last <= np.finfo(Wide).eps * np.abs(q)):
            return improved
        q = improved
    return q


def followed(hodograph: Hodograph, q: WideArray) -> tuple[WideArray, WideArray]:
    """The slip (n, 3), m/s, and its path (n, 3), m, at parameters (n,)."""
    less, more = hodograph.rates
    a, b, c = hodograph.along, hodograph.against, hodograph.slowing
    velocity = np.zeros((len(q), 3), Wide)
    velocity[:, 0] = a * np.exp(-less * q) - b * np.exp(-more * q)
    velocity[:, 1] = hodograph.across * np.exp(-c * q)
    path = np.zeros((len(q), 3), Wide)
    path[:, 0] = a * a * grown(2 * less, q) - b * b * grown(2 * more, q)
    path[:, 1] = hodograph.across * (a * grown(c + less, q) + b * grown(c + more, q))
    return velocity, path


def grown(rate: Wide, q: WideArray) -> WideArray:
    """The integrals (n,) of exp(-rate q) from 0 to q (n,)."""
    return np.asarray(q if rate == 0 else -np.expm1(-rate * q) / rate)


def _reached(rate: Wide, integral: WideArray) -> WideArray:
    """Return the q (n,) at which the integral of `grown` reaches a value (n,); infinite if it never does."""
    if rate == 0:
        return integral
    left = -rate * integral
    return np.asarray(np.where(left > -1, -np.log1p(np.maximum(left, np.nextafter(Wide(-1), Wide(0)))) / rate, np.inf))
