"""A trajectory: sampled states of one rigid body, or of the bodies of a mechanism, as arrays."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: An array in double precision.
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Trajectory:
    """States of a body at n instants, in the conventions of `scene.State`.

    The states of b bodies have the bodies as their first axis: positions (b, n, 3), and so on, at the same instants (n,).

    Attributes
    ----------
    t
        (n,) instants (s).
    position
        (n, 3) positions of the centre of mass, world frame (m).
    quaternion
        (n, 4) unit quaternions w, x, y, z that rotate body components to world components.
    velocity
        (n, 3) velocities of the centre of mass, world frame (m/s).
    angular_velocity
        (n, 3) angular velocities, body frame (rad/s).
    """

    t: Array
    position: Array
    quaternion: Array
    velocity: Array
    angular_velocity: Array

    def __len__(self) -> int:
        return len(self.t)

    def part(self, rows: slice | NDArray[Any]) -> "Trajectory":
        """The trajectory at some of the instants, selected by a slice, by indices or by a mask (n,)."""
        states = (self.position, self.quaternion, self.velocity, self.angular_velocity)
        return Trajectory(self.t[rows], *(values[..., rows, :] for values in states))

    def body(self, index: int) -> "Trajectory":
        """The trajectory of one of several bodies."""
        states = (self.position, self.quaternion, self.velocity, self.angular_velocity)
        return Trajectory(self.t, *(values[index] for values in states))


def stacked(t: Array, states: Sequence[Trajectory]) -> Trajectory:
    """The states of several bodies, each at the same instants (n,), s, as one trajectory with the bodies as the first axis."""
    parts = ("position", "quaternion", "velocity", "angular_velocity")
    return Trajectory(t, *(np.stack([getattr(state, part) for state in states]) for part in parts))
