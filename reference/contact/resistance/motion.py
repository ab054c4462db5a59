"""The motion of one sphere on a plane with rolling or torsional friction, leg by leg until it rests."""

import math
from dataclasses import dataclass, field, replace

import numpy as np

from bodycheck.reference.contact.motion import ContactMotion, Event, EventKind, Interface
from bodycheck.reference.contact.problem import NONE, ContactBody, Problem
from bodycheck.reference.contact.resistance.curved import curved
from bodycheck.reference.contact.resistance.laws import Pose, Resisted, resisted, velocity_and_spin
from bodycheck.reference.contact.resistance.straight import DOWNHILL, Straight, along_a_line, steady, unbraked
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.exact.numbers import Wide, wide
from bodycheck.reference.kinematics import conjugate, multiply, normalise, rotate
from bodycheck.reference.mechanisms.mechanism import WORLD, PairContact
from bodycheck.reference.scene import Plane, Sphere, vector_of
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import WideArray

#: The names of the equations.
CLOSED = "closed form: a sphere that slips, rolls and pivots along a line, with rolling and torsional friction"
INTEGRATED = "a sphere that slips, rolls and pivots with rolling and torsional friction, Gauss-Legendre collocation"

REASON = "a sphere touches at a point, and the law of friction gives the force and the moments there from its velocities"

#: The number of roundings of a state in a leg, relative to the largest speed.
ROUNDINGS = 64.0

#: The factor by which the error of integrated velocities may exceed the sum of the last terms of all steps.
SAFETY = 8.0

#: The largest number of legs.
MOST_LEGS = 100


@dataclass(eq=False)
class _Course:
    """The states at instants (n,) that are known so far, and what has happened until then.

    Attributes
    ----------
    errors, velocity_error
        The errors of velocities (n,), m/s, at the instants and so far, without roundings.
    speed, slowing
        The sum of all velocities at the start (m/s), and the rate at which the last one has vanished that has (m/s^2).
    grips
        The friction that the legs without slip need; infinite for a leg with slip.
    """

    times: WideArray
    position: WideArray
    velocity: WideArray
    spin: WideArray
    turn: WideArray
    errors: Array
    velocity_error: float
    speed: float
    slowing: float = math.inf
    row: int = 0
    events: list[Event] = field(default_factory=list)
    grips: list[float] = field(default_factory=list)
    integrated: bool = False


def sphere(problem: Problem, times: Array) -> ContactMotion | None:
    """The motion of one sphere with rolling or torsional friction at ascending times (n,) >= 0 (s).

    Returns None for a problem without such friction. Raises `NotModelled` for any other body with it, for a sphere that is not
    on the plane at the start, and for a sphere whose moments of inertia differ.
    """
    laws: tuple[Plane | PairContact, ...] = (problem.plane, *problem.contacts)
    if not any(law.rolling_friction or law.torsional_friction for law in laws):
        return None
    body, radius = _sphere(problem)
    law = problem.contact(0)
    whole = resisted(problem, body, radius, law)
    start, missed, height = _start(whole, body)
    count = len(times)
    course = _Course(
        times.astype(Wide),
        np.zeros((count, 3), Wide),
        np.zeros((count, 3), Wide),
        np.zeros((count, 3), Wide),
        np.zeros((count, 4), Wide),
        np.full(count, float(missed)),
        float(missed),
        float(np.abs(start.velocities).sum()),
    )
    _followed(whole, start, course)
    quaternion = normalise(multiply(course.turn, body.quaternion))
    rests = start.still and whole.holds
    return ContactMotion(
        course.position[None],
        course.velocity[None],
        quaternion[None],
        rotate(conjugate(quaternion), course.spin)[None],
        _bounds(whole, course, height),
        tuple(course.events),
        INTEGRATED if course.integrated else CLOSED,
        REASON,
        0.0 if math.inf in course.grips else max(course.grips, default=0.0),
        (Interface((WORLD, 0), float(whole.mass * whole.load)),) if rests else (),
    )


def _sphere(problem: Problem) -> tuple[ContactBody, float]:
    """The only body, and its radius (m). Raises `NotModelled` for any other problem."""
    body = problem.bodies[0]
    if len(problem.bodies) > 1 or not isinstance(body.shape, Sphere):
        raise NotModelled("rolling or torsional friction of anything but one sphere on the plane")
    if problem.pushes:
        raise NotModelled("pushes on a sphere with rolling or torsional friction")
    if len(set(body.moments.tolist())) != 1:
        raise NotModelled("a sphere on a plane whose moments of inertia differ")
    return body, body.shape.radius


def _start(whole: Resisted, body: ContactBody) -> tuple[Pose, Wide, Wide]:
    """The sphere at t = 0, and the sizes of the velocities (m/s) and of the distance (m) that are taken to be zero."""
    r, v, w = wide(whole.radius), body.velocity, rotate(body.quaternion, body.spin)
    height, speed = body.position[2] - r, np.sqrt(v @ v)
    if abs(height) > NONE * r or abs(v[2]) > NONE * speed:
        raise NotModelled("a sphere with rolling or torsional friction that is not on the plane at the start")
    position, none = body.position.copy(), np.zeros(2, Wide)
    position[2] = r
    rolling = r * np.array([w[1], -w[0]])
    slip, missed = v[:2] - rolling, abs(v[2])
    scale = speed + r * np.sqrt(w @ w)
    if 0 < np.abs(slip).max() <= NONE * scale:
        slip, missed = none, missed + np.abs(slip).sum()
    if slip.any() and not np.isfinite(float(whole.friction)):
        raise NotModelled("a body that slips at the start on a plane on which nothing slips")
    identity = np.array([1, 0, 0, 0], Wide)
    return Pose(Wide(0), position, identity, slip, rolling, r * w[2]), missed, abs(height)


