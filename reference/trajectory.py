"""Sampled states of one rigid body."""

from dataclasses import dataclass
from typing import Any

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

    def part(self, rows: slice | NDArray[Any]) -> "Trajectory":
        """Some of the instants, as a slice or by their places."""
        return Trajectory(
            self.t[rows], self.position[rows], self.quaternion[rows], self.velocity[rows], self.angular_velocity[rows]
        )
