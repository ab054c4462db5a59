"""A body that falls, and how its displacement in a step follows from its velocities.

In each step of h' seconds the height changes by h' ((1 - a) v_old + a v_new): with a = 1 the velocity is advanced before the
position, with a = 0 after it, and with a = 1/2 the displacement is of second order. With n equal substeps, of which each
advances the velocity first, a = (n + 1) / (2 n), because the velocity grows evenly over the substeps; with each advancing the
position first, a = (n - 1) / (2 n).
"""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.scene import Scene, State
from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probes.answers import watch
from bodycheck.studies.audit.probes.scenes import SPHERE

STEPS = 64

#: The launch is not a number of single precision, nor slow enough for a body to be put to sleep.
LAUNCH = State((0.0, 0.0, 0.1), velocity=(0.0, 0.0, -1.1))


@dataclass(frozen=True)
class Fall:
    """How a body falls.

    Parameters
    ----------
    timestep
        The time (s) for which it moves in a step.
    weight
        The weight a of the new velocity in a displacement.
    uncertainty
        The relative deviation of that time which is left by residuals of the fit, and by the change of the acceleration in a
        step, because damping acts on the velocities between substeps too.
    """

    timestep: float
    weight: float
    uncertainty: float


def fall(timestep: float) -> Flight:
    """Return the flight of a body that falls, with each of its steps."""
    return Flight(Scene(SPHERE, LAUNCH, gravity=9.81), timestep, (1,) * STEPS)


def falling(pilot: Pilot) -> Fall | NotFlown:
    """Return how a body falls, from a fit to displacements and velocities, so that neither gravity nor damping matters."""
    states = watch(pilot, fall(pilot.timestep))
    if isinstance(states, NotFlown):
        return states
    moved, old, new = np.diff(states[:, 2]), states[:-1, 9], states[1:, 9]
    change = float(np.abs(new - old).max())
    if not change > 0.0:
        return NotFlown("the body does not fall")
    parts = np.stack([(old + new) / 2, new - old], axis=1)
    timestep, part = np.linalg.lstsq(parts, moved)[0].tolist()
    uneven = float(np.ptp(new - old)) / float(np.abs(new).max()) / 100
    # A hundredth of what the weight makes of a step: larger residuals mean another law.
    residual = float(np.abs(parts @ [timestep, part] - moved).max())
    if not residual < 0.01 * pilot.timestep * change:
        return NotFlown("the displacement in a step is not a mean of its two velocities")
    return Fall(timestep, 0.5 + part / timestep, 10 * residual / float(np.abs(moved).max()) + uneven)
