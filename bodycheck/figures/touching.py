"""Figures of bodies that roll, bounce, rest and tip: instants of events and the states after them, energy gained, and loads.

The exact instants are the instants of the truth's events; the instants of a run are measured from its samples, see
`bodycheck.reference.contact.observables` and `impacts`. For several bodies, a figure is the largest value over the bodies.
"""

import math
from collections.abc import Iterator

import numpy as np

from bodycheck.figures.definition import Comparison, Figure, observe
from bodycheck.reference.bodies import motions
from bodycheck.reference.contact.impacts import Impact
from bodycheck.reference.contact.motion import Event, EventKind
from bodycheck.reference.contact.observables import Rolling, crept, depth, lean, rest, rests, rolling, work
from bodycheck.reference.contact.touching import Touching, pushes_on, touching
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.requirements import free_bodies_touch
from bodycheck.reference.scenes import Scenes
from bodycheck.reference.trajectory import Array, Trajectory

#: If the angle between a face and the plane in the truth does not exceed this (rad), the face lies on the plane.
FLAT = 1e-9

#: The fraction of a run, at its end, over which creep is measured if mechanics does not determine the motion.
LAST_PART = 0.1


def transitions(compared: Comparison) -> Iterator[tuple[Event, Rolling]]:
    """Yield the transitions to rolling, in the truth and in the run, of bodies that slip from the start without an impact."""
    for body, motion, events in _bodies(compared):
        first = next((event for event in events if event.time > 0), None)
        if first is not None and first.kind == "roll":
            later = [event.time for event in events if event.time > first.time]
            yield first, rolling(body, motion, min(later, default=math.inf))


def first_impacts(compared: Comparison) -> Iterator[tuple[Event, Impact | None, Touching]]:
    """Yield the first impact of each body on the plane, in the truth and in the run (None if the run has none)."""
    if not compared.events:
        return
    for index, (body, _, events) in enumerate(_bodies(compared)):
        first = _first(events, "impact")
        if first is not None:
            yield first, next(iter(compared.impacts[index]), None), body


def transition_time_error(compared: Comparison) -> float | None:
    """Return the difference (s) between the instants at which rolling begins in the run and in the truth."""
    return max((abs(seen.time - exact.time) for exact, seen in transitions(compared)), default=None)


def roll_speed_error(compared: Comparison) -> float | None:
    """Return the distance (m/s) between the velocities at the start of rolling in the run and in the truth."""
    return max((math.dist(seen.velocity, exact.velocity) for exact, seen in transitions(compared)), default=None)


def impact_time_error(compared: Comparison) -> float | None:
    """Return the difference (s) between the first impacts in run and truth; for a run without impact, its end counts.

    Those on the plane and those of each pair of bodies count.
    """
    last = float(compared.trajectory.t[-1])
    errors = [abs((last if seen is None else seen.time) - exact.time) for exact, seen, _ in first_impacts(compared)]
    for pair, hits in compared.meetings.items():
        first = next(event.time for event in compared.events if (event.body, event.other) == pair)
        errors.append(abs((hits[0].time if hits else last) - first))
    return max(errors, default=None)


def impact_speed_error(compared: Comparison) -> float | None:
    """Return the distance (m/s) between the velocities just after the first impact in the run and in the truth."""
    pairs = [
        (exact, velocity)
        for exact, seen, body in first_impacts(compared)
        if seen is not None and _known(exact) and (velocity := _after(seen, body, compared)) is not None
    ]
    return max((math.dist(velocity, exact.velocity) for exact, velocity in pairs), default=None)


def bounce_ratio_error(compared: Comparison) -> float | None:
    """Return the largest difference between a ratio of speeds after and before an impact and the restitution."""
    errors = []
    for index, (body, _, events) in enumerate(_bodies(compared)):
        first = _first(events, "impact")
        if first is None or not _known(first):
            continue
        for hit in compared.impacts[index]:
            if hit.seen or would_bounce(hit, body, compared):
                errors.append(abs((hit.after if hit.seen else 0.0) / hit.before - body.restitution))
    return max(errors, default=None)


def rest_time_error(compared: Comparison) -> float | None:
    """Return the difference (s) between the instants from which on a body rests in the run and in the truth."""
    errors = []
    for index, (body, motion, events) in enumerate(_bodies(compared)):
        if events and events[-1].kind == "rest" and events[-1].time > 0:
            errors.append(abs(rest(body, motion, compared.impacts[index], _gravity(compared)) - events[-1].time))
    return max(errors, default=None)


