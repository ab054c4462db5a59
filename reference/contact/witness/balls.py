"""The witness of a sphere, or of a cylinder on its side, alone on a plane.

`rolling` has the equations and the phases, `series` the power series of a step, and `pieces` the states at instants.
"""

from dataclasses import dataclass, replace

import numpy as np

from bodycheck.reference.bounds import STATES
from bodycheck.reference.contact.witness import pieces
from bodycheck.reference.contact.witness.reading import FreeBody, Surface, bodies, surface
from bodycheck.reference.contact.witness.rolling import (
    DECIMALS,
    ROUNDED,
    Moving,
    Round,
    along,
    course,
    slip,
    stopping,
    struck,
)
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.independent.arithmetic import Real, Vector, cross, dot, minus, norm, scaled
from bodycheck.reference.independent.border import MP
from bodycheck.reference.independent.directions import exact_quaternion
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.scene import Cylinder, Ellipsoid, Sphere
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import Instant, Witness

#: The name of the way in results.
NAME = "Newton's and Euler's equations with the force at the point of contact, power series"

#: The smallest and the largest size of numbers, in SI units, for which the series have their digits.
SMALLEST, LARGEST = 1e-20, 1e20


@dataclass(frozen=True, eq=False)
class Begun:
    """A body at t = 0, and the sizes of numbers of the file that count as zero.

    Attributes
    ----------
    moving, airborne
        The body, and whether it flies or hits the plane at t = 0.
    distance, speed, tilt
        The distance from the plane (m), speeds (m/s), and the angle of the axis of a cylinder (rad).
    """

    moving: Moving
    airborne: bool
    distance: float
    speed: float
    tilt: float


def second(scene: AnyScene, times: Array) -> Witness | None:
    """The motion of a sphere, or of a cylinder on its side, alone on a plane, at ascending times (n,) >= 0 (s).

    Returns None for any other scene. Raises `NotModelled` for a motion that these laws do not determine, and `OutOfReach` for
    too many impacts or steps, or numbers of extreme size.
    """
    free = bodies(scene)
    if len(free) != 1 or scene.pushes:
        return None
    (body,), plane = free, surface(scene)
    radius = _radius(body, plane)
    if radius is None:
        return None
    numbers = [*body.position, *body.velocity, *body.rates, radius, MP.mpf(scene.gravity)]
    if not all(SMALLEST <= abs(number) <= LARGEST for number in numbers if number):
        raise OutOfReach("numbers of extreme size")
    gravity: Vector = (MP.mpf(0), MP.mpf(0), -MP.mpf(scene.gravity))
    ratio = body.mass * radius**2 / moment(body)
    whole = Round(radius, ratio, plane, along(gravity, plane.normal), -dot(gravity, plane.normal))
    begun = _begun(whole, body)
    last = float(times.max(initial=0.0))
    parts, events = course(whole, begun.moving, begun.airborne, MP.mpf(last))
    return witness_of(whole, body, begun, pieces.states(parts, times), events, times)


def _radius(body: FreeBody, plane: Surface) -> Real | None:
    match body.shape:
        case Sphere(radius):
            return MP.mpf(radius)
        case Ellipsoid((radius, b, c)) if radius == b == c:
            return MP.mpf(radius)
        case Cylinder(radius, _) if abs(dot(_axis(body), plane.normal)) <= DECIMALS:
            return MP.mpf(radius)
    return None


def _axis(body: FreeBody) -> Vector:
    """The third axis of a body, world frame."""
    return [row[2] for row in body.cosines]


def moment(body: FreeBody) -> Real:
    """The moment of inertia about the axes about which a body rolls. Raises `NotModelled` if there is none."""
    rows = body.tensor
    moments = rows[0][0], rows[1][1], rows[2][2]
    mixed = max(abs(rows[0][1]), abs(rows[0][2]), abs(rows[1][2]))
    equal = isinstance(body.shape, Cylinder) or max(moments) - min(moments) <= ROUNDED * max(moments)
    if not (moments[2] > 0 and equal and mixed <= ROUNDED * max(moments)):
        raise NotModelled("a round body whose moments are not those of its shape")
    return moments[2]


