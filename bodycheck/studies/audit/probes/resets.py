"""The probe of resets: whether a body that flies very far or very fast is put back to its start without a word.

An engine that says that it started over ends the flight, which is no silent reset.
"""

import numpy as np

from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding
from bodycheck.studies.audit.probes.answers import not_probed, watch
from bodycheck.studies.audit.probes.bisection import threshold
from bodycheck.studies.audit.probes.scenes import DIRECTION, coast

#: Speeds (m/s) of the launches between which the one is looked for from which on a body is put back.
SLOW, FAST = 1e3, 1e13

STEPS = 3

#: The part of the way that it came, or comes in a step, within which of its start a body is back, and that of its speed.
BACK = 1e-2


def resets(pilot: Pilot) -> tuple[Finding, ...]:
    """Return a finding of silent-reset: the distance (m) or the speed (m/s) from which on a body is put back."""
    near, far = _put_back(pilot, SLOW, pilot.timestep), _put_back(pilot, FAST, pilot.timestep)
    if isinstance(near, NotFlown):
        return not_probed("resets", near.reason, "silent-reset")
    expected = "none"
    if near:
        return (Finding("silent-reset", f"resets: at {SLOW:g} m/s", "found", None, "m/s", expected),)
    if far is not True:
        # An engine that gives up a flight, or whose states are no numbers, does not keep it silent.
        words = f"resets: at {FAST:g} m/s: {far.reason}" if isinstance(far, NotFlown) else "resets"
        return (Finding("silent-reset", words, "none", expected=expected),)

    def flies(speed: float) -> bool:
        return _put_back(pilot, speed, pilot.timestep) is not True

    speed = threshold(flies, SLOW, FAST)
    # In steps of an eighth it comes less than half as far.
    if _put_back(pilot, 1.1 * speed, pilot.timestep / 8) is True:
        return (Finding("silent-reset", "resets: by the speed", "found", speed, "m/s", expected),)
    distance = speed * pilot.timestep * STEPS
    return (Finding("silent-reset", "resets: by the distance", "found", distance, "m", expected),)


def _put_back(pilot: Pilot, speed: float, timestep: float) -> bool | NotFlown:
    """Return whether a body is at or near its start after some step, at rest or with the velocity of the launch."""
    states = watch(pilot, Flight(coast(speed, 0.0), timestep, (1,) * STEPS))
    if isinstance(states, NotFlown):
        return states
    way, speeds = states[:, :3] @ np.array(DIRECTION), states[:, 7:10] @ np.array(DIRECTION) / speed
    at_start = np.abs(way) <= BACK * np.maximum(np.abs(speeds) * speed * timestep, np.maximum.accumulate(way))
    as_launched = (np.abs(speeds) < BACK) | (np.abs(speeds - 1) < BACK)
    return bool((at_start & as_launched).any())
