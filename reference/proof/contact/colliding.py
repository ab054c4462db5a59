"""Two free spheres that hit each other in balls, with or without a level plane under them.

Each sphere flies, or moves on the plane, by its own pieces (`rolling`) until they hit each other: their distance is the root of
a polynomial in the time in which neither begins another piece. With the unit vector n from the first sphere to the second, the
points of contact have the relative velocity u = v1 - v2 + (r1 w1 + r2 w2) x n. An impulse J across n changes u by J (b1 + b2),
b = 1/m + r^2/I, so that the slip keeps its direction. Friction ends it if this needs at most mu times the impulse along n.

Hits on the plane may accumulate. Let w be the velocity of the lowest point due to the spin, s = v - w its slip, k = I/(m
r^2), and u = v - s k/(1 + k), which friction does not change. For constants V_i the sum E of m (v - V)^2 / 2 and k m (w -
V)^2 / 2 over both spheres has the rate F (v - V) - F (w - V) = F s <= 0 by a friction F of the plane. In a hit without
friction with the closing speed c, the impulse J = (1 + e) c / (1/m1 + 1/m2) changes it by -J (1 - e) c / 2 - J n (V2 - V1).
Just before a hit let M = c + |s1| + |s2|, and q^2 the sum of (1 + k) m over the smallest m or k m. If V is u with the mean of
both components along n, |v - V| and |w - V| are at most 2 M, so that 2 E <= (2 M)^2 (m1 (1 + k1) + m2 (1 + k2)), and they
stay below 2 M q: as long as they do, the product of x2 - x1, which is along n at first, and V2 - V1 does not become negative
if |V2 - V1| >= 4 M q. Otherwise the mean of both V serves for both, from which v and w stay within (2 M + 2 M q) q. In either
case v and w stay within (1 + 4 q + 2 q^2) M of u for ever, and change by at most 2 (1 + q)^2 M.
"""

import math
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from flint import arb, arb_poly

from bodycheck.reference.mechanisms.mechanism import PairContact
from bodycheck.reference.proof.balls import (
    Ball,
    Matrix,
    Triple,
    ball,
    cross,
    dot,
    product,
    scaled,
    size_of,
    squared,
    vector_sum,
)
from bodycheck.reference.proof.contact import rolling
from bodycheck.reference.proof.contact.start import Placed, Surroundings, diagonal, radius_of
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.motions import Piece
from bodycheck.reference.proof.roots import first_change, root_near
from bodycheck.reference.proof.turning import NO_TURN, constant
from bodycheck.reference.scene import Plane

#: A function from a time (s) to whether two spheres touch exactly then.
Meet = Callable[[Fraction], bool]

#: The time (s) until which a hit is searched if neither sphere begins another piece.
LONGEST = arb(2) ** 20

#: The time (s) after which a velocity shows the acceleration: short, as rotations are computed until then.
SOON = arb(2) ** -6

#: The speed after an impact on the plane below which no further impact is an event, over the root of g r.
LAST_EVENT = arb(10) ** -30

#: The speeds of closing and of slip together, relative to the speeds at the start, below which further hits on the plane are
#: enclosed together, and are no events.
LAST_HIT = arb(2) ** -80


@dataclass(frozen=True, eq=False)
class Sphere:
    """A sphere: its mass, moment and radius, its law on the plane, and the attitude at the begin of its pieces."""

    mass: Ball
    moment: Ball
    round: rolling.Round
    attitude: Matrix
    on_plane: bool

    @property
    def mobility(self) -> Ball:
        """The velocity of a point of the surface, across its radius, for an impulse of 1 N s along it."""
        return 1 / self.mass + squared(self.round.radius) / self.moment


@dataclass(frozen=True, eq=False)
class Course:
    """The pieces of a sphere between two hits: the present one, and those ahead."""

    sphere: Sphere
    piece: Piece
    ahead: Iterator[Piece]

    def states(self, t: Ball) -> "State":
        """Position, attitude, velocity and angular velocity along the axes of the world at a time (s)."""
        position, velocity, spin, turn = self.piece.at(t - self.piece.begin)
        return position, product(turn, self.sphere.attitude), velocity, spin


