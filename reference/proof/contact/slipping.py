"""A slip against friction in balls: along a line, or across the fall line of an incline.

A slip u of two components obeys u' = g - c u/|u| with g along x. Along a line its rate is constant. Otherwise, with A and B,
half of |u| + u_x and of |u| - u_x at the begin, and the parameter q with dt = |u| dq,

    u_x = A exp(-(c - g) q) - B exp(-(c + g) q),    u_y = u_y(0) exp(-c q),    |u| = A exp(-(c - g) q) + B exp(-(c + g) q).

Time and path are integrals of exponentials over q, and q at a time is a root.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from flint import arb

from bodycheck.reference.proof.balls import Ball, size_of
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.roots import root_near

#: Two components along a plane.
Pair = tuple[Ball, Ball]


@dataclass(frozen=True, eq=False)
class Hodograph:
    """A slip whose direction changes: see the docstring of the module."""

    downhill: Ball
    slowing: Ball
    along: Ball
    against: Ball
    across: Ball

    def decays(self, q: Any) -> tuple[Any, Any, Any]:
        """The exponentials of -(c - g) q, -(c + g) q and -c q."""
        less, more = self.slowing - self.downhill, self.slowing + self.downhill
        return (q * -less).exp(), (q * -more).exp(), (q * -self.slowing).exp()

    def size(self, q: Any) -> Any:
        """|u| at a parameter."""
        one, other, _ = self.decays(q)
        return one * self.along + other * self.against

    def time(self, q: Any) -> Any:
        """The time (s) at a parameter."""
        one, other, _ = self.decays(q)
        less, more = self.slowing - self.downhill, self.slowing + self.downhill
        return (one * -1 + 1) * (self.along / less) + (other * -1 + 1) * (self.against / more)

    def slip(self, q: Any) -> tuple[Any, Any]:
        """The slip at a parameter."""
        one, other, middle = self.decays(q)
        return one * self.along - other * self.against, middle * self.across

    def path(self, decays: tuple[Ball, Ball, Ball]) -> Pair:
        """The integral of the slip over time until the exponentials have these values."""
        one, other, middle = decays
        a, b, c, g = self.along, self.against, self.slowing, self.downhill
        x = a * a * (1 - one * one) / (2 * (c - g)) - b * b * (1 - other * other) / (2 * (c + g))
        y = a * (1 - middle * one) / (2 * c - g) + b * (1 - middle * other) / (2 * c + g)
        return x, self.across * y

    def parameter(self, t: Ball) -> Ball:
        """The parameter at a time (s)."""
        guess = t / (self.along + self.against)
        while self.time(guess.mid()) < t:  # a guess that is not too small would lead Newton's method beyond the end
            guess = guess * 2
        low, high = arb(0), guess
        for _ in range(32):
            middle = ((low + high) / 2).mid()
            low, high = (middle, high) if self.time(middle) < t else (low, middle)
        return root_near(lambda q: self.time(q) - t, self.size, high)


@dataclass(frozen=True, eq=False)
class Slip:
    """A slip: its duration (s; None if it does not end), its rate if it is constant, and its function of time.

    Attributes
    ----------
    duration, rate
        The duration (s), None if it does not end, and the constant rate (m/s^2), None if its direction changes.
    at
        A function from the time (s) since its begin to the slip (m/s) and to its path (m).
    ended
        The path at its end (m).
    hodograph
        The hodograph of a slip whose direction changes.
    """

    duration: Ball | None
    rate: Pair | None
    at: Callable[[Ball], tuple[Pair, Pair]]
    ended: Pair | None
    hodograph: Hodograph | None = None


def slipping(slip: Pair, downhill: Ball, slowing: Ball) -> Slip:
    """Return the motion of a slip (m/s) under the accelerations g, along x, and c, against the slip (m/s^2)."""
    if downhill.is_zero() or slip[1].is_zero():
        return _straight(slip, downhill, slowing)
    size = size_of(slip)
    turning = Hodograph(downhill, slowing, (size + slip[0]) / 2, (size - slip[0]) / 2, slip[1])
    if not (turning.along > 0 and turning.against > 0):
        raise NotEnclosed("a slip that may be along the fall line")
    duration = ended = None
    if slowing > downhill:
        duration = turning.along / (slowing - downhill) + turning.against / (slowing + downhill)
        ended = turning.path((arb(0), arb(0), arb(0)))
    elif not slowing < downhill or slowing.is_zero():
        raise NotEnclosed("a slip that may never end")

    def at(t: Ball) -> tuple[Pair, Pair]:
        q = turning.parameter(t)
        return turning.slip(q), turning.path(turning.decays(q))

    return Slip(duration, None, at, ended, turning)


def _straight(slip: Pair, downhill: Ball, slowing: Ball) -> Slip:
    size = size_of(slip)
    if size.is_zero():
        direction = (arb(1), arb(0))
    elif slip[1].is_zero():
        direction = (slip[0].sgn(), arb(0))
    else:
        direction = (slip[0] / size, slip[1] / size)
    against = slowing - downhill * direction[0]
    rate = (downhill - slowing * direction[0], -slowing * direction[1])
    duration = None
    if not (slowing.is_zero() or size.is_zero()):
        if against > 0:
            duration = size / against
        elif not against <= 0:
            raise NotEnclosed("a slip that may never end")

    def at(t: Ball) -> tuple[Pair, Pair]:
        now = (slip[0] + rate[0] * t, slip[1] + rate[1] * t)
        return now, (t * (slip[0] + now[0]) / 2, t * (slip[1] + now[1]) / 2)

    ended = None if duration is None else (slip[0] * duration / 2, slip[1] * duration / 2)
    return Slip(duration, rate, at, ended)
