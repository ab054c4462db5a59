"""The body of a scene and the start of its motion, as rational numbers where they are rational, otherwise as balls."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeGuard

from flint import arb

from bodycheck.reference.proof.balls import (
    Ball,
    Matrix,
    Triple,
    about,
    applied,
    ball,
    of_quaternion,
    product,
    quaternion_rows,
    triple,
)
from bodycheck.reference.scene import (
    AlongPlane,
    Attitude,
    Brick,
    Cylinder,
    Ellipsoid,
    EulerAngles,
    EulerRates,
    Given,
    Particle,
    Scene,
    Shape,
    Solid,
    Tensor,
    valid,
)

#: Three rational numbers, and a symmetric matrix of them by its rows.
Rationals = tuple[Fraction, Fraction, Fraction]
Rows = tuple[Rationals, Rationals, Rationals]

#: A symmetric matrix of rational numbers and balls by its rows.
Entries = tuple[tuple[Any, Any, Any], tuple[Any, Any, Any], tuple[Any, Any, Any]]


@dataclass(frozen=True, eq=False)
class Rotor:
    """A body and the start of its rotation.

    Attributes
    ----------
    tensor
        Rows of the inertia tensor about the centre of mass, in the frame of the body (kg m^2).
    exact_tensor
        The same as rational numbers; None if it is not known whether they are rational.
    attitude
        The matrix that takes body to world components at t = 0.
    rates
        The angular velocity at t = 0 in the frame of the body (rad/s).
    exact_rates
        The same as rational numbers; None if it is not known whether they are rational.
    """

    tensor: Matrix
    exact_tensor: Rows | None
    attitude: Matrix
    rates: Triple
    exact_rates: Rationals | None


def rotor(scene: Scene) -> Rotor:
    """Return the body of a scene and the start of its rotation, with the precision of the context.

    The numbers come from the parts of the scene's definition that are valid (see `scene.valid`), otherwise from its doubles,
    which are taken as exact.
    """
    definition, holds, initial = scene.definition, valid(scene), scene.initial
    rows = inertia(definition.inertia) if definition and holds.inertia else _of_doubles(scene)
    tensor, exact_tensor = _enclosed(rows), rows if _is_rational(rows) else None
    orientation = definition.attitude if definition and holds.attitude else initial.quaternion
    rotation = definition.rotation if definition and holds.rotation else initial.angular_velocity
    if isinstance(rotation, EulerRates):
        assert definition is not None
        rates = angular_velocity(definition.attitude, rotation)
        known = [Fraction(*_dyadic(rate)) for rate in rates if rate.is_exact()]
        exact = (known[0], known[1], known[2]) if len(known) == 3 else None
        return Rotor(tensor, exact_tensor, attitude(orientation), rates, exact)
    p, q, r = map(Fraction, rotation)
    return Rotor(tensor, exact_tensor, attitude(orientation), triple((p, q, r)), (p, q, r))


def _enclosed(rows: Entries) -> Matrix:
    a, b, c = ((as_ball(x), as_ball(y), as_ball(z)) for x, y, z in rows)
    return a, b, c


def _is_rational(rows: Entries) -> TypeGuard[Rows]:
    return all(isinstance(value, Fraction) for row in rows for value in row)


def as_ball(value: Fraction | Ball) -> Ball:
    """Return a ball that contains a number, which may be a ball already."""
    return ball(value) if isinstance(value, Fraction) else value


def _dyadic(value: Any) -> tuple[int, int]:
    mantissa, exponent = (int(part) for part in value.man_exp())
    return (mantissa << exponent, 1) if exponent >= 0 else (mantissa, 1 << -exponent)


def inertia(given: Given) -> Entries:
    """Return the inertia tensor (kg m^2) about the centre of mass of a body, from what its file states.

    Its entries are rational numbers, or balls where solids are turned by angles.
    """
    match given:
        case Tensor():
            return _rows([[Fraction(value) for value in row] for row in given.rows])
        case Solid():
            return _diagonal(moments(given.shape, Fraction(given.mass)))
        case _:
            return _joined(given)


def moments(shape: Shape, mass: Fraction) -> Rationals:
    """Return the principal moments (kg m^2) of a homogeneous solid of a mass (kg)."""
    if isinstance(shape, Cylinder):
        across = Fraction(shape.radius) ** 2 / 4 + Fraction(shape.half_length) ** 2 / 3
        return mass * across, mass * across, mass * Fraction(shape.radius) ** 2 / 2
    if isinstance(shape, Brick | Ellipsoid):
        a, b, c = (Fraction(length) ** 2 for length in shape.semi_axes)
        part = mass / (3 if isinstance(shape, Brick) else 5)
        return part * (b + c), part * (a + c), part * (a + b)
    round_ = 2 * mass * Fraction(shape.radius) ** 2 / 5
    return round_, round_, round_


def _joined(parts: Sequence[Particle | Solid]) -> Entries:
    """The inertia tensor of a body of several particles or solids about their common centre of mass."""
    masses = [Fraction(part.mass) for part in parts]
    places = [[Fraction(value) for value in part.position] for part in parts]
    whole = sum(masses)
    centre = [sum(m * x[i] for m, x in zip(masses, places, strict=True)) / whole for i in range(3)]
    rows: list[list[Any]] = [[Fraction(0)] * 3 for _ in range(3)]
    for part, mass, position in zip(parts, masses, places, strict=True):
        of_part = _tensor_of(part, mass)
        r = [position[i] - centre[i] for i in range(3)]
        square = sum(x * x for x in r)
        for i in range(3):
            for j in range(3):
                rows[i][j] = added(rows[i][j], added(of_part[i][j], mass * ((square if i == j else 0) - r[i] * r[j])))
    return _rows(rows)


def added(one: Fraction | Ball, other: Fraction | Ball) -> Fraction | Ball:
    """Return the sum of two numbers, which is rational if both are."""
    both = isinstance(one, Fraction) and isinstance(other, Fraction)
    return one + other if both else as_ball(one) + as_ball(other)


def _tensor_of(part: Particle | Solid, mass: Fraction) -> Entries:
    zero = Fraction(0)
    if isinstance(part, Particle):
        return _diagonal((zero, zero, zero))
    about_own = moments(part.shape, mass)
    if isinstance(part.attitude, EulerAngles | AlongPlane):
        return _turned(attitude(part.attitude), triple(about_own))
    return _turned(_rational(part.attitude), about_own)


def _turned(turn: Sequence[Sequence[Any]], principal: Sequence[Any]) -> Entries:
    """The tensor with principal moments along axes that are the columns of a matrix."""
    return _rows([[sum(turn[i][k] * principal[k] * turn[j][k] for k in range(3)) for j in range(3)] for i in range(3)])


def _rational(quaternion: Sequence[float]) -> list[list[Fraction]]:
    w, x, y, z = map(Fraction, quaternion)
    n = w * w + x * x + y * y + z * z
    return [[entry / n for entry in row] for row in quaternion_rows(w, x, y, z)]


def _of_doubles(scene: Scene) -> Entries:
    return _turned(_rational(scene.body.axes), [Fraction(moment) for moment in scene.body.moments])


def _diagonal(principal: Rationals) -> Rows:
    zero = Fraction(0)
    return (principal[0], zero, zero), (zero, principal[1], zero), (zero, zero, principal[2])


def _rows(rows: Sequence[Sequence[Any]]) -> Entries:
    a, b, c = ((x, y, z) for x, y, z in rows)
    return a, b, c


def attitude(orientation: Attitude) -> Matrix:
    """Return the matrix of an attitude, body to world components: that of Euler angles is Rz(phi) Rx(theta) Rz(psi)."""
    match orientation:
        case EulerAngles(phi, theta, psi):
            turns = [about(axis, *ball(angle).sin_cos()) for axis, angle in ((2, phi), (0, theta), (2, psi))]
            return product(product(turns[0], turns[1]), turns[2])
        case AlongPlane(incline):
            return about(1, *ball(incline).sin_cos())
        case _:
            return of_quaternion(orientation)


def angular_velocity(orientation: Attitude, rates: Sequence[float] | EulerRates) -> Triple:
    """Return the angular velocity in the frame of a body, also from the rates of Euler angles: those of nodes and axes."""
    if not isinstance(rates, EulerRates):
        return triple(rates)
    s, c, sp, cp = _nodes(orientation)
    first, second, third = triple((rates.dphi, rates.dtheta, rates.dpsi))
    return first * s * sp + second * cp, first * s * cp - second * sp, first * c + third


def _nodes(orientation: Attitude) -> tuple[Ball, Ball, Ball, Ball]:
    """The sines and cosines of the Euler angles theta and psi of an attitude; phi is 0 where theta is 0 or pi."""
    if isinstance(orientation, EulerAngles):
        return *ball(orientation.theta).sin_cos(), *ball(orientation.psi).sin_cos()
    (a, b, _), _, (x, y, z) = attitude(orientation)
    if x.is_zero() and y.is_zero():
        return arb(0), z, -b, a
    across = (x * x + y * y).sqrt()
    return across, z, x / across, y / across


def momentum(body: Rotor) -> Triple:
    """Return the angular momentum at t = 0 in the frame of the body (kg m^2/s)."""
    return applied(body.tensor, body.rates)


def length(vector: Sequence[Any]) -> Any:
    """Return the length of a vector of balls."""
    return sum((value * value for value in vector), arb(0)).sqrt()


def sums(values: Iterable[Fraction]) -> Fraction:
    """Return the sum of rational numbers."""
    return sum(values, Fraction(0))