Pair = tuple[Course, Course]

#: The state of a sphere: see `Course.states`.
State = tuple[Triple, Matrix, Triple, Triple]


def pieces(
    bodies: list[Placed], law: PairContact | Plane, laws: list[Plane | None], around: Surroundings, meet: Meet | None
) -> Iterator[Piece]:
    """Yield the pieces of the motion of two spheres, whose states are those of each, with velocities along fixed axes.

    meet: whether spheres that fly from the start on touch exactly at a time (s); None if it is not known that they fly.
    """
    spheres = [_sphere(body, each, around) for body, each in zip(bodies, laws, strict=True)]
    sizes = [size_of(b.velocity) + s.round.radius * size_of(b.spin) for b, s in zip(bodies, spheres, strict=True)]
    scale = sizes[0].max(sizes[1])
    one, other = (_begun(sphere, body, scale) for sphere, body in zip(spheres, bodies, strict=True))
    reach = spheres[0].round.radius + spheres[1].round.radius
    apart = _minus(bodies[1].position, bodies[0].position)
    pair, begin, gap = (one, other), arb(0), dot(apart, apart) - squared(reach)
    if not gap > 0:
        raise NotEnclosed("spheres that may touch at the start")
    while True:
        begin, pair = yield from _until_hit(pair, begin, gap, meet)
        meet = None
        together = _together(pair, begin, law, scale)
        if together is not None:
            yield Piece(begin, None, together)
            return
        impulse, events = _impulse(pair, begin, law), [("impact", 0), ("impact", 1)]
        struck = []
        for index in (0, 1):
            pressed, friction = (scaled(arb(1 - 2 * index), part) for part in impulse)
            each, kind = _struck(pair, begin, pressed, friction, index, scale)
            struck.append(each)
            events += [(kind, index)] if kind else []
        yield Piece(begin, begin, lambda _: (), tuple(events), jumps=True)
        pair, gap = (struck[0], struck[1]), arb(0)


def _sphere(body: Placed, law: Plane | None, around: Surroundings) -> Sphere:
    radius, moments = radius_of(body.shape), diagonal(body.inertia)
    if radius is None or len(set(moments)) != 1:
        raise NotEnclosed("bodies that hit each other and are no spheres with equal moments")
    if around.incline:
        raise NotEnclosed("spheres that hit each other on an incline")
    ratio = ball(moments[0] / (body.mass * Fraction(radius) ** 2))
    friction = None if law is None or math.isinf(law.friction) else ball(law.friction)
    restitution = ball(0 if law is None else law.restitution)
    least = LAST_EVENT * (around.onto * ball(radius)).sqrt()
    whole = rolling.Round(ball(radius), ratio, friction, restitution, arb(0), around.onto, grips=True, least=least)
    return Sphere(ball(body.mass), ball(moments[0]), whole, body.attitude, law is not None)


def _course(sphere: Sphere, ahead: Iterator[Piece]) -> Course:
    return Course(sphere, next(ahead), ahead)


def _begun(sphere: Sphere, body: Placed, scale: Ball) -> Course:
    """The course of a sphere from t = 0 on."""
    if sphere.on_plane:
        return _course(sphere, rolling.begun(sphere.round, body.position, body.velocity, body.spin, scale))
    start = rolling.Moving(arb(0), body.position, body.velocity, body.spin, (arb(0), arb(0)), NO_TURN)
    return _course(sphere, iter([Piece(arb(0), None, rolling.flying(sphere.round, start), phase="flies")]))


def _until_hit(pair: Pair, begin: Ball, gap: Ball, meet: Meet | None) -> Generator[Piece, None, tuple[Ball, Pair]]:
    """Yield the pieces until the spheres hit each other, and return the time of this with the pieces then.

    gap: the square of the distance of the centres beyond that at which they touch (m^2), exactly zero if they do.
    """
    while True:
        ends = [course.piece.end for course in pair]
        first = _first(ends)
        span = LONGEST if first is None else ends[first] - begin
        beyond = _beyond(pair, begin, gap)
        hit = _hit(beyond, span)
        states = _both(pair, begin)
        if hit is not None:
            yield Piece(begin, begin + hit, states, jumps=True, ends_at=meet)
            return begin + hit, pair
        if first is None:
            yield Piece(begin, None, states)
            raise NotEnclosed("spheres that hit each other very late")
        ended = pair[first]
        end = ended.piece.end
        yield Piece(begin, end, states, tuple((kind, first) for kind, _ in ended.piece.events), ended.piece.jumps)
        following = replace(ended, piece=next(ended.ahead))
        pair = (following, pair[1]) if first == 0 else (pair[0], following)
        gap, begin = beyond(span), end


