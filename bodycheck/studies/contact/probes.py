"""Probes of contact: short motions of a ball, a box or two boxes, whose exact outcome is known without computing it.

They measure what a scene does not show by itself: the restitution over the speed and the time step, the speed from which on
bodies bounce, the depth at rest over the mass, sleeping, creep on a ramp, the speed below which friction is viscous, friction
over the direction, and energy and momentum over an impact. The last three are those of the audit.
"""

from collections.abc import Callable, Mapping, Sequence
from math import atan, ceil, cos, sin, sqrt
from statistics import fmean

import numpy as np

from bodycheck.figures.friction import viscous_below
from bodycheck.reference.scene import Body, Brick, Plane, Scene, Sphere, State
from bodycheck.reference.trajectory import Array
from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import Probe as AuditProbe
from bodycheck.studies.audit.probes.friction import friction as friction_of_directions
from bodycheck.studies.audit.probes.impact import impact
from bodycheck.studies.audit.probes.stopping import threshold
from bodycheck.studies.contact.property import NAMES, Name, Property
from bodycheck.studies.contact.sheet import Group

GRAVITY, RADIUS = 9.81, 0.1

#: The coefficient of restitution that is given to the engine, and the speeds (m/s) of impacts.
RESTITUTION = 0.5
SPEEDS = (0.1, 0.3, 1.0, 3.0)

#: The time steps in words, as multiples of that of the method.
STEPS = {"": 1.0, ", a quarter of the step": 0.25}

#: How far the ball is from the plane at the start, in steps, so that impacts are at several instants within a step; the
#: duration (s), in which a compliant contact ends.
STEPS_AWAY, DURATION = (2.1, 2.35, 2.6, 2.85), 0.3

#: The part of the asked restitution from which on a ball counts as bouncing, and the range (m/s) of the search for the speed.
BOUNCES = 0.5
SLOWEST, FASTEST = 0.01, 10.0

#: The masses (kg) of balls at rest, and the time (s) that they have to settle.
MASSES, SETTLING = (1.0, 100.0), 2.0

#: The coefficient of friction; the slope of a ramp as a part of it; the durations (s) before and of the measurement of creep.
FRICTION, HELD = 0.5, 0.9
CREEPS_FROM, CREEPS_FOR = 1.0, 1.0

#: The speeds (m/s) between which the threshold of sleeping is searched for, and the interval (s) and the number of samples.
DOZING, AWAKE = 5e-4, 10.0
WATCHED_S, WATCHED = 0.05, 60

#: A ball that is put to sleep loses in one interval nearly all of its speed: from above the first part of its launch speed to
#: below the second.
MOVING, STILL = 0.5, 1e-3

#: The speed (m/s) of a box that slides to rest, and the duration (s), in multiples of the time in which it should stop.
SLIDING, LONGER = 1.0, 1.5


#: A probe: it makes flights by a pilot, and returns properties.
Probe = Callable[[Pilot], tuple[Property, ...]]


def restitution(pilot: Pilot) -> tuple[Property, ...]:
    """Return which part of its speed a ball keeps in an impact without gravity and friction, over the speed and the step.

    The value is the mean over several instants of the impact within a step.
    """
    rows = []
    for words, part in STEPS.items():
        for speed in SPEEDS:
            kept, condition = _kept(pilot, speed, part * pilot.timestep, 0.0), f"{speed:g} m/s{words}"
            if isinstance(kept, NotFlown):
                rows.append(_property("restitution", condition, kept, "", RESTITUTION))
            else:
                note = f"{min(kept):.3g} to {max(kept):.3g}, depending on the instant within a step"
                rows.append(_property("restitution", condition, fmean(kept), "", RESTITUTION, note))
    return tuple(rows)


def _property(
    name: Name, condition: str, value: float | NotFlown | None, unit: str, expected: float, note: str = ""
) -> Property:
    """Return a property; without a value if it could not be measured."""
    if isinstance(value, NotFlown):
        return Property(name, condition, None, unit, expected, value.reason)
    return Property(name, condition, value, unit, expected, note)


