"""A body that slides across a constant force: the direction of its velocity turns towards the force while friction brakes it.

With D the force along the plane that drives a body, per mass, phi the angle between the velocity and D, and kappa the ratio of
friction to D, the equations of motion along and across the path are

    dv/dt = D (cos phi - kappa),    v dphi/dt = -D sin phi.

With lambda = ln(tan(phi0 / 2) / tan(phi / 2)) >= 0, c = cos^2(phi0 / 2), s = sin^2(phi0 / 2) and
E(p) = (1 - exp(-p lambda)) / p, which is lambda for p = 0, their solution is

    D t / v0                    = c E(kappa - 1) + s E(kappa + 1),
    D (path along D) / v0^2     = c^2 E(2 kappa - 2) - s^2 E(2 kappa + 2),
    D (path across D) / v0^2    = sin phi0 (c E(2 kappa - 1) + s E(2 kappa + 1)),
    velocity along D / v0       = c exp(-(kappa - 1) lambda) - s exp(-(kappa + 1) lambda),
    velocity across D / v0      = sin phi0 exp(-kappa lambda).

If kappa > 1, the body stops, as lambda goes to infinity.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from bodycheck.reference.exact.numbers import MP, Real, Vector2, real, wide
from bodycheck.reference.witness import WideArray

#: The argument of a decaying exponential beyond which its value is below all digits of the wide type.
_GONE = 100

#: The largest number of steps of Newton's method, which needs about ten, but as many as `_GONE` near the end of a slow stop.
_STEPS = 200


@dataclass(frozen=True)
class Oblique:
    """An oblique slide.

    Attributes
    ----------
    speed, drive
        v0 (m/s) and D (m/s^2), > 0.
    ratio
        kappa.
    along, across
        The unit vector of the force, and the unit vector perpendicular to it, on the side of the velocity.
    cosine, sine
        cos phi0 and sin phi0 > 0.
    """

    speed: Real
    drive: Real
    ratio: Real
    along: Vector2
    across: Vector2
    cosine: Real
    sine: Real

    @property
    def parts(self) -> tuple[Real, Real]:
        """c and s."""
        large = (1 + abs(self.cosine)) / 2
        small = self.sine**2 / (4 * large)
        return (large, small) if self.cosine > 0 else (small, large)


@dataclass(frozen=True)
class Arithmetic:
    """The exponential functions of an arithmetic, and the conversion of exact numbers to it."""

    exp: Callable[[Any], Any]
    expm1: Callable[[Any], Any]
    taken: Callable[[Real], Any]


#: The wide type, and exact arithmetic.
WIDE = Arithmetic(np.exp, np.expm1, wide)
EXACT = Arithmetic(MP.exp, MP.expm1, MP.mpf)


def oblique(velocity: Vector2, drive: Vector2, friction: Real) -> Oblique:
    """The slide from a velocity (m/s) that is not along the drive (m/s^2). friction: force of friction per mass (m/s^2)."""
    (u, v), (a, b) = velocity, drive
    speed, size = MP.hypot(u, v), MP.hypot(a, b)
    cross = a * v - b * u
    side = 1 if cross > 0 else -1
    cosine, sine = (a * u + b * v) / (speed * size), abs(cross) / (speed * size)
    return Oblique(speed, size, friction / size, (a / size, b / size), (-side * b / size, side * a / size), cosine, sine)


def stop(slide: Oblique) -> Real:
    """The time (s) until the body stops; infinite if it does not stop."""
    if slide.ratio <= 1:
        return MP.inf
    c, s = slide.parts
    return slide.speed / slide.drive * (c / (slide.ratio - 1) + s / (slide.ratio + 1))


def at_angle(slide: Oblique, angle: Real) -> Real:
    """The time (s) at which the angle between velocity and force is `angle` (rad), which is less than the initial angle."""
    c, s = slide.parts
    turned = MP.log(MP.sqrt(s / c) / MP.tan(angle / 2))
    return _scaled_time(slide, turned, EXACT) * slide.speed / slide.drive


def states(slide: Oblique, times: WideArray) -> tuple[WideArray, WideArray]:
    """Displacements (n, 2), m, and velocities (n, 2), m/s, after times (n,), s, at which the body still moves."""
    scaled = times * wide(slide.drive / slide.speed)
    ways, velocities = _along_and_across(slide, _turned(slide, scaled), WIDE)
    axes = np.array([[wide(part) for part in axis] for axis in (slide.along, slide.across)])
    return np.stack(ways, axis=-1) @ axes, np.stack(velocities, axis=-1) @ axes


def state(slide: Oblique, time: Real) -> tuple[Vector2, Vector2]:
    """Displacement (m) and velocity (m/s) after a time (s), in exact arithmetic; the time may be the time of the stop."""
    if time >= stop(slide):
        way, velocity = _at_stop(slide), (MP.mpf(0), MP.mpf(0))
    else:
        scaled = time * slide.drive / slide.speed
        turned = real(_turned(slide, np.array([wide(scaled)]))[0])
        for _ in range(_STEPS):
            step = (scaled - _scaled_time(slide, turned, EXACT)) / _scaled_speed(slide, turned, EXACT)
            turned += step
            if abs(step) <= MP.mpf(10) ** (20 - MP.dps) * (1 + turned):
                break
        way, velocity = _along_and_across(slide, turned, EXACT)
    return _in_plane(slide, way), _in_plane(slide, velocity)


def _in_plane(slide: Oblique, vector: Vector2) -> Vector2:
    (a, b), (p, q), (x, y) = slide.along, slide.across, vector
    return a * x + p * y, b * x + q * y


def _at_stop(slide: Oblique) -> Vector2:
    c, s = slide.parts
    size, ratio = slide.speed**2 / slide.drive, slide.ratio
    along = c**2 / (2 * ratio - 2) - s**2 / (2 * ratio + 2)
    return size * along, size * slide.sine * (c / (2 * ratio - 1) + s / (2 * ratio + 1))


def _grown(power: Real, turned: Any, arithmetic: Arithmetic) -> Any:
    """E(p) for `power` p and `turned` lambda."""
    return -arithmetic.expm1(-arithmetic.taken(power) * turned) / arithmetic.taken(power) if power else turned


def _scaled_time(slide: Oblique, turned: Any, arithmetic: Arithmetic) -> Any:
    c, s = slide.parts
    return arithmetic.taken(c) * _grown(slide.ratio - 1, turned, arithmetic) + arithmetic.taken(s) * _grown(
        slide.ratio + 1, turned, arithmetic
    )


def _scaled_speed(slide: Oblique, turned: Any, arithmetic: Arithmetic) -> Any:
    c, s = slide.parts
    return arithmetic.taken(c) * arithmetic.exp(-arithmetic.taken(slide.ratio - 1) * turned) + arithmetic.taken(
        s
    ) * arithmetic.exp(-arithmetic.taken(slide.ratio + 1) * turned)


def _along_and_across(slide: Oblique, turned: Any, arithmetic: Arithmetic) -> tuple[tuple[Any, Any], tuple[Any, Any]]:
    """Displacements (m) and velocities (m/s) along and across the force. turned: lambda."""
    c, s = slide.parts
    ratio = slide.ratio
    size, speed, sine = (
        arithmetic.taken(slide.speed**2 / slide.drive),
        arithmetic.taken(slide.speed),
        arithmetic.taken(slide.sine),
    )
    along = arithmetic.taken(c * c) * _grown(2 * ratio - 2, turned, arithmetic) - arithmetic.taken(s * s) * _grown(
        2 * ratio + 2, turned, arithmetic
    )
    across = arithmetic.taken(c) * _grown(2 * ratio - 1, turned, arithmetic) + arithmetic.taken(s) * _grown(
        2 * ratio + 1, turned, arithmetic
    )
    fast = arithmetic.taken(c) * arithmetic.exp(-arithmetic.taken(ratio - 1) * turned)
    faded = arithmetic.taken(s) * arithmetic.exp(-arithmetic.taken(ratio + 1) * turned)
    return (size * along, size * sine * across), (
        speed * (fast - faded),
        speed * sine * arithmetic.exp(-arithmetic.taken(ratio) * turned),
    )


def _turned(slide: Oblique, scaled: WideArray) -> WideArray:
    """lambda (n,) at scaled times D t / v0 (n,), by Newton's method within brackets, since the time may grow at any rate."""
    largest = np.max(scaled, initial=0)
    end = wide(MP.mpf(1))
    if slide.ratio > 1:
        end = wide(_GONE / (slide.ratio - 1))
    else:
        while _scaled_time(slide, end, WIDE) < largest:
            end *= 2
    low, high = np.zeros_like(scaled), np.full_like(scaled, end)
    turned = np.zeros_like(scaled)
    for _ in range(_STEPS):
        ahead = scaled - _scaled_time(slide, turned, WIDE)
        low, high = np.where(ahead >= 0, turned, low), np.where(ahead < 0, turned, high)
        step = ahead / _scaled_speed(slide, turned, WIDE)
        tried = turned + step
        tried = np.where((tried < low) | (tried > high), (low + high) / 2, tried)
        done = np.abs(tried - turned) <= np.finfo(tried.dtype).eps * (1 + np.abs(turned))
        turned = tried
        if done.all():
            break
    return turned
