"""A sphere on a plane with rolling and torsional friction, whose slip and rolling velocity are along one line, in balls.

With the radius r, the velocity v and the angular velocity w, the rolling velocity is p = r w x n, the slip u = v - p, and the
pivoting velocity s = r w_n. Per mass, a force F along the plane, a moment r R along the plane and a moment r T about its normal
give the rates

    u' = g + (1 + 1/k) F - R/k,    p' = (R - F)/k,    s' = T/k,    k = I/(m r^2).

With the load a each has a limit of its own: |F| <= mu a, |R| <= mu_r a/r and |T| <= mu_t a/r, against u, p and s. All rates are
constant until one of u, p and s is zero; it stays zero where a force within its limit can hold it.
"""

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from bodycheck.reference.proof.balls import Ball, Triple, ball, size_of
from bodycheck.reference.proof.contact.rolling import States, counts_as_zero
from bodycheck.reference.proof.contact.start import Placed, Surroundings, diagonal, radius_of
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.motions import Piece
from bodycheck.reference.proof.turning import NO_TURN, Turn, accelerated, after
from bodycheck.reference.scene import Plane

#: A slip, a rolling velocity and a pivoting velocity (m/s), or their rates (m/s^2).
Speeds = tuple[Ball, Ball, Ball]


@dataclass(frozen=True, eq=False)
class Resisted:
    """A sphere: r, k, g, the largest F (None if it is infinite), R and T, and the unit vector of its line along the plane."""

    radius: Ball
    ratio: Ball
    downhill: Ball
    friction: Ball | None
    rolling: Ball
    pivoting: Ball
    direction: tuple[Ball, Ball]

    def vectors(self, speeds: Speeds) -> tuple[Triple, Triple]:
        """Velocity and angular velocity along the axes of the plane."""
        (a, b), (u, p, s) = self.direction, speeds
        return ((u + p) * a, (u + p) * b, arb(0)), (-p * b / self.radius, p * a / self.radius, s / self.radius)


def pieces(body: Placed, law: Plane, plane: Surroundings) -> Iterator[Piece]:
    """Yield the pieces of the motion, whose states are those of `rolling`."""
    radius, moments = radius_of(body.shape), diagonal(body.inertia)
    if radius is None or len(set(moments)) != 1:
        raise NotEnclosed("rolling friction of anything but a sphere")
    if law.cone == "one":
        raise NotEnclosed("friction and rolling friction with one limit")
    around, speeds = _start(body, law, plane, radius, moments[0])
    time, position, turn = arb(0), body.position, NO_TURN
    slips: bool | None = None
    while True:
        rates, rests = _rates(around, speeds)
        now = not (speeds[0].is_zero() and rates[0].is_zero())
        kinds = [] if slips is None else [("rest", 0)] if rests else [("slip" if now else "roll", 0)] if now != slips else []
        if kinds:
            yield Piece(time, time, lambda _: (), tuple(kinds))
        slips = now
        at = _states(around, position, speeds, rates, turn)
        ends = [(-v / a, index) for index, (v, a) in enumerate(zip(speeds, rates, strict=True)) if _opposite(v, a)]
        if not ends:
            yield Piece(time, None, at)
            return
        lasting, first = min(ends, key=lambda each: float(each[0].mid()))
        gone = {first}
        for other, index in ends:
            if index != first and not other > lasting:
                raise NotEnclosed("a sphere of which two velocities may vanish at once")
        yield Piece(time, time + lasting, at)
        position, turn = _moved(around, position, speeds, rates, lasting), after(_turn(around, speeds, rates)(lasting), turn)
        speeds = tuple(arb(0) if i in gone else v + lasting * a for i, (v, a) in enumerate(zip(speeds, rates, strict=True)))  # type: ignore[assignment]
        time = time + lasting


def _opposite(value: Ball, rate: Ball) -> bool:
    """Return whether a velocity decreases to zero."""
    return bool((value > 0 and rate < 0) or (value < 0 and rate > 0))


