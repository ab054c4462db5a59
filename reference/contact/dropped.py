"""A brick, cylinder or ellipsoid that falls on the plane, with a face, an edge, a corner or a point of its surface.

Until the first touch it is in free flight. The result of an impact at several points does not follow from the laws of rigid
bodies and of friction, and the motion after an impact beside the centre of mass is not computed: from the first touch on, only
inequalities are known.
"""

import math

import numpy as np

from bodycheck.reference.bounds import EPS
from bodycheck.reference.contact.motion import ContactMotion, Event, known_at
from bodycheck.reference.contact.problem import NONE, ContactBody, Problem
from bodycheck.reference.contact_observables import reach
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.exact.start import start
from bodycheck.reference.flight import closed_form
from bodycheck.reference.flight.amplification import amplification
from bodycheck.reference.kinematics import conjugate, rotate
from bodycheck.reference.scene import Body, Brick, Cylinder, Ellipsoid, Quaternion, Scene, Sphere, State, Vector, vector_of
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import WideArray

#: The normal of the plane, along the axes of the plane.
NORMAL = (0.0, 0.0, 1.0)

#: Relative error of a number of the widest type after a few roundings.
ROUNDINGS = 16 * float(np.finfo(Wide).eps)

#: Relative error of a height above the plane.
HEIGHT_ROUNDINGS = 16 * EPS

#: The number of parts into which an interval is divided in the search for the first touch, and the largest number of searches.
PARTS = 128
MAX_SEARCHES = 2000


def motion(problem: Problem, times: Array) -> ContactMotion | None:
    """The motion of a body that falls on the plane, at ascending times (n,) >= 0 (s): NaN from the first touch on.

    If the body lies on an edge or a corner at the start, all states are NaN. Returns None for a sphere, for a body that lies on
    a face or rolls, and with pushes. Raises `NotModelled` for a body that reaches into the plane or falls on a plane with
    infinite friction, since no finite coefficient is large enough for an impact, and `OutOfReach` if the first touch is not
    found.
    """
    if len(problem.bodies) != 1 or problem.pushes:
        return None
    (body,) = problem.bodies
    lowest = _lowest(body)
    if lowest is None:
        return None
    size = float(reach(body.shape, body.quaternion[None], NORMAL)[0])
    gap = float(body.position[2]) - size
    if gap < -NONE * size:
        raise NotModelled("a body that reaches into the plane at the start")
    if gap <= NONE * size and lowest > 2:
        return None
    if math.isinf(problem.pair(0)[0]):
        raise NotModelled("a body that falls on a plane on which nothing slips")
    if gap <= NONE * size:
        return _states(problem, body, times, 0.0, ())
    touch = _first_touch(problem, body, float(times[-1]))
    return _states(problem, body, times, math.inf if touch is None else touch.time - touch.error, (touch,) if touch else ())


def _lowest(body: ContactBody) -> int | None:
    """The number of lowest points of a body: 1 for a corner, 2 for an edge, 4 for a face; None for a sphere.

    An ellipsoid and a cylinder on its side, which can roll, count as 4, so that this way leaves them to others if they touch
    the plane.
    """
    if isinstance(body.shape, Sphere):
        return None
    if isinstance(body.shape, Ellipsoid):
        return 4
    down = np.abs(rotate(conjugate(body.quaternion), np.array(NORMAL, dtype=Wide)))
    if isinstance(body.shape, Cylinder):
        across = np.hypot(down[0], down[1])
        return 4 if min(across, down[2]) <= NONE else 1
    return int(2 ** np.count_nonzero(down <= NONE))


def _flight(problem: Problem, body: ContactBody, times: Array) -> tuple[WideArray, ...]:
    """Positions, velocities (n, 3), quaternions (n, 4) and spins (n, 3) in free flight, and bounds (n,) of the last two."""
    t = times.astype(Wide)[:, None]
    position = body.position + t * (body.velocity + t * problem.gravity / 2)
    velocity = body.velocity + t * problem.gravity
    if not np.any(body.spin):
        still = np.full(len(times), ROUNDINGS)
        return position, velocity, np.tile(body.quaternion, (len(times), 1)), np.zeros_like(position), still, 0 * still
    alone = _alone(body)
    turned = closed_form.flight(alone, times)
    # The closed form starts from doubles, which differ from the numbers of the file by rounding.
    begun = 2 * EPS * np.asarray(amplification(start(alone), times))
    speed = float(np.linalg.norm(body.spin.astype(float)))
    rotation, bounds = turned.motion, turned.bounds
    errors = bounds.error + begun, bounds.angular_velocity_error + begun * speed
    return position, velocity, rotation.quaternion.astype(Wide), rotation.angular_velocity.astype(Wide), *errors


def _alone(body: ContactBody) -> Scene:
    """A scene of the body alone, with its attitude and spin, along the axes of the plane."""
    a, b, c = map(float, body.moments)
    w, x, y, z = map(float, body.quaternion)
    attitude: Quaternion = (w, x, y, z)
    return Scene(Body(float(body.mass), (a, b, c)), State(quaternion=attitude, angular_velocity=vector_of(body.spin)))


