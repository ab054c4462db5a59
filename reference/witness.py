"""Witnesses of a truth: the same motion computed in another way, whose own error is known."""

import bisect
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.bounds import STATES, Bounds
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array, Trajectory

#: Decimal digits of double precision.
DOUBLE_DIGITS = 16

#: An array in double precision or wider.
WideArray = NDArray[Any]

#: The kind of an instant from which on a motion is not known, if none of the kinds of events says why.
END = "end"


@dataclass(frozen=True)
class Instant:
    """An event of a motion: its kind, its time and error (s), and the index of the body.

    The kind is one of `contact.motion.EventKind`, or `END`.
    """

    kind: str
    time: float
    error: float
    body: int = 0


@dataclass(frozen=True, eq=False)
class Witness:
    """A motion that was computed in another way than the truth, with bounds of its own error.

    The arrays may be wider than double precision, since a witness is usually more accurate than the doubles of the truth.
    States that the way does not compute are None or NaN, and are not compared. If there are b bodies, the arrays of states have
    the bodies as first axis: (b, n, 4) and (b, n, 3).

    Attributes
    ----------
    name
        Name of the way and of the software that computed it.
    quaternion
        (n, 4) attitudes w, x, y, z, body frame of the scene to world.
    angular_velocity
        (n, 3) angular velocities in the body frame of the scene (rad/s).
    position
        (n, 3) positions of the centre of mass, world frame (m).
    velocity
        (n, 3) velocities of the centre of mass, world frame (m/s).
    error, angular_velocity_error, position_error, velocity_error
        (n,) bounds of the errors of these four quantities, in rad, rad/s, m and m/s.
    digits
        Decimal digits of the arithmetic.
    events
        The events until the last instant, in ascending order of time; None if the way does not compute events.
    """

    name: str
    quaternion: WideArray | None = None
    angular_velocity: WideArray | None = None
    position: WideArray | None = None
    velocity: WideArray | None = None
    error: Array | float = 0.0
    angular_velocity_error: Array | float = 0.0
    position_error: Array | float = 0.0
    velocity_error: Array | float = 0.0
    digits: int = 19
    events: tuple[Instant, ...] | None = None


def distances(one: "Witness", other: "Witness") -> dict[str, Array]:
    """Return the distances of two ways at each instant (n,), in the figures that both compute, by the names of `Bounds`.

    Each is the largest over all bodies, and zero at instants at which a way does not compute the state. All differences are
    formed in the wider of the two types.
    """
    apart = {}
    if one.quaternion is not None and other.quaternion is not None:
        apart["error"] = _largest(angle_between(one.quaternion, other.quaternion))
    for name in ("position", "velocity", "angular_velocity"):
        vectors = getattr(one, name), getattr(other, name)
        if vectors[0] is not None and vectors[1] is not None:
            apart[f"{name}_error"] = _largest(_apart(*vectors))
    return apart


def contradictions(one: Witness, other: Witness) -> dict[str, Array]:
    """Return the distances (n,) of two ways in states where they exceed the bounds of both, and zero elsewhere.

    Each is the largest so far, by the names of `bounds.STATES`; zero in states that one of the ways does not compute.
    """
    apart = distances(one, other)
    beyond = {}
    for name in STATES:
        allowed = np.asarray(getattr(one, name) + getattr(other, name))
        distance = apart.get(name, np.zeros(np.broadcast_shapes(allowed.shape, (1,))))
        beyond[name] = np.maximum.accumulate(np.where(distance > allowed, distance, 0.0))
    return beyond


def event_distances(events: Sequence[Instant], others: Sequence[Instant], last: float) -> list[float]:
    """Return how far each event of one way is in time from the nearest event of its kind and body in another way (s).

    The distance is zero if the errors of both events cover it, or if the event may lie beyond the last instant `last` (s) of
    the motion. It is infinite if the other way has no such event.
    """
    alike: dict[tuple[str, int], list[Instant]] = {}
    for other in others:
        alike.setdefault((other.kind, other.body), []).append(other)
    return [_event_distance(event, alike.get((event.kind, event.body), []), last) for event in events]


