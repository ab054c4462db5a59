"""The motion of two spheres as phases of constant acceleration, and the events between them.

In a phase, each sphere flies, slips on the plane against a constant friction, or rolls. A phase of both ends when one of them
lands or ceases to slip, or when they hit each other.

Hits of two spheres on a plane may accumulate: each makes the spheres slip, and friction brings them together again. They are
left out when the speeds of closing and of slip, together s, are too small to change what is printed. Let u be the velocity
with which a sphere of mass m and ratio k = I/(m r^2) would roll on, which friction does not change, and z = w x n r that of
its spin at the plane. The sum of m (v - V)^2 / 2 and k m (z - V)^2 / 2 over both spheres grows neither by friction, which
acts against v - z, nor by a hit without friction, if their constant velocities V do not bring the spheres closer. With V near
to u it follows that v and z change by at most 2 (1 + q)^2 s for ever, where q^2 is the sum of (1 + k) m, divided by the
smallest m or k m.
"""

from dataclasses import dataclass, replace

from bodycheck.reference.contact.motion import EventKind
from bodycheck.reference.contact.spheres import collision
from bodycheck.reference.contact.spheres.ball import Ball, Law, Moving, never_slips, size
from bodycheck.reference.contact.spheres.collision import UP, Impulse, slip
from bodycheck.reference.contact.spheres.touch import next_touch
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.exact.numbers import MP, NEGLIGIBLE, Real, Vector3
from bodycheck.reference.exact.rotations import ORIGIN, cross, dot, minus, plus, scaled
from bodycheck.reference.mechanisms.mechanism import WORLD

#: The largest number of events; these take some seconds.
MAX_EVENTS = 4000

#: The speed after an impact on the plane, relative to that of a fall by half the radius, below which a sphere no longer
#: bounces. The bounces that are left out take less time than the rounding of an instant.
LAST_IMPACT = MP.mpf(10) ** -30

#: The ratio of the speeds of closing and of slip, together, to the speeds at the start below which hits of two spheres on the
#: plane are left out.
LAST_HIT = MP.mpf(2) ** -80

#: The ratio of a speed to the speeds at the start below which a sphere is at rest, because of the decimals in the file.
AT_REST = 1e-12


@dataclass(frozen=True, eq=False)
class Pair:
    """Two spheres.

    Attributes
    ----------
    balls, law
        The spheres, and the law of their contact with each other.
    gravity
        The gravitational acceleration along -z (m/s^2).
    speed
        The size of the speeds at the start (m/s).
    """

    balls: tuple[Ball, Ball]
    law: Law
    gravity: Real
    speed: Real


@dataclass(frozen=True, eq=False)
class Phase:
    """A phase of a sphere: its state at the start, its acceleration (m/s^2), and the rate of its angular velocity (rad/s^2)."""

    start: Moving
    acceleration: Vector3 = ORIGIN
    spin_rate: Vector3 = ORIGIN


@dataclass(frozen=True, eq=False)
class Change:
    """An event of a sphere.

    Attributes
    ----------
    kind, body, moving
        The kind of the event, the index of the sphere, and the sphere just after it.
    other
        The index of what it hits in an impact: the other sphere, or `WORLD`.
    closing
        The speed (m/s) along the line of centres, or towards the plane, just before an impact.
    grip
        The smallest coefficient of friction that ends the slip in an impact.
    """

    kind: EventKind
    body: int
    moving: Moving
    other: int = WORLD
    closing: Real = MP.zero
    grip: Real = MP.zero


@dataclass(frozen=True, eq=False)
class Course:
    """The phases of each sphere, and the events between them, in ascending order of time."""

    phases: tuple[list[Phase], list[Phase]]
    changes: list[Change]


