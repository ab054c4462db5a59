"""A witness of the closed form: Euler's equations and dq/dt = q Omega / 2 by Taylor series in integers of 2^-200.

It starts from the same floating-point numbers as the closed form, and its own error is far below their rounding.
"""

import math
from fractions import Fraction
from operator import mul

import numpy as np

from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

#: Number of bits after the binary point of a fixed-point number.
BITS = 200

#: The number 1 in fixed point.
ONE = 1 << BITS

#: Size of a term, in fixed point, at which a series ends.
NEGLIGIBLE = 1 << 30


def fixed(value: Fraction) -> int:
    """A rational number in fixed point, rounded."""
    return round(value * ONE)


def cauchy(a: list[int], b: list[int]) -> int:
    """The highest coefficient of the product of two series in fixed point."""
    return sum(map(mul, a, reversed(b))) >> BITS


def taylor_step(ratios: list[int], rates: list[int], attitude: list[int], step: int) -> tuple[list[int], list[int]]:
    """Angular velocity (3) and attitude (4) after one step, all in fixed point; ratios: (B - C)/A and cyclically."""
    p, q, r = series = [[rate] for rate in rates]
    w, x, y, z = turned = [[part] for part in attitude]
    power, order = ONE, 0
    while True:
        order += 1
        power = power * step >> BITS
        accelerations = [cauchy(q, r), cauchy(r, p), cauchy(p, q)]
        turns = [
            -cauchy(x, p) - cauchy(y, q) - cauchy(z, r),
            cauchy(w, p) + cauchy(y, r) - cauchy(z, q),
            cauchy(w, q) + cauchy(z, p) - cauchy(x, r),
            cauchy(w, r) + cauchy(x, q) - cauchy(y, p),
        ]
        for part, ratio, value in zip(series, ratios, accelerations, strict=True):
            part.append((ratio * value >> BITS) // order)
        for part, value in zip(turned, turns, strict=True):
            part.append(value // (2 * order))
        last = [abs(part[-1]) for part in series + turned]
        if order > 8 and max(last) * power >> BITS < NEGLIGIBLE:
            break

    def summed(coefficients: list[int]) -> int:
        total = 0
        for coefficient in reversed(coefficients):
            total = (total * step >> BITS) + coefficient
        return total

    return [summed(part) for part in series], [summed(part) for part in turned]


def witness(scene: Scene, times: Array) -> list[tuple[list[int], Array]]:
    """Attitudes in fixed point and angular velocities (3,) in double precision, rad/s, at ascending times (n,) >= 0, s."""
    a, b, c = map(Fraction, scene.body.moments)
    ratios = [fixed((b - c) / a), fixed((c - a) / b), fixed((a - b) / c)]
    # Time is measured in a unit, a power of two of the second, in which no rate is above 1.
    unit = Fraction(2) ** -math.frexp(max(map(abs, scene.initial.angular_velocity)))[1]
    rates = [fixed(Fraction(rate) * unit) for rate in scene.initial.angular_velocity]
    attitude = [fixed(Fraction(part)) for part in scene.initial.quaternion]
    now, states = Fraction(0), []
    for time in times.tolist():
        end = Fraction(time) / unit
        while now < end:
            step = min(Fraction(1, 2), end - now)
            rates, attitude = taylor_step(ratios, rates, attitude, fixed(step))
            now += step
        states.append((attitude, np.array([float(Fraction(rate, ONE) / unit) for rate in rates])))
    return states


def angle_between(exact: list[int], quaternion: Array) -> float:
    """Angle (rad) between an attitude in fixed point and one in double precision (4,)."""
    w, x, y, z = exact
    a, b, c, d = (fixed(Fraction(part)) for part in quaternion.tolist())
    scalar = w * a + x * b + y * c + z * d
    vector = (w * b - x * a - y * d + z * c, w * c + x * d - y * a - z * b, w * d - x * c + y * b - z * a)
    return 2 * math.atan2(math.isqrt(sum(part * part for part in vector)) / ONE**2, abs(scalar) / ONE**2)
