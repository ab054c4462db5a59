"""Figures of a body on a plane: its stop, its creep afterwards, its penetration and tilt, and the load on the plane."""

import math
from collections.abc import Callable

from bodycheck.figures import gripping, touching
from bodycheck.figures.definition import Comparison, Figure, Load
from bodycheck.reference import contact_observables
from bodycheck.reference.planar import Stop
from bodycheck.reference.requirements import grips
from bodycheck.reference.scenes import Scenes
from bodycheck.reference.trajectory import Array


def creep(compared: Comparison) -> float | None:
    """Return the mean speed (m/s) of the centre of mass along the plane after the run's stop.

    Returns None if the body does not stop in the truth. For bodies in contact, the result is that of `touching.creep`, and
    for a body between fingers that of `gripping.creep`.
    """
    if compared.touching:
        return touching.creep(compared)
    if not isinstance(compared.scene, Scenes) and grips(compared.scene):
        return gripping.creep(compared)
    if compared.truth.stop is None:
        return None
    stop, trajectory = compared.stop, compared.trajectory
    later = float(trajectory.t[-1]) - stop.time
    crept = math.dist(trajectory.position[-1, :2], stop.position[:2])
    return crept / later if later > 0 else 0.0


def penetration(compared: Comparison) -> Array | None:
    """Return the depth (n,), m, of the lowest point of a body below the plane; None without a plane."""
    if compared.touching:
        return touching.penetration(compared)
    scene = compared.on_plane
    return None if scene is None else contact_observables.penetration(scene, compared.trajectory)


def tilt(compared: Comparison) -> Array | None:
    """Return the angle (n,), rad, between the body axis K and the vertical; None without a plane.

    For bodies in contact, it is the angle between the plane and the face that lies on it.
    """
    if compared.touching:
        return touching.tilt(compared)
    return None if compared.on_plane is None else contact_observables.tilt(compared.trajectory)


def _of_stops(difference: Callable[[Stop, Stop], float]) -> Callable[[Comparison], float | None]:
    """Return a function that computes a figure from the stops of the run and of the truth, if the truth has one."""

    def compute(compared: Comparison) -> float | None:
        return None if compared.truth.stop is None else difference(compared.stop, compared.truth.stop)

    return compute


def _of_load(part: Callable[[Load], float]) -> Callable[[Comparison], float | None]:
    """Return a function that takes a figure from the load of a run, if the load was measured."""
    return lambda compared: None if compared.load is None else part(compared.load)


STOP = (
    Figure(
        name="stop_time_error",
        title="Stop time error",
        meaning="difference between the time at which the body comes to rest and the exact time",
        unit="s",
        remark="of a body that slides to rest",
        compute=_of_stops(lambda seen, expected: abs(seen.time - expected.time)),
        scale=lambda scales: scales.duration,
        most=lambda last: last,  # both stops are between the start and the last instant
    ),
    Figure(
        name="stop_position_error",
        title="Stop position error",
        meaning="distance between the place at which the body comes to rest and the exact place",
        unit="m",
        remark="of a body that slides to rest",
        compute=_of_stops(lambda seen, expected: math.dist(seen.position[:2], expected.position[:2])),
        scale=lambda scales: scales.length,
    ),
    Figure(
        name="stop_yaw_error",
        title="Stop yaw error",
        meaning="difference between the yaw at which the body comes to rest and the exact yaw",
        unit="rad",
        remark="of a body that slides to rest",
        compute=_of_stops(lambda seen, expected: abs(seen.yaw - expected.yaw)),
        scale=lambda scales: scales.angle,
    ),
    Figure(
        name="creep",
        title="Creep",
        meaning="mean speed after the stop, when the body should be at rest",
        unit="m/s",
        remark="of a body that slides to rest, or that should rest",
        compute=creep,
        scale=lambda scales: scales.speed,
    ),
)

POSE = (
    Figure(
        name="penetration",
        title="Penetration",
        meaning="depth to which the body sinks into the plane",
        unit="m",
        largest=True,
        remark="on a plane",
        compute=penetration,
        scale=lambda scales: scales.length,
        plotted=True,
    ),
    Figure(
        name="tilt",
        title="Tilt",
        meaning="angle by which the body is tilted against the plane",
        unit="rad",
        largest=True,
        remark="on a plane",
        compute=tilt,
        scale=lambda scales: scales.angle,
        most=lambda _: math.pi,
        plotted=True,
    ),
)

#: Without any error, the plane bears the weight of the body in every step.
LOAD = (
    Figure(
        name="mean_load",
        title="Mean load",
        meaning="average load on the plane until the stop",
        counts="weights",
        compute=_of_load(lambda load: load.mean_load),
        limited=False,
        ideal=1.0,
    ),
    Figure(
        name="peak_load",
        title="Peak load",
        meaning="largest load on the plane in a step until the stop",
        counts="weights",
        compute=_of_load(lambda load: load.peak_load),
        limited=False,
        ideal=1.0,
    ),
    Figure(
        name="time_in_contact",
        title="Steps in contact",
        meaning="share of the steps until the stop in which the plane carries a load",
        counts="share",
        compute=_of_load(lambda load: load.time_in_contact),
        limited=False,
        ideal=1.0,
        most=lambda _: 1.0,
    ),
)
