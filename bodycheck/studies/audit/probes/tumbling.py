"""Probes by a body with three moments A, B, C that tumbles: of the gyroscopic torque, of scales, and of the origin.

It is launched with an angular velocity (0, w2, w3) in its own frame. By Euler's equations only the first component
changes at first, at the rate (B - C) w2 w3 / A, which damping, along the angular velocity, does not change.

Without forces it tumbles alike whatever its mass, its size and its place. The scales are powers of two, so that they change no
rounding of a scheme that multiplies and divides alone.
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

#: Slow, so that damping in proportion to the square of the speed takes little of it.
VELOCITY = (0.11, -0.07, 0.19)

#: The launch, and the strides to each of its states: 64 steps.
LAUNCH = State(velocity=VELOCITY, angular_velocity=SPIN)
STRIDES = (1,) * 8 + (8,) * 7

#: The least fraction that is told from errors of the scheme, of second order in h w.
LEAST = 0.02

#: The factors of the mass, at the same size, and those of the size, at the same mass, in words.
MASSES = {"1/1024 of the mass": 2.0**-10, "1024 times the mass": 2.0**10}
SIZES = {"1/128 of the size": 2.0**-7, "128 times the size": 2.0**7}

#: The distance from the origin along each axis (m).
FAR = 1024.0

#: The relative change of a velocity in a step, in units of roundoff, that rounding explains.
ROUNDINGS = 4


def gyroscopic(pilot: Pilot) -> tuple[Finding, ...]:
    """Return a finding of no-gyroscopic-torque: the fraction of the torque that is missing."""
    missing = _missing(pilot, STRIDES, 1)
    if isinstance(missing, NotFlown):
        return not_probed("gyroscopic", missing.reason, "no-gyroscopic-torque")
    if abs(missing) > LEAST:
        # What damping takes in a step, and other errors of the step, vanish with it.
        finer = _missing(pilot, (1,), 2)
        missing = missing if isinstance(finer, NotFlown) else 2 * finer - missing
    lacks = abs(missing) > LEAST
    return (Finding("no-gyroscopic-torque", "gyroscopic", "found" if lacks else "none", missing if lacks else None, "", "0"),)


def _missing(pilot: Pilot, strides: tuple[int, ...], parts: int) -> float | NotFlown:
    """Return the fraction of the torque that is missing in the first step, or why the body cannot be flown.

    The step is the audited one divided by `parts`. Its duration is measured by the fall of a body where that can be flown.
    """
    states, seen = watch(pilot, Flight(Scene(TRIAXIAL, LAUNCH), pilot.timestep / parts, strides)), falling(pilot)
    if isinstance(states, NotFlown):
        return states
    duration = (pilot.timestep if isinstance(seen, NotFlown) else seen.timestep) / parts
    first, second, third = TRIAXIAL.moments
    rate = (second - third) / first * SPIN[1] * SPIN[2]
    return 1 - float(states[0, 10]) / (rate * duration)


def scales(pilot: Pilot) -> tuple[Finding, ...]:
    """Return the findings of scale-dependence and of origin-dependence.

    The value of each is the largest relative difference of the velocity or the angular velocity within 64 steps.
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
