"""A box on a level plane that is pushed by a constant force through its centre of mass, with spheres at rest on its top.

A sphere of mass m, radius R and moment of inertia k m R^2 is on a box with the acceleration A. If the sphere has the
acceleration a, its friction is m a. The angular acceleration w follows from k m R^2 w = R m a, so that the lowest point of the
sphere has the acceleration a + a / k. Without slip this is equal to A, so that a = k A / (1 + k), which is 2 A / 7 for a
homogeneous sphere. If m a exceeded mu m g, the sphere slips, and a = mu g. For a box that slides, M A = F - mu (M + sum m) g -
sum m a.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from bodycheck.reference.bounds import EPS
from bodycheck.reference.contact.motion import ContactMotion, Event, EventKind
from bodycheck.reference.contact.piles.upright import Upright, margin, upright
from bodycheck.reference.contact.problem import NONE, ContactBody, Problem, holds
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import MP, Real, Wide, real, wide
from bodycheck.reference.kinematics import about, conjugate, multiply, rotate
from bodycheck.reference.scene import Brick, Sphere, vector_of
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import END, Instant, WideArray

#: Relative error of a number of the widest type after a few roundings.
ROUNDINGS = 16 * float(np.finfo(Wide).eps)


@dataclass(frozen=True, eq=False)
class Pushed:
    """A box with spheres on it.

    Attributes
    ----------
    problem
        The problem with all bodies.
    box, balls
        The indices of the box and of the spheres.
    faces
        The faces of all bodies, in the order of the bodies.
    direction
        (2,) unit vector along the push, in the plane.
    force
        Size of the push (N).
    """

    problem: Problem
    box: int
    balls: tuple[int, ...]
    faces: tuple[Upright, ...]
    direction: WideArray
    force: Real

    def across(self, ball: int) -> Wide:
        """The signed distance (m) of a sphere from the line of the push."""
        x, y = self.faces[ball].centre - self.faces[self.box].centre
        return Wide(self.direction[0] * y - self.direction[1] * x)


@dataclass(frozen=True, eq=False)
class Accelerations:
    """Accelerations (b,) of all bodies along the push (m/s^2), and the smallest friction of the contacts that do not slip."""

    along: WideArray
    friction: float


def motion(problem: Problem, times: Array) -> ContactMotion | None:
    """The motion of a pushed box with spheres on it, at ascending times (n,) >= 0 (s); None for any other problem.

    The states are NaN from the instant on at which the push ends, a sphere leaves the box or touches another sphere, or the box
    tips. Raises `NotModelled` for a box that turns or tips from the start.
    """
    scene = _recognised(problem)
    if scene is None:
        return None
    solution = accelerations(scene)
    _check_straight(scene, solution)
    until, kind, index = _end(scene, solution)
    states = _states(scene, solution, times, until)
    if until > times[-1]:
        return states
    if kind is None:
        return replace(states, end=Instant(END, until, 4 * EPS * until, index))
    at_end = _states(scene, solution, np.array([until]), math.inf)
    position, velocity = (vector_of(rows[index, 0]) for rows in (at_end.position, at_end.velocity))
    spin = vector_of(rotate(at_end.quaternion, at_end.spin)[index, 0])
    return replace(states, events=(Event(kind, until, 4 * EPS * until, index, position, velocity, spin),))


def _recognised(problem: Problem) -> Pushed | None:
    """The box and its spheres; None for any other problem."""
    bricks = [index for index, body in enumerate(problem.bodies) if isinstance(body.shape, Brick)]
    balls = tuple(index for index, body in enumerate(problem.bodies) if isinstance(body.shape, Sphere))
    faces = tuple(face for body in problem.bodies if (face := upright(body)) is not None)
    if len(bricks) != 1 or not balls or len(balls) + 1 < len(problem.bodies) or len(faces) < len(problem.bodies):
        return None
    if problem.plane.incline or not problem.gravity[2] or len(problem.pushes) != 1:
        return None
    if any(np.any(body.velocity) or np.any(body.spin) for body in problem.bodies):
        return None
    push = problem.pushes[0]
    x, y, z = push.force
    if push.body != bricks[0] or push.start or z or any(push.point) or not (x or y):
        return None
    if not all(_isotropic(problem.bodies[index]) for index in balls) or not _on_top(faces, bricks[0], balls):
        return None
    force = MP.hypot(MP.mpf(x), MP.mpf(y))
    direction = np.array([wide(MP.mpf(x) / force), wide(MP.mpf(y) / force)], dtype=Wide)
    return Pushed(problem, bricks[0], balls, faces, direction, force)


def _isotropic(body: ContactBody) -> bool:
    first, second, third = body.moments
    return bool(first == second == third)


def _on_top(faces: tuple[Upright, ...], box: int, balls: tuple[int, ...]) -> bool:
    """Return whether the box stands on the plane, and all spheres on its top without touching each other."""
    under = faces[box]
    near = NONE * max(face.size for face in faces)
    if abs(under.bottom) > near:
        return False
    if any(abs(faces[ball].bottom - under.top) > near or margin(under, faces[ball].centre) <= near for ball in balls):
        return False
    pairs = ((faces[one], faces[other]) for index, one in enumerate(balls) for other in balls[index + 1 :])
    return all(np.sum((one.centre - other.centre) ** 2) > _touching(one, other) * (1 + Wide(NONE)) for one, other in pairs)


def _touching(one: Upright, other: Upright) -> Wide:
    """The square of the distance (m^2), along the face, of two touching spheres on the face: (R + r)^2 - (R - r)^2."""
    return Wide(4 * one.half[0] * other.half[0])


def _roundness(body: ContactBody) -> Real:
    """The ratio k = I / (m R^2) of a sphere, with its moment of inertia I; 2/5 for a homogeneous sphere."""
    assert isinstance(body.shape, Sphere)
    return real(body.moments[0]) / (real(body.mass) * MP.mpf(body.shape.radius) ** 2)


def accelerations(scene: Pushed) -> Accelerations:
    """The accelerations along the push. Which spheres roll and whether the box slides is decided with a hundred digits.

    The force that all bodies require grows with the acceleration of the box, so that only one acceleration balances the push.
    """
    problem, box = scene.problem, scene.box
    gravity = -real(problem.gravity[2])
    masses = [real(body.mass) for body in problem.bodies]
    weight, friction = gravity * sum(masses), problem.pair(box)[0]
    if holds(friction, scene.force, weight):
        return Accelerations(np.zeros(len(masses), dtype=Wide), float(scene.force / weight))
    shares = {ball: (k := _roundness(problem.bodies[ball])) / (1 + k) for ball in scene.balls}
    limits = {ball: MP.mpf(problem.pair(box, ball)[0]) * gravity for ball in scene.balls}
    order = sorted(scene.balls, key=lambda ball: limits[ball] / shares[ball])
    left, rolling = scene.force - MP.mpf(friction) * weight, list(order)

    def inertia() -> Real:
        return masses[box] + sum(masses[ball] * shares[ball] for ball in rolling)

    while rolling and shares[rolling[0]] * left > limits[rolling[0]] * inertia():
        ball = rolling.pop(0)
        left -= masses[ball] * limits[ball]
    fast = left / inertia()
    along = [
        fast if index == box else shares[index] * fast if index in rolling else limits[index] for index in range(len(masses))
    ]
    needed = max((along[ball] / gravity for ball in rolling), default=MP.mpf(0))
    return Accelerations(np.array([wide(value) for value in along], dtype=Wide), float(needed))


def _check_straight(scene: Pushed, solution: Accelerations) -> None:
    """Raise `NotModelled` if the friction of the plane and of the spheres turns the box about the normal.

    The friction of the plane acts at the centre of the load, so that each sphere contributes the moment (a + mu g) m times its
    distance from the line of the push. If friction holds the box, the push divided by all masses replaces mu g.
    """
    problem = scene.problem
    mass = float(sum(body.mass for body in problem.bodies))
    held = min(problem.pair(scene.box)[0] * -float(problem.gravity[2]), float(scene.force) / mass)
    moments = [(solution.along[ball] + held) * problem.bodies[ball].mass for ball in scene.balls]
    turning = sum(moment * scene.across(ball) for moment, ball in zip(moments, scene.balls, strict=True))
    if abs(turning) > NONE * sum(moments) * scene.faces[scene.box].size:
        raise NotModelled("a pushed box with loads beside the line of the push, which turns")


def _end(scene: Pushed, solution: Accelerations) -> tuple[float, EventKind | None, int]:
    """The instant (s) at which the accelerations change, the kind of event (None if it is none), and the index of the body."""
    relative = solution.along - solution.along[scene.box]
    under = scene.faces[scene.box]
    ends: list[tuple[Wide, EventKind | None, int]] = [(_tipping(scene, solution, relative), "tip", scene.box)]
    for index, ball in enumerate(scene.balls):
        gone = _leaving(under, scene.faces[ball].centre, relative[ball] * scene.direction)
        ends.append((gone, None, ball))
        ends += [(_meeting(scene, ball, other, relative), "impact", ball) for other in scene.balls[:index]]
    half_square, kind, body = min(ends, key=lambda end: end[0])
    instant = float(np.sqrt(2 * half_square))
    pushed_until = scene.problem.pushes[0].end
    return (instant, kind, body) if instant <= pushed_until else (pushed_until, None, scene.box)


def _leaving(face: Upright, point: WideArray, rate: WideArray) -> Wide:
    """Half the square of the time (s^2) at which a point (2,), at rest at first, leaves a face; infinite if it never does.

    rate: (2,) its acceleration relative to the face (m/s^2).
    """
    places, rates = face.sides @ (point - face.centre), face.sides @ rate
    leaving = [
        (half - np.sign(speed) * coordinate) / abs(speed)
        for half, coordinate, speed in zip(face.half, places, rates, strict=True)
        if speed
    ]
    return min(leaving, default=Wide(np.inf))


def _meeting(scene: Pushed, one: int, other: int, relative: WideArray) -> Wide:
    """Half the square of the time (s^2) at which two spheres touch each other; infinite if they never do.

    relative: (b,) accelerations relative to the box, along the push (m/s^2).
    """
    apart = scene.faces[one].centre - scene.faces[other].centre
    rate = relative[one] - relative[other]
    closing = -(apart @ scene.direction) * rate
    beyond = apart @ apart - _touching(scene.faces[one], scene.faces[other])
    square = closing**2 - rate**2 * beyond
    if closing <= 0 or square < 0:
        return Wide(np.inf)
    return Wide(beyond / (closing + np.sqrt(square)))


def _tipping(scene: Pushed, solution: Accelerations, relative: WideArray) -> Wide:
    """Half the square of the time (s^2) at which the centre of the load leaves the base of the box; infinite if it never does.

    The load balances the moments about the box's centre of mass by the spheres' weights and by the friction above and below it.
    relative: as for `_meeting`. Raises `NotModelled` if the box tips from the start.
    """
    problem, face = scene.problem, scene.faces[scene.box]
    masses = np.array([body.mass for body in problem.bodies])
    taken = masses * solution.along
    pushed = wide(scene.force) - sum(taken)
    upper = sum(taken) - taken[scene.box]
    shift = (face.top - face.bottom) / 2 * (pushed - upper) / -problem.gravity[2] * scene.direction
    offsets = sum(masses[ball] * (scene.faces[ball].centre - face.centre) for ball in scene.balls)
    begin = face.centre + (offsets + shift) / sum(masses)
    if margin(face, begin) <= NONE * face.size:
        raise NotModelled("a pushed box that tips over")
    return _leaving(face, begin, (masses * relative).sum() / sum(masses) * scene.direction)


def _states(scene: Pushed, solution: Accelerations, times: Array, until: float) -> ContactMotion:
    """The motion at times (n,), s, with NaN from the instant `until` (s) on."""
    problem, t = scene.problem, times.astype(Wide)
    t[times >= until] = np.nan
    along = np.append(scene.direction, Wide(0))
    axis = np.array([-along[1], along[0], Wide(0)])
    shape = (len(problem.bodies), len(times))
    position, velocity, spin = (np.zeros((*shape, 3), dtype=Wide) for _ in range(3))
    quaternion, angles = np.zeros((*shape, 4), dtype=Wide), np.zeros(shape, dtype=Wide)
    for index, body in enumerate(problem.bodies):
        acceleration = solution.along[index]
        position[index] = body.position + np.multiply.outer(acceleration * t * t / 2, along)
        velocity[index] = np.multiply.outer(acceleration * t, along)
        # Friction acts at the lowest point, in the direction of motion, so that a sphere turns against the sense in which it
        # would roll on the plane.
        rate = Wide(0) if index == scene.box else -acceleration / (wide(_roundness(body)) * scene.faces[index].half[0])
        angles[index] = rate * t * t / 2
        turn = about(axis, angles[index])
        quaternion[index] = multiply(turn, np.broadcast_to(body.quaternion, turn.shape))
        spin[index] = rotate(conjugate(quaternion[index]), np.multiply.outer(rate * t, axis))
    speeds, rates = (np.abs(rows).max(axis=(0, 2)) for rows in (velocity, spin))
    gap = max(abs(float(scene.faces[ball].bottom - scene.faces[scene.box].top)) for ball in scene.balls)
    tilt = scene.faces[scene.box].tilt
    left = gap + abs(float(scene.faces[scene.box].bottom)) + tilt * scene.faces[scene.box].size
    angle = np.abs(angles).max(axis=0)
    errors = {
        "error": tilt + ROUNDINGS * (1 + angle),
        "position_error": left + ROUNDINGS * np.abs(position).max(axis=(0, 2)),
        "velocity_error": ROUNDINGS * speeds,
        "angular_velocity_error": ROUNDINGS * rates * (1 + angle),
    }
    return ContactMotion(
        position,
        velocity,
        quaternion,
        spin,
        {name: np.asarray(values.astype(float)) for name, values in errors.items()},
        (),
        "closed form: Newton and Euler",
        "all accelerations are constant while box and spheres slide or roll on",
        friction=solution.friction,
    )
