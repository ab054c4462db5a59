"""Sampled states of one rigid body."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Trajectory:
    """States of a body at n instants, in the conventions of `State`.

    t: (n,) s. position: (n, 3) world, m. quaternion: (n, 4) unit, w x y z, body to world.
    velocity: (n, 3) world, m/s. angular_velocity: (n, 3) body, rad/s.
    """

    t: Array
    position: Array
    quaternion: Array
    velocity: Array
    angular_velocity: Array

    def __len__(self) -> int:
        return len(self.t)
