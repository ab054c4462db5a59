"""Inertias, poses and states as DART has them, and a limit of its motions."""

from collections.abc import Sequence
from typing import Any

import dartpy as dart
import numpy as np

from bodycheck.adapters.attitudes import quaternions, rotation_vector
from bodycheck.adapters.contract import states
from bodycheck.adapters.links import Link, tensor
from bodycheck.adapters.quiet import no_stderr
from bodycheck.reference.kinematics import conjugate, normalise, rotate
from bodycheck.reference.scene import State
from bodycheck.reference.trajectory import Array

#: The kinetic energy (J) above which the next acceleration may overflow.
LARGEST_ENERGY_J = 1e200


def inertia(link: Link) -> "dart.dynamics.Inertia":
    """Return the mass, the centre of mass and the inertia of a link as DART's inertia."""
    with no_stderr():  # DART warns of moments of zero, but accepts them
        return dart.dynamics.Inertia(link.mass, link.center_of_mass, tensor(link))


def pose(position: Sequence[float], quaternion: Sequence[float]) -> Any:
    """Return DART's pose of a frame in another frame; the quaternion w x y z may have any norm."""
    isometry = dart.math.Isometry3()
    isometry.set_translation(np.array(position, dtype=float))
    isometry.set_quaternion(dart.math.Quaternion(*normalise(np.array(quaternion, dtype=float)).tolist()))
    return isometry


def place(skeleton: "dart.dynamics.Skeleton", initial: State) -> None:
    """Set the state of the body of a skeleton, which is on a free joint."""
    attitude = np.array(initial.quaternion)
    skeleton.setPositions(np.array([*rotation_vector(attitude), *initial.position]))
    skeleton.setVelocities(np.array([*rotate(attitude, np.array(initial.angular_velocity)), *initial.velocity]))


def coordinates(skeleton: "dart.dynamics.Skeleton") -> Array:
    """Return the coordinates and velocities (12,) of a skeleton with one free joint."""
    return np.concatenate([skeleton.getPositions(), skeleton.getVelocities()])


def rows(seen: Array) -> Array:
    """Return the rows (n, 13) of states from DART's coordinates and velocities (n, 12)."""
    turn, position, angular_velocity, velocity = np.split(seen, [3, 6, 9], axis=1)
    quaternion = quaternions(turn)
    return states(position, quaternion, velocity, rotate(conjugate(quaternion), angular_velocity))