def course(pair: Pair, starts: tuple[Moving, Moving], touching: bool, end: Real) -> Course:
    """Return the phases and events until the time `end` (s).

    starts: the spheres at t = 0. touching: whether they touch.

    Raises `NotModelled` if an impact depends on more than the laws of the pairs, or if spheres stay in touch and press on each
    other, and `OutOfReach` for too many events.
    """
    whole, moving = Course(([], []), []), starts
    if touching and _closing(moving) > 0:
        moving = _collided(pair, moving, whole.changes)
    reach = pair.balls[0].radius + pair.balls[1].radius
    for _ in range(MAX_EVENTS):
        one, other = (_phase(pair, ball, each) for ball, each in zip(pair.balls, moving, strict=True))
        whole.phases[0].append(one)
        whole.phases[1].append(other)
        left = end - moving[0].time
        ends = [_lasts(pair, ball, phase) for ball, phase in zip(pair.balls, (one, other), strict=True)]
        until = min(*ends, left)
        apart = minus(other.start.position, one.start.position)
        parting = minus(other.start.velocity, one.start.velocity), minus(other.acceleration, one.acceleration)
        hit = next_touch(apart, *parting, reach, until, touching=touching)
        if min(hit, until) >= left:
            return whole
        if abs(hit - until) <= NEGLIGIBLE * end:
            raise NotModelled("a sphere that hits another one at the instant at which it lands or ceases to slip")
        moving = after(one, min(hit, until)), after(other, min(hit, until))
        if hit < until:
            rolling, touching = _left_out(pair, moving), True
            moving = rolling or _collided(pair, moving, whole.changes)
            continue
        touching = touching and not any(map(any, parting))
        ended = [
            _ended(pair, index, each, whole.changes) if lasts == until else each
            for index, (each, lasts) in enumerate(zip(moving, ends, strict=True))
        ]
        moving = ended[0], ended[1]
    raise OutOfReach(f"two spheres with more than {MAX_EVENTS} events")


def after(phase: Phase, lasting: Real) -> Moving:
    """Return a sphere at a time (s) after the start of a phase."""
    start = phase.start
    return replace(
        start,
        time=start.time + lasting,
        position=plus(start.position, scaled(lasting, plus(start.velocity, scaled(lasting / 2, phase.acceleration)))),
        velocity=plus(start.velocity, scaled(lasting, phase.acceleration)),
        spin=plus(start.spin, scaled(lasting, phase.spin_rate)),
    )


def _phase(pair: Pair, ball: Ball, moving: Moving) -> Phase:
    """Return the phase of a sphere that begins. Raises `NotModelled` for a slip on a plane on which nothing slips."""
    if not moving.borne:
        return Phase(moving, scaled(-pair.gravity, UP))
    law, slipping = ball.plane, slip(ball, moving)
    speed = size(slipping)
    assert law is not None  # the plane bears the sphere
    if moving.rolls or not speed:
        return Phase(moving)
    if never_slips(law):
        raise NotModelled("a sphere that slips on a plane on which nothing slips")
    braking = scaled(-law.friction * pair.gravity / speed, slipping)
    return Phase(moving, braking, scaled(-ball.radius * ball.mass / ball.moment, cross(UP, braking)))


def _lasts(pair: Pair, ball: Ball, phase: Phase) -> Real:
    """Return how long (s) a sphere flies, or slips on the plane; infinity if this has no end."""
    start = phase.start
    if start.borne:
        slowing = size(phase.acceleration) * ball.mass * ball.mobility
        return size(slip(ball, start)) / slowing if slowing else MP.inf
    if ball.plane is None:
        return MP.inf
    height, rise = max(start.position[2] - ball.radius, MP.zero), start.velocity[2]
    speed = MP.sqrt(rise * rise + 2 * pair.gravity * height)
    if rise < 0:
        return 2 * height / (speed - rise)
    return (rise + speed) / pair.gravity if pair.gravity else MP.inf


def _ended(pair: Pair, index: int, moving: Moving, changes: list[Change]) -> Moving:
    """Append the events of a sphere that lands, or ceases to slip on the plane, and return the sphere just after."""
    ball = pair.balls[index]
    if moving.borne:
        rolling = replace(moving, rolls=True)
        changes.append(Change(_kind(pair, rolling), index, rolling))
        return rolling
    assert ball.plane is not None  # it lands on the plane
    fall = -moving.velocity[2]
    impulse = collision.on_plane(ball, moving, ball.plane)
    risen = collision.struck(ball, moving, impulse.on_first, scaled(MP.mpf(-1), UP))
    changes.append(Change("impact", index, risen, WORLD, fall, impulse.grip))
    if risen.velocity[2] > LAST_IMPACT * MP.sqrt(pair.gravity * ball.radius):
        return risen
    landed = _borne(ball, risen)
    changes.append(Change(_kind(pair, landed), index, landed))
    return landed