def _kept(pilot: Pilot, speed: float, timestep: float, gravity: float) -> tuple[float, ...] | NotFlown:
    """Return the parts of its speed (m/s) that a ball has after impacts on the plane, one for each of `STEPS_AWAY`."""
    parts = []
    for away in STEPS_AWAY:
        start = State((0.0, 0.0, RADIUS + away * speed * timestep), velocity=(0.0, 0.0, -speed))
        scene = Scene(ball(1.0), start, gravity, Plane(0.0, restitution=RESTITUTION))
        flown = _states(pilot, scene, timestep, (1,) * max(10, ceil(DURATION / timestep)))
        if isinstance(flown, NotFlown):
            return flown
        parts.append(max(0.0, float(flown[:, 9].max())) / speed)
    return tuple(parts)


def bounce_threshold(pilot: Pilot) -> tuple[Property, ...]:
    """Return the speed (m/s) of impacts below which a ball under gravity never keeps half of what it should keep.

    Impacts are not resolved below the speed that gravity gives in a few steps.
    """
    least = max(SLOWEST, 4 * GRAVITY * pilot.timestep / RESTITUTION)

    def stays(speed: float) -> bool:
        kept = _kept(pilot, speed, pilot.timestep, GRAVITY)
        return isinstance(kept, NotFlown) or max(kept) < BOUNCES * RESTITUTION

    fast = _kept(pilot, FASTEST, pilot.timestep, GRAVITY)
    value: float | NotFlown | None = 0.0
    note = f"looked for between {least:.2g} and {FASTEST:g} m/s"
    if isinstance(fast, NotFlown):
        value = fast
    elif stays(FASTEST):
        value, note = None, f"a ball keeps less than {BOUNCES * RESTITUTION:g} of its speed at any speed"
    elif stays(least):
        launch = threshold(stays, least, FASTEST)
        value = sqrt(launch**2 + 2 * GRAVITY * fmean(STEPS_AWAY) * launch * pilot.timestep)  # the speed of the impact
    return (_property("bounce-threshold", "", value, "m/s", 0.0, note),)


def depth(pilot: Pilot) -> tuple[Property, ...]:
    """Return how deep (m) balls of two masses lie in the plane after they have settled; negative above the plane."""
    rows = []
    for mass in MASSES:
        scene = Scene(ball(mass), State((0.0, 0.0, RADIUS)), GRAVITY, Plane(FRICTION))
        flown = _states(pilot, scene, pilot.timestep, (round(SETTLING / pilot.timestep),))
        value = flown if isinstance(flown, NotFlown) else RADIUS - float(flown[-1, 2])
        rows.append(_property("depth-at-rest", f"{mass:g} kg", value, "m", 0.0))
    return tuple(rows)


def creep(pilot: Pilot) -> tuple[Property, ...]:
    """Return the mean speed (m/s) with which a box creeps down a ramp on which nine tenths of the friction should hold it."""
    angle, half = atan(HELD * FRICTION), 0.1
    start = State((half * sin(angle), 0.0, half * cos(angle)), (cos(angle / 2), 0.0, sin(angle / 2), 0.0))
    scene = Scene(box((half, half, half)), start, GRAVITY, Plane(FRICTION, incline=angle))
    strides = tuple(round(span / pilot.timestep) for span in (CREEPS_FROM, CREEPS_FOR))
    flown = _states(pilot, scene, pilot.timestep, strides)
    if not isinstance(flown, NotFlown):
        speed = float(np.linalg.norm(flown[1, :3] - flown[0, :3])) / (strides[1] * pilot.timestep)
        return (_property("creep", "", speed, "m/s", 0.0),)
    return (_property("creep", "", flown, "m/s", 0.0),)