def _first(ends: list[Ball | None]) -> int | None:
    """The index of the piece that ends first; None if neither ends.

    If it is not decided which of the two ends first, any order will do, since each sphere goes on by itself.
    """
    one, other = ends
    if one is None or other is None:
        return None if one is other else 0 if other is None else 1
    return 0 if float((one - other).mid()) <= 0 else 1


def _both(pair: Pair, begin: Ball) -> Callable[[Ball], Any]:
    return lambda t: tuple(course.states(begin + t) for course in pair)


def _motion(pair: Pair, begin: Ball) -> tuple[Triple, Triple, Triple]:
    """The relative position, velocity and acceleration: the latter is constant in each piece."""
    parts = []
    for course in pair:
        since = begin - course.piece.begin
        (position, velocity, *_), (_, later, *_) = course.piece.at(since), course.piece.at(since + SOON)
        parts.append((position, velocity, scaled(1 / SOON, _minus(later, velocity))))
    one, other = parts
    return tuple(_minus(b, a) for a, b in zip(one, other, strict=True))  # type: ignore[return-value]


def _minus(a: Triple, b: Triple) -> Triple:
    return vector_sum(a, scaled(arb(-1), b))


def _beyond(pair: Pair, begin: Ball, gap: Ball) -> arb_poly:
    """The square of the distance of two spheres beyond that at which they touch, as a function of the time from now on.

    gap: its value now, which balls of the positions contain with an error that does not become small with it.
    """
    quadratics = [arb_poly([p, v, a / 2]) for p, v, a in zip(*_motion(pair, begin), strict=True)]
    polynomial = sum((each * each for each in quadratics), arb_poly([]))
    return arb_poly([gap, *(polynomial[index] for index in range(1, 5))])


def _hit(beyond: arb_poly, span: Ball) -> Ball | None:
    """The time after which two spheres hit each other; None if they do not within a time (s)."""
    coefficients = [beyond[index] for index in range(5)]
    if coefficients[0].is_zero():  # they have just hit each other
        coefficients = coefficients[1:]
    if all(each.is_zero() for each in coefficients):
        return None
    if not coefficients[0] > 0:
        raise NotEnclosed("spheres of which it is not decided whether they part")
    left = arb_poly(coefficients)
    slope = left.derivative()
    near = first_change(left, slope, span)
    if near is None:
        return None
    hit = root_near(left, slope, near)
    if hit < span:
        return hit
    if hit > span:
        return None
    raise NotEnclosed("a hit of two spheres at an event of one of them")


def _together(pair: Pair, begin: Ball, law: PairContact | Plane, scale: Ball) -> Callable[[Ball], Any] | None:
    """The states from a hit on, from which all hits are enclosed together; None if this one is not among them."""
    one, other = (course.sphere for course in pair)
    bounces = any(not course.sphere.on_plane or course.piece.phase == "flies" for course in pair)
    if bounces or law.friction or not (one.round.radius - other.round.radius).is_zero():
        return None
    states = [course.states(begin) for course in pair]
    slips = [course.sphere.round.slip(v, spin) for course, (_, _, v, spin) in zip(pair, states, strict=True)]
    speeds = dot(_minus(states[0][2], states[1][2]), _normal(pair, begin)) + size_of(slips[0]) + size_of(slips[1])
    if speeds > LAST_HIT * scale:
        return None
    if not speeds < LAST_HIT * scale:
        raise NotEnclosed("hits of two spheres of which it is not decided whether they are events")
    whole = sum(((1 + each.round.ratio) * each.mass for each in (one, other)), arb(0))
    least = [arb.min(arb(1), each.round.ratio) * each.mass for each in (one, other)]
    change = 2 * squared(1 + (whole / arb.min(*least)).sqrt()) * speeds
    return lambda t: tuple(
        _nearly_rolling(sphere, state, t, change) for sphere, state in zip((one, other), states, strict=True)
    )


