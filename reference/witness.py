"""Witnesses of a truth: the same motion computed in another way, whose own error is known."""

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


@dataclass(frozen=True, eq=False)
class Witness:
    """A motion that was computed in another way than the truth, with bounds of its own error.

    The arrays may be wider than double precision, since a witness is usually more accurate than the doubles of the truth.
    States that the way does not compute are None, and are not compared.

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


def distances(one: "Witness", other: "Witness") -> dict[str, Array]:
    """Return the distances of two ways at each instant (n,), in the figures that both compute, by the names of `Bounds`.

    All differences are formed in the wider of the two types.
    """
    apart = {}
    if one.quaternion is not None and other.quaternion is not None:
        apart["error"] = angle_between(one.quaternion, other.quaternion)
    for name in ("position", "velocity", "angular_velocity"):
        vectors = getattr(one, name), getattr(other, name)
        if vectors[0] is not None and vectors[1] is not None:
            apart[f"{name}_error"] = _apart(*vectors)
    return apart


def excess(scene: Scene, motion: Trajectory, own_bounds: Bounds, witness: Witness) -> Bounds:
    """The disagreement of a motion and a witness beyond the bounds of both, as the largest value so far.

    It is zero where the bounds of both hold. Otherwise the motion or the witness is wrong, and the bound of the motion has to
    grow by this excess.

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
        The excess of each figure (n,), never decreasing. The excess of energy and angular momentum follows from the others.
    """
    apart = distances(as_way("", motion, own_bounds), witness)
    none = np.zeros(len(motion))
    excesses = {
        name: np.maximum.accumulate(np.maximum(0.0, apart.get(name, none) - getattr(own_bounds, name) - getattr(witness, name)))
        for name in STATES
    }
    return Bounds(**excesses, **conserved_errors(scene, motion, **excesses))


def as_way(name: str, motion: Trajectory, bounds: Bounds) -> Witness:
    """Return a motion in double precision and the bounds of its errors as a `Witness`, to be compared with others."""
    states = motion.quaternion, motion.angular_velocity, motion.position, motion.velocity
    return Witness(name, *states, **bounds.of_states(), digits=DOUBLE_DIGITS)


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
    """Angle (n,), rad, between attitudes (n, 4) in double precision or wider, computed in the wider of the two types.

    If two attitudes differ by an angle alpha, the distance between their unit quaternions p and q, or p and -q, is 2
    sin(alpha/4). This formula takes fewer operations than the relative quaternion, and is as accurate near 0 and near pi.
    """
    wide = np.result_type(p, q)
    one, other = p.astype(wide), q.astype(wide)
    opposite = (one * other).sum(axis=1) < 0
    difference = one - np.where(opposite[:, None], -other, other)
    half = np.sqrt((difference * difference).sum(axis=1)) / 2
    return np.asarray(4 * np.arcsin(half.astype(float)))


def _apart(one: WideArray, other: WideArray) -> Array:
    """Distances (n,) between vectors (n, 3), computed in the wider of the two types."""
    wide = np.result_type(one, other)
    difference = one.astype(wide) - other.astype(wide)
    return np.asarray(np.sqrt((difference * difference).sum(axis=1))).astype(float)