def _borne(ball: Ball, moving: Moving) -> Moving:
    """Return a sphere that stays on the plane, with its velocity along the plane."""
    (x, y, _), (speed_x, speed_y, _) = moving.position, moving.velocity
    level = replace(moving, position=(x, y, ball.radius), velocity=(speed_x, speed_y, MP.zero), borne=True)
    slipping = size(slip(ball, level))
    return replace(level, rolls=bool(slipping <= NEGLIGIBLE * (size(level.velocity) + ball.radius * size(level.spin))))


def _kind(pair: Pair, moving: Moving) -> EventKind:
    """Return the kind of the event with which a sphere begins to slip, to roll or to rest on the plane."""
    if not moving.rolls:
        return "slip"
    return "rest" if size(moving.velocity) <= AT_REST * pair.speed else "roll"


def _collided(pair: Pair, moving: tuple[Moving, Moving], changes: list[Change]) -> tuple[Moving, Moving]:
    """Append the events of two spheres that hit each other, and return the spheres just after.

    Raises `NotModelled` if the impulse presses a sphere on the plane that bears it.
    """
    normal, impulse = collision.direction(*moving), collision.between(pair.balls, moving, pair.law)
    closing = _closing(moving)
    struck = [_struck(pair, index, moving[index], impulse, normal) for index in (0, 1)]
    for index, each in enumerate(struck):
        changes.append(Change("impact", index, each, 1 - index, closing, impulse.grip))
    for index, (before, each) in enumerate(zip(moving, struck, strict=True)):
        if each.borne and before.rolls != each.rolls:
            changes.append(Change(_kind(pair, each), index, each))
    return struck[0], struck[1]


def _left_out(pair: Pair, moving: tuple[Moving, Moving]) -> tuple[Moving, Moving] | None:
    """Return two spheres that roll on from a hit if it and all later ones are left out; None if they are not."""
    one, other = pair.balls
    if pair.law.friction or one.radius != other.radius or not all(each.borne for each in moving):
        return None
    speeds = _closing(moving) + sum(size(slip(ball, each)) for ball, each in zip(pair.balls, moving, strict=True))
    if not speeds < LAST_HIT * pair.speed:
        return None
    ratios = [ball.moment / (ball.mass * ball.radius**2) for ball in pair.balls]
    whole = sum((1 + k) * ball.mass for k, ball in zip(ratios, pair.balls, strict=True))
    least = min(min(1, k) * ball.mass for k, ball in zip(ratios, pair.balls, strict=True))
    doubt = 2 * (1 + MP.sqrt(whole / least)) ** 2 * speeds
    return replace(moving[0], rolls=True, doubt=doubt), replace(moving[1], rolls=True, doubt=doubt)


def _closing(moving: tuple[Moving, Moving]) -> Real:
    """Return the speed (m/s) at which two spheres approach each other."""
    return dot(collision.direction(*moving), minus(moving[0].velocity, moving[1].velocity))


def _struck(pair: Pair, index: int, moving: Moving, impulse: Impulse, normal: Vector3) -> Moving:
    """Return a sphere just after an impact. normal: the direction from the first sphere to the second."""
    ball, sign = pair.balls[index], MP.mpf(1 - 2 * index)
    exerted = scaled(sign, impulse.on_first)
    each = collision.struck(ball, moving, exerted, scaled(sign, normal))
    if not moving.borne:
        return each
    lifting = exerted[2]
    if abs(lifting) <= NEGLIGIBLE * size(exerted):
        return _borne(ball, each)
    if lifting < 0:
        raise NotModelled("a sphere on the plane that another one presses on it in an impact, of which the plane bears a part")
    return replace(each, borne=False, rolls=False)
