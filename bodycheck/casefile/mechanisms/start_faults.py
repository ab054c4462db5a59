"""Check what only the start of a mechanism can tell: its mass matrix, loops, and numbers that would overflow."""

from collections.abc import Iterator, Mapping

import numpy as np

from bodycheck.casefile.scenes import MAX_SIZE, Inconsistent
from bodycheck.casefile.toml_positions import Path
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.mechanisms import start
from bodycheck.reference.mechanisms.mechanism import Mechanism

#: Smallest pivot of the mass matrix relative to the element of its diagonal; a smaller one is rounding of the file's numbers.
MIN_PIVOT = 1e-15

#: Largest ratio of all masses times the square of the largest distance to an inertia that is turned against: sums of both are
#: formed with a hundred digits.
MAX_RATIO = 1e60

#: How far apart the points of a loop may be, relative to the lengths around it, and how fast they may part, relative to the
#: speeds: what the decimals of a file leave.
LOOP_TOLERANCE = 1e-12


def check_start(mechanism: Mechanism, duration: float) -> None:
    """Refuse a mechanism without a motion, or with one that is too large. duration: of the run (s).

    Raises `Inconsistent` for a mass matrix in joint coordinates that is not positive definite at the start, loops that do not
    close or do not stay closed, inertias that are too small beside the others, and quantities above `MAX_SIZE`.
    """
    frames, coordinates = start.frames(mechanism), start.coordinates(mechanism)
    faults = [*_undetermined(mechanism, coordinates), *_open_loops(mechanism, frames)]
    if not faults:
        faults += _out_of_scale(mechanism, frames, coordinates)
        faults += _too_large(mechanism, frames, coordinates, duration)
    if faults:
        raise Inconsistent(*faults)


def _undetermined(mechanism: Mechanism, coordinates: tuple[start.Coordinate, ...]) -> Iterator[tuple[Path, str]]:
    """Yield the first coordinate of each joint or free body that nothing resists."""
    told: set[int] = set()
    for coordinate in coordinates:
        if coordinate.loose > MIN_PIVOT * coordinate.locked or coordinate.body in told:
            continue
        told.add(coordinate.body)
        name = mechanism.bodies[coordinate.body].name
        if coordinate.joint is None:
            yield (
                ("bodies", coordinate.body),
                f"{name} is free and has no moment of inertia about some axis; its turning is not determined",
            )
        else:
            yield (
                ("joints", coordinate.joint),
                "what it moves has no inertia against it while the joints behind it are loose: the mass matrix is not positive "
                "definite at the start; give moments of inertia, or an armature",
            )


def _open_loops(mechanism: Mechanism, frames: Mapping[int, start.Frame]) -> Iterator[tuple[Path, str]]:
    reach = max(np.abs(frame.origin).max() for frame in frames.values())
    fastest = max(np.abs(frame.velocity).max() for frame in frames.values())
    turning = max(np.abs(frame.spin).max() for frame in frames.values())
    for index, loop in enumerate(mechanism.loops):
        ends = [frames[body] for body in loop.bodies]
        points = [np.array(point, dtype=Wide) for point in loop.points]
        size = max(reach, *(np.abs(point).max() for point in points))
        here, there = (end.point(point) for end, point in zip(ends, points, strict=True))
        if (gap := _length(here - there)) > LOOP_TOLERANCE * size:
            yield (
                ("loops", index),
                f"does not close at the start: its points are {gap:.6g} m apart, at {_told(here)} and {_told(there)} in the "
                "world",
            )
            continue
        one, other = (end.speed(point) for end, point in zip(ends, points, strict=True))
        if (speed := _length(one - other)) > LOOP_TOLERANCE * (fastest + turning * size):
            yield (
                ("loops", index),
                f"does not stay closed: its points part with {speed:.6g} m/s at the start; the initial velocities must fit",
            )


def _out_of_scale(
    mechanism: Mechanism, frames: Mapping[int, start.Frame], coordinates: tuple[start.Coordinate, ...]
) -> Iterator[tuple[Path, str]]:
    """Yield joints about which the inertia is so small that sums with those of the whole mechanism lose it."""
    mass = sum(start.mass(body) for body in mechanism.bodies)
    reach = max(max(_length(frames[place].origin), _length(start.centre(body))) for place, body in enumerate(mechanism.bodies))
    told: set[int] = set()
    for coordinate in coordinates:
        joint = coordinate.joint
        if joint is None or joint in told or mechanism.joints[joint].form.slides:
            continue
        if mass * reach**2 > MAX_RATIO * coordinate.locked:
            told.add(joint)
            yield (
                ("joints", joint),
                f"the inertia about it is {coordinate.locked:.3g} kg m^2, and all masses times the square of the largest "
                f"distance are {mass * reach**2:.3g} kg m^2; their ratio may be at most {MAX_RATIO:g}",
            )


def _too_large(
    mechanism: Mechanism, frames: Mapping[int, start.Frame], coordinates: tuple[start.Coordinate, ...], duration: float
) -> Iterator[tuple[Path, str]]:
    """Yield quantities of the motion that are so large within a duration (s) that squares and products could overflow."""
    time, gravity, energy, mass, speed, way = (Wide(duration), Wide(mechanism.gravity), *[Wide(0)] * 4)
    for place, body in enumerate(mechanism.bodies):
        frame, centre, own = frames[place], start.centre(body), start.mass(body)
        velocity, spin = frame.speed(centre), frame.turn.T @ frame.spin
        energy += Wide(own * velocity @ velocity + spin @ start.tensor(body) @ spin) / 2
        mass, speed = mass + own, max(speed, _length(velocity))
        way = max(way, _length(frame.point(centre)))
    push = gravity
    for coordinate in coordinates:
        if coordinate.joint is not None and len(mechanism.joints[coordinate.joint].start) == 1:
            joint = mechanism.joints[coordinate.joint]
            force = abs(Wide(joint.effort)) + Wide(joint.stiffness) * (abs(Wide(joint.start[0])) + abs(Wide(joint.rest)))
            push = max(push, force / coordinate.loose)
    way += (speed + push * time) * time
    inertia = [coordinate.locked for coordinate in coordinates]
    sizes: dict[Path, dict[str, tuple[Wide, str]]] = {
        ("bodies",): {
            "kinetic energy at the start": (energy, "J"),
            "largest inertia of a coordinate": (max(inertia, default=Wide(1)), "kg m^2 or kg"),
            "smallest inertia of a coordinate, inverted,": (
                1 / min((coordinate.loose for coordinate in coordinates), default=Wide(1)),
                "1/(kg m^2) or 1/kg",
            ),
        },
        ("run", "duration"): {
            "distance from the origin at the end": (way, "m"),
            "energy at the end": (mass * ((speed + push * time) ** 2 + push * way), "J"),
        },
    }
    for path, quantities in sizes.items():
        for name, (value, unit) in quantities.items():
            if not value <= MAX_SIZE:
                yield path, f"its {name} is {value:.3g} {unit}; at most {MAX_SIZE:g} is allowed"


def _length(vector: start.WideArray) -> Wide:
    """The length of a vector, whose square may be too large or too small for the type."""
    largest = np.abs(vector).max()
    return Wide(largest * np.sqrt(np.square(vector / largest).sum())) if largest else Wide(0)


def _told(place: start.WideArray) -> str:
    return f"[{', '.join(f'{float(part):.6g}' for part in place)}]"
