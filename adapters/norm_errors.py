"""How far the quaternions of each of several scenes were from unit length before an adapter normalised them."""

from typing import Protocol, runtime_checkable

import numpy as np

from bodycheck.adapters.contract import Normalising, Simulation
from bodycheck.reference.trajectory import Array


@runtime_checkable
class NormalisingEach(Protocol):
    """A simulation of several scenes that tells of each of them what `Normalising` tells of all."""

    @property
    def quaternion_norm_errors(self) -> Array:
        """The largest deviation from 1 of the norm of a quaternion of each scene (scenes,), in all its states so far."""
        ...


def of_each(simulation: Simulation, scenes: int) -> Array:
    """Return the largest deviation from 1 of the norm of a quaternion of each scene (scenes,), as the engine returned it.

    It is zero where nothing is normalised. A simulation that tells only of all scenes together tells the same of each.
    """
    if isinstance(simulation, NormalisingEach):
        return simulation.quaternion_norm_errors
    return np.full(scenes, simulation.quaternion_norm_error if isinstance(simulation, Normalising) else 0.0)
