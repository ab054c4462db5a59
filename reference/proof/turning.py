"""Rotations in balls as quaternions with one radius, which grows by sums only, and rotations about an axis that turns.

A rotation with an angular velocity w(s) that is an entire function of its parameter obeys q' = w q / 2. Its Taylor series
converges everywhere, and Cauchy's estimate bounds the terms that are left out: on a disc on which |w| is at most S, |q| is at
most exp(S R / 2).
"""

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from flint import acb, arb, arb_poly, arb_series, ctx

from bodycheck.reference.proof.balls import Ball, Matrix, Triple, cross, dot, quaternion_rows, size_of, squared
from bodycheck.reference.proof.enclosure import NotEnclosed

#: The largest number of steps of a rotation about an axis that turns.
MOST_STEPS = 5_000

#: The largest angle of a step (rad), the radius of the disc of Cauchy's estimate in steps, and the largest exponent on it.
ANGLE, DISC, MOST_GROWTH = 0.5, 8, 8.0

#: The distance from its begin, in steps, up to which a step may be used, and the bits that a term adds at this distance.
REACH, BITS_PER_TERM = 1.25, 2.5

#: An angular velocity along fixed axes as a function of a parameter, which is a ball, a complex ball or a power series.
Spin = Callable[[Any], tuple[Any, Any, Any]]


@dataclass(frozen=True, eq=False)
class Turn:
    """A rotation: the exact components w, x, y, z of a quaternion, and a bound of its distance from the unit quaternion."""

    parts: tuple[Ball, Ball, Ball, Ball]
    radius: Ball

    @property
    def matrix(self) -> Matrix:
        """The matrix of the rotation."""
        around = arb(0, self.radius)
        a, b, c = ((x, y, z) for x, y, z in quaternion_rows(*(part + around for part in self.parts)))
        return a, b, c


#: No rotation.
NO_TURN = Turn((arb(1), arb(0), arb(0), arb(0)), arb(0))


def turn_of(parts: Sequence[Ball], radius: Ball) -> Turn:
    """Return the rotation of a unit quaternion of balls, which is within a further radius."""
    w, x, y, z = (part.mid() for part in parts)
    rounded = sum((squared(arb(part.rad())) for part in parts), arb(0)).sqrt()
    return Turn((w, x, y, z), arb((rounded + radius).upper()))


def about_axis(unit: Triple, angle: Ball) -> Turn:
    """Return the rotation by an angle (rad) about a unit vector."""
    sine, cosine = (angle / 2).sin_cos()
    return turn_of((cosine, *(sine * part for part in unit)), arb(0))


def after(second: Turn, first: Turn) -> Turn:
    """Return a rotation that comes after another one, both along fixed axes."""
    parts = quaternion_product(second.parts, first.parts)
    longer = 1 + first.radius
    return turn_of(parts, second.radius * longer + first.radius * (1 + second.radius))


def quaternion_product(one: Sequence[Any], other: Sequence[Any]) -> tuple[Any, Any, Any, Any]:
    """Return the product of two quaternions."""
    (a, b, c, d), (w, x, y, z) = one, other
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )


@dataclass(frozen=True, eq=False)
class _Step:
    """The rotation from a parameter on, of some length: polynomials of its quaternion, their error, and what it follows."""

    begin: Ball
    size: Ball
    polynomials: tuple[Any, ...]
    radius: Ball
    before: Turn

    def at(self, parameter: Ball) -> Turn:
        if not abs(parameter - self.begin) < arb(REACH) * self.size:
            raise NotEnclosed("an instant within balls that are too large")
        parts = [polynomial(parameter - self.begin) for polynomial in self.polynomials]
        return after(turn_of(parts, self.radius), self.before)


def constant(spin: Triple) -> Callable[[Ball], Turn]:
    """Return the rotation with a constant angular velocity as a function of time."""
    if all(part.is_zero() for part in spin):
        return lambda _: NO_TURN
    size = size_of(spin)
    if not size > 0:
        return varying(lambda _: spin)
    x, y, z = (part / size for part in spin)
    return lambda t: about_axis((x, y, z), size * t)


