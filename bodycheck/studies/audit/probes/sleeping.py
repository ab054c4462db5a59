"""The probe of sleeping: the speed below which a body that moves uniformly is stopped."""

from math import ceil

import numpy as np
from numpy.typing import NDArray

from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding
from bodycheck.studies.audit.probes.answers import not_probed, watch
from bodycheck.studies.audit.probes.bisection import threshold
from bodycheck.studies.audit.probes.scenes import DIRECTION, coast

#: The speeds (m/s) between which a threshold is looked for, and how long (s) a body is watched.
SLOWEST, FASTEST = 1e-4, 10.0
DURATION = 3.0

#: The number of single steps that are watched first, and that of strides for the rest.
FIRST, STRIDES = 64, 100

#: The parts of the launch speed with which a body moves or is still. One that crawls after damping is between them for a while,
#: and one that is put to sleep stops within one stride of many steps.
MOVING, STILL = 1e-2, 1e-3


def sleeping(pilot: Pilot) -> tuple[Finding, ...]:
    """Return a finding of sleeping: the threshold of the speed (m/s) of a body without spin."""
    long = max(1, ceil((DURATION / pilot.timestep - FIRST) / STRIDES))
    strides = (1,) * FIRST + (long,) * STRIDES
    still = _still(pilot, SLOWEST, strides)
    if isinstance(still, NotFlown):
        return not_probed("sleeping", still.reason, "sleeping")
    expected = f"none above {SLOWEST:g} m/s"
    if not still[-1]:
        return (Finding("sleeping", "sleeping", "none", expected=expected),)
    place = int(np.argmax(still))
    short = (sum(strides[: place + 1]), strides[place + 1] if place + 1 < len(strides) else 1)

    def sleeps(speed: float) -> bool:
        found = _still(pilot, speed, short)
        return not isinstance(found, NotFlown) and bool(found[-1])

    words = f"sleeping: after {short[0] * pilot.timestep:.3g} s"
    if sleeps(FASTEST):
        return (Finding("sleeping", f"{words}, at any speed", "found", None, "m/s", expected),)
    return (Finding("sleeping", words, "found", threshold(sleeps, SLOWEST, FASTEST), "m/s", expected),)


def _still(pilot: Pilot, speed: float, strides: tuple[int, ...]) -> NDArray[np.bool_] | NotFlown:
    """Return in which strides (n,) a body that moved before is still, and all of those after them."""
    states = watch(pilot, Flight(coast(speed, 0.0), pilot.timestep, strides))
    if isinstance(states, NotFlown):
        return states
    moved = np.abs(np.diff(states[:, :3] @ np.array(DIRECTION), prepend=0.0)) / (speed * pilot.timestep * np.array(strides))
    before = np.concatenate([[1.0], moved[:-1]])
    stopped = np.logical_or.accumulate((moved <= STILL) & (before >= MOVING))
    return np.asarray(stopped & (moved <= STILL))
