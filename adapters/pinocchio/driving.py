"""Drive the joints of a mechanism by efforts that each evaluation of the accelerations adds to the forces in the joints."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.adapters.contract import Law
from bodycheck.reference.trajectory import Array

#: Indices in an array.
Indices = NDArray[np.int64]

#: The forces on joints as a function of their coordinates, their velocities, and the part of the step that has passed.
Forces = Callable[[Array, Array, float], Array]


class Actuated:
    """The driven joints of a mechanism, and the forces on all its joints.

    Parameters
    ----------
    forces
        The forces without the efforts.
    in_q, in_v
        The indices of the driven joints in the coordinates and the velocities of all joints, as `joint_numbers` has them.
    count
        The number of velocities of all joints.
    timestep
        The time step (s).
    """

    def __init__(self, forces: Forces, in_q: Indices, in_v: Indices, count: int, timestep: float) -> None:
        self.forces, self.in_q, self.in_v, self.timestep = forces, in_q, in_v, timestep
        self.steps, self.held = 0, np.zeros(count)
        self.law: Law | None = None

    def total(self, q: Array, v: Array, passed: float) -> Array:
        """Return the forces with the efforts."""
        efforts = self.forces(q, v, passed) + self.held
        if self.law is not None:
            efforts[self.in_v] += self.law((self.steps + passed) * self.timestep, q[self.in_q], v[self.in_v])
        return efforts

    def state(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Return the coordinates and velocities of the driven joints."""
        return q[self.in_q], v[self.in_v]

    def apply(self, efforts: Array) -> None:
        """Exert efforts from now on, in addition to the law."""
        self.held[self.in_v] = efforts

    def obey(self, law: Law) -> None:
        """Exert from now on the efforts of a law."""
        self.law = law

    def count(self, state: Any) -> Any:
        """Count a step, and return the state after it."""
        self.steps += 1
        return state
