"""The witness of a sphere alone on a plane with rolling and torsional friction.

Velocities are along two directions of the plane and its normal. Along a line with separate limits, the accelerations are those
that make Gauss's function of constraint with the powers of friction smallest. All other motions are power series of Newton's
and Euler's equations, step by step: see `flowing`.
"""

from collections.abc import Sequence
from dataclasses import replace

from bodycheck.reference.bounds import EPS
from bodycheck.reference.contact.witness import balls, pieces
from bodycheck.reference.contact.witness.flowing import Flow, flowed, rates_in_cone
from bodycheck.reference.contact.witness.pieces import Piece
from bodycheck.reference.contact.witness.reading import FreeBody, bodies, surface
from bodycheck.reference.contact.witness.rolling import DECIMALS, NONE, Moving, Round, advanced, along
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.independent.arithmetic import Real, Vector, cross, dot, norm, plus, scaled
from bodycheck.reference.independent.border import MP
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.scene import Sphere
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import Instant, Witness

#: The number of sweeps in which the smallest value of a function is found, and the size of an acceleration that is zero.
SWEEPS, ZERO = 700, MP.mpf(10) ** -60

#: The largest number of parts of a motion.
MOST_PARTS = 60


def second(scene: AnyScene, times: Array) -> Witness | None:
    """The motion of a sphere with rolling or torsional friction at ascending times (n,) >= 0 (s).

    Returns None for a scene without such friction. Raises `NotModelled` for any other body with it.
    """
    laws = scene.contact_laws if isinstance(scene, Mechanism) else (scene.plane,)
    if not any(law is not None and (law.rolling_friction or law.torsional_friction) for law in laws):
        return None
    free = bodies(scene)
    if len(free) != 1 or scene.pushes or not isinstance(free[0].shape, Sphere):
        raise NotModelled("rolling friction of other bodies than one sphere")
    (body,), plane = free, surface(scene)
    radius = MP.mpf(body.shape.radius) if isinstance(body.shape, Sphere) else MP.mpf(0)
    gravity: Vector = (MP.mpf(0), MP.mpf(0), -MP.mpf(scene.gravity))
    ratio = body.mass * radius**2 / balls.moment(body)
    whole = Round(radius, ratio, plane, along(gravity, plane.normal), -dot(gravity, plane.normal))
    flow, begun = _begun(whole, body)
    parts: list[Piece] = []
    events = _course(flow, begun.moving, MP.mpf(float(times.max(initial=0.0))), parts)
    return balls.witness_of(whole, body, begun, pieces.states(parts, times), events, times)


def _begun(whole: Round, body: FreeBody) -> tuple[Flow, balls.Begun]:
    """The velocities and the body at the start. Raises `NotModelled` for one that is not on the plane."""
    normal = whole.surface.normal
    height, speed = dot(body.position, normal) - whole.radius, norm(body.velocity)
    sinking = dot(body.velocity, normal)
    if abs(height) > DECIMALS * whole.radius or abs(sinking) > DECIMALS * speed:
        raise NotModelled("a sphere that is not on the plane")
    first = _downhill(whole)
    second = cross(normal, first)
    spin: Vector = [dot(row, body.rates) for row in body.cosines]
    r = whole.radius
    turning = r * dot(spin, second), -r * dot(spin, first)
    slipping = dot(body.velocity, first) - turning[0], dot(body.velocity, second) - turning[1]
    missed = abs(sinking)
    if norm((*slipping, MP.mpf(0))) <= DECIMALS * (speed + r * norm(spin)):
        missed, slipping = missed + abs(slipping[0]) + abs(slipping[1]), (MP.mpf(0), MP.mpf(0))
    elif MP.isinf(whole.surface.friction):
        raise NotModelled("a body that slips at the start on a plane on which nothing slips")
    flow = Flow(whole, first, second, slipping, turning, r * dot(spin, normal))
    position = plus(body.position, scaled(normal, -height))
    moving = flow.moved(Moving(MP.mpf(0), position, NONE, NONE, (MP.mpf(1), MP.mpf(0), MP.mpf(0), MP.mpf(0))))
    return flow, balls.Begun(moving, False, float(abs(height)), float(missed), 0.0)


