"""The probe of the gyroscopic torque: how a body with three moments A, B, C begins to tumble.

It is launched with an angular velocity (0, w2, w3) in its own frame. By Euler's equations only the first component
changes at first, at the rate (B - C) w2 w3 / A, which damping, along the angular velocity, does not change.
"""

from bodycheck.reference.scene import Scene, State
from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding
from bodycheck.studies.audit.probes.answers import not_probed, watch
from bodycheck.studies.audit.probes.falling import falling
from bodycheck.studies.audit.probes.scenes import TRIAXIAL

SPIN = (0.0, 1.2, 1.6)

#: Slow, so that damping in proportion to the square of the speed takes little of it.
VELOCITY = (0.11, -0.07, 0.19)

#: The launch, and the strides to each of its states: 64 steps.
LAUNCH = State(velocity=VELOCITY, angular_velocity=SPIN)
STRIDES = (1,) * 8 + (8,) * 7

#: The least fraction that is told from errors of the scheme, of second order in h w.
LEAST = 0.02


def gyroscopic(pilot: Pilot) -> tuple[Finding, ...]:
    """Return a finding of no-gyroscopic-torque: the fraction that is missing of the torque."""
    missing = _missing(pilot, STRIDES, 1)
    if isinstance(missing, NotFlown):
        return not_probed("gyroscopic", missing.reason, "no-gyroscopic-torque")
    if abs(missing) > LEAST:
        # What damping takes in a step, and other errors of the step, vanish with it.
        finer = _missing(pilot, (1,), 2)
        missing = missing if isinstance(finer, NotFlown) else 2 * finer - missing
    found = abs(missing) > LEAST
    return (Finding("no-gyroscopic-torque", "gyroscopic", "found" if found else "none", missing if found else None, "", "0"),)


def _missing(pilot: Pilot, strides: tuple[int, ...], parts: int) -> float | NotFlown:
    """Return what is missing of the torque in the first step, which is a part of the audited one, by the method's own time."""
    states, seen = watch(pilot, Flight(Scene(TRIAXIAL, LAUNCH), pilot.timestep / parts, strides)), falling(pilot)
    if isinstance(states, NotFlown):
        return states
    duration = (pilot.timestep if isinstance(seen, NotFlown) else seen.timestep) / parts
    first, second, third = TRIAXIAL.moments
    rate = (second - third) / first * SPIN[1] * SPIN[2]
    return 1 - float(states[0, 10]) / (rate * duration)
