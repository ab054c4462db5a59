"""A sphere, or a cylinder on its side, alone on a plane in balls: flights, impacts, slip and roll, from phase to phase.

With the radius r, the velocity v and the angular velocity w, the point of contact slips with u = (v_x - r w_y, v_y + r w_x). A
force F along the plane at this point gives v the rate F/m and u the rate (1 + 1/k) F/m, where k = I/(m r^2). Slip is carried
along as a state of its own, so that it is exactly zero after friction has ended it.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

from flint import arb

from bodycheck.reference.proof.balls import Ball, Matrix, Triple, ball, dot, scaled, size_of, squared, vector_sum
from bodycheck.reference.proof.contact.slipping import Hodograph, Pair, Slip, slipping
from bodycheck.reference.proof.contact.start import NONE, Placed, Surroundings, diagonal, radius_of
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.motions import Piece
from bodycheck.reference.proof.turning import NO_TURN, Turn, accelerated, after, constant, varying
from bodycheck.reference.scene import Cylinder, Plane

#: The ratio of the speed after an impact to the speed of the first impact below which no further impact is an event, and the
#: ratio below which the remaining impacts are enclosed together.
LAST_EVENT, LAST_IMPACT = arb(2) ** -60, arb(2) ** -96

#: The states of a body: position, velocity, angular velocity and rotation since t = 0, along the axes of the plane.
States = tuple[Triple, Triple, Triple, Matrix]


@dataclass(frozen=True, eq=False)
class Round:
    """A round body and its plane.

    Attributes
    ----------
    radius, ratio
        r and k.
    friction, restitution
        mu, None if it is infinite, and e.
    downhill, onto
        Gravity along x and against the normal (m/s^2).
    grips
        Whether a body that rolls goes on to roll.
    least
        The speed after an impact below which no further impact is an event; None for `LAST_EVENT` of that of the first impact.
    """

    radius: Ball
    ratio: Ball
    friction: Ball | None
    restitution: Ball
    downhill: Ball
    onto: Ball
    grips: bool
    least: Ball | None = None

    def slip(self, velocity: Triple, spin: Triple) -> Pair:
        """The velocity of the point of contact."""
        return velocity[0] - self.radius * spin[1], velocity[1] + self.radius * spin[0]

    @property
    def slowing(self) -> Ball:
        """The rate at which friction reduces a slip (m/s^2); 0 for infinite friction, with which nothing slips."""
        return arb(0) if self.friction is None else self.friction * self.onto * (1 + 1 / self.ratio)


@dataclass(frozen=True, eq=False)
class Moving:
    """A round body at a time (s): position, velocity, angular velocity, slip, and rotation since t = 0."""

    time: Ball
    position: Triple
    velocity: Triple
    spin: Triple
    slip: Pair
    turn: Turn


def pieces(body: Placed, law: Plane, plane: Surroundings) -> Iterator[Piece]:
    """Return the pieces of the motion of a round body, whose states are `States`."""
    radius, moments = radius_of(body.shape), diagonal(body.inertia)
    if radius is not None:
        if len(set(moments)) != 1:
            raise NotEnclosed("a sphere whose moments differ")
        around = _round(body, law, plane, radius, moments[0])
        return begun(around, body.position, body.velocity, body.spin)
    assert isinstance(body.shape, Cylinder)
    column: Triple = tuple(row[2] for row in body.attitude)
    if not abs(column[2]) <= NONE:
        raise NotEnclosed("a cylinder that does not lie on its side")
    straight = _level(column, plane)
    along = scaled(-dot(body.velocity, straight), straight)
    around = _round(body, law, plane, body.shape.radius, moments[2])
    return begun(around, body.position, vector_sum(body.velocity, along), scaled(dot(body.spin, straight), straight))


def _level(axis: Triple, plane: Surroundings) -> Triple:
    """The axis of a cylinder without its component along the normal, perpendicular to the fall line of an incline."""
    if not plane.downhill.is_zero() and abs(axis[0]) <= NONE:
        return arb(0), axis[1].sgn(), arb(0)
    size = size_of(axis[:2])
    return axis[0] / size, axis[1] / size, arb(0)


def _round(body: Placed, law: Plane, plane: Surroundings, radius: float, moment: Fraction) -> Round:
    ratio = moment / (body.mass * Fraction(radius) ** 2)
    friction = None if math.isinf(law.friction) else ball(law.friction)
    grips = friction is None or plane.downhill.is_zero()
    if not grips:
        assert friction is not None
        margin = friction * ball(1 + ratio) * plane.onto - plane.downhill * ball(ratio)
        if not (margin >= 0 or margin < 0):
            raise NotEnclosed("a body of which it is not decided whether it rolls")
        grips = bool(margin >= 0)
    return Round(ball(radius), ball(ratio), friction, ball(law.restitution), plane.downhill, plane.onto, grips)


def begun(body: Round, position: Triple, velocity: Triple, spin: Triple, most: Ball | None = None) -> Iterator[Piece]:
    """Return the pieces from t = 0 on, where a distance from the plane, a normal velocity and a slip may count as zero.

    most: the size of speeds beside which a body is at rest; by default its own.
    """
    height, speed = position[2] - body.radius, size_of(velocity)
    touching = counts_as_zero(height, body.radius)
    airborne = not touching or not counts_as_zero(velocity[2], speed)
    slip, scale = body.slip(velocity, spin), speed + body.radius * size_of(spin)
    start = Moving(arb(0), position, velocity, spin, slip, NO_TURN)
    if airborne:
        lower = position if not touching else (position[0], position[1], body.radius)
        return bouncing(body, replace(start, position=lower), scale if most is None else most)
    start = replace(start, velocity=(velocity[0], velocity[1], arb(0)))
    if (body.friction is None or body.friction > 0) and counts_as_zero(size_of(slip), scale):
        start = replace(_pushed(body, start, scaled_pair(-body.ratio / (1 + body.ratio), slip)), slip=(arb(0), arb(0)))
    return on_plane(body, start, scale if most is None else most)


def counts_as_zero(value: Ball, scale: Ball) -> bool:
    """Return whether a value at t = 0 counts as zero beside the size of its terms."""
    if value.is_zero() or abs(value) <= NONE * scale:
        return True
    if abs(value) > NONE * scale:
        return False
    raise NotEnclosed("a body of which it is not decided whether it touches the plane or rolls")


def scaled_pair(factor: Ball, pair: Pair) -> Pair:
    """Return the product of a number and two components."""
    return factor * pair[0], factor * pair[1]


def _pushed(body: Round, moving: Moving, change: Pair) -> Moving:
    """The body after friction has changed its velocity: friction at the point of contact changes its angular velocity too."""
    x, y = change
    (u, v, w), (p, q, r) = moving.velocity, moving.spin
    arm = body.ratio * body.radius
    return replace(moving, velocity=(u + x, v + y, w), spin=(p + y / arm, q - x / arm, r))


def bouncing(body: Round, moving: Moving, scale: Ball) -> Iterator[Piece]:
    """Yield the pieces of a body that flies, or hits the plane at once. scale: the size of speeds at the start (m/s)."""
    first: Ball | None = None
    listed = True
    while True:
        lasting, speed = _fall(body, moving)
        states = flying(body, moving)
        if lasting is None:
            yield Piece(moving.time, None, states, phase="flies")
            return
        end = moving.time + lasting
        yield Piece(moving.time, end, states, (("impact", 0),) if listed else (), jumps=True, phase="flies")
        first = speed if first is None else first
        moving = _impacted(body, _at_end(body, moving, lasting), speed)
        listed = bool(moving.velocity[2] > (first * LAST_EVENT if body.least is None else body.least))
        if not moving.velocity[2] > first * LAST_IMPACT:
            break
    settled, lasting = _settled(body, moving)
    yield Piece(moving.time, settled.time, _settling(body, moving, lasting), ((kind_of(body, settled, scale), 0),))
    yield from on_plane(body, settled, scale)


def _fall(body: Round, moving: Moving) -> tuple[Ball | None, Ball]:
    """The duration of a flight (s), and its final speed towards the plane (m/s); None and 0 if it never lands."""
    height, rise = moving.position[2] - body.radius, moving.velocity[2]
    speed = (squared(rise) + 2 * body.onto * height).sqrt() if not height.is_zero() else abs(rise)
    if rise < 0:
        return 2 * height / (speed - rise), speed
    if body.onto > 0:
        return (rise + speed) / body.onto, speed
    if body.onto.is_zero() and rise >= 0:
        return None, arb(0)
    raise NotEnclosed("a body of which it is not decided whether it lands")


def flying(body: Round, moving: Moving) -> Callable[[Ball], States]:
    """Return the states of a body that flies."""
    turning = constant(moving.spin)

    def states(t: Ball) -> States:
        (x, y, z), (u, v, w) = moving.position, moving.velocity
        position = (x + t * (u + t * body.downhill / 2), y + t * v, z + t * (w - t * body.onto / 2))
        velocity = (u + t * body.downhill, v, w - t * body.onto)
        return position, velocity, moving.spin, after(turning(t), moving.turn).matrix

    return states


def _at_end(body: Round, moving: Moving, t: Ball) -> Moving:
    """The body at the end of a flight, just before it hits the plane."""
    position, velocity, spin, _ = flying(body, moving)(t)
    slip = (moving.slip[0] + t * body.downhill, moving.slip[1])
    turn = after(constant(moving.spin)(t), moving.turn)
    return Moving(moving.time + t, (position[0], position[1], body.radius), velocity, spin, slip, turn)


def _impacted(body: Round, moving: Moving, speed: Ball) -> Moving:
    """The body just after it has hit the plane with a speed along the normal (m/s)."""
    u, v, _ = moving.velocity
    moving = replace(moving, velocity=(u, v, body.restitution * speed))
    normal = (1 + body.restitution) * speed
    size = size_of(moving.slip)
    if _ends(body, size, normal):
        stopped = _pushed(body, moving, scaled_pair(-body.ratio / (1 + body.ratio), moving.slip))
        return replace(stopped, slip=(arb(0), arb(0)))
    if body.friction is None or body.friction.is_zero():
        return moving
    change = scaled_pair(-body.friction * normal / size, moving.slip)
    further = scaled_pair(1 + 1 / body.ratio, change)
    pushed = _pushed(body, moving, change)
    return replace(pushed, slip=(moving.slip[0] + further[0], moving.slip[1] + further[1]))


def _ends(body: Round, slip: Ball, normal: Ball) -> bool:
    """Return whether friction ends a slip in an impact. normal: impulse along the normal over the mass (m/s)."""
    if body.friction is None or slip.is_zero():
        return True
    if body.friction.is_zero():
        return False
    margin = body.friction * normal * (1 + body.ratio) - slip * body.ratio
    if not (margin >= 0 or margin < 0):
        raise NotEnclosed("an impact of which it is not decided whether the slip ends")
    return bool(margin >= 0)


def _settled(body: Round, moving: Moving) -> tuple[Moving, Ball]:
    """The body after all remaining impacts, and their duration (s), which is the sum of a geometric series.

    In this time, velocities along the plane change at most as if the body slipped and slid down all the time.
    """
    speed = moving.velocity[2]
    if speed.is_zero():
        return moving, arb(0)
    lasting = 2 * speed / (body.onto * (1 - body.restitution))
    once = _ends(body, 2 * speed * body.downhill / body.onto, (1 + body.restitution) * speed)
    gripped = all(part.is_zero() for part in moving.slip) and once
    change = (body.downhill + body.slowing) * lasting
    if not gripped and not (body.slowing.is_zero() or size_of(moving.slip) > change):
        raise NotEnclosed("a body of which it is not decided whether it slips after its impacts")
    position, velocity, spin, turned = _around(body, moving, lasting, lasting)
    about = _spread(change)
    slip = (arb(0), arb(0)) if gripped else (moving.slip[0] + about, moving.slip[1] + about)
    placed = (position[0], position[1], body.radius)
    return Moving(moving.time + lasting, placed, (velocity[0], velocity[1], arb(0)), spin, slip, turned), lasting


def _around(body: Round, moving: Moving, t: Ball, lasting: Ball) -> tuple[Triple, Triple, Triple, Turn]:
    """The states within the remaining impacts, after a time (s) of their duration."""
    smooth = body.downhill.is_zero() and all(part.is_zero() for part in moving.slip)
    about = arb(0) if smooth else _spread((body.downhill + body.slowing) * lasting)
    (x, y, z), (u, v, w) = moving.position, moving.velocity
    velocity = (u + about, v + about, _spread(w))
    position = (x + t * velocity[0], y + t * velocity[1], z + squared(w) / (2 * body.onto) * arb(0.5, 0.5))
    p, q, r = moving.spin
    faster = about * 1 / (body.ratio * body.radius)
    spin = (p + faster, q + faster, r)
    turn = after(constant(spin)(t), moving.turn) if smooth else turned_at_most(moving.turn, size_of(spin) * t)
    return position, velocity, spin, turn


def turned_at_most(turn: Turn, angle: Ball) -> Turn:
    """Return a rotation after which the body may turn further by at most an angle (rad)."""
    return Turn(turn.parts, arb((turn.radius + angle).upper()))


def _spread(value: Ball) -> Ball:
    return arb(0, abs(value).upper())


def _settling(body: Round, moving: Moving, lasting: Ball) -> Callable[[Ball], States]:
    def states(t: Ball) -> States:
        *vectors, turn = _around(body, moving, t, lasting)
        return vectors[0], vectors[1], vectors[2], turn.matrix

    return states


def on_plane(body: Round, moving: Moving, scale: Ball) -> Iterator[Piece]:
    """Yield the pieces of a body that stays on the plane. scale: the size of speeds at the start (m/s)."""
    while not (all(part.is_zero() for part in moving.slip) and body.grips):
        slip = slipping(moving.slip, body.downhill, body.slowing)
        states = _slipped(body, moving, slip)
        if slip.duration is None:
            yield Piece(moving.time, None, states, phase="slips")
            return
        ended = _after_slip(body, moving, slip)
        yield Piece(moving.time, ended.time, states, ((kind_of(body, ended, scale), 0),), phase="slips")
        moving = ended
    faster = body.downhill / (1 + body.ratio)
    turning = accelerated(moving.spin, (arb(0), faster / body.radius, arb(0)))

    def rolling(t: Ball) -> States:
        (x, y, z), (u, v, w), (p, q, r) = moving.position, moving.velocity, moving.spin
        position, velocity = (x + t * (u + t * faster / 2), y + t * v, z), (u + t * faster, v, w)
        return position, velocity, (p, q + t * faster / body.radius, r), after(turning(t), moving.turn).matrix

    yield Piece(moving.time, None, rolling, phase="rolls")


def kind_of(body: Round, moving: Moving, scale: Ball) -> str:
    """Return the kind of the event with which a body begins to stay on the plane or ends to slip."""
    if not (all(part.is_zero() for part in moving.slip) and body.grips):
        return "slip"
    speed = size_of(moving.velocity) + body.radius * abs(moving.spin[2])
    return "rest" if body.downhill.is_zero() and counts_as_zero(speed, scale) else "roll"


def _slipped(body: Round, moving: Moving, slip: Slip) -> Callable[[Ball], States]:
    turning = _turning(body, moving, slip)

    def states(t: Ball) -> States:
        now, path = slip.at(t)
        return *_along(body, moving, t, now, path), after(turning(t), moving.turn).matrix

    return states


def _along(body: Round, moving: Moving, t: Ball, now: Pair, path: Pair) -> tuple[Triple, Triple, Triple]:
    """Position, velocity and angular velocity from a slip and its path: friction changes velocity and slip in one ratio."""
    part, rate = body.ratio / (1 + body.ratio), body.downhill / (1 + body.ratio)
    (x, y, z), (u, v, w), (p, q, r) = moving.position, moving.velocity, moving.spin
    change = (now[0] - moving.slip[0], now[1] - moving.slip[1])
    moved = (
        x + t * (u - part * moving.slip[0] + t * rate / 2) + part * path[0],
        y + t * (v - part * moving.slip[1]) + part * path[1],
        z,
    )
    arm = body.radius * (1 + body.ratio)
    spin = (p + change[1] / arm, q + (t * body.downhill - change[0]) / arm, r)
    return moved, (u + t * rate + part * change[0], v + part * change[1], w), spin


def _turning(body: Round, moving: Moving, slip: Slip) -> Callable[[Ball], Turn]:
    """The rotation of a body that slips, as a function of the time since the begin of the slip (s)."""
    arm = body.radius * (1 + body.ratio)
    if slip.rate is not None:
        x, y = slip.rate
        return accelerated(moving.spin, (y / arm, (body.downhill - x) / arm, arb(0)))
    assert slip.hodograph is not None
    turning = _over_hodograph(body, moving, slip.hodograph)
    return lambda t: turning(slip.hodograph.parameter(t))  # type: ignore[union-attr]


def _over_hodograph(body: Round, moving: Moving, hodograph: Hodograph) -> Callable[[Ball], Turn]:
    arm = body.radius * (1 + body.ratio)
    p, q, r = moving.spin

    def spin(parameter):  # type: ignore[no-untyped-def]
        (x, y), size = hodograph.slip(parameter), hodograph.size(parameter)
        along = (y - moving.slip[1]) * (1 / arm) + p
        across = (hodograph.time(parameter) * body.downhill - x + moving.slip[0]) * (1 / arm) + q
        return along * size, across * size, size * r

    return varying(spin)


def _after_slip(body: Round, moving: Moving, slip: Slip) -> Moving:
    """The body at the end of a slip."""
    assert slip.duration is not None
    assert slip.ended is not None
    position, velocity, spin = _along(body, moving, slip.duration, (arb(0), arb(0)), slip.ended)
    if slip.hodograph is None:
        turn = _turning(body, moving, slip)(slip.duration)
    else:
        turn = _at_infinity(body, moving, slip.hodograph, slip.duration)
    return Moving(moving.time + slip.duration, position, velocity, spin, (arb(0), arb(0)), after(turn, moving.turn))


def _at_infinity(body: Round, moving: Moving, hodograph: Hodograph, duration: Ball) -> Turn:
    """The rotation until the end of a slip, where its parameter is infinite: the rest after a large one is small."""
    parameter = arb((arb(LAST_IMPACT).log() / (hodograph.downhill - hodograph.slowing)).mid())
    turn = _over_hodograph(body, moving, hodograph)(parameter)
    left = duration - hodograph.time(parameter)
    fastest = size_of(moving.spin) + (2 * size_of(moving.slip) + duration * body.downhill) / (body.radius * (1 + body.ratio))
    return turned_at_most(turn, fastest * abs(left))
