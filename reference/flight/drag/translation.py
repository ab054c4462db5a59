"""Positions and velocities of a body with quadratic drag, with bounds of their errors."""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.flight.drag.motion import ROUNDING, SUBNORMAL, motion, sizes
from bodycheck.reference.flight.drag.witness import witness
from bodycheck.reference.flight.elliptic import WideArray
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array


@dataclass(frozen=True, eq=False)
class Translation:
    """A translation at n instants, in double precision.

    Attributes
    ----------
    position
        (n, 3) positions in the world frame (m).
    velocity
        (n, 3) velocities in the world frame (m/s).
    position_error
        (n,) bound of the error of the positions (m), never decreasing.
    velocity_error
        (n,) bound of the error of the velocities (m/s).
    witnesses
        Names of the independent solutions that the bounds rely on; empty where none can follow the motion.
    """

    position: Array
    velocity: Array
    position_error: Array
    velocity_error: Array
    witnesses: tuple[str, ...]


def translation(scene: Scene, times: Array) -> Translation:
    """The translation of a scene with drag, which may be zero, at ascending times (n,) >= 0, s.

    The bounds are those of the motion itself, with the rounding to double precision, plus the largest disagreement so far with
    the witness. The error of the witness is subtracted from the disagreement, since it is no error of the motion.
    """
    flight = motion(scene, times)
    position, velocity = flight.position.astype(float), flight.velocity.astype(float)
    position_error = flight.position_error + _rounding(position)
    velocity_error = flight.velocity_error + _rounding(velocity)
    other = witness(scene, times) if scene.drag else None
    if other is not None:
        # An instant that is not compared takes the disagreement of the next compared instant.
        following = np.searchsorted(other.instants, np.arange(len(times)))
        seen = other.motion
        apart = _excess(flight.position[other.instants], seen.position, seen.position_error)
        position_error = position_error + apart[following]
        apart = _excess(flight.velocity[other.instants], seen.velocity, seen.velocity_error)
        velocity_error = velocity_error + apart[following]
    return Translation(
        position,
        velocity,
        np.maximum.accumulate(position_error),
        velocity_error,
        () if other is None else (other.name,),
    )


def _excess(one: WideArray, other: WideArray, error: Array) -> Array:
    """Largest distance so far (k,) between vectors (k, 3), beyond the error (k,) of the second vectors."""
    return np.maximum.accumulate(np.maximum(sizes(one - other).astype(float) - error, 0))


def _rounding(values: Array) -> Array:
    """Bound (n,) of the distance between vectors (n, 3) in double precision and the vectors before rounding."""
    return np.asarray(ROUNDING * sizes(values) + SUBNORMAL)
