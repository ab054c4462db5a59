"""Bounds of the errors of a trajectory, figure by figure."""

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.trajectory import Array

#: Twice the largest relative error of a number that is rounded to double precision.
EPS = float(np.finfo(float).eps)


@dataclass(frozen=True, eq=False)
class Bounds:
    """Bounds of the errors of a trajectory at its n instants, as arrays (n,).

    Attributes
    ----------
    error
        Attitude: the angle between the attitude and the exact one (rad).
    position_error
        Distance of the centre of mass from its exact position (m).
    velocity_error
        Size of the difference between the velocity and the exact one, world frame (m/s).
    angular_velocity_error
        Size of the difference between the angular velocity and the exact one, body frame (rad/s).
    energy_error
        Difference between the total energy and the exact one (J), where the energy is computed from the states by
        `observables.observe`.
    angular_momentum_error
        Size of the difference between the angular momentum about the centre of mass and the exact one, world frame
        (kg m^2/s), computed likewise.
    """

    error: Array
    position_error: Array
    velocity_error: Array
    angular_velocity_error: Array
    energy_error: Array
    angular_momentum_error: Array

    def of_states(self) -> dict[str, Array]:
        """The bounds of the states, by their names: all bounds except those of energy and angular momentum."""
        return {name: getattr(self, name) for name in STATES}

    def plus(self, other: "Bounds") -> "Bounds":
        """The sums of these bounds and others."""
        return Bounds(*(getattr(self, name) + getattr(other, name) for name in NAMES))

    def part(self, places: NDArray[np.intp]) -> "Bounds":
        """The bounds at some of the instants, given by their indices (k,)."""
        return Bounds(*(getattr(self, name)[places] for name in NAMES))


#: The names of the figures.
NAMES = tuple(field.name for field in fields(Bounds))

#: The names of the figures that are states.
STATES = NAMES[:4]
