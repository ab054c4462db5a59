"""The probe of limits: the largest speed and the largest spin that a sphere can have.

A sphere is launched very fast and half as fast, in steps so short that damping takes nothing away and that a limit of the
turn in a step is far. Where both launches end with the same speed, there is a limit.
"""

import numpy as np

from bodycheck.reference.trajectory import Array
from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding, Property
from bodycheck.studies.audit.probes.answers import not_probed, watch
from bodycheck.studies.audit.probes.scenes import coast

#: The larger launch in m/s and rad/s; the smaller is half of it.
LAUNCH = 1e4

#: The largest limit that is looked for. A launch may lose more than the last tenth to damping.
LARGEST = 9e3

#: The time step (s) and the number of steps.
TIMESTEP, STEPS = 1e-5, 3

#: Relative deviation of speeds that count as the same: rounding in single precision, and damping, change them less.
SAME = 1e-2


def limits(pilot: Pilot) -> tuple[Finding, ...]:
    """Return findings of speed-limit and spin-limit."""
    return (
        _finding("speed-limit", _limit(pilot, slice(7, 10)), "m/s"),
        _finding("spin-limit", spin_limit(pilot), "rad/s"),
    )


def spin_limit(pilot: Pilot) -> tuple[float, str] | NotFlown | None:
    """Return the largest spin (rad/s) and of what it is the limit; None if there is none up to `LARGEST`."""
    return _limit(pilot, slice(10, 13))


def _limit(pilot: Pilot, columns: slice) -> tuple[float, str] | NotFlown | None:
    fast, half = (watch(pilot, Flight(coast(size, size), TIMESTEP, (1,) * STEPS)) for size in (LAUNCH, LAUNCH / 2))
    if isinstance(fast, NotFlown):
        return fast
    if isinstance(half, NotFlown):
        return half
    vectors = [_slower(states, columns) for states in (fast, half)]
    sizes = [float(np.linalg.norm(vector)) for vector in vectors]
    limited = abs(sizes[0] / sizes[1] - 1) < SAME or abs(sizes[1] / (LAUNCH / 2) - 1) < SAME
    if sizes[0] > LARGEST or not limited:
        return None
    components = np.abs(vectors[0])
    if np.ptp(components) < SAME * components.max():
        return float(components.max()), "of each component"
    return sizes[0], ""


def _slower(states: Array, columns: slice) -> Array:
    """Return the last velocity (3,), or the last displacement divided by the time step where that is slower."""
    vector = states[-1, columns]
    moved = (states[-1, :3] - states[-2, :3]) / TIMESTEP
    slower = columns == slice(7, 10) and np.linalg.norm(moved) < (1 - SAME) * np.linalg.norm(vector)
    return moved if slower else vector


def _finding(which: Property, limit: tuple[float, str] | NotFlown | None, unit: str) -> Finding:
    if isinstance(limit, NotFlown):
        return not_probed("limits", limit.reason, which)[0]
    expected = f"none below {LARGEST:g} {unit}"
    if limit is None:
        return Finding(which, "limits", "none", expected=expected)
    return Finding(which, ": ".join(filter(None, ("limits", limit[1]))), "found", limit[0], unit, expected)