def _begun(body: Round, free: FreeBody) -> Begun:
    """The start of a body. Raises `NotModelled` for one that begins within the plane, or slips where nothing slips."""
    normal = body.surface.normal
    position, velocity = free.position, free.velocity
    given: Vector = [dot(row, free.rates) for row in free.cosines]
    spin, tilt = given, MP.mpf(0)
    if isinstance(free.shape, Cylinder):
        axis = _level_axis(body, _axis(free))
        tilt = norm(minus(axis, _axis(free)))
        velocity, spin = minus(velocity, scaled(axis, dot(velocity, axis))), scaled(axis, free.rates[2])
    height, speed = dot(position, normal) - body.radius, norm(velocity)
    if height < -DECIMALS * body.radius:
        raise NotModelled("a body that begins within the plane")
    touching = height <= DECIMALS * body.radius
    if touching:
        position = minus(position, scaled(normal, height))
    airborne = not touching or abs(dot(velocity, normal)) > DECIMALS * speed
    moving = Moving(MP.mpf(0), position, velocity, spin, (MP.mpf(1), MP.mpf(0), MP.mpf(0), MP.mpf(0)))
    if not airborne:
        moving = replace(moving, velocity=along(velocity, normal))
        slipping = norm(slip(body, moving))
        if not slipping or (body.surface.friction and slipping <= DECIMALS * (speed + body.radius * norm(spin))):
            moving = struck(body, moving, MP.mpf(0), stopping(body, moving))
        elif MP.isinf(body.surface.friction):
            raise NotModelled("a body that slips at the start on a plane on which nothing slips")
    missed = norm(minus(moving.velocity, free.velocity)) + body.radius * norm(minus(moving.spin, given))
    return Begun(moving, airborne, float(abs(height)) if touching else 0.0, float(missed), float(tilt))


def _level_axis(body: Round, axis: Vector) -> Vector:
    """The axis of a cylinder along the plane, and on an incline perpendicular to the fall line.

    Raises `NotModelled` if the axis is not perpendicular to the fall line of an incline.
    """
    steep = norm(body.pull)
    if not steep:
        level = along(axis, body.surface.normal)
        return scaled(level, 1 / norm(level))
    if abs(dot(axis, body.pull)) > DECIMALS * steep:
        raise NotModelled("a cylinder on an incline whose axis is not perpendicular to the fall line")
    across = scaled(cross(body.surface.normal, body.pull), 1 / steep)
    return scaled(across, MP.sign(dot(across, axis)))


def witness_of(
    body: Round, free: FreeBody, begun: Begun, states: pieces.States, events: list[Instant], times: Array
) -> Witness:
    """The witness from the states of a body at times (n,), s, and its events."""
    attitude = pieces.multiplied(states.turn.T, exact_quaternion(free.cosines))
    w, x, y, z = attitude
    back = pieces.multiplied((w, -x, -y, -z), (np.zeros_like(w), *states.spin.T))
    rates = np.stack(pieces.multiplied(back, attitude)[1:], axis=1)
    rolling = float((1 + body.lever) / body.radius)
    fastest = np.sqrt((states.spin * states.spin).sum(axis=1)).astype(float)
    error = states.errors["error"] + pieces.ROUNDINGS + rolling * begun.speed * times + 2 * begun.tilt
    added = {
        "error": error,
        "position_error": states.errors["position_error"] + begun.distance + begun.speed * times,
        "velocity_error": states.errors["velocity_error"] + begun.speed,
        "angular_velocity_error": states.errors["angular_velocity_error"] + rolling * begun.speed + fastest * error,
    }
    return Witness(
        NAME,
        np.stack(attitude, axis=1)[None],
        rates[None],
        states.position[None],
        states.velocity[None],
        **{name: added[name] for name in STATES},
        digits=19,
        events=tuple(events),
    )