def _followed(whole: Resisted, start: Pose, course: _Course) -> None:
    """Fill in the states of a course."""
    last = course.times.max(initial=Wide(0))
    pose, slipped = start, whole.one or bool(start.slip.any())
    for number in range(MOST_LEGS):
        if number and pose.time > last:
            return
        if pose.still and (whole.holds or not whole.load):
            if number:
                _event(whole, course, "rest", pose)
            _fill(whole, course, Straight(pose, np.zeros(5, Wide)), Wide(np.inf))
            return
        leg = _leg(whole, pose)
        course.velocity_error += 0.0 if leg is None else leg.error
        slips = whole.one or bool(pose.slip.any()) or (leg is not None and bool(leg.rates[:2].any()))
        if number and slips != slipped:
            _event(whole, course, "slip" if slips else "roll", pose)
        slipped = slips
        course.grips.append(math.inf if slips else 0.0 if leg is None else leg.grip)
        if leg is None:
            pose = _integrated(whole, course, pose, last)
            continue
        lasting = leg.lasting()
        _fill(whole, course, leg, lasting)
        if not pose.time + lasting <= last:
            return
        pose = leg.ended(wide(whole.radius), lasting)
    raise OutOfReach(f"a sphere with more than {MOST_LEGS} changes of its motion")


def _leg(whole: Resisted, pose: Pose) -> Straight | None:
    """The leg with constant accelerations that begins with a pose, or None."""
    if not whole.load or not (whole.friction or whole.rolling):
        return unbraked(whole, pose)
    if not whole.one:
        directions = [vector for vector in (pose.slip, pose.rolling) if vector.any()]
        direction = DOWNHILL if whole.downhill or not directions else directions[0] / np.hypot(*directions[0])
        aside = [abs(vector[0] * direction[1] - vector[1] * direction[0]) > NONE * np.hypot(*vector) for vector in directions]
        return None if any(aside) else along_a_line(whole, pose, direction)
    return steady(whole, pose)


def _fill(whole: Resisted, course: _Course, leg: Straight, lasting: Wide) -> None:
    """Fill in the states at the instants of a leg."""
    inside = int(np.searchsorted(course.times, leg.start.time + lasting, side="right"))
    rows = slice(course.row, inside)
    position, velocity, spin, turn = leg.states(wide(whole.radius), course.times[rows] - leg.start.time)
    course.position[rows], course.velocity[rows], course.spin[rows], course.turn[rows] = position, velocity, spin, turn
    course.errors[rows] = course.velocity_error
    course.row = inside
    slowing = [abs(a) for v, a in zip(leg.start.velocities, leg.rates, strict=True) if v * a < 0]
    course.slowing = float((max if leg.together else min)(slowing, default=Wide(np.inf)))


def _integrated(whole: Resisted, course: _Course, pose: Pose, last: Wide) -> Pose:
    """Fill in the states of a leg that is integrated, and return its end."""
    stops = wide(whole.pivoting * whole.load / whole.ratio)
    until = pose.time + abs(pose.pivoting) / stops if pose.pivoting and stops and not whole.one else Wide(np.inf)
    leg = curved(whole, pose, course.times[course.row :], min(until, np.nextafter(last, Wide(np.inf))))
    course.integrated = True
    course.velocity_error += SAFETY * leg.error
    rows = slice(course.row, course.row + len(leg.turn))
    course.position[rows], course.velocity[rows], course.spin[rows], course.turn[rows] = (
        leg.position,
        leg.velocity,
        leg.spin,
        leg.turn,
    )
    course.errors[rows] = course.velocity_error
    course.row = rows.stop
    course.slowing = leg.slowing
    return replace(leg.end, pivoting=Wide(0)) if leg.end.time >= until else leg.end


def _event(whole: Resisted, course: _Course, kind: EventKind, pose: Pose) -> None:
    """Append an event. Its time is as uncertain as the velocity that has vanished, over the rate of this velocity."""
    (velocity,), (spin,) = velocity_and_spin(wide(whole.radius), pose.velocities[None])
    roundings = ROUNDINGS * float(np.finfo(Wide).eps) * (len(course.grips) + 1)
    late = float(1 + 1 / whole.ratio) * (course.velocity_error + roundings * course.speed) / course.slowing
    error = late + roundings * float(pose.time)
    position, fast, turning = (vector_of(each) for each in (pose.position, velocity, spin))
    course.events.append(Event(kind, float(pose.time), error, 0, position, fast, turning))


def _bounds(whole: Resisted, course: _Course, height: Wide) -> dict[str, Array]:
    """The bounds (n,) of the errors of the states, by the names of `bounds.STATES`.

    Errors of the velocities do not grow, as the kinetic energy of the difference of two motions does not.
    """
    times = course.times.astype(float)
    roundings = ROUNDINGS * float(np.finfo(Wide).eps) * (len(course.grips) + 1)
    turning = float((1 + 1 / whole.ratio) / whole.radius)
    speed = 4 * (course.speed + float(whole.downhill) * times)
    fast = course.errors + roundings * speed
    far = times * fast + roundings * float(whole.radius)
    size = np.sqrt((course.position * course.position).sum(axis=1)).astype(float)
    return {
        "error": roundings + turning * times * fast,
        "position_error": far + roundings * size + float(height),
        "velocity_error": fast,
        "angular_velocity_error": turning * fast,
    }