def creep(compared: Comparison) -> float | None:
    """Return the mean speed (m/s) along the plane of a body that should rest, the largest of several; None if none should.

    The mean begins when the body comes to rest in the run or should come to rest, whichever is later; when it should, if it
    never rests in the run. If mechanics does not determine the motion, the mean is over the last tenth of the run.
    """
    speeds = []
    for index, (body, motion, events) in enumerate(_bodies(compared)):
        if settles(compared, index):
            speeds.append(crept(motion, body, (1 - LAST_PART) * float(motion.t[-1])))
            continue
        still = rests(compared.motions[index][1], compared.truth.bounds.velocity_error)
        if still.sum() < 2:
            continue
        begin = float(motion.t[still][0])
        if events and events[-1].kind == "rest" and 0 < events[-1].time <= begin:
            resting_from = rest(body, motion, compared.impacts[index], _gravity(compared))
            speed = crept(motion, body, max(begin, resting_from))
            speeds.append(crept(motion, body, begin) if speed is None else speed)
        else:
            speeds.append(crept(motion, body, begin))
    return max((speed for speed in speeds if speed is not None), default=None)


def settles(compared: Comparison, index: int) -> bool:
    """Return whether a body falls and settles in a way that mechanics does not determine: at most its impacts are known."""
    _, exact = compared.motions[index]
    others = any(event.body == index and event.kind != "impact" for event in compared.events)
    return bool(np.isnan(exact.position[-1, 0])) and not others


def penetration(compared: Comparison) -> Array | None:
    """Return the largest depth (n,), m, of a body below the plane."""
    depths = [depth(body, motion) for body, motion, _ in _bodies(compared)]
    return np.maximum.reduce(depths) if depths else None


def tilt(compared: Comparison) -> Array | None:
    """Return the largest angle (n,), rad, between the plane and the face of a body that should lie on it.

    The angle is NaN at instants at which no body should. A body whose motion mechanics does not determine should lie on a face
    at the last instant.
    """
    angles = []
    for index, (body, motion, _) in enumerate(_bodies(compared)):
        angle, should = lean(body, motion), lean(body, compared.motions[index][1])
        if angle is None or should is None:
            continue
        if settles(compared, index):
            should = np.append(np.full(len(motion) - 1, np.nan), 0.0)
        angles.append(np.where(should <= FLAT, angle, np.nan))
    return np.fmax.reduce(angles) if angles else None


def energy_gain(compared: Comparison) -> Array | None:
    """Return by how much (n,) the mechanical energy, less the work of the pushes, exceeds its lowest value so far.

    The excess is relative to the largest mechanical energy of the truth, where known, and of the start of the run, with zero
    potential energy for a centre of mass in the plane, or without potential energy if there is no plane. There is no such
    figure for fingers, whose efforts do work.
    """
    if isinstance(compared.scene, Scenes) or not free_bodies_touch(compared.scene):
        return None
    start = energy_from_plane(compared.scene, compared.trajectory.part(slice(0, 1)))
    exact = energy_from_plane(compared.scene, compared.truth.trajectory)
    size = float(np.fmax.reduce(np.concatenate([start, exact])))
    return gained(compared.scene, compared.trajectory) / (size or 1.0)


def gained(scene: AnyScene, trajectory: Trajectory) -> Array:
    """Return by how much (n,), J, the mechanical energy, less the work of the pushes, exceeds its lowest value so far."""
    energy = observe(scene, trajectory).total_energy
    for index, motion in enumerate(motions(scene, trajectory)):
        for push in pushes_on(scene, index):
            energy = energy - work(push, motion)
    return np.asarray(energy - np.minimum.accumulate(energy))


def energy_from_plane(scene: AnyScene, trajectory: Trajectory) -> Array:
    """Return the mechanical energy (n,), J, of all bodies, with a potential energy that is zero in the plane.

    Without a plane it is the kinetic energy alone.
    """
    energy = np.array(observe(scene, trajectory).kinetic_energy)
    if scene.plane is None:
        return energy
    for body, motion in zip(touching(scene), motions(scene, trajectory), strict=True):
        height = motion.position @ np.array(body.normal) * body.normal[2]
        energy += body.mass * scene.gravity * np.maximum(height, 0.0)
    return energy


def load_error(compared: Comparison) -> float | None:
    """Return the largest relative error of the mean load of an interface; None if there is no exact load to compare with."""
    if compared.interfaces is None:
        return None
    seen = {interface.bodies: interface.load for interface in compared.interfaces}
    bearing = [interface for interface in compared.exact_interfaces if interface.load > 0]
    errors = [abs(seen.get(interface.bodies, 0.0) - interface.load) / interface.load for interface in bearing]
    return max(errors, default=None)


