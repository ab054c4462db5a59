"""Closed forms of the translation with quadratic drag: without gravity, and along the vertical.

All quantities are dimensionless: speeds are divided by the terminal speed V = sqrt(g m / c), times by V/g, lengths by V^2/g =
m/c. The equation of motion is dw/dt = -k - |w| w. Without gravity, V is an arbitrary speed and the unit of time is m/(cV).

A course is an array (5, n) in the wide type. Its rows are the horizontal distance, the height, the length of the path, the
horizontal speed and the upward velocity, at n instants.
"""

import numpy as np

from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.flight.elliptic import WideArray

#: Below this size of its argument, the function arctan(sqrt(s)) / sqrt(s) is computed from three terms of its series.
SMALL_SQUARE = 1e-6

#: Number of rows of a course that are lengths, which add up when one course follows another.
LENGTHS = 3


def continued(first: WideArray, end: WideArray, rest: WideArray, later: WideArray) -> WideArray:
    """One course (5, n) followed by another.

    first: the course up to the change. end: (5, 1) its state at the change. rest: the other course, counted from the change.
    later: (n,) whether an instant is after the change.
    """
    moved = rest.copy()
    moved[:LENGTHS] += end[:LENGTHS]
    return np.where(later, moved, first)


def coasting(along: Wide, climb: Wide, times: WideArray) -> WideArray:
    """The course without gravity: the path is straight, 1/w grows linearly with time, and the path is ln(1 + w0 t) long.

    along, climb: horizontal speed and upward velocity at the start, not both zero. times: (n,) times >= 0.
    """
    speed = np.hypot(along, climb)
    path = logarithm_past_one(speed, times)
    left = 1 / (1 / speed + times)
    direction = np.array([along, climb]) / speed
    return np.stack([direction[0] * path, direction[1] * path, path, direction[0] * left, direction[1] * left])


def logarithm_past_one(speed: Wide, times: WideArray) -> WideArray:
    """ln(1 + w t) for w > 0 and times t (n,) >= 0, computed without overflow of the product."""
    large = times > 1e30 / speed
    apart = np.log(speed) + np.log(np.where(large, times, 1))
    return np.where(large, apart, np.log1p(speed * np.where(large, 0, times)))


def vertical(along: Wide, climb: Wide, times: WideArray) -> WideArray:
    """The course along the vertical, with a horizontal speed so small that it has no effect on the drag.

    The speed is a tangent of time on the way up and a hyperbolic tangent on the way down. The horizontal speed decays by
    exp(-path).
    """
    if climb <= 0:
        return falling(along, -climb, times)
    apex = np.arctan(climb)
    end = rising(along, climb, apex[None])
    fallen = falling(end[3, 0], Wide(0), np.maximum(times - apex, 0))
    return continued(rising(along, climb, np.minimum(times, apex)), end, fallen, times > apex)


def rising(along: Wide, climb: Wide, times: WideArray) -> WideArray:
    """The course straight up until the apex, at times (n,) up to arctan(climb)."""
    sine, cosine, half = np.sin(times), np.cos(times), np.tan(times / 2)
    slowed = cosine + climb * sine
    height = np.log1p(climb * sine - 2 * np.sin(times / 2) ** 2)
    root = np.hypot(climb, 1)
    # The integral of dt / (cos t + climb sin t), in terms of tan(t / 2).
    distance = np.log1p(2 * root * half / (1 - half / (climb + root))) / root
    return np.stack([along * distance, height, height, along / slowed, (climb * cosine - sine) / slowed])


def falling(along: Wide, sink: Wide, times: WideArray) -> WideArray:
    """The course straight down from a downward speed `sink` >= 0, at times (n,) >= 0."""
    decayed = np.expm1(-2 * times)
    # exp(-t) (cosh t + sink sinh t) - 1: nothing overflows, and nothing cancels for either sign of 1 - sink.
    share = (1 - sink) * decayed / 2
    short = np.minimum(times, 1)
    growth = np.log1p(sink * np.sinh(short) + 2 * np.sinh(short / 2) ** 2)
    depth = np.where(times < 1, growth, times + np.log1p(share))
    speed = (2 * sink - (1 - sink) * decayed) / (2 + (1 - sink) * decayed)
    distance = along * _integral_of_slowing(sink, np.tanh(times / 2))
    return np.stack([distance, -depth, depth, along * np.exp(-times) / (1 + share), -speed])


def _integral_of_slowing(sink: Wide, half: WideArray) -> WideArray:
    """The integral of dt / (cosh t + sink sinh t), in terms of half = tanh(t / 2) (n,)."""
    ratio = half / (1 + sink * half)
    square = (1 - sink) * (1 + sink) * ratio**2
    root = np.sqrt(abs((1 - sink) * (1 + sink)))
    if np.max(np.abs(square), initial=0) < SMALL_SQUARE:
        return np.asarray(2 * ratio * (1 - square / 3 + square**2 / 5))
    if sink < 1:
        return np.asarray(2 * np.arctan(root * ratio) / root)
    return np.asarray(np.log1p(2 * root * half / (1 + half / (sink + root))) / root)
