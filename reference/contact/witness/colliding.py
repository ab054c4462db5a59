"""The witness of two spheres that hit each other, in space or over a level plane.

The velocities after an impact of both spheres, and the impulse between them, are the solution of fifteen linear equations:
impulse and momentum, impulse and angular momentum, the coefficient of restitution, and either no slip after the impact or the
largest friction against the slip. Which of the two holds is decided by the impulse of the first. What the plane does follows
from `rolling`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bodycheck.reference.bounds import EPS, STATES
from bodycheck.reference.contact.witness import pieces
from bodycheck.reference.contact.witness.reading import FreeBody, Surface, bodies, pair_law, surface
from bodycheck.reference.contact.witness.rolling import (
    DECIMALS,
    NONE,
    ROUNDED,
    Moving,
    Round,
    advance,
    falling,
    grip,
    later,
    slip,
    struck,
)
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.independent.arithmetic import Real, Vector, cross, dot, minus, norm, plus, scaled
from bodycheck.reference.independent.border import MP
from bodycheck.reference.independent.directions import exact_quaternion
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.scene import Ellipsoid, Sphere
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import Instant, Witness

#: The name of the way in results.
NAME = "linear equations of impulse and momentum, power series"

#: The largest number of events; these take some seconds.
MOST_EVENTS = 2000

#: The speed after an impact on the plane, relative to the speed of a fall by the radius, at which a sphere ceases to bounce.
LAST_BOUNCE = MP.mpf(10) ** -28

#: The speeds of closing and of slip together, relative to those at the start, with which spheres on a plane cease to hit.
LAST_HIT = MP.mpf(2) ** -80

UP: Vector = (MP.mpf(0), MP.mpf(0), MP.mpf(1))


@dataclass(frozen=True, eq=False)
class One:
    """A sphere.

    Attributes
    ----------
    round, mass
        Its laws on the plane, and its mass (kg). Without a plane the laws count for nothing.
    moving
        Its state.
    over_plane, borne
        Whether there is a plane, and whether the sphere stays on it.
    rounded
        Whether it slips on the plane only because of the decimals in the file.
    """

    round: Round
    mass: Real
    moving: Moving
    over_plane: bool
    borne: bool
    rounded: bool

    @property
    def moment(self) -> Real:
        """The moment of inertia (kg m^2)."""
        return self.mass * self.round.radius**2 / self.round.lever

    @property
    def friction(self) -> Vector:
        """The acceleration (m/s^2) by the friction of the plane."""
        slipping = slip(self.round, self.moving)
        if not self.borne or self.moving.held or not self.round.braking or not norm(slipping):
            return NONE
        return scaled(slipping, -self.round.braking / norm(slipping))

    @property
    def acceleration(self) -> Vector:
        """The acceleration (m/s^2) of the centre."""
        return self.friction if self.borne else scaled(UP, -self.round.load)

    @property
    def lasts(self) -> Real:
        """The time (s) until the sphere lands or ceases to slip; infinity if it does neither."""
        if self.borne:
            slowing = norm(self.friction) * (1 + self.round.lever)
            return norm(slip(self.round, self.moving)) / slowing if slowing else MP.inf
        lasting = falling(self.round, self.moving) if self.over_plane else None
        return MP.inf if lasting is None else lasting

    def moved(self, lasting: Real, parts: list[pieces.Piece]) -> "One":
        """Append the pieces of the next `lasting` seconds, and return the sphere at their end."""
        start, until = self.moving, self.moving.time + lasting
        if self.borne:
            moving = advance(self.round, start, self.friction, until, until, parts)
            assert moving is not None  # it ends at `until`
            return replace(self, moving=replace(moving, held=start.held))
        speeds, rates = (start.velocity, self.acceleration), (start.spin, NONE)
        parts.append(pieces.uniform(start.time, start.position, start.turn, speeds, rates))
        return replace(self, moving=later(start, self.acceleration, NONE, lasting))

    def landed(self, events: list[Instant], body: int) -> "One":
        """Append the events of the sphere when it lands or ceases to slip, and return it just after.

        A slip that only the decimals of the file leave is no event.
        """
        if self.rounded:
            return replace(self, moving=replace(self.moving, held=True), rounded=False)
        if self.borne:
            return self._on_plane(replace(self.moving, held=True), events, body)
        pressing = -(1 + self.round.surface.restitution) * self.moving.velocity[2]
        moving = struck(self.round, self.moving, pressing, grip(self.round, self.moving, pressing))
        events.append(_event("impact", moving.time, body))
        if moving.velocity[2] > LAST_BOUNCE * MP.sqrt(self.round.load * self.round.radius):
            return replace(self, moving=moving)
        return self._on_plane(moving, events, body)

    def _on_plane(self, moving: Moving, events: list[Instant], body: int) -> "One":
        """Append the event with which a sphere begins to rest, roll or slip on the plane, and return it."""
        level = replace(moving, velocity=(*moving.velocity[:2], MP.mpf(0)))
        still = "rest" if norm(level.velocity) <= DECIMALS * self.round.radius else "roll"
        events.append(_event(still if level.held else "slip", level.time, body))
        return replace(self, moving=level, borne=True)


def second(scene: AnyScene, times: Array) -> Witness | None:
    """The motion of two spheres at ascending times (n,) >= 0 (s); None for any other scene.

    Raises `NotModelled` for a motion that these laws do not determine, and `OutOfReach` for too many events.
    """
    free = bodies(scene)
    if len(free) != 2 or scene.pushes or (scene.plane is not None and scene.plane.incline):
        return None
    if not all(_radius(body) for body in free):
        return None
    pair = [_one(scene, index, body) for index, body in enumerate(free)]
    gap = norm(minus(pair[1].moving.position, pair[0].moving.position)) - sum(one.round.radius for one in pair)
    if gap < -DECIMALS * sum(one.round.radius for one in pair):
        raise NotModelled("spheres that overlap at the start")
    parts: tuple[list[pieces.Piece], list[pieces.Piece]] = [], []
    events: list[Instant] = []
    wrong = float(_follow(pair, pair_law(scene, (0, 1)), gap <= 0, MP.mpf(float(times.max(initial=0.0))), parts, events))
    states = [pieces.states(each, times) for each in parts]
    attitudes = [
        np.stack(pieces.multiplied(each.turn.T, exact_quaternion(body.cosines)), axis=1)
        for each, body in zip(states, free, strict=True)
    ]
    fastest = [np.sqrt((each.spin * each.spin).sum(axis=1)).astype(float) for each in states]
    errors = {name: np.maximum(*(each.errors[name] for each in states)) for name in STATES}
    spun = wrong / float(min(one.round.radius for one in pair))
    errors["error"] = errors["error"] + pieces.ROUNDINGS + spun * times
    errors["position_error"] = errors["position_error"] + wrong * times
    errors["velocity_error"] = errors["velocity_error"] + wrong
    unseen = spun + float(ROUNDED * max(norm(one.moving.velocity) / one.round.radius for one in pair))
    errors["angular_velocity_error"] = errors["angular_velocity_error"] + np.maximum(*fastest) * errors["error"] + unseen
    return Witness(
        NAME,
        np.stack(attitudes),
        np.stack([pieces.along_body(each.spin, turn) for each, turn in zip(states, attitudes, strict=True)]),
        np.stack([each.position for each in states]),
        np.stack([each.velocity for each in states]),
        **errors,
        digits=19,
        events=tuple(events),
    )


def _radius(body: FreeBody) -> float | None:
    match body.shape:
        case Sphere(radius) | Ellipsoid((radius, _, _)) if (
            isinstance(body.shape, Sphere) or len(set(body.shape.semi_axes)) == 1
        ):
            return radius
    return None


def _one(scene: AnyScene, index: int, body: FreeBody) -> One:
    """Return a sphere at t = 0. Raises `NotModelled` for one that begins within the plane, or whose moments differ."""
    rows, radius = body.tensor, MP.mpf(_radius(body))
    moments = {rows[0][0], rows[1][1], rows[2][2]}
    if len(moments) > 1 or not rows[0][0] > 0 or any((rows[0][1], rows[0][2], rows[1][2])):
        raise NotModelled("a sphere whose moments are not those of its shape")
    over_plane, load = scene.plane is not None, MP.mpf(scene.gravity)
    plane = surface(scene, index) if over_plane else Surface(UP, MP.mpf(0), MP.mpf(0), MP.mpf(0), MP.mpf(0), one=False)
    laws = Round(radius, body.mass * radius**2 / rows[0][0], plane, NONE, load)
    spin = [dot(row, body.rates) for row in body.cosines]
    moving = Moving(MP.mpf(0), body.position, body.velocity, spin, (MP.mpf(1), MP.mpf(0), MP.mpf(0), MP.mpf(0)))
    height = body.position[2] - radius
    if over_plane and height < 0:
        raise NotModelled("a sphere that begins within the plane")
    borne = over_plane and not height and not body.velocity[2]
    slipping = norm(slip(laws, moving))
    rounded = borne and 0 < slipping <= DECIMALS * (norm(moving.velocity) + radius * norm(spin))
    return One(laws, body.mass, replace(moving, held=borne and not slipping), over_plane, borne, rounded)


def _event(kind: str, time: Real, body: int) -> Instant:
    return Instant(kind, float(time), EPS * float(time), body)


def _follow(
    pair: list[One],
    law: tuple[Real, Real],
    touching: bool,
    end: Real,
    parts: tuple[list[pieces.Piece], list[pieces.Piece]],
    events: list[Instant],
) -> Real:
    """Append the pieces of both spheres and their events until `end` (s), and return by how much velocities may be wrong (m/s).

    law: friction and restitution of the pair.
    """
    wrong, fastest = MP.mpf(0), max(norm(one.moving.velocity) + one.round.radius * norm(one.moving.spin) for one in pair)
    if touching and _closing(pair) > 0:
        pair = _collided(pair, law, events)
    for _ in range(MOST_EVENTS):
        if any(one.borne and not one.moving.held and MP.isinf(one.round.surface.friction) for one in pair):
            raise NotModelled("a sphere that slips on a plane on which nothing slips")
        left = end - pair[0].moving.time
        ends = [one.lasts for one in pair]
        hit = _meeting(pair, touching, min(*ends, left))
        until = min(*ends, hit, left)
        stays = touching and not any((*_parting(pair), *minus(pair[1].acceleration, pair[0].acceleration)))
        pair = [one.moved(until, part) for one, part in zip(pair, parts, strict=True)]
        if until >= left:
            return wrong
        if hit == until:
            touching, moves = True, _relative(pair)
            if moves < LAST_HIT * fastest and not law[0] and all(one.borne for one in pair) and not _apart(pair)[2]:
                pair, wrong = [replace(one, moving=replace(one.moving, held=True)) for one in pair], moves * _change(pair)
            else:
                pair = _collided(pair, law, events)
            continue
        pair = [one.landed(events, index) if ends[index] == until else one for index, one in enumerate(pair)]
        touching = stays
    raise OutOfReach(f"two spheres with more than {MOST_EVENTS} events")


def _apart(pair: Sequence[One]) -> Vector:
    return minus(pair[1].moving.position, pair[0].moving.position)


def _relative(pair: Sequence[One]) -> Real:
    """The sum of the speeds (m/s) at which two spheres approach each other and slip on the plane."""
    return _closing(pair) / norm(_apart(pair)) + sum(norm(slip(one.round, one.moving)) for one in pair)


def _change(pair: Sequence[One]) -> Real:
    """The change of velocities in all hits without friction that follow, at most, relative to `_relative`.

    With constants V and W of a sphere that rolls, (m (v - V)^2 + I (w - W)^2) / 2 does not grow in sum over both. It follows
    that velocities change by at most 2 (1 + q)^2, q^2 being the sum of m + I/r^2 over the smallest m or I/r^2.
    """
    inertias = [(one.mass, one.mass / one.round.lever) for one in pair]
    q = MP.sqrt(sum(map(sum, inertias)) / min(map(min, inertias)))
    return 2 * (1 + q) ** 2


def _parting(pair: Sequence[One]) -> Vector:
    return minus(pair[1].moving.velocity, pair[0].moving.velocity)


def _closing(pair: Sequence[One]) -> Real:
    """The speed (m/s) at which two spheres approach each other, times their distance (m)."""
    return -dot(_apart(pair), _parting(pair))


def _meeting(pair: Sequence[One], touching: bool, until: Real) -> Real:
    """The time (s) until two spheres meet; infinity if they do not until `until` (s). touching: whether they touch now."""
    apart, parting = _apart(pair), _parting(pair)
    pull = minus(pair[1].acceleration, pair[0].acceleration)
    reach = sum(one.round.radius for one in pair)
    if not any(pull):
        speed = norm(parting)
        if touching or not speed or dot(apart, parting) >= 0:
            return MP.inf
        nearest = norm(cross(apart, parting)) / speed
        inside = (reach - nearest) * (reach + nearest)
        return (-dot(apart, parting) / speed - MP.sqrt(inside)) / speed if inside > 0 else MP.inf
    farthest = max(norm(plus(one.moving.velocity, scaled(one.acceleration, part))) for one in pair for part in (0, until))
    if norm(apart) > reach + 2 * farthest * until:  # each goes at most this far
        return MP.inf
    powers = [
        dot(pull, pull) / 4,
        dot(pull, parting),
        dot(parting, parting) + dot(pull, apart),
        2 * dot(apart, parting),
        MP.mpf(0) if touching else dot(apart, apart) - reach**2,
    ]
    while touching and powers and abs(powers[-1]) <= ROUNDED * (reach**2 + dot(parting, parting) + dot(pull, pull)):
        powers.pop()
    if touching and powers and powers[-1] < 0:
        raise NotModelled("spheres that stay in touch and press on each other")
    return _first_root(powers)


def _first_root(powers: Sequence[Real]) -> Real:
    """The smallest positive root at which a polynomial, highest power first, changes from positive to negative values."""
    if len(powers) < 2:
        return MP.inf
    try:
        roots = MP.polyroots(list(powers), maxsteps=400, extraprec=400)
    except MP.NoConvergence as error:
        raise NotModelled("spheres that graze each other") from error
    real_roots = [root.real for root in roots if abs(root.imag) <= ROUNDED * abs(root) and root.real > 0]
    slopes = [order * power for order, power in zip(range(len(powers) - 1, 0, -1), powers, strict=False)]
    return min((root for root in real_roots if MP.polyval(slopes, root) < 0), default=MP.inf)


def _collided(pair: Sequence[One], law: tuple[Real, Real], events: list[Instant]) -> list[One]:
    """Append the events of an impact of both spheres, and return the spheres just after.

    Raises `NotModelled` if the impulse is not along the plane for a sphere that the plane bears.
    """
    apart = _apart(pair)
    normal = scaled(apart, 1 / norm(apart))
    axis = min(range(3), key=lambda k: abs(normal[k]))
    aside = cross(normal, [MP.mpf(k == axis) for k in range(3)])
    first = scaled(aside, 1 / norm(aside))
    basis = normal, first, cross(normal, first)
    arms = scaled(normal, pair[0].round.radius), scaled(normal, -pair[1].round.radius)
    at_point = [plus(one.moving.velocity, cross(one.moving.spin, arm)) for one, arm in zip(pair, arms, strict=True)]
    slipping = [dot(each, minus(at_point[0], at_point[1])) for each in basis]
    friction, restitution = law
    after, impulse = _solved(pair, arms, basis, [-restitution * slipping[0], 0, 0], None)
    if norm((0, *impulse[1:])) > friction * impulse[0]:
        size = norm((0, *slipping[1:]))
        against = [friction * part / size for part in slipping[1:]]
        after, impulse = _solved(pair, arms, basis, [-restitution * slipping[0], 0, 0], against)
    vertical = sum(part * each[2] for part, each in zip(impulse, basis, strict=True))
    events.extend(_event("impact", pair[0].moving.time, index) for index in (0, 1))
    struck_pair = []
    for index, (one, (velocity, spin)) in enumerate(zip(pair, after, strict=True)):
        moving = replace(one.moving, velocity=velocity, spin=spin)
        if one.borne:
            if abs(vertical) > ROUNDED * norm(impulse):
                raise NotModelled("a sphere on the plane that is hit across the plane")
            slips = norm(slip(one.round, moving)) > ROUNDED * (norm(velocity) + one.round.radius * norm(spin))
            moving = replace(moving, velocity=(*velocity[:2], MP.mpf(0)), held=not slips)
            if moving.held != one.moving.held:
                events.append(_event("roll" if moving.held else "slip", moving.time, index))
        struck_pair.append(replace(one, moving=moving, rounded=False))
    return struck_pair


def _solved(
    pair: Sequence[One], arms: Sequence[Vector], basis: Sequence[Vector], wanted: Sequence[Real], against: Sequence[Real] | None
) -> tuple[list[tuple[Vector, Vector]], list[Real]]:
    """The velocities and angular velocities after an impact, and the impulse on the second sphere along a basis (N s).

    Parameters
    ----------
    pair, arms
        The spheres, and the vectors from their centres to the point of contact (m).
    basis
        The normal from the first sphere to the second, and two directions across it.
    wanted
        The velocity of the first point of contact relative to the second along the basis after the impact (m/s).
    against
        The ratios of the impulse along the two directions to that along the normal, which replace the wanted velocities; None
        if the slip ends.
    """
    matrix, right = MP.zeros(15, 15), MP.zeros(15, 1)
    for index, (one, arm) in enumerate(zip(pair, arms, strict=True)):
        sign, first = 2 * index - 1, 6 * index
        for k in range(3):
            matrix[first + k, first + k], right[first + k] = one.mass, one.mass * one.moving.velocity[k]
            matrix[first + 3 + k, first + 3 + k], right[first + 3 + k] = one.moment, one.moment * one.moving.spin[k]
            for number, each in enumerate(basis):
                matrix[first + k, 12 + number] = -sign * each[k]
                matrix[first + 3 + k, 12 + number] = -sign * cross(arm, each)[k]
        for number, each in enumerate(basis):
            lever = cross(arm, each)
            for k in range(3):
                matrix[12 + number, first + k], matrix[12 + number, first + 3 + k] = -sign * each[k], -sign * lever[k]
    for number in range(3):
        right[12 + number] = wanted[number]
    for number, ratio in enumerate(against or (), start=13):
        for column in range(12):
            matrix[number, column] = 0
        matrix[number, number], matrix[number, 12] = 1, -ratio
    values = list(MP.lu_solve(matrix, right))
    return [(values[0:3], values[3:6]), (values[6:9], values[9:12])], values[12:15]