def contact_losses(compared: Comparison) -> float | None:
    """Return the number of times that bodies that should bear each other lose contact; None if it was not measured."""
    if compared.interfaces is None or not compared.exact_interfaces:
        return None
    bearing = {interface.bodies for interface in compared.exact_interfaces if interface.load > 0}
    return float(sum(interface.losses for interface in compared.interfaces if interface.bodies in bearing))


def _bodies(compared: Comparison) -> Iterator[tuple[Touching, Trajectory, list[Event]]]:
    """Yield the bodies that touch, with their motion in the run and their events in the truth."""
    for index, body in enumerate(compared.touching):
        yield body, compared.motions[index][0], [event for event in compared.events if event.body == index]


def _first(events: list[Event], kind: EventKind) -> Event | None:
    """Return the first event of a kind after the start; impacts count only on the plane."""
    return next((e for e in events if e.kind == kind and e.time > 0 and (kind != "impact" or e.ends_flight)), None)


def _known(event: Event) -> bool:
    """Return whether mechanics determines the state after an event."""
    return not math.isnan(event.velocity[0])


def _gravity(compared: Comparison) -> float:
    assert not isinstance(compared.scene, Scenes)
    return compared.scene.gravity


def would_bounce(hit: Impact, body: Touching, compared: Comparison) -> bool:
    """Return whether the samples would show the bounce after an impact if the bounce were exact."""
    fall = _gravity(compared) * body.normal[2]
    return body.restitution > 0 and 2 * body.restitution * hit.before >= 2 * hit.shortest * fall


def _after(hit: Impact, body: Touching, compared: Comparison) -> Array | None:
    """Return the velocity (3,), m/s, after an impact; None if the samples are too coarse to determine it."""
    if hit.seen:
        return hit.velocity
    normal = np.array(body.normal)
    return hit.velocity - (hit.velocity @ normal) * normal if would_bounce(hit, body, compared) else None


FIGURES = (
    Figure(
        name="transition_time_error",
        title="Transition time error",
        meaning="difference between the time at which a body that slips begins to roll and the exact time",
        unit="s",
        remark="of a body that slips until it rolls",
        compute=transition_time_error,
        scale=lambda scales: scales.duration,
        most=lambda last: last,
    ),
    Figure(
        name="roll_speed_error",
        title="Rolling velocity error",
        meaning="difference between the velocity of the centre of mass when rolling begins and the exact one",
        unit="m/s",
        remark="of a body that slips until it rolls",
        compute=roll_speed_error,
        scale=lambda scales: scales.speed,
    ),
    Figure(
        name="impact_time_error",
        title="Impact time error",
        meaning="difference between the time of the first impact, where the arcs before and after it meet, and the exact time",
        unit="s",
        remark="of bodies that hit the plane or each other",
        compute=impact_time_error,
        scale=lambda scales: scales.duration,
        most=lambda last: last,
    ),
    Figure(
        name="impact_speed_error",
        title="Impact velocity error",
        meaning="difference between the velocity of the centre of mass just after the first impact and the exact one",
        unit="m/s",
        remark="of a body that bounces; empty where the samples are too coarse to see the bounce",
        compute=impact_speed_error,
        scale=lambda scales: scales.speed,
    ),
    Figure(
        name="bounce_ratio_error",
        title="Bounce ratio error",
        meaning=(
            "difference between the ratio of the normal speeds after and before an impact and the coefficient of restitution, "
            "the largest over all bounces that are seen"
        ),
        remark="of a body that bounces; a bounce is seen where two samples lie on its arc",
        compute=bounce_ratio_error,
    ),
    Figure(
        name="rest_time_error",
        title="Rest time error",
        meaning="difference between the time from which on a body rests and the exact time",
        unit="s",
        remark="of a body that comes to rest",
        compute=rest_time_error,
        scale=lambda scales: scales.duration,
        most=lambda last: last,
    ),
    Figure(
        name="energy_gain",
        title="Energy gain",
        meaning=(
            "rise of the mechanical energy above its lowest value so far, less the work of pushes, relative to the largest "
            "mechanical energy counted from the plane"
        ),
        largest=True,
        remark="of bodies that touch",
        compute=energy_gain,
        scale=lambda scales: scales.energy,
        plotted=True,
    ),
    Figure(
        name="load_error",
        title="Load error",
        meaning="difference between the mean load after 1 s between two bodies that rest and the exact load, relative",
        remark="of bodies that rest; the largest over all pairs that bear each other",
        compute=load_error,
    ),
    Figure(
        name="contact_losses",
        title="Contact losses",
        meaning="how often, after 1 s, bodies that rest on each other or on the plane lose contact",
        counts="times",
        remark="of bodies that rest",
        compute=contact_losses,
    ),
)