def sleeping(pilot: Pilot) -> tuple[Property, ...]:
    """Return the speed (m/s) below which a ball that rolls on level ground is suddenly at rest."""
    stride = max(1, round(WATCHED_S / pilot.timestep))
    note = f"looked for above {DOZING:g} m/s, within {WATCHED * stride * pilot.timestep:.2g} s"

    def asleep(speed: float) -> bool | NotFlown:
        start = State((0.0, 0.0, RADIUS), velocity=(speed, 0.0, 0.0), angular_velocity=(0.0, speed / RADIUS, 0.0))
        flown = _states(pilot, Scene(ball(1.0), start, GRAVITY, Plane(FRICTION)), pilot.timestep, (stride,) * WATCHED)
        if isinstance(flown, NotFlown):
            return flown
        parts = np.concatenate([[1.0], np.abs(flown[:, 7]) / speed])
        return bool(((parts[:-1] > MOVING) & (parts[1:] < STILL)).any() and parts[-1] < STILL)

    slow = asleep(DOZING)
    if isinstance(slow, NotFlown):
        return (_property("sleeping", "", slow, "m/s", 0.0),)
    value = threshold(lambda speed: asleep(speed) is True, DOZING, AWAKE) if slow else 0.0
    return (_property("sleeping", "", value, "m/s", 0.0, note),)


def viscous(pilot: Pilot) -> tuple[Property, ...]:
    """Return the speed (m/s) below which friction decelerates a box that slides on level ground by less than it should."""
    half, stop = (0.2, 0.2, 0.05), SLIDING / (FRICTION * GRAVITY)
    start = State((0.0, 0.0, half[2]), velocity=(SLIDING, 0.0, 0.0))
    steps = ceil(LONGER * stop / pilot.timestep)
    flown = _states(pilot, Scene(box(half), start, GRAVITY, Plane(FRICTION)), pilot.timestep, (1,) * steps)
    if isinstance(flown, NotFlown):
        return (_property("viscous-speed", "", flown, "m/s", 0.0),)
    t = pilot.timestep * np.arange(steps + 1, dtype=np.float64)
    seen = np.concatenate([[SLIDING], np.abs(flown[:, 7])])
    value = viscous_below(t, seen, np.maximum(SLIDING * (1 - t / stop), 0.0), 0.0, stop)
    note = "the time step is too large" if value is None else f"resolved above {FRICTION * GRAVITY * pilot.timestep:.2g} m/s"
    return (_property("viscous-speed", "", value, "m/s", 0.0, note),)


def audited(probe: AuditProbe) -> Probe:
    """Return the probe that measures what a probe of the audit measures."""

    def measured(pilot: Pilot) -> tuple[Property, ...]:
        rows = []
        for one in probe(pilot):
            # Texts are "friction: ATTITUDE: NUMBERS" and "impact: NUMBERS".
            _, *words = one.probe.split(": ")
            condition = words[0] if len(words) > 1 else ""
            value = None if one.verdict == "not-probed" else one.value
            rows.append(Property(NAMES[one.property], condition, value, one.unit, 0.0, words[-1]))
        return tuple(rows)

    return measured


#: The probes by the group of scenes whose settings they are made of, and by name, in the order in which they are made.
PROBES: Mapping[Group, Mapping[str, Probe]] = {
    "impact": {"restitution": restitution, "bounce-threshold": bounce_threshold, "impact": audited(impact)},
    "contact": {
        "depth": depth,
        "sleeping": sleeping,
        "creep": creep,
        "viscous": viscous,
        "friction": audited(friction_of_directions),
    },
}
BY_NAME = {name: probe for of_group in PROBES.values() for name, probe in of_group.items()}


def ball(mass: float) -> Body:
    """Return a homogeneous ball of some mass (kg)."""
    return Body(mass, (0.4 * mass * RADIUS**2,) * 3, Sphere(RADIUS))


def box(half: tuple[float, float, float]) -> Body:
    """Return a homogeneous box of 1 kg with half its lengths (m)."""
    a, b, c = (each**2 for each in half)
    return Body(1.0, ((b + c) / 3, (a + c) / 3, (a + b) / 3), Brick(half))


def _states(pilot: Pilot, scene: Scene, timestep: float, strides: Sequence[int]) -> Array | NotFlown:
    """Return the states (n, 13) of a flight, or the reason why there are none."""
    flown = pilot.fly(Flight(scene, timestep, tuple(strides)))
    if isinstance(flown, NotFlown):
        return flown
    return flown.states if np.isfinite(flown.states).all() else NotFlown("its states are not numbers")