def _downhill(whole: Round) -> Vector:
    """A unit vector along the plane, downhill if it is inclined."""
    steep = norm(whole.pull)
    return scaled(whole.pull, 1 / steep) if steep else (MP.mpf(1), MP.mpf(0), MP.mpf(0))


def _course(flow: Flow, moving: Moving, end: Real, parts: list[Piece]) -> list[Instant]:
    """Append the pieces of a motion until `end` (s), and return its events."""
    events: list[Instant] = []
    slipped = flow.slips
    for number in range(MOST_PARTS):
        direction = flow.line()
        rates = rates_in_cone(flow) if flow.one else None if direction is None else _along(flow, direction)
        moves = flow.moves or (rates is not None and any(rates))
        if number:
            slips = flow.slips or (rates is not None and any(rates[:2]))
            kind = "rest" if not moves else "slip" if slips and not slipped else "roll" if slipped and not slips else ""
            events += (
                [Instant(kind, float(moving.time), EPS * float(moving.time))]
                if kind and (kind == "rest" or not flow.one)
                else []
            )
            slipped = slips
        after = flowed(flow, moving, end, parts) if rates is None else _uniform(flow, rates, moving, end, parts)
        if after is None:
            return events
        flow, moving = after
    raise OutOfReach(f"a sphere with more than {MOST_PARTS} changes of its motion")


def _uniform(flow: Flow, rates: Sequence[Real], moving: Moving, end: Real, parts: list[Piece]) -> tuple[Flow, Moving] | None:
    """Append a part with constant rates of the velocities, and return what follows it; None if it lasts until `end` (s)."""
    values = *flow.slipping, *flow.turning, flow.pivoting
    lasting = min((-v / a for v, a in zip(values, rates, strict=True) if v * a < 0), default=MP.inf)
    u_1, u_2, p_1, p_2, s = rates
    changed = replace(flow, slipping=(u_1, u_2), turning=(p_1, p_2), pivoting=s).moved(moving)
    after = advanced(moving, changed.velocity, changed.spin, moving.time + lasting, end, parts)
    if after is None:
        return None
    ended = [v + lasting * a for v, a in zip(values, rates, strict=True)]
    largest = max(map(abs, values))
    u_1, u_2, p_1, p_2, s = (MP.mpf(0) if abs(v) <= ZERO * largest else v for v in ended)
    later = replace(flow, slipping=(u_1, u_2), turning=(p_1, p_2), pivoting=s)
    return later, later.moved(after)


def _along(flow: Flow, direction: tuple[Real, Real]) -> tuple[Real, ...]:
    """The rates of all velocities of a sphere with separate limits, which moves along a line.

    A velocity that is not zero is braked by its limit. The rates of the others make half the square of all accelerations that
    are not gravity's, each with its inertia, and the power of friction smallest; each in turn, as both are convex.
    """
    x, y = direction
    body, lever = flow.body, flow.body.lever
    pull = norm(body.pull) * x
    slipping, turning = (a * x + b * y for a, b in (flow.slipping, flow.turning))
    limits = body.surface.friction * body.load if body.load else MP.mpf(0), body.surface.rolling / body.radius * body.load
    slips, turns = MP.mpf(0), MP.mpf(0)
    for _ in range(SWEEPS):
        slips = _smallest(pull - turns, MP.mpf(1), limits[0], slipping)
        turns = _smallest(pull - slips, 1 + 1 / lever, limits[1], turning)
    slips, turns = (MP.mpf(0) if abs(rate) <= ZERO * (1 + abs(pull) + limits[1]) else rate for rate in (slips, turns))
    braking = -MP.sign(flow.pivoting) * lever * body.surface.torsional / body.radius * body.load
    return slips * x, slips * y, turns * x, turns * y, braking


def _smallest(target: Real, inertia: Real, limit: Real, velocity: Real) -> Real:
    """The rate a that makes inertia a^2/2 - target a + limit |a| smallest; with sign(v) a for |a| if v is not zero."""
    if velocity:
        return (target - limit * MP.sign(velocity)) / inertia
    return MP.mpf(0) if abs(target) <= limit else (target - limit * MP.sign(target)) / inertia
