"""The flight of a body with quadratic drag in balls: closed forms along a line, and enclosed integrals on a curved path.

With k = c/m the velocity obeys v' = g - k |v| v. Along a vertical line it is a tangent until the top and a hyperbolic tangent
of time after it. On a curved path, with the horizontal speed u and the slope p of the velocity, u p' = -g and

    1/u^2 = 1/u0^2 - (k/g) (F(p) - F(p0)),    F(p) = p sqrt(1 + p^2) + asinh p,

so that time, way and height are integrals over p of u/g, u^2/g and p u^2/g. Arb encloses them; the slope at a time is a root.
"""

import math
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import acb, arb

from bodycheck.reference.proof.balls import Ball, Triple, ball, scaled, size_of, squared, triple, vector_sum
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.motions import union
from bodycheck.reference.proof.roots import root_near

#: The time (s) after which a slope that was computed is kept for later ones.
KEPT = arb(1) / 64

#: A function from a time (s) to the way from the start (m) and the velocity (m/s).
Flight = Callable[[Fraction], tuple[Triple, Triple]]


def flight(velocity: tuple[Fraction, ...], drag: Fraction, gravity: Fraction) -> Flight:
    """Return the flight from a velocity (m/s). drag: k (1/m). gravity: along -z (m/s^2)."""
    u, v, w = velocity
    start, k = triple(velocity), ball(drag)
    if not gravity:
        return _straight(start, k) if any(velocity) else lambda _: (start, start)
    return _curved(start, k, ball(gravity)) if u or v else _vertical(ball(w), k, ball(gravity))


def _straight(start: Triple, k: Ball) -> Flight:
    """A flight without gravity: v = v0 / (1 + k |v0| t)."""
    speed = size_of(start)

    def at(t: Fraction) -> tuple[Triple, Triple]:
        slower = 1 + k * speed * ball(t)
        return scaled(slower.log() / (k * speed), start), scaled(1 / slower, start)

    return at


def _vertical(rise: Ball, k: Ball, gravity: Ball) -> Flight:
    """A flight along a vertical line, with the speed sqrt(g/k) that it approaches."""
    last = (gravity / k).sqrt()

    def falling(speed: Ball, t: Ball) -> tuple[Ball, Ball]:
        sine, cosine = (gravity * t / last).sinh_cosh()
        whole = cosine + speed / last * sine
        return -whole.log() / k, -last * (speed / last * cosine + sine) / whole

    def rising(t: Ball) -> tuple[Ball, Ball]:
        sine, cosine = (gravity * t / last).sin_cos()
        whole = cosine + rise / last * sine
        return whole.log() / k, last * (rise / last * cosine - sine) / whole

    top = (rise / last).atan() * last / gravity
    height, _ = rising(top)

    def after(t: Ball) -> tuple[Ball, Ball]:
        way, velocity = falling(arb(0), t - top)
        return height + way, velocity

    def at(t: Fraction) -> tuple[Triple, Triple]:
        time = ball(t)
        if rise <= 0:
            way, velocity = falling(-rise, time)
        elif time <= top:
            way, velocity = rising(time)
        else:
            way, velocity = after(time) if time >= top else union(after(time), rising(time))
        return (arb(0), arb(0), way), (arb(0), arb(0), velocity)

    return at


@dataclass(frozen=True, eq=False)
class _Known:
    """A slope that is exact, and the time, the way and the height at which it is reached."""

    slope: Ball
    time: Ball
    way: Ball
    height: Ball


def _curved(start: Triple, k: Ball, gravity: Ball) -> Flight:
    """A flight with a horizontal velocity. Slopes that were computed are kept, so that later integrals are short."""
    u, v, w = start
    level = size_of((u, v))
    first, constant = w / level, 1 / squared(level)
    begin, part = _arc(first), acb(k / gravity)
    most = acb(constant) + part * begin

    def square(p: Any, analytic: bool = False) -> Any:
        """1/u^2 at a slope."""
        return most - part * _arc(p, analytic)

    def lasting(one: Ball, other: Ball) -> Ball:
        """The time from one slope to another."""
        return _integral(lambda p, analytic: square(p, analytic).rsqrt(analytic=analytic), one, other).real / gravity

    imaginary = acb(0, 1)

    def moved(one: Ball, other: Ball) -> tuple[Ball, Ball]:
        """Way and height from one slope to another: the real and the imaginary part of one integral."""
        both = _integral(lambda p, analytic: (1 + imaginary * p) / square(p, analytic), one, other) / gravity
        return both.real, both.imag

    def speed(p: Ball) -> Ball:
        return 1 / square(acb(p)).real.sqrt()

    def rate(p: float) -> float:
        """The rate of the slope (1/s), in doubles."""
        return -float(gravity) * math.sqrt(float(constant) - float(k / gravity) * (_arc_of_double(p) - float(begin.real)))

    latest = (0.0, float(first.mid()))  # a time, and a slope near to that at it
    known = [_Known(first.mid(), lasting(first, first.mid()), *moved(first, first.mid()))]

    def at(t: Fraction) -> tuple[Triple, Triple]:
        nonlocal latest
        time = ball(t)
        near = known[max(bisect_right(known, float(t), key=lambda each: float(each.time.mid())) - 1, 0)]
        if not float(near.time) <= latest[0] <= t:
            latest = (float(near.time), float(near.slope))
        guess = arb(_followed(rate, latest[1], float(t) - latest[0]))
        p = root_near(lambda q: near.time + lasting(near.slope, q) - time, lambda q: -speed(q) / gravity, guess)
        latest = float(t), float(p)
        parts = moved(near.slope, p)
        way, height, exact = near.way + parts[0], near.height + parts[1], p.mid()
        if near.time + KEPT < time:
            parts = moved(near.slope, exact)
            known.append(_Known(exact, near.time + lasting(near.slope, exact), near.way + parts[0], near.height + parts[1]))
            known.sort(key=lambda each: float(each.time.mid()))
        fast = speed(p)
        along = scaled(1 / level, (u, v, arb(0)))
        shown = vector_sum(scaled(way, along), (arb(0), arb(0), height))
        if not all(part.is_finite() for part in shown):
            raise NotEnclosed("a flight with drag whose integrals are not enclosed")
        return shown, vector_sum(scaled(fast, along), (arb(0), arb(0), fast * p))

    return at


def _followed(rate: Callable[[float], float], slope: float, lasting: float) -> float:
    """A slope after a time (s), by a step of the method of Runge and Kutta, with which the search for the exact one begins."""
    try:
        one = rate(slope)
        two = rate(slope + lasting / 2 * one)
        three = rate(slope + lasting / 2 * two)
        found = slope + lasting / 6 * (one + 2 * two + 2 * three + rate(slope + lasting * three))
    except (ValueError, OverflowError):
        return slope
    return found if math.isfinite(found) else slope


def _arc_of_double(p: float) -> float:
    """F(p) in double precision."""
    return p * math.hypot(1.0, p) + math.asinh(p)


def _integral(integrand: Callable[[Any, bool], Any], one: Ball, other: Ball) -> Any:
    """The integral of a function from a slope down to another one, a complex number."""
    return acb.integral(integrand, acb(other), acb(one))


def _arc(p: Any, analytic: bool = False) -> Any:
    """F(p)."""
    slope = acb(p)
    root = (1 + slope * slope).sqrt(analytic=analytic)
    return slope * root + (slope + root).log(analytic=analytic)
