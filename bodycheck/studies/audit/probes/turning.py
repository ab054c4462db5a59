"""The probe of turning: the largest turn of a sphere in one step.

A sphere spins so fast that it turns by most of a revolution in a step, and more slowly. A scheme may turn it by another angle:
one that advances the quaternion linearly turns it by 2 atan(h w / 2) instead of h w. But only a limit makes all turns alike.
"""

import numpy as np

from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.trajectory import Array
from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding
from bodycheck.studies.audit.probes.answers import not_probed, watch
from bodycheck.studies.audit.probes.limits import spin_limit
from bodycheck.studies.audit.probes.scenes import coast

#: The turns (rad) in a step that a method is asked for: the first set that it can make without giving up.
ASKED = ((6.0, 5.5, 5.0), (1.2, 1.1, 1.0))

#: The spin (rad/s) of the largest turn, and the part of a limit of the spin that it may be.
SPIN, BELOW_LIMIT = 30.0, 0.8

#: Relative deviation of turns that count as the same; those of schemes differ by some percent.
SAME = 2e-3


def turning(pilot: Pilot) -> tuple[Finding, ...]:
    """Return a finding of turn-limit."""
    limit = spin_limit(pilot)
    spin = min(SPIN, BELOW_LIMIT * limit[0]) if isinstance(limit, tuple) else SPIN
    for asked in ASKED:
        timestep = asked[0] / spin
        flown = [watch(pilot, Flight(coast(0.0, turn / timestep), timestep, (1, 1))) for turn in asked]
        seen = [_turns(states, timestep) for states in flown if not isinstance(states, NotFlown)]
        if len(seen) == len(asked):
            return (_finding(np.array(asked), np.array(seen)),)
    reason = next(states.reason for states in flown if isinstance(states, NotFlown))
    return not_probed("turning", reason, "turn-limit")


def _turns(states: Array, timestep: float) -> Array:
    """Return the turns (rad) of two steps (2, 2) by the spin, and by the attitudes, of which only up to pi can be told."""
    attitudes = np.concatenate([[(1.0, 0.0, 0.0, 0.0)], states[:, 3:7]])
    by_spin = np.linalg.norm(states[:, 10:], axis=1) * timestep
    return np.stack([by_spin, geodesic_angle(attitudes[:-1], attitudes[1:])], axis=1)


def _finding(asked: Array, seen: Array) -> Finding:
    """Return the finding from the turns asked for (n,), and those seen (n, 2, 2): by spin and by attitude, in two steps."""
    expected = f"none below {asked[0]:g} rad"
    for step in (0, 1):
        for way, words in enumerate(("of the angular velocity", "of the attitude alone")):
            turns = seen[:, step, way]
            if turns[0] > 0.0 and np.ptp(turns) < SAME * turns[0] and turns[0] < asked[-1]:
                return Finding("turn-limit", f"turning: {words}", "found", float(turns[0]), "rad per step", expected)
    return Finding("turn-limit", "turning", "none", expected=expected)