def _event_distance(event: Instant, alike: list[Instant], last: float) -> float:
    """The result of `event_distances` for one event. alike: the other way's events of its kind and body, in order of time."""
    after = bisect.bisect(alike, event.time, key=lambda other: other.time)
    nearest = min(alike[max(after - 1, 0) : after + 1], key=lambda other: abs(other.time - event.time), default=None)
    if last - event.time <= event.error:
        return 0.0
    if nearest is None:
        return math.inf
    apart = abs(nearest.time - event.time)
    return apart if apart > event.error + nearest.error else 0.0


def excess(scene: Scene, motion: Trajectory, own_bounds: Bounds, witness: Witness) -> Bounds:
    """The disagreement of a motion and a witness where it exceeds the bounds of both, as the largest value so far.

    It is zero where the bounds of both hold. Otherwise the motion or the witness is wrong, and the bound of the motion has to
    grow by this disagreement.

    Parameters
    ----------
    scene
        The scene.
    motion
        The motion at n instants.
    own_bounds
        The bounds of its errors.
    witness
        The witness at the same instants.

    Returns
    -------
    Bounds
        The disagreement in each figure (n,), never decreasing. That of energy and angular momentum follows from the others.
    """
    excesses = contradictions(as_way("", motion, own_bounds), witness)
    return Bounds(**excesses, **conserved_errors(scene, motion, **excesses))


def as_way(name: str, motion: Trajectory, bounds: Bounds, events: tuple[Instant, ...] | None = None) -> Witness:
    """Return a motion in double precision and the bounds of its errors as a `Witness`, to be compared with others."""
    states = motion.quaternion, motion.angular_velocity, motion.position, motion.velocity
    return Witness(name, *states, **bounds.of_states(), digits=DOUBLE_DIGITS, events=events)


def conserved_errors(
    scene: Scene, motion: Trajectory, error: Array, position_error: Array, velocity_error: Array, angular_velocity_error: Array
) -> dict[str, Array]:
    """Bounds of the errors of energy and angular momentum that errors (n,) of the states cause, by the names of `Bounds`.

    They hold for errors in any direction, and are infinite where they exceed the range of doubles.
    """
    moments = np.array(scene.body.moments)
    speeds, spins = np.linalg.norm(motion.velocity, axis=1), np.linalg.norm(motion.angular_velocity, axis=1)
    largest = float(moments.max())
    turned = np.minimum(error, 2.0)  # a unit vector that is turned by any angle moves by at most 2
    with np.errstate(over="ignore"):
        momentum_error = largest * (angular_velocity_error + spins * turned)
        translational = scene.body.mass * (velocity_error * (speeds + velocity_error) + scene.gravity * position_error)
        rotational = largest * angular_velocity_error * (spins + angular_velocity_error)
    return {"energy_error": translational + rotational, "angular_momentum_error": momentum_error}


def angle_between(p: WideArray, q: WideArray) -> Array:
    """Angle (..., n), rad, between attitudes (..., n, 4) in double precision or wider, in the wider of the two types.

    If two attitudes differ by an angle alpha, the distance between their unit quaternions p and q, or p and -q, is 2
    sin(alpha/4). This formula takes fewer operations than the relative quaternion, and is as accurate near 0 and near pi.
    """
    wide = np.result_type(p, q)
    one, other = p.astype(wide), q.astype(wide)
    opposite = (one * other).sum(axis=-1) < 0
    difference = one - np.where(opposite[..., None], -other, other)
    half = np.sqrt((difference * difference).sum(axis=-1)) / 2
    return np.asarray(4 * np.arcsin(half.astype(float)))


def _apart(one: WideArray, other: WideArray) -> Array:
    """Distances (..., n) between vectors (..., n, 3), computed in the wider of the two types."""
    wide = np.result_type(one, other)
    difference = one.astype(wide) - other.astype(wide)
    return np.asarray(np.sqrt((difference * difference).sum(axis=-1))).astype(float)


def _largest(apart: Array) -> Array:
    """The largest distances (n,) over all bodies, from distances (n,) or (b, n); unknown ones count as zero."""
    return np.asarray(np.nan_to_num(np.atleast_2d(apart), nan=0.0).max(axis=0))