def _nearly_rolling(sphere: Sphere, state: State, t: Ball, change: Ball) -> State:
    """The state of a sphere after a time (s) in which velocity, and that of the lowest point by the spin, are nearly constant.

    change: a bound of their changes (m/s).
    """
    (x, y, z), attitude, (u, v, w), spin = state
    about, faster = arb(0, change.upper()), change / sphere.round.radius
    turned = rolling.turned_at_most(constant(spin)(t), faster * t)
    around = arb(0, faster.upper())
    position = (x + t * (u + about), y + t * (v + about), z)
    return position, product(turned.matrix, attitude), (u + about, v + about, w), (spin[0] + around, spin[1] + around, spin[2])


def _normal(pair: Pair, t: Ball, index: int = 0) -> Triple:
    """The unit vector from one sphere to the other one."""
    apart = _minus(pair[1].states(t)[0], pair[0].states(t)[0])
    return scaled(arb(1 - 2 * index) / size_of(apart), apart)


def _impulse(pair: Pair, t: Ball, law: PairContact | Plane) -> tuple[Triple, Triple]:
    """The impulse on the first sphere (N s) along the line of centres, and that of friction, which may be exactly zero."""
    (_, _, v1, w1), (_, _, v2, w2) = (course.states(t) for course in pair)
    first, second = (course.sphere for course in pair)
    normal = _normal(pair, t)
    turning = vector_sum(scaled(first.round.radius, w1), scaled(second.round.radius, w2))
    velocity = vector_sum(_minus(v1, v2), cross(turning, normal))
    closing = dot(velocity, normal)
    along = (1 + ball(law.restitution)) * closing / (1 / first.mass + 1 / second.mass)
    pressed = scaled(-along, normal)
    if not math.isinf(law.friction) and not law.friction:
        return pressed, (arb(0), arb(0), arb(0))
    across = _minus(velocity, scaled(closing, normal))
    speed, most = size_of(across), None if math.isinf(law.friction) else ball(law.friction) * along
    stopping = scaled(-1 / (first.mobility + second.mobility), across)
    needed = speed / (first.mobility + second.mobility)
    if most is None or needed <= most:
        return pressed, stopping
    if needed > most:
        return pressed, scaled(-most / speed, across)
    raise NotEnclosed("spheres of which it is not decided whether friction ends their slip")


def _struck(pair: Pair, t: Ball, pressed: Triple, friction: Triple, index: int, scale: Ball) -> tuple[Course, str]:
    """The course of a sphere that has been hit, and the kind of an event of the sphere on the plane that this is too."""
    course, normal = pair[index], _normal(pair, t, index)
    sphere, around = course.sphere, course.sphere.round
    position, attitude, velocity, spin = course.states(t)
    impulse = vector_sum(pressed, friction)
    velocity = vector_sum(velocity, scaled(1 / sphere.mass, impulse))
    spin = vector_sum(spin, scaled(around.radius / sphere.moment, cross(normal, friction)))
    slip = around.slip(velocity, spin)
    moving = rolling.Moving(t, position, velocity, spin, slip, NO_TURN)
    turned = replace(sphere, attitude=attitude)
    if not sphere.on_plane:
        return _course(turned, iter([Piece(t, None, rolling.flying(around, moving), phase="flies")])), ""
    if course.piece.phase == "flies" or impulse[2] > 0:
        return _course(turned, rolling.bouncing(around, moving, scale)), ""
    if not impulse[2].is_zero():
        raise NotEnclosed("a sphere that another one presses on the plane")
    if not all(part.is_zero() for part in slip) and not size_of(slip) > 0:
        raise NotEnclosed("a sphere of which it is not decided whether it slips after a hit")
    after = _course(turned, rolling.on_plane(around, moving, scale))
    return after, rolling.kind_of(around, moving, scale) if after.piece.phase != course.piece.phase else ""
