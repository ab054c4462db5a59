"""The probe of scales: whether a motion depends on the scale of mass and length, or on where the origin of the world is.

A body without forces tumbles alike whatever its mass, its size and its place. The scales are powers of two, so that they change
no rounding of a scheme that multiplies and divides alone.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from bodycheck.reference.scene import Body, Scene
from bodycheck.reference.trajectory import Array
from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding, Property
from bodycheck.studies.audit.probes.answers import not_probed, watch
from bodycheck.studies.audit.probes.gyroscopic import LAUNCH, STRIDES
from bodycheck.studies.audit.probes.precision import roundoff
from bodycheck.studies.audit.probes.scenes import TRIAXIAL

#: The factors of the mass, at the same size, and those of the size, at the same mass, in words.
MASSES = {"1/1024 of the mass": 2.0**-10, "1024 times the mass": 2.0**10}
SIZES = {"1/128 of the size": 2.0**-7, "128 times the size": 2.0**7}

#: The distance from the origin along each axis (m).
FAR = 1024.0

#: The relative change of a velocity in a step, in units of roundoff, that rounding explains.
ROUNDINGS = 4


def scales(pilot: Pilot) -> tuple[Finding, ...]:
    """Return findings of scale-dependence and origin-dependence: the largest relative difference of a velocity in 64 steps."""
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
    """Return the largest difference of the velocity or the angular velocity, relative to it."""
    parts = [(here[:, columns], there[:, columns]) for columns in (slice(7, 10), slice(10, 13))]
    return max(float((np.linalg.norm(b - a, axis=1) / np.linalg.norm(a, axis=1)).max()) for a, b in parts)
