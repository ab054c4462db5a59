"""Motions of a sphere with rolling and torsional friction as power series, step by step.

The velocities are the slip u, the rolling velocity p = r w x n and the pivoting velocity s = r w n, along two directions of the
plane. The part of a step is the parameter, and each velocity is in units of its size at the start of the step, if it is not
zero. The pace of time is the product of the sizes of slip and rolling velocity, or the size of that which friction does not
keep at zero; in one cone it is the size of all velocities with their coefficients. No velocity vanishes then in a finite
number of steps, and all equations are polynomials.
"""

from dataclasses import dataclass, replace
from operator import mul

from bodycheck.reference.contact.witness import series
from bodycheck.reference.contact.witness.pieces import Piece
from bodycheck.reference.contact.witness.rolling import STEP_RAD, Moving, Round, stepped
from bodycheck.reference.contact.witness.series import BITS, TERMS, Series
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.independent.arithmetic import Real, Vector, norm, plus, scaled
from bodycheck.reference.independent.border import MP

#: The ratio of the size of a velocity to its first size at which it has vanished.
VANISHED = MP.mpf(10) ** -22

#: The relative difference of the rates of two velocities, each over the velocity, at which they keep their ratio.
KEPT = MP.mpf(10) ** -19

#: The relative distance from a line of velocities along it, because of the decimals of a file.
ASIDE = MP.mpf(10) ** -12

#: The largest relative change of a velocity in a step, and the largest number of steps.
STEP, MOST = 3, 1500

Pair = tuple[Real, Real]


@dataclass(frozen=True, eq=False)
class Flow:
    """A sphere on its plane and its velocities.

    Attributes
    ----------
    body
        The sphere and its plane.
    first, second
        Unit vectors along the plane, world frame, of which the first points downhill.
    slipping, turning, pivoting
        The slip and the rolling velocity along these vectors, and the pivoting velocity (m/s).
    """

    body: Round
    first: Vector
    second: Vector
    slipping: Pair
    turning: Pair
    pivoting: Real

    @property
    def one(self) -> bool:
        """True for one cone."""
        return self.body.surface.one

    @property
    def slips(self) -> bool:
        """True if the point of contact slips."""
        return any(self.slipping)

    @property
    def moves(self) -> bool:
        """True if any velocity is not zero."""
        return self.slips or any(self.turning) or bool(self.pivoting)

    @property
    def coefficients(self) -> tuple[Real, Real, Real]:
        """The coefficients of friction, of rolling friction over the radius, and of torsional friction over the radius."""
        surface, radius = self.body.surface, self.body.radius
        return surface.friction, surface.rolling / radius, surface.torsional / radius

    def line(self) -> Pair | None:
        """The direction of slip, rolling velocity and gravity along the plane; None if they are not along one line."""
        moving = [pair for pair in (self.slipping, self.turning) if any(pair)]
        if norm(self.body.pull) or not moving:
            x, y = MP.mpf(1), MP.mpf(0)
        else:
            size = MP.hypot(*moving[0])
            x, y = moving[0][0] / size, moving[0][1] / size
        aside = any(abs(a * y - b * x) > ASIDE * MP.hypot(a, b) for a, b in moving)
        return None if aside else (x, y)

    def moved(self, moving: Moving) -> Moving:
        """A body with the velocity and the angular velocity of these velocities."""
        (u_1, u_2), (p_1, p_2), r = self.slipping, self.turning, self.body.radius
        velocity = plus(scaled(self.first, u_1 + p_1), scaled(self.second, u_2 + p_2))
        spin = plus(
            scaled(self.first, -p_2 / r), scaled(self.second, p_1 / r), scaled(self.body.surface.normal, self.pivoting / r)
        )
        return replace(moving, velocity=velocity, spin=spin)