def _start(body: Placed, law: Plane, plane: Surroundings, radius: float, moment: Fraction) -> tuple[Resisted, Speeds]:
    """The sphere on its line, and its velocities. A slip and a normal velocity may count as zero."""
    r = ball(radius)
    (v_x, v_y, v_z), (w_x, w_y, w_z) = body.velocity, body.spin
    scale = size_of(body.velocity) + r * size_of(body.spin)
    if not (counts_as_zero(body.position[2] - r, r) and counts_as_zero(v_z, size_of(body.velocity))):
        raise NotEnclosed("a sphere with rolling friction that is not on the plane at the start")
    rolling = (r * w_y, -r * w_x)
    slip = (v_x - rolling[0], v_y - rolling[1])
    if counts_as_zero(size_of(slip), scale):
        slip = (arb(0), arb(0))
    direction = (arb(1), arb(0))
    if plane.downhill.is_zero():
        direction = next((_unit(each) for each in (slip, rolling) if not _is_zero(each)), direction)
    aside = [vector[1] * direction[0] - vector[0] * direction[1] for vector in (slip, rolling)]
    if not all(counts_as_zero(each, size_of(vector)) for each, vector in zip(aside, (slip, rolling), strict=True)):
        raise NotEnclosed("rolling friction of a sphere whose slip is not along its rolling velocity")
    along = [arb(0) if _is_zero(each) else each[0] * direction[0] + each[1] * direction[1] for each in (slip, rolling)]
    load = plane.onto
    friction = None if math.isinf(law.friction) else ball(law.friction) * load
    limits = (ball(law.rolling_friction) * load / r, ball(law.torsional_friction) * load / r)
    ratio = ball(moment / (body.mass * Fraction(radius) ** 2))
    return Resisted(r, ratio, plane.downhill, friction, *limits, direction), (along[0], along[1], r * w_z)


def _is_zero(pair: tuple[Ball, Ball]) -> bool:
    return bool(pair[0].is_zero() and pair[1].is_zero())


def _unit(pair: tuple[Ball, Ball]) -> tuple[Ball, Ball]:
    if pair[1].is_zero():
        return pair[0].sgn(), arb(0)
    size = size_of(pair)
    return pair[0] / size, pair[1] / size


def _sign(value: Ball) -> int:
    if value.is_zero():
        return 0
    if value > 0 or value < 0:
        return 1 if value > 0 else -1
    raise NotEnclosed("a sphere of which it is not decided how it moves")


def _rates(body: Resisted, speeds: Speeds) -> tuple[Speeds, bool]:
    """The rates of the velocities, and whether the sphere rests."""
    slip, rolling, pivoting = map(_sign, speeds)
    twist = -pivoting * body.pivoting / body.ratio
    slipping, rolled = _along(body, slip, rolling)
    rests = not (slip or rolling or pivoting) and slipping.is_zero() and rolled.is_zero()
    return (slipping, rolled, twist), rests


def _along(body: Resisted, slip: int, rolling: int) -> tuple[Ball, Ball]:
    """The rates of the slip and of the rolling velocity, from the signs of both: the only solution of Coulomb's laws."""
    most, resisting, g, k = body.friction, body.rolling, body.downhill, body.ratio
    for sign, turn in itertools.product((slip,) if slip else (0, 1, -1), (rolling,) if rolling else (0, 1, -1)):
        if sign and most is None:
            continue
        if not turn:
            force = -g if not sign else -most * sign  # type: ignore[operator]
            rates, moment = ((g + force) * abs(sign), arb(0)), force
        elif not sign:
            moment = -resisting * turn
            rates = (arb(0), (g + moment) / (1 + k))
            force = rates[1] - g
        else:
            force, moment = -most * sign, -resisting * turn  # type: ignore[operator]
            rates = (g + force + (force - moment) / k, (moment - force) / k)
        checks = [] if sign or most is None else [most - abs(force)]
        checks += [] if turn else [resisting - abs(moment)]
        leaving = [rates[0] * sign] if sign and not slip else []
        leaving += [rates[1] * turn] if turn and not rolling else []
        if all(value >= 0 for value in checks) and all(value > 0 for value in leaving):
            return rates
        if not (any(value < 0 for value in checks) or any(value <= 0 for value in leaving)):
            raise NotEnclosed("a sphere of which it is not decided whether friction holds it")
    raise NotEnclosed("a sphere of which it is not decided how it moves")


def _moved(body: Resisted, position: Triple, speeds: Speeds, rates: Speeds, t: Ball) -> Triple:
    way = (speeds[0] + speeds[1]) * t + (rates[0] + rates[1]) * t * t / 2
    (x, y, z), (a, b) = position, body.direction
    return x + way * a, y + way * b, z


def _turn(body: Resisted, speeds: Speeds, rates: Speeds) -> Callable[[Ball], Turn]:
    return accelerated(body.vectors(speeds)[1], body.vectors(rates)[1])


def _states(body: Resisted, position: Triple, speeds: Speeds, rates: Speeds, turn: Turn) -> Callable[[Ball], States]:
    turning = _turn(body, speeds, rates)

    def at(t: Ball) -> States:
        u, p, s = (v + t * a for v, a in zip(speeds, rates, strict=True))
        velocity, spin = body.vectors((u, p, s))
        return _moved(body, position, speeds, rates, t), velocity, spin, after(turning(t), turn).matrix

    return at
