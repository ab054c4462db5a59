"""Motions thin enough to be stored in a page: few instants, between which a player finds every other.

An attitude goes from one instant to the next by a cubic rotation vector that has the body's own angular velocity at both ends,
a place in a straight line. What is stored is rounded to 16 bits first and then checked against the samples, so that the
tolerances hold of what a reader sees.
"""

import math
from base64 import b64encode
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.trajectory import Array
from bodycheck.reports.series import corners

#: Angle (rad) between a sample and the attitude that is played: less than eyes see of the difference of two bodies.
TOLERANCE = 2e-3

#: Instants of one track: some 10 kB.
MOST_INSTANTS = 400

#: Samples that a track is checked at, evenly spread over those that there are.
MOST_CHECKED = 4001

#: Turn (rad) from one instant to the next: less than half a turn, so that which way it went is never in doubt.
WIDEST = 2.5

#: Turn (rad) from one sample to the next: where it is more, the samples do not tell how the body moved between them.
COARSEST = 1.0

#: Of 16 bits, from zero to the largest size.
LEVELS = 32767

#: Angle (rad) below which the first terms of a series have all digits that count here.
SMALL = 1e-2


@dataclass(frozen=True, eq=False)
class Turning:
    """How a body turns. t: (k,) s. turn: (k, 3) rotation vectors, body to world, rad. rate: (k, 3) body rad/s."""

    t: Array
    turn: Array
    rate: Array

    def encoded(self) -> dict[str, Any]:
        """As the player reads it: numbers as base64, rates as shares of the `fastest` component."""
        fastest = _largest(self.rate)
        return {
            "t": _text(self.t),
            "turn": _shares(self.turn, math.pi),
            "rate": _shares(self.rate, fastest),
            "fastest": fastest,
        }


@dataclass(frozen=True, eq=False)
class Course:
    """Where a body goes. t: (k,) s. place: (k, 3), in one unit of length. within: its largest miss of a sample, likewise."""

    t: Array
    place: Array
    within: float

    def encoded(self) -> dict[str, Any]:
        """As the player reads it: numbers as base64, places as shares of the `farthest` component."""
        farthest = _largest(self.place)
        within = float(f"{self.within:.2g}")
        return {"t": _text(self.t), "place": _shares(self.place, farthest), "farthest": farthest, "within": within}


def turning(t: Array, quaternion: Array, rate: Array, rate_tolerance: float) -> Turning | None:
    """The thin track of attitudes (n, 4) and body rates (n, 3), rad/s, at times (n,), s; n is at least 2.

    Between its instants `played` is within TOLERANCE of every sample that it is checked at, and its rates within theirs
    (rad/s). None where that takes more than MOST_INSTANTS, or where the body turns too far between samples.
    """
    rows = checked(len(t))
    t, quaternion, rate = t[rows], quaternion[rows], rate[rows]
    sizes, steps = np.linalg.norm(rate, axis=1), np.diff(t)
    turns = np.maximum(geodesic_angle(quaternion[:-1], quaternion[1:]), steps * (sizes[:-1] + sizes[1:]) / 2)
    turned = np.concatenate([[0.0], np.cumsum(turns)])
    if not turns.max() <= COARSEST or turned[-1] > WIDEST * MOST_INSTANTS:
        return None
    whole = Turning(
        t,
        _rounded(Rotation.from_quat(quaternion, scalar_first=True).as_rotvec(), math.pi),
        _rounded(rate, _largest(rate)),
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
    """The thin track of places (n, 3) at times (n,), s, whose components miss those of no sample by more than a tolerance.

    That is rounding apart, and where it takes more than MOST_INSTANTS, the misses that are left are the smallest.
    """
    rows = checked(len(t))
    t, place = t[rows], place[rows]
    kept = corners(t, place, MOST_INSTANTS, tolerance / (float(np.ptp(place)) or 1.0))
    times, places = t[kept], _rounded(place[kept], _largest(place[kept]))
    between = np.column_stack([np.interp(t, times, column) for column in places.T])
    return Course(times, places, float(np.linalg.norm(between - place, axis=1).max()))


def played(track: Turning, t: Array) -> tuple[Array, Array]:
    """Attitudes (n, 4), body to world, and body rates (n, 3), rad/s, at times (n,), s, as the player finds them."""
    span = np.clip(np.searchsorted(track.t, t, side="right") - 1, 0, len(track.t) - 2)
    h = (track.t[span + 1] - track.t[span])[:, None]
    s = (t - track.t[span])[:, None] / h
    knots = Rotation.from_rotvec(track.turn)
    whole = (knots[span].inv() * knots[span + 1]).as_rotvec()
    start, stop = h * track.rate[span], h * _derivative(whole, track.rate[span + 1])
    vector = (s - 2 * s**2 + s**3) * start + (3 * s**2 - 2 * s**3) * whole + (s**3 - s**2) * stop
    change = (1 - 4 * s + 3 * s**2) * start + (6 * s - 6 * s**2) * whole + (3 * s**2 - 2 * s) * stop
    return (knots[span] * Rotation.from_rotvec(vector)).as_quat(scalar_first=True), _rate(vector, change / h)


def checked(samples: int) -> NDArray[np.intp]:
    """The places, ascending, of the samples that a track is checked at; the first and the last are among them."""
    stride = math.ceil((samples - 1) / (MOST_CHECKED - 1))
    return np.union1d(np.arange(0, samples, max(1, stride)), samples - 1)


def _rate(vector: Array, change: Array) -> Array:
    """Body rates (n, 3), rad/s, of an attitude whose rotation vector (n, 3), rad, changes so (n, 3), rad/s."""
    angle = np.linalg.norm(vector, axis=1, keepdims=True)
    safe = np.where(angle > SMALL, angle, 1)
    first = np.sinc(angle / 2 / np.pi) ** 2 / 2
    second = np.where(angle > SMALL, (safe - np.sin(safe)) / safe**3, 1 / 6 - angle**2 / 120)
    cross = np.cross(vector, change)
    return np.asarray(change - first * cross + second * np.cross(vector, cross))


def _derivative(vector: Array, rate: Array) -> Array:
    """How a rotation vector (n, 3), rad, changes (rad/s) at body rates (n, 3), rad/s: the inverse of `_rate`."""
    angle = np.linalg.norm(vector, axis=1, keepdims=True)
    safe = np.where(angle > SMALL, angle, 1)
    factor = np.where(angle > SMALL, (1 - safe / 2 / np.tan(safe / 2)) / safe**2, 1 / 12 + angle**2 / 720)
    cross = np.cross(vector, rate)
    return np.asarray(rate + cross / 2 + factor * np.cross(vector, cross))


def _largest(values: Array) -> float:
    return float(np.abs(values).max()) or 1.0


def _rounded(values: Array, scale: float) -> Array:
    """Values as they come back after they were stored as shares of a scale."""
    return np.asarray(np.rint(values / scale * LEVELS) / LEVELS * scale)


def _shares(values: Array, scale: float) -> str:
    return _text(np.rint(values / scale * LEVELS).astype(np.int16))


def _text(values: NDArray[Any]) -> str:
    return b64encode(values.astype(values.dtype.newbyteorder("<")).tobytes()).decode("ascii")