def rates_in_cone(flow: Flow) -> tuple[Real, ...] | None:
    """The constant rates of the velocities in one cone, if they keep their ratios; else None."""
    if not flow.moves or (not flow.slips and not any(flow.turning) and not flow.coefficients[2]):
        return _released(flow)
    if not norm(flow.body.pull) and not flow.slips and not any(flow.turning):
        none = MP.mpf(0)
        return none, none, none, none, -MP.sign(flow.pivoting) * flow.body.lever * flow.coefficients[2] * flow.body.load
    return kept_ratio(flow)


def _released(flow: Flow) -> tuple[Real, ...]:
    """The rates of a sphere that is released at rest: the forces are on the cone, and the rates along its normal."""
    mu, rolling, _ = flow.coefficients
    none, pull, load, lever = MP.mpf(0), norm(flow.body.pull), flow.body.load, flow.body.lever
    if not pull or pull**2 * (1 / mu**2 + 1 / rolling**2) <= load**2:
        return none, none, none, none, none
    low, high = none, MP.pi / 2
    for _ in range(360):
        angle = (low + high) / 2
        force, moment = -load * mu * MP.cos(angle), -load * rolling * MP.sin(angle)
        slips, turns = pull + force + lever * (force - moment), lever * (moment - force)
        if slips * MP.sin(angle) / rolling > turns * MP.cos(angle) / mu:
            low, high = low, angle
        else:
            low, high = angle, high
    return slips, none, turns, none, none


def _rates(flow: Flow) -> tuple[Real, ...]:
    """The rates of the velocities that friction does not keep at zero (m/s^2)."""
    (u_1, u_2), (p_1, p_2), s = flow.slipping, flow.turning, flow.pivoting
    mu, rolling, torsional = flow.coefficients
    load, lever, pull = flow.body.load, flow.body.lever, norm(flow.body.pull)
    if flow.one:
        size = _size(flow)
        weights = mu**2 / size, rolling**2 / size, torsional**2 / size
    else:
        sizes = MP.hypot(u_1, u_2), MP.hypot(p_1, p_2), abs(s)
        weights = tuple(c / size if size else MP.mpf(0) for c, size in zip((mu, rolling, torsional), sizes, strict=True))
    f_1, f_2, m_1, m_2 = (
        -load * w * v for w, v in ((weights[0], u_1), (weights[0], u_2), (weights[1], p_1), (weights[1], p_2))
    )
    return (
        pull + f_1 + lever * (f_1 - m_1),
        f_2 + lever * (f_2 - m_2),
        lever * (m_1 - f_1),
        lever * (m_2 - f_2),
        -lever * load * weights[2] * s,
    )


def _size(flow: Flow) -> Real:
    mu, rolling, torsional = flow.coefficients
    squares = (mu * MP.hypot(*flow.slipping)) ** 2 + (rolling * MP.hypot(*flow.turning)) ** 2
    return MP.sqrt(squares + (torsional * flow.pivoting) ** 2)


def kept_ratio(flow: Flow) -> tuple[Real, ...] | None:
    """The rates of a sphere that rolls along a line in one cone, if slip and rolling velocity keep their ratio; else None."""
    direction = flow.line()
    if direction is None or not (flow.slips and any(flow.turning)) or (flow.pivoting and flow.coefficients[2]):
        return None
    rates = _rates(flow)
    x, y = direction
    slip, turning, faster, growth = (a * x + b * y for a, b in (flow.slipping, flow.turning, rates[:2], rates[2:4]))
    if not growth or abs(faster / slip - growth / turning) > KEPT * abs(growth / turning):
        return None
    faster = growth / turning * slip
    return faster * x, faster * y, growth * x, growth * y, MP.mpf(0)


