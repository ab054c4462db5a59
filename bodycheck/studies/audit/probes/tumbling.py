"""Probes of the gyroscopic torque, of scales and of the origin, by a tumbling body with three different moments A, B, C.

The body is launched with an angular velocity (0, w2, w3) in its own frame. By Euler's equations only the first component
changes at first, at the rate (B - C) w2 w3 / A. Damping acts along the angular velocity and does not change this rate.

Without forces, the motion of the body does not depend on its mass, its size and its position. The scales are powers of two, so
that they change no rounding in a scheme that only multiplies and divides.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from bodycheck.reference.scene import Body, Scene, State
from bodycheck.reference.trajectory import Array
from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding, Property, not_probed
from bodycheck.studies.audit.probes.conventions import watch
from bodycheck.studies.audit.probes.falling import falling, roundoff
from bodycheck.studies.audit.probes.scenes import TRIAXIAL

#: The angular velocity (rad/s) of the launch.
SPIN = (0.0, 1.2, 1.6)

#: The velocity (m/s) of the launch. It is slow, so that quadratic damping changes it little.
VELOCITY = (0.11, -0.07, 0.19)

#: The launch, and the strides to each of its states: 64 steps.
LAUNCH = State(velocity=VELOCITY, angular_velocity=SPIN)
STRIDES = (1,) * 8 + (8,) * 7

#: The smallest missing fraction that is distinguished from errors of the scheme, which are of second order in h w.
LEAST = 0.02

#: The factors of the mass, at the same size, and the factors of the size, at the same mass, by their words.
MASSES = {"1/1024 of the mass": 2.0**-10, "1024 times the mass": 2.0**10}
SIZES = {"1/128 of the size": 2.0**-7, "128 times the size": 2.0**7}

#: The distance from the origin along each axis (m).
FAR = 1024.0

#: The largest relative change of a velocity in a step that rounding can explain, in units of roundoff.
ROUNDINGS = 4


def gyroscopic(pilot: Pilot) -> tuple[Finding, ...]:
    """Return a finding about the property no-gyroscopic-torque, whose value is the missing fraction of the torque."""
    missing = _missing(pilot, STRIDES, 1)
    if isinstance(missing, NotFlown):
        return not_probed("gyroscopic", missing.reason, "no-gyroscopic-torque")
    if abs(missing) > LEAST:
        # The effect of damping in a step and the other errors of a step vanish with the time step.
        finer = _missing(pilot, (1,), 2)
        missing = missing if isinstance(finer, NotFlown) else 2 * finer - missing
    lacks = abs(missing) > LEAST
    return (Finding("no-gyroscopic-torque", "gyroscopic", "found" if lacks else "none", missing if lacks else None, "", "0"),)


def _missing(pilot: Pilot, strides: tuple[int, ...], parts: int) -> float | NotFlown:
    """Return the fraction of the torque that is missing in the first step, or the reason why there is no flight.

    The time step is the audited time step divided by `parts`. If a fall can be flown, the duration of a step is measured by it.
    """
    states, seen = watch(pilot, Flight(Scene(TRIAXIAL, LAUNCH), pilot.timestep / parts, strides)), falling(pilot)
    if isinstance(states, NotFlown):
        return states
    duration = (pilot.timestep if isinstance(seen, NotFlown) else seen.timestep) / parts
    first, second, third = TRIAXIAL.moments
    rate = (second - third) / first * SPIN[1] * SPIN[2]
    return 1 - float(states[0, 10]) / (rate * duration)


def scales(pilot: Pilot) -> tuple[Finding, ...]:
    """Return findings about the properties scale-dependence and origin-dependence.

    The value of each finding is the largest relative difference of the velocity or the angular velocity within 64 steps.
    """
    base, (a, b, c) = Scene(TRIAXIAL, LAUNCH), TRIAXIAL.moments
    heavier = {words: Body(TRIAXIAL.mass * s, (a * s, b * s, c * s)) for words, s in MASSES.items()}
    larger = {words: Body(TRIAXIAL.mass, (a * s * s, b * s * s, c * s * s)) for words, s in SIZES.items()}
    scaled = {words: replace(base, body=body) for words, body in {**heavier, **larger}.items()}
    far = {f"{FAR:g} m from the origin": replace(base, initial=replace(LAUNCH, position=(FAR, -FAR, FAR)))}
    return _finding(pilot, "scale-dependence", base, scaled), _finding(pilot, "origin-dependence", base, far)


def _finding(pilot: Pilot, which: Property, base: Scene, others: Mapping[str, Scene]) -> Finding:
    here = watch(pilot, Flight(base, pilot.timestep, STRIDES))
    if isinstance(here, NotFlown):
        return not_probed("scales", here.reason, which)[0]
    allowed = ROUNDINGS * roundoff(pilot) * sum(STRIDES)
    off, refused = {}, ""
    for words, scene in others.items():
        there = watch(pilot, Flight(scene, pilot.timestep, STRIDES))
        if not isinstance(there, NotFlown):
            off[words] = _difference(here, there)
        elif there.refused:
            refused = f"at {words}: {there.reason}"
        else:
            return Finding(which, f"scales: at {words}: {there.reason}", "found", expected="0")
    if not off:
        return not_probed("scales", refused, which)[0]
    most = max(off, key=lambda words: off[words])
    if off[most] <= allowed:
        return Finding(which, f"scales: {refused}" if refused else "scales", "none", expected="0")
    return Finding(which, f"scales: at {most}", "found", off[most], "", "0")


def _difference(here: Array, there: Array) -> float:
    """Return the largest relative difference of the velocity or the angular velocity between states (n, 13)."""
    parts = [(here[:, columns], there[:, columns]) for columns in (slice(7, 10), slice(10, 13))]
    return max(float((np.linalg.norm(b - a, axis=1) / np.linalg.norm(a, axis=1)).max()) for a, b in parts)
