"""The motion of a block that lies flat, in pieces of closed forms: it rests, slides straight or slides obliquely.

Between the instants at which pushes begin and end, the block is driven along the plane by a constant force D and pressed on it
by a constant force N. It rests for |D| <= mu N. While it slides, friction mu N is against its velocity.

The resultant of the normal forces acts at the point at which it balances all moments about axes along the plane. With h the
height of the centre of mass, F friction, and w the sum over the pushes of (height of the point) (force along the plane) -
(position of the point along the plane) (force along the normal), this point is at (w - h F) / N from the foot of the centre of
mass. The block tips if the point is outside its face. It turns about the normal unless the moments about the normal are
balanced, including the moment of friction at this point: while nothing turns, friction has the same direction everywhere,
whatever the distribution of the normal forces.
"""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from bodycheck.reference.contact.flat.face import Face, along_plane, exact_quaternion
from bodycheck.reference.contact.flat.oblique import Oblique, at_angle, oblique, state, stop
from bodycheck.reference.contact.problem import NONE, Problem
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import MP, Real, Vector2, real


@dataclass(frozen=True)
class Load:
    """The forces on a block from one instant to another.

    Attributes
    ----------
    start, end
        The instants (s).
    drive, press
        D and N (N).
    lever
        w (N m).
    twist
        The moment of the pushes about the normal (N m).
    moment, pushed
        The sums of the sizes of the pushes, with and without their arms (N m, N). Moments below 1e-12 of these are rounding.
    """

    start: Real
    end: Real
    drive: Vector2
    press: Real
    lever: Vector2
    twist: Real
    moment: Real
    pushed: Real


@dataclass(frozen=True)
class Leg:
    """A piece of the motion.

    Attributes
    ----------
    start, end
        The instants (s).
    position, velocity
        Position (m) and velocity (m/s) at the start, along the plane.
    acceleration
        The acceleration of a straight slide (m/s^2); else zero.
    oblique
        The oblique slide; None for a straight slide or rest.
    rests
        Whether the block rests.
    load
        The forces on the block.
    """

    start: Real
    end: Real
    position: Vector2
    velocity: Vector2
    acceleration: Vector2
    oblique: Oblique | None
    rests: bool
    load: Load


@dataclass(frozen=True)
class Turn:
    """An instant (s) at which the block comes to rest, begins to slip or to tip, with its position (m) and velocity (m/s)."""

    kind: Literal["rest", "slip", "tip"]
    time: Real
    position: Vector2
    velocity: Vector2


def loads(problem: Problem) -> Iterator[Load]:
    """Yield the forces on the only body of a problem, piece by piece, from 0 to infinity.

    Raises `NotModelled` if the body lifts off.
    """
    body, quaternion = problem.bodies[0], exact_quaternion(problem.bodies[0].quaternion)
    instants = {MP.mpf(0), MP.inf}
    for push in problem.pushes:
        instants |= {MP.mpf(push.start), MP.mpf(push.end)}
    ordered = sorted(instants)
    mass, incline = real(body.mass), MP.mpf(problem.plane.incline)
    weight = mass * MP.hypot(*map(real, problem.gravity[::2]))
    for start, end in itertools.pairwise(ordered):
        x, y, press = weight * MP.sin(incline), MP.mpf(0), weight * MP.cos(incline)
        u, v, twist, moment, pushed = (MP.mpf(0) for _ in range(5))
        for push in problem.pushes:
            if push.start <= start < push.end:
                fx, fy, fz = map(MP.mpf, push.force)
                px, py, pz = along_plane(quaternion, push.point)
                x, y, press = x + fx, y + fy, press - fz
                u, v = u + pz * fx - px * fz, v + pz * fy - py * fz
                twist += px * fy - py * fx
                size = MP.sqrt(fx * fx + fy * fy + fz * fz)
                moment, pushed = moment + size * MP.sqrt(px * px + py * py + pz * pz), pushed + size
        if press <= 0:
            raise NotModelled("a block that nothing presses on the plane")
        yield Load(start, end, (x, y), press, (u, v), twist, moment, pushed)


def legs(problem: Problem, face: Face, position: Vector2, velocity: Vector2) -> tuple[list[Leg], list[Turn]]:
    """The motion of a block from a position (m) and velocity (m/s), to infinity or to the onset of tipping, and its events.

    Raises `NotModelled` if the block turns about the normal, lifts off, or moves on a plane on which nothing slips.
    """
    friction, mass = problem.pair(0)[0], real(problem.bodies[0].mass)
    path: list[Leg] = []
    turns: list[Turn] = []
    for load in loads(problem):
        time = load.start
        while time < load.end:
            leg = _leg(load, friction, mass, face, time, position, velocity)
            tips = _tips(leg, face, friction)
            if tips == leg.start:
                return path, [*turns, Turn("tip", tips, position, velocity)]
            if (kind := _begins(path, leg)) is not None:
                turns.append(Turn(kind, time, position, velocity))
            if tips is not None:
                return [*path, replace(leg, end=tips)], [*turns, Turn("tip", tips, *at(replace(leg, end=MP.inf), tips))]
            path.append(leg)
            if leg.end == MP.inf:
                return path, turns
            time = leg.end
            position, velocity = at(leg, time)
    return path, turns