def flowed(flow: Flow, moving: Moving, end: Real, parts: list[Piece]) -> tuple[Flow, Moving] | None:
    """Append the steps of a motion until a velocity vanishes or keeps its ratio; return what follows, or None after `end`."""
    stop = flow.body.lever * flow.coefficients[2] * flow.body.load
    until = moving.time + abs(flow.pivoting) / stop if flow.pivoting and stop and not flow.one else MP.inf
    sizes, share = _sizes(flow), MP.mpf(1)
    for _ in range(MOST):
        if moving.time > end:
            return None
        if flow.one and kept_ratio(flow) is not None:
            return flow, moving
        gone = [now <= VANISHED * first < MP.inf for now, first in zip(_sizes(flow), sizes, strict=True)]
        if any(gone):
            return _ended(flow, moving, gone)
        taken = _step(flow, moving, share, until, parts)
        share = share / 2 if taken is None else min(MP.mpf(1), share * 5 / 4)
        if taken is not None:
            flow, moving = taken
            if moving.time >= until * (1 - KEPT):
                return replace(flow, pivoting=MP.mpf(0)), replace(flow, pivoting=MP.mpf(0)).moved(moving)
    raise OutOfReach(f"a sphere that slips and rolls for more than {MOST} steps")


def _sizes(flow: Flow) -> tuple[Real, Real]:
    """The sizes of the velocities that may vanish; infinite for one that does not count."""
    if flow.one:
        return _size(flow), MP.inf
    slipping, turning = (
        MP.hypot(*pair) if any(pair) and coefficient else MP.inf
        for pair, coefficient in zip((flow.slipping, flow.turning), flow.coefficients, strict=False)
    )
    return slipping, turning


def _ended(flow: Flow, moving: Moving, gone: list[bool]) -> tuple[Flow, Moving]:
    """The sphere when a velocity has vanished, whose direction no longer changes."""
    rates, none = _rates(flow), (MP.mpf(0), MP.mpf(0))
    if flow.one:
        # All velocities shrink by the same ratio.
        largest = flow.turning if MP.hypot(*flow.turning) > MP.hypot(*flow.slipping) else flow.slipping
        rate = rates[2:4] if largest is flow.turning else rates[:2]
        left = MP.hypot(*largest) / MP.hypot(*rate)
        pivoting = MP.mpf(0) if flow.coefficients[2] else flow.pivoting
        later = replace(flow, slipping=none, turning=none, pivoting=pivoting)
    else:
        velocity, rate = (flow.slipping, _slip_rates(flow)) if gone[0] else (flow.turning, _turn_rates(flow))
        left = MP.hypot(*velocity) / MP.hypot(*rate)
        later = replace(flow, slipping=none) if gone[0] else replace(flow, turning=none)
    return later, later.moved(replace(moving, time=moving.time + left))


def _slip_rates(flow: Flow) -> tuple[Real, ...]:
    """The rates of the slip; where friction keeps the sphere from rolling, its moment is that of the force."""
    if any(flow.turning) or not flow.coefficients[1]:
        return _rates(flow)[:2]
    size = MP.hypot(*flow.slipping)
    braking = [-flow.coefficients[0] * flow.body.load * part / size for part in flow.slipping]
    return braking[0] + norm(flow.body.pull), braking[1]


def _turn_rates(flow: Flow) -> tuple[Real, ...]:
    """The rates of the rolling velocity; of a sphere that does not slip, those of its velocity."""
    if flow.slips or not flow.coefficients[0]:
        return _rates(flow)[2:4]
    size, part = MP.hypot(*flow.turning), flow.body.lever / (1 + flow.body.lever)
    moment = [-flow.coefficients[1] * flow.body.load * each / size for each in flow.turning]
    return (moment[0] + norm(flow.body.pull)) * part, moment[1] * part


@dataclass(frozen=True, eq=False)
class _Growing:
    """The series of the velocities in a step, each over its size at the start: slip, rolling and pivoting velocity."""

    slip: tuple[Series, Series]
    turn: tuple[Series, Series]
    pivot: Series
    pace: Series


