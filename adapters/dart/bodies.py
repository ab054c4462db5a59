"""Inertias and poses as DART takes them, and a limit of its motions."""

from collections.abc import Sequence
from typing import Any

import dartpy as dart
import numpy as np

from bodycheck.adapters.links import Link, tensor
from bodycheck.adapters.quiet import no_stderr
from bodycheck.reference.kinematics import normalise

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
