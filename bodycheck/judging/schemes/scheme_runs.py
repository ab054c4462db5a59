"""Runs of textbook schemes with the time step and at the instants of an engine's run."""

from functools import lru_cache

import numpy as np

from bodycheck.adapters.contract import Strides
from bodycheck.reference.kinematics import geodesic_angle, normalise
from bodycheck.reference.scene import Scene
from bodycheck.reference.schemes.catalogue import CATALOGUE
from bodycheck.reference.schemes.formulations import Equations
from bodycheck.reference.schemes.one_step import Scheme, step_through
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import distance


def differences(
    scheme: Scheme, formulation: Equations, scene: Scene, timestep: float, trajectory: Trajectory
) -> tuple[Array, Array]:
    """Return the differences of a scheme from a run at its n instants; they are infinite after the scheme fails.

    Parameters
    ----------
    scheme, formulation
        The scheme, and the equations of motion that it integrates.
    scene
        The scene of the run.
    timestep
        The time step (s) of the run.
    trajectory
        The trajectory of the run.

    Returns
    -------
    The attitude differences (n,), in rad, and the distances of the centres of mass (n,), in m.
    """
    rows = sampled(scheme, formulation, scene, timestep, tuple(steps(trajectory, timestep).tolist()))
    turned = geodesic_angle(normalise(trajectory.quaternion), rows[:, 3:7])
    return or_infinite(turned), or_infinite(distance(trajectory.position, rows[:, :3]))


# The methods of all engines are compared with the same schemes at the same time steps and instants: one scene at a time, for
# which each scheme has a short run and perhaps a full run.
@lru_cache(maxsize=4 * len(CATALOGUE))
def sampled(scheme: Scheme, formulation: Equations, scene: Scene, timestep: float, ends: tuple[int, ...]) -> Array:
    """Return the states (n, 13) of a scheme after `ends` (n,) steps."""
    rows = step_through(scheme, formulation, scene, timestep, np.diff(ends, prepend=0))
    rows.setflags(write=False)
    return rows


def steps(trajectory: Trajectory, timestep: float) -> Strides:
    """Return the numbers of steps (n,) from the start of a run to its samples."""
    return np.rint(trajectory.t / timestep).astype(np.int64)


def or_infinite(values: Array) -> Array:
    """Return the values with NaN replaced by infinity."""
    return np.where(np.isnan(values), np.inf, values)