def accelerated(spin: Triple, rate: Triple) -> Callable[[Ball], Turn]:
    """Return the rotation with an angular velocity that changes at a constant rate, both along fixed axes."""
    if all(part.is_zero() for part in rate):
        return constant(spin)
    if all(part.is_zero() for part in cross(spin, rate)):
        size = size_of(rate)
        x, y, z = (part / size for part in rate)
        along = dot(spin, (x, y, z))
        return lambda t: about_axis((x, y, z), t * (along + size * t / 2))

    def at(t: Any) -> tuple[Any, Any, Any]:
        a, b, c = (w + t * r for w, r in zip(spin, rate, strict=True))
        return a, b, c

    return varying(at)


def varying(spin: Spin) -> Callable[[Ball], Turn]:
    """Return the rotation with an angular velocity along fixed axes as a function of its parameter, from 0 on."""
    steps: list[_Step] = []
    edges: list[float] = []

    def at(parameter: Ball) -> Turn:
        if not steps:
            steps.append(_begun(spin, arb(0), NO_TURN))
            edges.append(float(_length_of(spin, steps[-1].begin)))
        while edges[-1] < parameter:
            if len(steps) > MOST_STEPS:
                raise NotEnclosed(f"a rotation of more than {MOST_STEPS} steps")
            begin = arb(edges[-1])
            steps.append(_begun(spin, begin, steps[-1].at(begin)))
            edges.append(float((begin + _length_of(spin, begin)).mid()))
        return steps[min(bisect_right(edges, float(parameter.mid())), len(steps) - 1)].at(parameter)

    return at


def _length_of(spin: Spin, begin: Ball) -> Ball:
    """The exact length of a step, on whose disc the rotation does not grow too much."""
    speed = size_of(spin(begin)).upper() + arb(2) ** -30
    if not speed.is_finite():
        raise NotEnclosed("a rotation of balls that are too large")
    step = (arb(ANGLE) / speed).mid()
    while not _largest(spin, begin, DISC * step) * DISC * step / 2 < MOST_GROWTH:
        step = step / 2
        if step < arb(2) ** -ctx.prec:
            raise NotEnclosed("a rotation of balls that are too large")
    return step.mid()


def _largest(spin: Spin, centre: Ball, radius: Ball) -> Ball:
    """A bound of the length of the angular velocity on a disc."""
    most = radius.upper()
    return size_of([abs(part) for part in spin(acb(arb(centre, most), arb(0, most)))]).upper()


def _begun(spin: Spin, begin: Ball, before: Turn) -> _Step:
    """The step of a rotation from a parameter on."""
    step = _length_of(spin, begin)
    terms = round(ctx.prec / BITS_PER_TERM) + 8
    earlier, ctx.cap = ctx.cap, terms
    try:
        series = [part if isinstance(part, arb_series) else arb_series([part]) for part in spin(arb_series([begin, arb(1)]))]
        rates = [list(part.coeffs())[:terms] for part in series]
    finally:
        ctx.cap = earlier
    count = max(map(len, rates))
    speeds = [[part[n] if n < len(part) else arb(0) for part in rates] for n in range(count)]
    terms_of = [(arb(1), arb(0), arb(0), arb(0))]
    for n in range(terms):
        products = [quaternion_product((arb(0), *speeds[j]), terms_of[n - j]) for j in range(min(count, n + 1))]
        terms_of.append(tuple(sum(column, arb(0)) / (2 * (n + 1)) for column in zip(*products, strict=True)))  # type: ignore[arg-type]
    disc = DISC * step
    growth = (_largest(spin, begin, disc) * disc / 2).exp()
    ratio = arb(REACH) / DISC
    rest = growth * ratio ** (terms + 1) / (1 - ratio)
    polynomials = tuple(arb_poly(list(column)) for column in zip(*terms_of, strict=True))
    return _Step(begin, step, polynomials, arb(rest.upper()), before)