def _step(flow: Flow, moving: Moving, share: Real, until: Real, parts: list[Piece]) -> tuple[Flow, Moving] | None:
    """Append a step, and return the sphere at its end; None if the step is too large."""
    u, p, s = MP.hypot(*flow.slipping), MP.hypot(*flow.turning), abs(flow.pivoting)
    step = share * _length(flow, u, p)
    if flow.one:  # a velocity that is zero grows, in units of the others
        u, p, s = (each or u + p + s for each in (u, p, s))
    grown = _series(flow, u, p, s, step)
    last = moving.time + step * series.real(sum(grown.pace)) - until
    converged = series.converged([*grown.slip, *grown.turn, grown.pivot, grown.pace])
    if converged and last > 0:
        step = _shortened(grown.pace, step, until - moving.time)
        grown = _series(flow, u, p, s, step)
    velocity = [_combined((a, u), (b, p)) for a, b in zip(grown.slip, grown.turn, strict=True)]
    r = flow.body.radius
    turning = [_combined((grown.turn[1], -p / r)), _combined((grown.turn[0], p / r)), _combined((grown.pivot, s / r))]
    frame = flow.first, flow.second, flow.body.surface.normal
    in_world = [_combined(*((part, axis[row]) for part, axis in zip(velocity, frame, strict=False))) for row in range(3)]
    spin = [_combined(*((part, axis[row]) for part, axis in zip(turning, frame, strict=True))) for row in range(3)]
    taken = stepped(moving, step, grown.pace, in_world, spin, parts) if converged else None
    if taken is None:
        return None
    u_1, u_2, p_1, p_2, pivot = series.ended([*grown.slip, *grown.turn, grown.pivot])
    later = replace(flow, slipping=(u * u_1, u * u_2), turning=(p * p_1, p * p_2), pivoting=s * pivot)
    return later, later.moved(taken)


def _shortened(pace: Series, step: Real, lasting: Real) -> Real:
    """The step after which a time (s) has passed, which is within a step of a given pace, by Newton's method."""
    clock = [series.real(value) / order for order, value in enumerate(pace, start=1)]
    part = lasting / (step * sum(clock))
    for _ in range(200):
        passed = step * sum(value * part**order for order, value in enumerate(clock, start=1))
        rate = step * sum(order * value * part ** (order - 1) for order, value in enumerate(clock, start=1))
        change = (lasting - passed) / rate
        part += change
        if abs(change) <= MP.mpf(10) ** -60:
            break
    return step * part


def _length(flow: Flow, u: Real, p: Real) -> Real:
    """The length of a step (s) in which no velocity changes by much more than its size, and the sphere does not turn far."""
    mu, rolling, torsional = flow.coefficients
    load, lever, pull = flow.body.load, flow.body.lever, norm(flow.body.pull)
    if flow.one:
        size = _size(flow)
        fastest = load * (1 + lever) * max(mu, rolling, torsional) ** 2 / size + pull * max(mu, rolling) / size
        slipping = STEP / fastest
    else:
        strength = pull + (mu * (1 + lever) if u and not MP.isinf(mu) else 0) * load + rolling * lever * load
        slipping = STEP * min([each for each in (u, p) if each], default=MP.inf) / strength
    speed = (u + p + abs(flow.pivoting)) / flow.body.radius
    return min(slipping, 2 * STEP_RAD / speed)


