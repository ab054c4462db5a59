"""Motions that are small enough to be stored in a page: few instants, between which the player interpolates.

Between two instants, the attitude follows a cubic rotation vector that has the body's angular velocity at both ends, and the
position follows a straight line. Values are first rounded to 16 bits and then compared with the samples, so the tolerances hold
for the motion that the reader sees.
"""

import math
from base64 import b64encode
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.kinematics import conjugate, geodesic_angle, multiply
from bodycheck.reference.robots.rotations import rotation_vector
from bodycheck.reference.trajectory import Array
from bodycheck.reports.series import corners

#: The largest angle (rad) between a sample and the interpolated attitude: too small to be visible between two bodies.
TOLERANCE = 2e-3

#: The most instants of a track, about 10 kB.
MOST_INSTANTS = 400

#: The most samples with which a track is compared, evenly spread over all samples.
MOST_CHECKED = 4001

#: The largest rotation (rad) from one instant to the next: less than half a turn, so that its direction is unambiguous.
WIDEST = 2.5

#: The largest rotation (rad) from one sample to the next; samples farther apart do not determine the motion between them.
COARSEST = 1.0

#: The largest 16-bit integer: the number of steps from zero to the scale.
LEVELS = 32767

#: The largest deviation of the norm of a quaternion from 1, far above the rounding of a normalised quaternion.
UNIT = 1e-6

#: The angle (rad) below which the first terms of a series are accurate enough.
SMALL = 1e-2


@dataclass(frozen=True, eq=False)
class Turning:
    """The rotation of a body at k instants.

    Parameters
    ----------
    t
        Instants (k,), s.
    turn
        Rotation vectors (k, 3), body to world, rad.
    rate
        Angular velocities (k, 3) along the body's axes, rad/s.
    """

    t: Array
    turn: Array
    rate: Array

    def encoded(self) -> dict[str, Any]:
        """Return the rotation as the player reads it: numbers as base64, and rates relative to the `fastest` component."""
        fastest = _largest_component(self.rate)
        return {
            "t": _text(self.t),
            "turn": _shares(self.turn, math.pi),
            "rate": _shares(self.rate, fastest),
            "fastest": fastest,
        }


@dataclass(frozen=True, eq=False)
class Course:
    """The path of a body at k instants.

    Parameters
    ----------
    t
        Instants (k,), s.
    place
        Positions (k, 3), in any unit of length.
    within
        Largest distance of a sample from the interpolated path, in the same unit.
    """

    t: Array
    place: Array
    within: float

    def encoded(self) -> dict[str, Any]:
        """Return the path as the player reads it: numbers as base64, and positions relative to the `farthest` component."""
        farthest = _largest_component(self.place)
        within = float(f"{self.within:.2g}")
        return {"t": _text(self.t), "place": _shares(self.place, farthest), "farthest": farthest, "within": within}


def turning(t: Array, quaternion: Array, rate: Array, rate_tolerance: float) -> Turning | None:
    """Return a rotation at few instants from which `played` reproduces every checked sample within the tolerances.

    Return None if more than `MOST_INSTANTS` instants would be necessary, if the body turns too far between samples, if a rate
    is not finite, or if an attitude is not a unit quaternion.

    Parameters
    ----------
    t
        Instants of the samples (n,), s; n is at least 2.
    quaternion
        Attitudes (n, 4), body to world.
    rate
        Angular velocities (n, 3) along the body's axes, rad/s.
    rate_tolerance
        The largest deviation of a rate (rad/s); the largest deviation of an attitude is `TOLERANCE`.
    """
    rows = checked(len(t))
    t, quaternion, rate = t[rows], quaternion[rows], rate[rows]
    if not np.isfinite(rate).all() or not np.allclose(np.linalg.norm(quaternion, axis=1), 1.0, rtol=0, atol=UNIT):
        return None
    sizes, steps = np.linalg.norm(rate, axis=1), np.diff(t)
    turns = np.maximum(geodesic_angle(quaternion[:-1], quaternion[1:]), steps * (sizes[:-1] + sizes[1:]) / 2)
    turned = np.concatenate([[0.0], np.cumsum(turns)])
    if not turns.max() <= COARSEST or turned[-1] > WIDEST * MOST_INSTANTS:
        return None
    whole = Turning(
        t,
        _rounded(rotation_vector(quaternion), math.pi),
        _rounded(rate, _largest_component(rate)),
    )
    kept = np.unique(np.searchsorted(turned, np.linspace(0, turned[-1], 2 + int(turned[-1] / WIDEST))).clip(0, len(t) - 1))
    kept = np.union1d(kept, [0, len(t) - 1])
    while len(kept) <= MOST_INSTANTS:
        track = Turning(whole.t[kept], whole.turn[kept], whole.rate[kept])
        attitudes, rates = played(track, t)
        misses = np.maximum(
            geodesic_angle(attitudes, quaternion) / TOLERANCE, np.linalg.norm(rates - rate, axis=1) / rate_tolerance
        )
        spans = np.searchsorted(kept, np.arange(len(t) - 1), side="right") - 1
        wide = np.flatnonzero(np.diff(turned[kept]) > WIDEST)
        missing = np.union1d(spans[misses[:-1] > 1], wide)
        middles = (kept[missing] + kept[missing + 1]) // 2
        if not (new := np.setdiff1d(middles, kept)).size:
            return track
        kept = np.union1d(kept, new)
    return None


