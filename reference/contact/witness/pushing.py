"""The witness of a box that is pushed under spheres: Newton's and Euler's equations with the acceleration of the box bisected.

Friction f at the lowest point of a sphere of mass m, radius R and moment I gives this point the acceleration f (1/m + R^2/I).
The sphere rolls with the force that this needs to follow the box, or slips with the largest friction. The force that the box
needs for itself, the spheres and the plane grows with its acceleration, which is found by bisection. All accelerations are
constant, so that the conditions of the motion are quadratic functions of half the square of the time.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.bounds import EPS
from bodycheck.reference.contact.witness.faces import (
    AXES,
    DECIMALS,
    STILL,
    along_axes,
    axis,
    half_lengths,
    numbers,
    wide_vector,
)
from bodycheck.reference.contact.witness.reading import bodies, surface
from bodycheck.reference.contact.witness.standing import Standing, friction_of, standing
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.independent.arithmetic import (
    WIDE_EPS,
    Real,
    Vector,
    Wide,
    applied,
    cross,
    dot,
    minus,
    norm,
    plus,
    scaled,
    transposed,
    wide,
    wide_matrix,
)
from bodycheck.reference.independent.border import MP
from bodycheck.reference.independent.directions import quaternion_of
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene
from bodycheck.reference.scene import Brick, Push, Sphere
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import END, Instant, WideArray, Witness

#: Name of the way in results.
NAME = "Newton's and Euler's equations, bisection"

#: The number of roundings of a state in the wide type.
ROUNDINGS = 16.0

#: The number of bisections: as many as the arithmetic has bits.
HALVINGS = 340


@dataclass(frozen=True, eq=False)
class Pushed:
    """A box with spheres on it, by their indices among all bodies.

    Attributes
    ----------
    stands
        All bodies.
    box, balls
        The indices of the box and of the spheres.
    push
        The force on the box (N).
    gravity
        The gravitational acceleration (m/s^2).
    plane
        The coefficient of friction of the box and the plane.
    rough
        The coefficients of friction of the box and the spheres, in the order of all bodies.
    gap
        The largest distance of two bodies that touch, which counts as zero (m).
    """

    stands: list[Standing]
    box: int
    balls: list[int]
    push: Vector
    gravity: Real
    plane: Real
    rough: list[Real]
    gap: float

    @property
    def masses(self) -> list[Real]:
        """The masses of all bodies (kg)."""
        return [stand.body.mass for stand in self.stands]

    def radius(self, ball: int) -> Real:
        """The radius of a sphere (m)."""
        return self.stands[ball].height


@dataclass(frozen=True, eq=False)
class End:
    """An end of the motion: half the square of its time (s^2), the kind of the event (`END` if it is none), and its body."""

    half_square: Real
    kind: str
    body: int


def second(scene: AnyScene, times: Array) -> Witness | None:
    """The motion of a pushed box with spheres on it at ascending times (n,) >= 0 (s), to its end; None for another scene.

    Raises `NotModelled` if the box turns about the normal.
    """
    pushed = _pushed(scene)
    if pushed is None:
        return None
    along = _accelerations(pushed)
    ahead = scaled(pushed.push, 1 / norm(pushed.push))
    forces = [scaled(ahead, rate * mass) for rate, mass in zip(along, pushed.masses, strict=True)]
    end = min(_ends(pushed, forces), key=lambda each: each.half_square, default=End(MP.inf, END, 0))
    until, kind, body = float(MP.sqrt(2 * end.half_square)), end.kind, end.body
    if (released := scene.pushes[0].end) < until:
        until, kind, body = released, END, pushed.box
    events = (Instant(kind, until, 4 * EPS * until, body),) if until <= times[-1] else ()
    return _witness(pushed, forces, np.where(times < until, times, np.nan), events)


def _pushed(scene: AnyScene) -> Pushed | None:
    """The box and its spheres; None for a scene of another kind."""
    free, normal = bodies(scene), surface(scene).normal
    if normal[0] or not scene.gravity or len(scene.pushes) != 1 or any(any(body.velocity) or any(body.rates) for body in free):
        return None
    (push,) = scene.pushes
    stands = [stand for body in free if (stand := standing(body, normal)) is not None]
    balls = [index for index, body in enumerate(free) if isinstance(body.shape, Sphere)]
    others = [index for index in range(len(free)) if index not in balls]
    if len(stands) < len(free) or others != [push.body] or not balls or not _plain(push):
        return None
    (box,) = others
    if not isinstance(free[box].shape, Brick):
        return None
    near = DECIMALS * max(stand.half for stand in stands)
    top = stands[box].middle + stands[box].height
    gaps = [stands[box].middle - stands[box].height, *(stands[ball].middle - stands[ball].height - top for ball in balls)]
    if any(abs(gap) > near for gap in gaps):
        return None
    rough = [friction_of(scene, (box, index)) for index in range(len(free))]
    plane = friction_of(scene, (WORLD, box))
    return Pushed(stands, box, balls, numbers(push.force), MP.mpf(scene.gravity), plane, rough, float(max(map(abs, gaps))))


def _plain(push: Push) -> bool:
    """Return whether a push acts along a level plane at the centre of mass from the start."""
    return not (any(push.point) or push.start or push.force[2]) and any(push.force)


def _accelerations(pushed: Pushed) -> list[Real]:
    """The accelerations of all bodies along the push (m/s^2), by bisection of that of the box."""
    weight, force = pushed.gravity * sum(pushed.masses), norm(pushed.push)
    if force <= pushed.plane * weight:
        return [MP.zero for _ in pushed.stands]

    def taken(fast: Real) -> list[Real]:
        accelerations = []
        for index, stand in enumerate(pushed.stands):
            if index == pushed.box:
                accelerations.append(fast)
                continue
            body = stand.body
            following = fast / (1 + body.mass * pushed.radius(index) ** 2 / body.tensor[0][0])
            accelerations.append(min(following, pushed.rough[index] * pushed.gravity))
        return accelerations

    def needed(fast: Real) -> Real:
        return sum(mass * rate for mass, rate in zip(pushed.masses, taken(fast), strict=True))

    low, high = MP.zero, force / pushed.masses[pushed.box]
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if needed(middle) < force - pushed.plane * weight else (low, middle)
    return taken(high)


def _ends(pushed: Pushed, forces: list[Vector]) -> Iterator[End]:
    """Yield the ends of the motion. forces: those that accelerate the bodies (N)."""
    rates = [scaled(force, 1 / mass) for force, mass in zip(forces, pushed.masses, strict=True)]
    stands, box = pushed.stands, pushed.box
    places = [stand.body.position for stand in stands]

    def over_face(start: Vector, rate: Vector, kind: str, body: int) -> Iterator[End]:
        """Yield the instants at which a point, relative to the middle of the face, reaches an edge."""
        begin, change = (along_axes(stands[box].body, each) for each in (start, rate))
        for side, half in enumerate(half_lengths(stands[box].body)):
            if abs(axis(stands[box].body, side)[2]) > DECIMALS:
                continue
            for sign in (1, -1):
                if (first := _root(half - sign * begin[side], -sign * change[side], MP.zero)) is not None:
                    yield End(first, kind, body)

    for ball in pushed.balls:
        if stands[ball].body.tensor[0][0] != stands[ball].body.tensor[1][1]:
            raise NotModelled("a sphere whose moments differ")
        yield from over_face(minus(places[ball], places[box]), minus(rates[ball], rates[box]), END, ball)
        for other in pushed.balls[: pushed.balls.index(ball)]:
            apart, change = minus(places[ball], places[other]), minus(rates[ball], rates[other])
            touching = (pushed.radius(ball) + pushed.radius(other)) ** 2
            first = _root(dot(apart, apart) - touching, 2 * dot(apart, change), dot(change, change))
            if first is not None:
                yield End(first, "impact", ball)
    load = _load(pushed, forces, places), _load(pushed, forces, rates, moving=True)
    yield from over_face(minus(load[0], places[box]), minus(load[1], rates[box]), "tip", box)


def _load(pushed: Pushed, forces: list[Vector], arms: list[Vector], *, moving: bool = False) -> Vector:
    """The point at which the plane bears the load, from the balance of moments about the origin, or its change with `arms`.

    arms: the places of all bodies (m), or their changes; `moving` says which. Only changes of the places matter to the change.
    """
    up, weight = AXES[2], pushed.gravity * sum(pushed.masses)
    moments = [
        cross(arm, plus(force, scaled(up, mass * pushed.gravity)))
        for arm, force, mass in zip(arms, forces, pushed.masses, strict=True)
    ]
    spins = [] if moving else [cross(scaled(up, -pushed.radius(ball)), forces[ball]) for ball in pushed.balls]
    whole = plus(STILL, *moments, *spins, scaled(cross(arms[pushed.box], pushed.push), MP.mpf(-1)))
    load = scaled(cross(up, whole), 1 / weight)
    ground = minus(plus(*forces), pushed.push)
    turning, size = dot(up, minus(whole, cross(load, ground))), weight * pushed.stands[pushed.box].half
    if not moving and abs(turning) > DECIMALS * size:
        raise NotModelled("a pushed box with loads beside the line of the push, which turns")
    return load


def _root(value: Real, slope: Real, curve: Real) -> Real | None:
    """The first x > 0 at which value + slope x + curve x^2 falls through zero, with value > 0; None if it never does."""
    square = slope * slope - 4 * curve * value
    if slope >= 0 or square < 0:
        return None
    return 2 * value / (-slope + MP.sqrt(square))


def _witness(pushed: Pushed, forces: list[Vector], t: Array, events: tuple[Instant, ...]) -> Witness:
    """The witness with forces (N) that accelerate the bodies, at times t (n,), s, that are NaN after the end."""
    passed = t.astype(Wide)[:, None]
    half_square, states = passed * passed / 2, []
    for index, (stand, force) in enumerate(zip(pushed.stands, forces, strict=True)):
        body, rate = stand.body, wide_vector(scaled(force, 1 / stand.body.mass))
        turning = STILL
        if index != pushed.box:
            turning = scaled(cross(scaled(AXES[2], -pushed.radius(index)), force), 1 / body.tensor[0][0])
        size = norm(turning)
        about = scaled(turning, 1 / size) if size else AXES[2]
        angle, begin = half_square[:, 0] * wide(size), wide_matrix(body.cosines)
        skew = wide_matrix(transposed([cross(about, each) for each in AXES]))
        turn = np.sin(angle)[:, None, None] * skew + 2 * np.sin(angle / 2)[:, None, None] ** 2 * (skew @ skew)
        cosines = (np.eye(3, dtype=Wide) + turn) @ begin
        attitude = np.full((len(t), 4), np.nan, dtype=Wide)
        attitude[~np.isnan(t)] = quaternion_of(cosines[~np.isnan(t)])
        spin = passed * wide_vector(applied(transposed(body.cosines), turning))
        states.append((attitude, spin, wide_vector(body.position) + half_square * rate, passed * rate, angle))
    quaternion, spins, position, velocity, angles = (np.array(each) for each in zip(*states, strict=True))
    tilt, roundings = max(stand.tilt for stand in pushed.stands), ROUNDINGS * WIDE_EPS
    turned, widest = 1 + _largest(angles[..., None]), max(stand.half for stand in pushed.stands)
    return Witness(
        NAME,
        quaternion,
        spins,
        position,
        velocity,
        error=tilt + roundings * turned,
        angular_velocity_error=roundings * turned * _largest(spins),
        position_error=2 * pushed.gap + tilt * widest + roundings * _largest(position),
        velocity_error=roundings * _largest(velocity),
        events=events,
    )


def _largest(states: WideArray) -> Array:
    """The largest components (n,) of states (b, n, k)."""
    return np.asarray(np.abs(np.nan_to_num(states)).max(axis=(0, 2))).astype(float)