def at(leg: Leg, time: Real) -> tuple[Vector2, Vector2]:
    """Position (m) and velocity (m/s) at an instant (s) of a leg; the velocity is exactly zero at the end of a stop."""
    passed = time - leg.start
    (x, y), (u, v), (a, b) = leg.position, leg.velocity, leg.acceleration
    stopped = time == leg.end and time < leg.load.end
    if leg.oblique is not None:
        (dx, dy), speed = state(leg.oblique, MP.inf if stopped else passed)
        return (x + dx, y + dy), speed
    position = x + passed * (u + a * passed / 2), y + passed * (v + b * passed / 2)
    return position, (MP.mpf(0), MP.mpf(0)) if stopped else (u + a * passed, v + b * passed)


def _begins(path: Sequence[Leg], leg: Leg) -> Literal["rest", "slip"] | None:
    """Return the kind of event with which a leg begins, or None if it begins without an event. path: the legs before."""
    if leg.rests:
        return "rest" if path and not path[-1].rests else None
    return None if any(leg.velocity) else "slip"


def _leg(load: Load, friction: float, mass: Real, face: Face, time: Real, position: Vector2, velocity: Vector2) -> Leg:
    """The leg that begins at a time (s) with a position (m) and a velocity (m/s). Raises `NotModelled` as `legs` does."""
    (x, y), (u, v), none = load.drive, velocity, (MP.mpf(0), MP.mpf(0))
    moves = bool(u or v)
    if math.isinf(friction):
        if moves:
            raise NotModelled("a block that moves along a plane on which nothing slips")
        return _checked(Leg(time, load.end, position, none, none, None, True, load), face, MP.mpf(0))
    brake = MP.mpf(friction) * load.press
    if not moves and x * x + y * y <= brake * brake:
        return _checked(Leg(time, load.end, position, none, none, None, True, load), face, brake)
    if moves and x * v != y * u:
        slide = oblique(velocity, (x / mass, y / mass), brake / mass)
        return _checked(Leg(time, min(load.end, time + stop(slide)), position, velocity, none, slide, False, load), face, brake)
    dx, dy = _unit(velocity if moves else load.drive)
    a, b = (x - brake * dx) / mass, (y - brake * dy) / mass
    gained = a * dx + b * dy
    end = time - (u * dx + v * dy) / gained if moves and gained < 0 else MP.inf
    return _checked(Leg(time, min(load.end, end), position, velocity, (a, b), None, False, load), face, brake)


def _checked(leg: Leg, face: Face, brake: Real) -> Leg:
    """Return the leg if the moments about the normal are balanced along it. Raises `NotModelled` if they are not."""
    load = leg.load
    limit = NONE * (load.moment + face.height * load.pushed)
    (u, v), twist = load.lever, load.twist
    if leg.oblique is not None:
        turns = MP.hypot(u, v) > limit or abs(twist) > limit
    else:
        fx, fy = _friction(leg, brake)
        turns = abs(twist + (u * fy - v * fx) / load.press) > limit
    if turns:
        raise NotModelled("a push that turns a block about the normal of the plane")
    return leg


def _friction(leg: Leg, brake: Real) -> Vector2:
    """The force of friction (N) at the start of a leg. brake: its size while the block slides."""
    x, y = leg.load.drive
    if leg.rests:
        return -x, -y
    dx, dy = _unit(leg.velocity if any(leg.velocity) else leg.load.drive)
    return -brake * dx, -brake * dy


def _tips(leg: Leg, face: Face, friction: float) -> Real | None:
    """The instant (s) of a leg at which the block begins to tip, or None if it does not tip."""
    load = leg.load
    brake = MP.mpf(0) if leg.rests else MP.mpf(friction) * load.press
    (u, v), (fx, fy) = load.lever, _friction(leg, brake)
    if not face.bears((u - face.height * fx) / load.press, (v - face.height * fy) / load.press):
        return leg.start
    slide = leg.oblique
    if slide is None:
        return None
    first, last = MP.atan2(*reversed(leg.velocity)), MP.atan2(*reversed(slide.along))
    last += 2 * MP.pi * MP.nint((first - last) / (2 * MP.pi))
    way = face.leaves(face.height * MP.mpf(friction), first, last)
    if way is None or way == last:  # the velocity reaches the direction of the force at infinity, or at the stop
        return None
    tips = leg.start + at_angle(slide, abs(last - way))
    return tips if tips < leg.end else None


def _unit(vector: Vector2) -> Vector2:
    x, y = vector
    size = MP.hypot(x, y)
    return x / size, y / size