def _series(flow: Flow, u: Real, p: Real, s: Real, step: Real) -> _Growing:
    """The series of the velocities in a step. u, p, s: their units, which are their sizes at its start."""
    mu, rolling, torsional = flow.coefficients
    load, lever, pull = flow.body.load, flow.body.lever, norm(flow.body.pull)
    slip = tuple([series.fixed(each / u if u else u)] for each in flow.slipping)
    turn = tuple([series.fixed(each / p if p else p)] for each in flow.turning)
    pivot = [series.fixed(flow.pivoting / s if s else s)]
    if flow.one:
        size = _size(flow)
        squares = [(mu * u / size) ** 2, (rolling * p / size) ** 2, (torsional * s / size) ** 2]
        factors = [load * mu**2 / size * u, load * rolling**2 / size * p, load * torsional**2 / size * s]
    else:
        squares = [MP.mpf(0)] * 3
        factors = [load * mu if u else MP.mpf(0), load * rolling, load * torsional]
    both = not flow.one and bool(u and p and mu and rolling)
    held = not flow.one and bool(u and not p and rolling)
    rolls = not flow.one and not u
    _refuse(flow, held, rolls)
    weights = [series.fixed(each) for each in squares]
    force, moment, twist = (series.fixed(each * step) for each in factors)
    drive, one_more, lever_, part = map(series.fixed, (pull * step, 1 + lever, lever, lever / (1 + lever)))
    over_u, over_p, over_s = (series.fixed(1 / each) if each else 0 for each in (u, p, s))
    sizes: list[Series] = [[], []]
    pace: Series = []
    for order in range(TERMS + 1):
        for size_, pair, there in zip(sizes, (slip, turn), (u, p), strict=True):
            size_.append(_root(size_, _square(pair, order), order) if there else 0)
        if flow.one:
            total = weights[0] * _square(slip, order) + weights[1] * _square(turn, order)
            pace.append(_root(pace, (total + weights[2] * _square((pivot,), order)) >> BITS, order))
        elif both:
            pace.append(_term(sizes[0], sizes[1], order))
        else:
            pace.append(sizes[1][order] if rolls or (p and not mu) else sizes[0][order])
        if order == TERMS:
            break
        pulls = drive * pace[order] >> BITS, 0
        for axis in (0, 1):
            if both:
                f = -force * _term(slip[axis], sizes[1], order) >> BITS
                m = -moment * _term(turn[axis], sizes[0], order) >> BITS
            else:
                f, m = -force * slip[axis][order] >> BITS, -moment * turn[axis][order] >> BITS
            if held:
                m = f
            if rolls:
                turned, slipped = part * (pulls[axis] + m) >> BITS, 0
            else:
                turned = lever_ * (m - f) >> BITS
                slipped = pulls[axis] + (one_more * f - lever_ * m >> BITS)
            slip[axis].append((over_u * slipped >> BITS) // (order + 1))
            turn[axis].append((over_p * turned >> BITS) // (order + 1))
        braked = pivot[order] if flow.one else pace[order] * (1 if pivot[0] > 0 else -1 if pivot[0] else 0)
        pivot.append((over_s * (-lever_ * (twist * braked >> BITS) >> BITS) >> BITS) // (order + 1))
    return _Growing((slip[0], slip[1]), (turn[0], turn[1]), pivot, pace)


def _term(one: Series, other: Series, order: int) -> int:
    """The coefficient of a power of a product of two series, as far as they are known."""
    total: int = sum(map(mul, one[: order + 1], other[order::-1]))
    return total >> BITS


def _square(parts: tuple[Series, ...], order: int) -> int:
    """The coefficient of a power of the sum of the squares of series."""
    return sum(_term(part, part, order) for part in parts)


def _root(known: Series, square: int, order: int) -> int:
    """The next coefficient of the square root of a series, whose first coefficient is one, from those before it."""
    if not order:
        return series.ONE
    products: int = sum(map(mul, known[1:order], known[order - 1 : 0 : -1]))
    return square - (products >> BITS) >> 1


def _combined(*terms: tuple[Series, Real]) -> Series:
    """A sum of series times numbers."""
    return [sum(values) for values in zip(*(series.times(each, factor) for each, factor in terms), strict=True)]


def _refuse(flow: Flow, held: bool, rolls: bool) -> None:
    """Raise `NotModelled` for a sphere that begins to slip or to roll across the fall line."""
    mu, rolling, _ = flow.coefficients
    part, load = flow.body.lever / (1 + flow.body.lever), flow.body.load
    needed = norm(flow.body.pull) * (1 - part) + rolling * load * part
    if (held and mu > rolling) or (rolls and needed > mu * load):
        raise NotModelled("a sphere that begins to slip or to roll across the fall line")
