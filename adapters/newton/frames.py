"""Poses and velocities of links as Newton takes them."""

from typing import Any

import numpy as np
import warp as wp

from bodycheck.adapters.links import Link, velocity_of
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.scene import Quaternion, State, Vector


def twist(link: Link, own: State) -> tuple[float, ...]:
    """Return Newton's twist of a link whose frame is in a state: the velocity of its centre of mass and its spin (world)."""
    spin = rotate(np.array(own.quaternion), np.array(own.angular_velocity))
    return (*velocity_of(link.center_of_mass, own), *spin.tolist())


def transform(position: Vector, quaternion: Quaternion) -> Any:
    """Return Warp's transform of a position (m) and a quaternion (w, x, y, z)."""
    w, x, y, z = quaternion
    return wp.transform(position, wp.quat(x, y, z, w))
