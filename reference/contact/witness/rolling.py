"""A round body on its plane: flights, impacts, slip and roll, by the force at the point of contact.

Everything is in the axes of the world. With the normal n, the radius r, the velocity v and the angular velocity w, the point
of contact slips with u = v - r w x n, without its part along n. A force m f along the plane at this point gives v the rate f,
w the rate -(m r/I) n x f, and u the rate (1 + m r^2/I) f. An impulse does the same to v, w and u at once.

A phase ends with an event, which is decided by the force or the impulse that would hold the point of contact. Flights are
parabolas with a hundred digits. On the plane, velocities, path and attitude are power series of the equations of motion, step
by step.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from bodycheck.reference.bounds import EPS
from bodycheck.reference.contact.witness import pieces, series
from bodycheck.reference.contact.witness.pieces import Piece
from bodycheck.reference.contact.witness.reading import Surface
from bodycheck.reference.contact.witness.series import Series
from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.independent.arithmetic import Real, Vector, cross, dot, minus, norm, plus, scaled
from bodycheck.reference.independent.border import MP
from bodycheck.reference.witness import Instant

#: The part of the size, of a speed or of a direction up to which the decimals of a file mean zero (docs/truth.md).
DECIMALS = MP.mpf("1e-12")

#: The ratio of a number to the terms that it is the sum of, up to which rounding explains it.
ROUNDED = MP.mpf(10) ** -45

#: The ratio of the speed after an impact to that of the first impact below which all remaining impacts are summed.
LAST_IMPACT = MP.mpf(10) ** -20

#: The ratio of a slip across the fall line to its size at its start at which it has ended.
LAST_SLIP = MP.mpf(10) ** -25

#: The largest angle (rad) by which a body turns in a step, and the largest relative change of the slip in a step.
STEP_RAD, STEP_SLIP = 6, 4

#: The largest numbers of impacts and of steps on the plane; they take some seconds.
MOST_IMPACTS, MOST_STEPS = 10_000, 3000

NONE: Vector = (MP.mpf(0), MP.mpf(0), MP.mpf(0))


@dataclass(frozen=True, eq=False)
class Round:
    """A round body on its plane.

    Attributes
    ----------
    radius
        The radius r (m).
    lever
        m r^2/I, with the moment of inertia I about the axes about which the body rolls.
    surface
        The plane.
    pull, load
        The gravitational acceleration along the plane, world frame, and against the normal (m/s^2).
    """

    radius: Real
    lever: Real
    surface: Surface
    pull: Vector
    load: Real

    @property
    def braking(self) -> Real:
        """The acceleration by friction against a slip (m/s^2)."""
        return self.surface.friction * self.load

    @property
    def holding(self) -> Vector:
        """The acceleration by friction (m/s^2) that keeps the point of contact from slipping."""
        return scaled(self.pull, -1 / (1 + self.lever))

    @property
    def holds(self) -> bool:
        """True if friction can keep the point of contact from slipping."""
        needed = norm(self.holding)
        return not needed or bool(needed <= self.braking)


@dataclass(frozen=True, eq=False)
class Moving:
    """A body at a time (s): position (m), velocity (m/s) and angular velocity (rad/s), world frame, and rotation since t = 0.

    `held` says that the point of contact does not slip, since friction has ended its slip.
    """

    time: Real
    position: Vector
    velocity: Vector
    spin: Vector
    turn: Vector
    held: bool = False


def course(body: Round, begin: Moving, airborne: bool, end: Real) -> tuple[list[Piece], list[Instant]]:
    """The pieces of a motion and its events until `end` (s). airborne: whether the body flies, or hits the plane at t = 0.

    Raises `OutOfReach` for too many impacts or steps.
    """
    parts: list[Piece] = []
    events: list[Instant] = []
    moving: Moving | None = begin
    if airborne:
        moving = _bounced(body, begin, end, parts, events)
    arrived = airborne
    while moving is not None and moving.time <= end:
        rolls = moving.held and body.holds
        if arrived:
            events.append(_event(_rest_or_roll(body, moving, begin) if rolls else "slip", moving))
        arrived = True
        if rolls:
            _advance(body, moving, body.holding, MP.inf, end, parts)
            break
        moving = _slid(body, moving, end, parts)
    return parts, events


def _event(kind: str, moving: Moving) -> Instant:
    return Instant(kind, float(moving.time), EPS * float(moving.time))


def _rest_or_roll(body: Round, moving: Moving, begin: Moving) -> str:
    """Return "rest" for a body that no longer moves on a level plane, except for the decimals of a file."""
    left = norm(moving.velocity) + body.radius * abs(dot(moving.spin, body.surface.normal))
    at_first = norm(begin.velocity) + body.radius * norm(begin.spin)
    return "rest" if not norm(body.pull) and left <= DECIMALS * at_first else "roll"


def _bounced(body: Round, moving: Moving, end: Real, parts: list[Piece], events: list[Instant]) -> Moving | None:
    """Append flights and impacts, and return the body when it stays on the plane; None if it still flies at `end` (s)."""
    normal, back = body.surface.normal, body.surface.restitution
    gravity = minus(body.pull, scaled(normal, body.load))
    first = None
    for _ in range(MOST_IMPACTS):
        parts.append(_uniform(moving, gravity, NONE))
        lasting = _falling(body, moving)
        if lasting is None or moving.time + lasting > end:
            return None
        landed = _after(moving, gravity, NONE, lasting)
        fall = -dot(landed.velocity, normal)
        first = fall if first is None else first
        pressing = (1 + back) * fall
        moving = struck(body, landed, pressing, _grip(body, landed, pressing))
        events.append(_event("impact", moving))
        rise = back * fall
        if rise <= LAST_IMPACT * first:
            rest = 2 * rise / (body.load * (1 - back)) if rise else MP.mpf(0)
            level = replace(moving, velocity=along(moving.velocity, normal))
            return replace(_after(level, NONE, NONE, rest), held=moving.held)
    raise OutOfReach(f"a body that bounces more than {MOST_IMPACTS} times")


def _uniform(moving: Moving, acceleration: Vector, faster: Vector) -> Piece:
    """The piece of a body with a constant acceleration (m/s^2), and a constant rate of its spin (rad/s^2) along its axis."""
    velocity, spin = (moving.velocity, acceleration), (moving.spin, faster)
    return pieces.uniform(moving.time, moving.position, moving.turn, velocity, spin)


def _falling(body: Round, moving: Moving) -> Real | None:
    """The time (s) after which a body in flight hits the plane; None if it does not."""
    height = dot(moving.position, body.surface.normal) - body.radius
    rise = dot(moving.velocity, body.surface.normal)
    height = height if height > ROUNDED * body.radius else MP.mpf(0)
    if body.load > 0:
        return (rise + MP.sqrt(rise * rise + 2 * body.load * height)) / body.load
    return height / -rise if rise < 0 else None


def _after(moving: Moving, acceleration: Vector, faster: Vector, lasting: Real) -> Moving:
    """A body after a time (s) in which it moves as in `_uniform`."""
    path = plus(scaled(moving.velocity, lasting), scaled(acceleration, lasting * lasting / 2))
    axis = moving.spin if norm(moving.spin) else faster
    size = norm(axis)
    axis = scaled(axis, 1 / size) if size else NONE
    cosine, sine = MP.cos_sin(lasting * (dot(axis, moving.spin) + lasting * dot(axis, faster) / 2) / 2)
    turn = pieces.multiplied((cosine, *scaled(axis, sine)), moving.turn)
    velocity, spin = plus(moving.velocity, scaled(acceleration, lasting)), plus(moving.spin, scaled(faster, lasting))
    return Moving(moving.time + lasting, plus(moving.position, path), velocity, spin, turn)


def slip(body: Round, moving: Moving) -> Vector:
    """The velocity of the point of contact along the plane (m/s)."""
    normal = body.surface.normal
    return along(minus(moving.velocity, scaled(cross(moving.spin, normal), body.radius)), normal)


def stopping(body: Round, moving: Moving) -> Vector:
    """The impulse along the plane over the mass (m/s) that ends the slip."""
    return scaled(slip(body, moving), -1 / (1 + body.lever))


def _grip(body: Round, moving: Moving, pressing: Real) -> Vector:
    """The impulse along the plane over the mass (m/s) in an impact, from the impulse along the normal over the mass."""
    needed = stopping(body, moving)
    allowed, size = body.surface.friction * pressing, norm(needed)
    return needed if size <= allowed else scaled(needed, allowed / size)


def struck(body: Round, moving: Moving, pressing: Real, gripping: Vector) -> Moving:
    """A body after impulses over the mass (m/s) along the normal and along the plane."""
    normal = body.surface.normal
    velocity = plus(moving.velocity, scaled(normal, pressing), gripping)
    spin = minus(moving.spin, scaled(cross(normal, gripping), body.lever / body.radius))
    after = replace(moving, velocity=velocity, spin=spin)
    return replace(after, held=bool(norm(slip(body, after)) <= ROUNDED * (norm(velocity) + body.radius * norm(spin))))


def along(vector: Vector, normal: Vector) -> Vector:
    """A vector without its part along a unit normal."""
    return minus(vector, scaled(normal, dot(vector, normal)))


def _slid(body: Round, moving: Moving, end: Real, parts: list[Piece]) -> Moving | None:
    """Append the pieces of a slip, and return the body when it no longer slips; None if it still slips at `end` (s)."""
    slipping: Vector = NONE if moving.held else slip(body, moving)
    size, steep = norm(slipping), norm(body.pull)
    if not body.braking:
        return _advance(body, moving, NONE, MP.inf, end, parts)
    if norm(cross(slipping, body.pull)) > ROUNDED * size * steep:
        return _curved(body, moving, end, parts)
    direction = scaled(slipping, 1 / size) if size else scaled(body.pull, 1 / steep)
    faster = dot(body.pull, direction) - (1 + body.lever) * body.braking
    lasting = size / -faster if size and faster < 0 else MP.inf
    return _advance(body, moving, scaled(direction, -body.braking), moving.time + lasting, end, parts)


def _advance(body: Round, moving: Moving, friction: Vector, until: Real, end: Real, parts: list[Piece]) -> Moving | None:
    """Append the steps until `until`, or at least `end` (s), in which friction is a constant acceleration (m/s^2).

    Returns the body at `until`, when it no longer slips; None if `until` is after `end`.
    """
    faster = scaled(cross(body.surface.normal, friction), -body.lever / body.radius)
    return advanced(moving, plus(body.pull, friction), faster, until, end, parts)


def advanced(moving: Moving, acceleration: Vector, faster: Vector, until: Real, end: Real, parts: list[Piece]) -> Moving | None:
    """Append the steps until `until`, or at least `end` (s), with a constant acceleration and rate of the spin.

    Returns the body at `until`; None if `until` is after `end`.
    """
    if norm(cross(moving.spin, faster)) <= ROUNDED * norm(moving.spin) * norm(faster):
        parts.append(_uniform(moving, acceleration, faster))
        return replace(_after(moving, acceleration, faster, until - moving.time), held=True) if until <= end else None
    last, share = min(until, end), MP.mpf(1)
    for _ in range(MOST_STEPS):
        if last - moving.time <= ROUNDED * last:
            return replace(moving, time=until, held=True) if until <= end else None
        step = min(share * _step(norm(moving.spin), norm(faster)), last - moving.time)
        velocity = series.linear(moving.velocity, scaled(acceleration, step))
        spin = series.linear(moving.spin, scaled(faster, step))
        taken = stepped(moving, step, series.constant(series.ONE), velocity, spin, parts)
        share, moving = (share / 2, moving) if taken is None else (min(MP.mpf(1), share * 5 / 4), taken)
    raise OutOfReach(f"a body that rolls or slips for more than {MOST_STEPS} steps")


def _step(rate: Real, faster: Real) -> Real:
    """The step (s) for an angular velocity (rad/s) and the size of its rate (rad/s^2), for which the series converge fast."""
    return 2 * STEP_RAD / (rate + MP.sqrt(rate * rate + 16 * STEP_RAD * faster))


def _curved(body: Round, moving: Moving, end: Real, parts: list[Piece]) -> Moving | None:
    """Append the steps of a slip across the fall line, and return the body when it no longer slips; None if it still slips.

    The parameter of a step is the integral of dt over the size of the slip, in which the end of the slip is infinitely far.
    """
    steep, slowing = norm(body.pull), (1 + body.lever) * body.braking
    twist = body.braking * body.lever / body.radius
    first, share = norm(slip(body, moving)), MP.mpf(1)
    for _ in range(MOST_STEPS):
        slipping = slip(body, moving)
        size = norm(slipping)
        if size <= LAST_SLIP * first and slowing > steep:
            return replace(moving, time=moving.time + size / (slowing - steep), held=True)
        if moving.time > end:
            return None
        step = share * min(STEP_SLIP * size / (slowing + steep), _step(norm(moving.spin), twist))
        u, pace = series.slip(scaled(slipping, 1 / size), scaled(body.pull, step / size), slowing * step / size)
        velocity = [
            series.summed(start, (pace, pull * step), (part, -body.braking * step))
            for start, pull, part in zip(moving.velocity, body.pull, u, strict=True)
        ]
        spin = _twisted(moving.spin, scaled(body.surface.normal, twist * step), u)
        taken = stepped(moving, step, pace, velocity, spin, parts) if series.converged([*u, pace]) else None
        share, moving = (share / 2, moving) if taken is None else (min(MP.mpf(1), share * 5 / 4), taken)
    raise OutOfReach(f"a body that slips for more than {MOST_STEPS} steps")


def _twisted(spin: Vector, lever: Vector, u: Sequence[Series]) -> list[Series]:
    """The series of an angular velocity (rad/s) whose rate is the vector product of a constant vector and a series."""
    x, y, z = lever
    a, b, c = u
    first, second, third = spin
    return [
        series.summed(first, (c, y), (b, -z)),
        series.summed(second, (a, z), (c, -x)),
        series.summed(third, (b, x), (a, -y)),
    ]


def stepped(
    moving: Moving, step: Real, pace: Series, velocity: Sequence[Series], spin: Sequence[Series], parts: list[Piece]
) -> Moving | None:
    """Append a step, and return the body at its end; None for a step that is too large.

    step: the change of the parameter (s). pace: the rate of the time in the parameter. velocity, spin: in the step.
    """
    a, b, c = (series.times(series.product(pace, part), step) for part in spin)
    turning = series.turned(moving.turn, (a, b, c))
    if not series.converged(turning):
        return None
    none = MP.mpf(0)
    path = [series.summed(none, (series.product(pace, part), step)) for part in velocity]
    clock = series.summed(none, (pace, step))
    parts.append(
        Piece(
            moving.time,
            pieces.wide(moving.position),
            pieces.wide(moving.turn),
            series.widened(path),
            series.widened(velocity),
            series.widened(spin),
            series.widened(turning),
            series.widened([clock])[0],
        )
    )
    (lasting,) = series.ended([clock])
    return Moving(
        moving.time + lasting,
        plus(moving.position, series.ended(path)),
        series.ended(velocity),
        series.ended(spin),
        series.ended(turning),
    )
