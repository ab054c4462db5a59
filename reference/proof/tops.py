"""A symmetric body on a ball joint in balls: Lagrange's top, the spherical pendulum, and free rotation about a point.

With the moments I1 across and I3 along the axis e, mu = M g r, and the angular momentum L, all along the axes of the world,

    e' = L x e / I1,    L' = mu z x e,    w = L / I1 + (1/I3 - 1/I1) L3 e,

so that the body turns with L / I1 after it has turned about its own axis at a constant rate. The first equations are quadratic.
Their Taylor series is stepped; on the disc of radius I1 / (4 l), l = max(|L|, sqrt(mu I1)), complex values obey |e| <= 5/3,
|L| <= 3 l/2 and |q| <= 3/2 for the quaternion q of the turn, so that Cauchy's estimate bounds what the series leave out.
"""

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import arb, arb_poly, ctx

from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.proof import free_body
from bodycheck.reference.proof.balls import (
    Ball,
    Matrix,
    Triple,
    applied,
    ball,
    cross,
    dot,
    of_quaternion,
    product,
    scaled,
    size_of,
    transposed,
    triple,
    turned_about,
    vector_sum,
)
from bodycheck.reference.proof.bodies import Rotor, Rows, attitude, inertia
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.mass import centre_of, mass_of
from bodycheck.reference.proof.turning import NO_TURN, Turn, after, quaternion_product, turn_of

#: The radius of the disc in steps, the part of a step that may be used, and the bits that a term of the series adds there.
DISC, REACH, BITS_PER_TERM = 8, 1.1, 2.8

#: The largest number of steps.
MOST_STEPS = 20_000

#: The states of the body: position of the centre of mass, attitude, velocity, angular velocity along its axes.
States = tuple[Triple, Matrix, Triple, Triple]


def on_ball_joint(mechanism: Mechanism) -> bool:
    """Return whether a mechanism is one body on a ball joint of the world."""
    alone = len(mechanism.joints) == 1 == len(mechanism.bodies) and mechanism.joints[0].parent == WORLD
    return alone and mechanism.joints[0].type == "spherical"


def states(mechanism: Mechanism) -> Callable[[Fraction], States]:
    """Return the states of a body on a ball joint as a function of time. Raises `NotEnclosed` if there is no proof of them."""
    (joint,), (body,) = mechanism.joints, mechanism.bodies
    _check(mechanism, joint)
    centre, mass, gravity = centre_of(body), mass_of(body), Fraction(mechanism.gravity)
    tensor = inertia(body.inertia)
    if not all(isinstance(value, Fraction) for row in tensor for value in row):
        raise NotEnclosed("a solid that is turned by angles, on a joint")
    square = sum((part * part for part in centre), Fraction(0))
    rows: Any = tuple(
        tuple(tensor[i][j] + mass * ((square if i == j else 0) - centre[i] * centre[j]) for j in range(3)) for i in range(3)
    )
    begin = product(attitude(joint.attitude), of_quaternion(joint.start or (1.0, 0.0, 0.0, 0.0)))
    spin: Any = tuple(map(Fraction, joint.start_velocity or (0.0, 0.0, 0.0)))
    if gravity and square:
        turning = _top(rows, centre, square, mass * gravity, begin, spin)
    else:
        turning = free_body.rotation(Rotor(tuple(map(triple, rows)), rows, begin, triple(spin), spin))  # type: ignore[arg-type]
    origin = triple(joint.position)

    def at(t: Fraction) -> States:
        turned, rates = turning(t)
        arm = applied(turned, triple(centre))
        return vector_sum(origin, arm), turned, cross(applied(turned, rates), arm), rates

    return at


def _check(mechanism: Mechanism, joint: Joint) -> None:
    for kind, there in (
        ("a loop", mechanism.loops),
        ("pushes", mechanism.pushes),
        ("a controller of a ball joint", mechanism.controllers),
        ("other forces on a ball joint", joint.damping or joint.stiffness or joint.friction or joint.effort or joint.armature),
    ):
        if there:
            raise NotEnclosed(kind)