def course(t: Array, place: Array, tolerance: float) -> Course:
    """Return a path at few instants, with straight lines between them.

    No component deviates from a sample by more than the tolerance, apart from rounding. For paths that would need more than
    `MOST_INSTANTS` instants, the deviation can be larger.

    Parameters
    ----------
    t
        Instants of the samples (n,), s.
    place
        Positions (n, 3).
    tolerance
        The largest deviation, in the unit of the positions.
    """
    rows = checked(len(t))
    t, place = t[rows], place[rows]
    kept = corners(t, place, MOST_INSTANTS, tolerance / (float(np.ptp(place)) or 1.0))
    times, places = t[kept], _rounded(place[kept], _largest_component(place[kept]))
    between = np.column_stack([np.interp(t, times, column) for column in places.T])
    return Course(times, places, float(np.linalg.norm(between - place, axis=1).max()))


def played(track: Turning, t: Array) -> tuple[Array, Array]:
    """Return attitudes (n, 4), body to world, and body rates (n, 3), rad/s, at times (n,), s, as the player computes them."""
    span = np.clip(np.searchsorted(track.t, t, side="right") - 1, 0, len(track.t) - 2)
    h = (track.t[span + 1] - track.t[span])[:, None]
    s = (t - track.t[span])[:, None] / h
    knots = _quaternion(track.turn)
    turns = rotation_vector(multiply(conjugate(knots[:-1]), knots[1:]))
    whole = turns[span]
    start, stop = h * track.rate[span], h * _derivative(turns, track.rate[1:])[span]
    vector = (s - 2 * s**2 + s**3) * start + (3 * s**2 - 2 * s**3) * whole + (s**3 - s**2) * stop
    change = (1 - 4 * s + 3 * s**2) * start + (6 * s - 6 * s**2) * whole + (3 * s**2 - 2 * s) * stop
    return multiply(knots[span], _quaternion(vector)), _rate(vector, change / h)


def checked(samples: int) -> NDArray[np.intp]:
    """Return the ascending indices of the samples with which a track is compared; they include the first and the last."""
    stride = math.ceil((samples - 1) / (MOST_CHECKED - 1))
    return np.union1d(np.arange(0, samples, max(1, stride)), samples - 1)


def _quaternion(vector: Array) -> Array:
    """Return the unit quaternions (n, 4) of rotation vectors (n, 3), rad."""
    half = np.linalg.norm(vector, axis=1, keepdims=True) / 2
    return np.hstack([np.cos(half), np.sinc(half / np.pi) / 2 * vector])


def _rate(vector: Array, change: Array) -> Array:
    """Return the body rates (n, 3), rad/s, of rotation vectors (n, 3), rad, with time derivatives (n, 3), rad/s."""
    angle = np.linalg.norm(vector, axis=1, keepdims=True)
    safe = np.where(angle > SMALL, angle, 1)
    first = np.sinc(angle / 2 / np.pi) ** 2 / 2
    second = np.where(angle > SMALL, (safe - np.sin(safe)) / safe**3, 1 / 6 - angle**2 / 120)
    cross = np.cross(vector, change)
    return np.asarray(change - first * cross + second * np.cross(vector, cross))


def _derivative(vector: Array, rate: Array) -> Array:
    """Return the time derivatives (rad/s) of rotation vectors, rad, at body rates (n, 3), rad/s: inverse of `_rate`."""
    angle = np.linalg.norm(vector, axis=1, keepdims=True)
    safe = np.where(angle > SMALL, angle, 1)
    factor = np.where(angle > SMALL, (1 - safe / 2 / np.tan(safe / 2)) / safe**2, 1 / 12 + angle**2 / 720)
    cross = np.cross(vector, rate)
    return np.asarray(rate + cross / 2 + factor * np.cross(vector, cross))


def _largest_component(values: Array) -> float:
    """Return the largest absolute value of a component, or 1 if all components are zero."""
    return float(np.abs(values).max()) or 1.0


def _rounded(values: Array, scale: float) -> Array:
    """Return values with the rounding that results from storing them as 16-bit integers relative to a scale."""
    return np.asarray(np.rint(values / scale * LEVELS) / LEVELS * scale)


def _shares(values: Array, scale: float) -> str:
    return _text(np.rint(values / scale * LEVELS).astype(np.int16))


def _text(values: NDArray[Any]) -> str:
    return b64encode(values.astype(values.dtype.newbyteorder("<")).tobytes()).decode("ascii")