def _gaps(problem: Problem, body: ContactBody, times: Array) -> WideArray:
    """Return the heights (n,), m, of a body in free flight above the plane."""
    position, _, quaternion, *_ = _flight(problem, body, times)
    return np.asarray(position[:, 2] - reach(body.shape, quaternion, NORMAL))


def _first_touch(problem: Problem, body: ContactBody, until: float) -> Event | None:
    """The first impact until the time `until` (s); None if there is none.

    Between instants of a grid the gap changes at most at the largest speed of a point of the body, so that no touch between
    them is missed: an interval in which a touch is possible is divided further, until its length is a rounding of the time.
    """
    if not until:
        return None
    until = min(until, _centre_touches(problem, body))
    top = _top_speed(problem, body, until)
    begin, span, searches = 0.0, until, 0
    while span > 4 * EPS * max(begin, span):
        times = begin + span * np.arange(PARTS + 1) / PARTS
        gaps = _gaps(problem, body, times).astype(float)
        possible = np.flatnonzero((gaps[:-1] + gaps[1:] <= top * span / PARTS) | (gaps[1:] <= 0))
        searches += 1
        if searches > MAX_SEARCHES:
            raise OutOfReach("the first touch of a body that comes close to the plane again and again is not found")
        if len(possible):
            begin, span = float(times[possible[0]]), span / PARTS
        elif begin + span >= until:
            return None
        else:
            begin, span = begin + span, min(PARTS * span, until - begin - span)
    return _impact(problem, body, begin)


def _centre_touches(problem: Problem, body: ContactBody) -> float:
    """The time (s) at which the centre of mass would reach the plane, after the first touch; infinite if it never does."""
    height, speed, pull = float(body.position[2]), float(body.velocity[2]), -float(problem.gravity[2])
    if pull:
        return 2 * (speed + math.sqrt(speed**2 + 2 * pull * height)) / pull
    return -2 * height / speed if speed < 0 else math.inf


def _top_speed(problem: Problem, body: ContactBody, until: float) -> float:
    """A bound of the speed (m/s) along the normal of any point of the body until the time `until` (s)."""
    radius = float(np.linalg.norm(_half_lengths(body)))
    low, _, high = sorted(map(float, body.moments))
    # Neither energy nor angular momentum changes in flight, so that the angular velocity does not exceed this.
    spin = float(np.linalg.norm(body.spin.astype(float))) * math.sqrt(high / low)
    return abs(float(body.velocity[2])) + abs(float(problem.gravity[2])) * until + spin * radius


def _half_lengths(body: ContactBody) -> Vector:
    match body.shape:
        case Brick(semi_axes) | Ellipsoid(semi_axes):
            return semi_axes
        case Cylinder(radius, half_length):
            return radius, 0.0, half_length
        case _:
            raise TypeError(body.shape)  # excluded by `_lowest`


def _impact(problem: Problem, body: ContactBody, instant: float) -> Event:
    """Return the first impact as an event at an instant (s). The states after it are not known."""
    position, velocity, quaternion, _, turned, _ = _flight(problem, body, np.array([instant]))
    size = float(reach(body.shape, quaternion, NORMAL)[0])
    high = HEIGHT_ROUNDINGS * (size + float(np.abs(body.position).max())) + float(turned[0]) * size
    step = max(instant, 1e-3) * 1e-6
    before = _gaps(problem, body, np.array([max(instant - step, 0.0)]))[0] - _gaps(problem, body, np.array([instant]))[0]
    closing = max(float(before) / step, math.sqrt(2 * high * abs(float(problem.gravity[2]))), np.finfo(float).tiny)
    unknown = (math.nan, math.nan, math.nan)
    error = 8 * EPS * instant + 2 * high / closing
    return Event("impact", instant, error, 0, vector_of(position[0]), unknown, unknown, -float(velocity[0, 2]))


def _states(problem: Problem, body: ContactBody, times: Array, until: float, events: tuple[Event, ...]) -> ContactMotion:
    """The states of the flight at times (n,), s, which are NaN from the instant `until` (s) on."""
    position, velocity, quaternion, spin, turned, spun = _flight(problem, body, times)
    size = np.abs(body.position).max() + times * (np.abs(body.velocity).max() + times * np.abs(problem.gravity).max())
    speed = np.abs(body.velocity).max() + times * np.abs(problem.gravity).max()
    errors = {
        "error": turned,
        "position_error": ROUNDINGS * size,
        "velocity_error": ROUNDINGS * speed,
        "angular_velocity_error": spun,
    }
    whole = ContactMotion(
        position[None],
        velocity[None],
        quaternion[None],
        spin[None],
        {name: values.astype(float) for name, values in errors.items()},
        events,
        "free flight until the first touch, then inequalities",
        "the motion after an impact beside the centre of mass, or at several points, follows from no law",
    )
    return known_at(whole, times < until)