def _top(
    rows: Rows, centre: tuple[Fraction, ...], square: Fraction, weight: Fraction, begin: Matrix, spin: tuple[Fraction, ...]
) -> free_body.Rotation:
    """The rotation of a top whose centre of mass is on its axis of symmetry."""
    along = sum((centre[i] * rows[i][j] * centre[j] for i in range(3) for j in range(3)), Fraction(0)) / square
    across = (rows[0][0] + rows[1][1] + rows[2][2] - along) / 2
    for i in range(3):
        for j in range(3):
            if rows[i][j] != (across if i == j else 0) + (along - across) * centre[i] * centre[j] / square:
                raise NotEnclosed("a body on a ball joint that is not symmetric about the line to its centre of mass")
    size = ball(square).sqrt()
    x, y, z = (ball(part) / size for part in centre)
    unit: Triple = (x, y, z)
    whole = applied(begin, _momentum(rows, spin))
    faster = dot(unit, triple(spin)) * ball(1 - along / across)
    path = _followed(ball(across), ball(weight) * size, applied(begin, unit), whole)

    def at(t: Fraction) -> tuple[Matrix, Triple]:
        time = ball(t)
        turn, axis, momentum = path(time)
        turned = product(turn.matrix, product(begin, turned_about(unit, faster * time)))
        rates = vector_sum(scaled(1 / ball(across), momentum), scaled(faster, axis))
        return turned, applied(transposed(turned), rates)

    return at


def _momentum(rows: Rows, spin: tuple[Fraction, ...]) -> Triple:
    return triple([sum((row[j] * spin[j] for j in range(3)), Fraction(0)) for row in rows])


@dataclass(frozen=True, eq=False)
class _Step:
    """A step from a time on, of some length: the polynomials of q, e and L, their errors, and the turn before it."""

    begin: Ball
    size: Ball
    polynomials: list[Any]
    errors: list[Ball]
    before: Turn

    def at(self, t: Ball) -> tuple[Turn, Triple, Triple]:
        since = t - self.begin
        if not abs(since) < arb(REACH) * self.size:
            raise NotEnclosed("an instant within balls that are too large")
        values = [polynomial(since) for polynomial in self.polynomials]
        turn = after(turn_of(values[:4], self.errors[0]), self.before)
        axis = [value + arb(0, self.errors[1]) for value in values[4:7]]
        momentum = [value + arb(0, self.errors[2]) for value in values[7:]]
        return turn, (axis[0], axis[1], axis[2]), (momentum[0], momentum[1], momentum[2])


def _followed(across: Ball, weight: Ball, axis: Triple, momentum: Triple) -> Callable[[Ball], tuple[Turn, Triple, Triple]]:
    """The turn with L / I1 since t = 0, e and L as a function of time."""
    steps = [_step(arb(0), across, weight, NO_TURN, axis, momentum)]
    edges = [float(steps[0].size)]

    def at(t: Ball) -> tuple[Turn, Triple, Triple]:
        while edges[-1] < t:
            if len(steps) > MOST_STEPS:
                raise NotEnclosed(f"a top of more than {MOST_STEPS} steps")
            begin = arb(edges[-1])
            steps.append(_step(begin, across, weight, *steps[-1].at(begin)))
            edges.append(float((begin + steps[-1].size).mid()))
        return steps[min(bisect_right(edges, float(t.mid())), len(steps) - 1)].at(t)

    return at


def _step(begin: Ball, across: Ball, weight: Ball, before: Turn, axis: Triple, momentum: Triple) -> _Step:
    """The step of a top from a time on."""
    largest = size_of(momentum).max((weight * across).sqrt()).upper()
    radius = (across / (4 * largest)).lower()
    terms = round(ctx.prec / BITS_PER_TERM) + 4
    turn: list[Sequence[Ball]] = [(arb(1), arb(0), arb(0), arb(0))]
    e: list[Triple] = [axis]
    moment: list[Triple] = [momentum]
    for n in range(terms):
        speed = [scaled(1 / across, moment[j]) for j in range(n + 1)]
        turned = [quaternion_product((arb(0), *speed[j]), turn[n - j]) for j in range(n + 1)]
        crossed = [cross(speed[j], e[n - j]) for j in range(n + 1)]
        turn.append([sum(column, arb(0)) / (2 * (n + 1)) for column in zip(*turned, strict=True)])
        x, y, z = (sum(column, arb(0)) / (n + 1) for column in zip(*crossed, strict=True))
        moment.append((-weight * e[n][1] / (n + 1), weight * e[n][0] / (n + 1), arb(0)))
        e.append((x, y, z))
    polynomials = [arb_poly(list(column)) for part in (turn, e, moment) for column in zip(*part, strict=True)]
    ratio = arb(REACH) / DISC
    rest = ratio ** (terms + 1) / (1 - ratio)
    errors = [arb((bound * rest).upper()) for bound in (arb(1.5), arb(5) / 3, arb(1.5) * largest)]
    return _Step(begin, (radius / DISC).mid(), polynomials, errors, before)
