"""The rotation of a free rigid body in balls: closed forms for every body and every start.

Along the principal axes the angular velocity is given by Jacobi's elliptic functions, which are quotients of theta functions,
and the turn about the angular momentum by an elliptic integral of the third kind (Whittaker, Analytical Dynamics, 69). Bodies
with two equal moments, rotations about a principal axis, and the separatrix have elementary forms. Which form holds is decided
by rational numbers, or by balls that do not contain zero.
"""

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

from flint import acb, acb_mat, arb, fmpz_poly

from bodycheck.reference.proof.balls import (
    UNIT,
    Ball,
    Matrix,
    Triple,
    about,
    applied,
    ball,
    cross,
    dot,
    product,
    squared,
    transposed,
    turned_about,
)
from bodycheck.reference.proof.bodies import Rationals, Rotor, Rows, length, momentum
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.jacobi import jacobi

#: A function from a time (s) to the attitude, body to world components, and the angular velocity along the axes of the body.
Rotation = Callable[[Fraction], tuple[Matrix, Triple]]


def rotation(body: Rotor) -> Rotation:
    """Return the rotation of a free body as a function of time.

    Raises `NotEnclosed` where the precision of the context leaves undecided which form the motion has.
    """
    tensor, rates = body.exact_tensor, body.exact_rates
    if all(rate.is_zero() for rate in body.rates):
        return _steady(body)
    if tensor is None:
        principal_moments = _eigenvalues(body.tensor)
        return _triaxial(body, principal_moments, _axes(body.tensor, principal_moments), None)
    if rates is not None and not any(cross(_times(tensor, rates), rates)):
        return _steady(body)
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = tensor
    if not (xy or xz or yz):
        if len({xx, yy, zz}) < 3:
            return _symmetric(body, *_twice_diagonal((xx, yy, zz)))
        return _triaxial(body, (xx, yy, zz), UNIT, rates)
    roots = _moments(tensor)
    if isinstance(roots, tuple):
        return _symmetric(body, *_twice(tensor, *roots))
    return _triaxial(body, roots, _axes(body.tensor, roots), None)


def _eigenvalues(rows: Matrix) -> list[Ball]:
    """The principal moments in ascending order. Raises `NotEnclosed` if they are not known to be different."""
    try:
        values = acb_mat([[acb(value) for value in row] for row in rows]).eig()
    except ValueError:
        raise NotEnclosed("principal moments that may be equal") from None
    return sorted((value.real for value in values), key=lambda value: float(value.mid()))


def _times(rows: Rows, v: Rationals) -> Rationals:
    a, b, c = (sum((x * y for x, y in zip(row, v, strict=True)), Fraction(0)) for row in rows)
    return a, b, c


def _steady(body: Rotor) -> Rotation:
    """The rotation about an axis that keeps its direction, or none."""
    if all(rate.is_zero() for rate in body.rates):
        return lambda _: (body.attitude, body.rates)
    speed = length(body.rates)
    x, y, z = (rate / speed for rate in body.rates)
    return lambda t: (product(body.attitude, turned_about((x, y, z), speed * ball(t))), body.rates)


def _twice_diagonal(principal_moments: Rationals) -> tuple[Fraction, Fraction, Triple]:
    """Of three moments of which two are equal: these, the other one, and its axis."""
    other = next((i for i in range(3) if principal_moments.count(principal_moments[i]) == 1), 2)
    return principal_moments[other - 1], principal_moments[other], UNIT[other]


def _moments(rows: Rows) -> Sequence[Ball] | tuple[Fraction, Fraction]:
    """The principal moments in ascending order, as a list of balls; if two are equal, these and the other one, as a tuple."""
    (a, d, e), (_, b, f), (_, _, c) = rows
    trace = a + b + c
    minors = a * b - d * d + a * c - e * e + b * c - f * f
    determinant = a * (b * c - f * f) - d * (d * c - e * f) + e * (d * f - b * e)
    # x^3 - trace x^2 + minors x - determinant has a double root p / 2q where these are not both zero; see its discriminant.
    discriminant = (
        trace**2 * minors**2
        - 4 * minors**3
        - 4 * trace**3 * determinant
        + 18 * trace * minors * determinant
        - 27 * determinant**2
    )
    if discriminant == 0:
        spread = trace**2 - 3 * minors
        double = trace / 3 if not spread else (trace * minors - 9 * determinant) / (2 * spread)
        return double, trace - 2 * double
    coefficients = [-determinant, minors, -trace, Fraction(1)]
    common = math.lcm(*(value.denominator for value in coefficients))
    factors: Any = fmpz_poly([int(value * common) for value in coefficients]).complex_roots()
    roots = [root.real for root, _ in factors]
    return sorted(roots, key=lambda root: float(root.mid()))


def _twice(rows: Rows, double: Fraction, other: Fraction) -> tuple[Fraction, Fraction, Triple]:
    """Of a tensor with two equal moments: these, the other one, and its axis, from (tensor - double) / (other - double)."""
    if double == other:
        return double, other, UNIT[2]
    outer = [[(rows[i][j] - (double if i == j else 0)) / (other - double) for j in range(3)] for i in range(3)]
    i = max(range(3), key=lambda index: outer[index][index])
    size = ball(outer[i][i]).sqrt()
    x, y, z = (ball(outer[i][j]) / size for j in range(3))
    return double, other, (x, y, z)


def _symmetric(body: Rotor, double: Fraction, other: Fraction, axis: Triple) -> Rotation:
    """The rotation of a body with two equal moments: a turn about its axis, and then one about its angular momentum."""
    whole = momentum(body)
    size = length(whole)
    direction: Triple = tuple(part / size for part in applied(body.attitude, whole))
    spin = dot(axis, body.rates)
    spinning, precession = spin * (1 - ball(other / double)), size / ball(double)

    def at(t: Fraction) -> tuple[Matrix, Triple]:
        time = ball(t)
        turn = turned_about(axis, spinning * time)
        attitude = product(turned_about(direction, precession * time), product(body.attitude, turn))
        return attitude, applied(transposed(turn), body.rates)

    return at


def _axes(rows: Matrix, moments: Sequence[Ball]) -> Matrix:
    """The unit vectors along the principal axes of a tensor with different moments, as the rows of a right-handed matrix."""
    vectors = []
    for moment in moments[:2]:
        shifted = [[rows[i][j] - (moment if i == j else 0) for j in range(3)] for i in range(3)]
        normals = [cross(shifted[i], shifted[j]) for i, j in ((0, 1), (1, 2), (2, 0))]
        best = max(normals, key=lambda normal: float(dot(normal, normal).mid()))
        size = length(best)
        vectors.append(tuple(part / size for part in best))
    a, b = vectors
    return a, b, cross(a, b)


def _sign(rational: Fraction | None, value: Ball) -> int:
    """The sign of a number that is given as a rational number, or otherwise as a ball."""
    if rational is not None:
        return (rational > 0) - (rational < 0)
    if value > 0:
        return 1
    if value < 0:
        return -1
    raise NotEnclosed("a rotation that may be one about a principal axis, or on the separatrix")


def _triaxial(body: Rotor, principal_moments: Sequence[Any], axes: Matrix, rates: Rationals | None) -> Rotation:
    """The rotation of a body with three different moments about axes that are the rows of a matrix.

    rates: the rational angular velocity along these axes; None if it is not known to be rational.
    """
    given = [each if isinstance(each, arb) else ball(each) for each in principal_moments]
    order = sorted(range(3), key=lambda index: float(given[index].mid()))
    balls = [given[i] for i in order]
    along = applied(axes, body.rates)
    start = [along[i] for i in order]
    energy = sum((moment * squared(rate) for moment, rate in zip(balls, start, strict=True)), arb(0))
    square = sum((squared(moment * rate) for moment, rate in zip(balls, start, strict=True)), arb(0))
    tie = None
    if rates is not None:
        exact = [principal_moments[i] for i in order]
        spins = [rates[i] for i in order]
        tie = sum(((m * w) ** 2 for m, w in zip(exact, spins, strict=True)), Fraction(0)) - exact[1] * sum(
            (m * w * w for m, w in zip(exact, spins, strict=True)), Fraction(0)
        )
    side = _sign(tie, square - balls[1] * energy)
    # The last axis of the three is the one about which the body turns on and on: that of the largest or the smallest moment.
    chosen = order if side >= 0 else order[::-1]
    frame = [axes[i] for i in chosen]
    moments = balls if side >= 0 else balls[::-1]
    speeds = [along[i] for i in chosen]
    if _permutation(chosen) < 0:  # a right-handed frame
        frame[1] = tuple(-part for part in frame[1])
        speeds[1] = -speeds[1]
    principal = _separatrix(moments, speeds) if side == 0 else _circulating(moments, speeds, energy, square)
    rows: Matrix = (frame[0], frame[1], frame[2])
    return _turning(body, rows, moments, square.sqrt(), principal)


def _permutation(order: Sequence[int]) -> int:
    return 1 if tuple(order) in ((0, 1, 2), (1, 2, 0), (2, 0, 1)) else -1


#: A function from a time to the angular velocity along the principal axes and to the angle of the turn about the momentum.
Principal = Callable[[Fraction], tuple[list[Ball], Ball]]


def _circulating(moments: Sequence[Ball], start: Sequence[Ball], energy: Ball, square: Ball) -> Principal:
    """The rotation about the third axis on and on, with the momentum's square and twice the energy."""
    a, b, c = moments
    over, under = c * energy - square, square - a * energy  # both have the sign of c - a
    first, second = (over / (a * (c - a))).sqrt(), (over / (b * (c - b))).sqrt()
    third = (under / (c * (c - a))).sqrt()
    rate = (under * (c - b) / (a * b * c)).sqrt()
    m = (b - a) * over / ((c - b) * under)
    if not all(value.is_finite() for value in (first, second, third, rate, m)):
        raise NotEnclosed("a rotation that may be one about a principal axis, or on the separatrix")
    if start[2] < 0:
        third = -third
    elif not start[2] > 0:
        raise NotEnclosed("a rotation that may be on the separatrix")
    # A dw1/dt = (B - C) w2 w3 requires A first rate = (C - B) second third.
    second = a * first * rate / ((c - b) * third)
    functions, quarter = jacobi(m)
    begin = _first_kind(start[1] / second, start[0] / first, m)
    kappa = squared(c * third) * m / (square - squared(c * third))  # minus the characteristic
    factor = square.sqrt() * (energy - square / c) / ((square - squared(c * third)) * rate)
    steady, complete = square.sqrt() / c, _third_kind(arb.pi() / 2, -kappa, m)

    def integral(u: Ball) -> tuple[Ball, tuple[Ball, Ball, Ball]]:
        if not u.is_finite():
            raise NotEnclosed("a rotation so near to the separatrix that its balls have no bound")
        turns = round(float((u / (2 * quarter)).mid()))
        sn, cn, dn = functions(u - 2 * quarter * turns)
        reduced = _third_kind(arb.atan2(sn, cn), -kappa, m)
        sign = -1 if turns % 2 else 1
        return reduced + 2 * turns * complete, (sign * sn, sign * cn, dn)

    before, _ = integral(begin)

    def at(t: Fraction) -> tuple[list[Ball], Ball]:
        time = ball(t)
        after, (sn, cn, dn) = integral(begin + rate * time)
        return [first * cn, second * sn, third * dn], steady * time + factor * (after - before)

    return at


def _first_kind(sine: Ball, cosine: Ball, m: Ball) -> Ball:
    """Legendre's integral of the first kind up to the angle with this sine and cosine."""
    return acb.elliptic_f(acb(arb.atan2(sine, cosine)), acb(m)).real


def _third_kind(angle: Ball, characteristic: Ball, m: Ball) -> Ball:
    """Legendre's integral of the third kind."""
    return acb.elliptic_pi_inc(acb(characteristic), acb(angle), acb(m)).real


def _separatrix(moments: Sequence[Ball], start: Sequence[Ball]) -> Principal:
    """The rotation that ends at the second axis: the momentum's square is the second moment times twice the energy."""
    a, b, c = moments
    w = (a * squared(start[0]) + b * squared(start[1]) + c * squared(start[2])) / b
    speed = w.sqrt()  # about the second axis, in the end
    first = speed * (b * (c - b) / (a * (c - a))).sqrt()
    third = speed * (b * (b - a) / (c * (c - a))).sqrt()
    rate = speed * ((c - b) * (b - a) / (a * c)).sqrt()
    if start[0] < 0:
        first = -first
    if start[2] < 0:
        third = -third
    if start[0].contains(0) or start[2].contains(0):
        raise NotEnclosed("a rotation on the separatrix, whose start is not known to be away from its ends")
    second = a * first * rate / ((c - b) * third)
    begin = (start[1] / second).atanh()
    size = b * speed  # the momentum
    kappa = squared(c * third) / (squared(size) - squared(c * third))
    factor = size * (b * squared(speed) - squared(size) / c) / ((squared(size) - squared(c * third)) * rate)

    def integral(u: Ball) -> Ball:
        k = kappa.sqrt()
        return (u + k * (k * u.tanh()).atan()) / (1 + kappa)

    def at(t: Fraction) -> tuple[list[Ball], Ball]:
        u = begin + rate * ball(t)
        sech = u.sech()
        angle = size / c * ball(t) + factor * (integral(u) - integral(begin))
        return [first * sech, second * u.tanh(), third * sech], angle

    return at


def _turning(body: Rotor, rows: Matrix, moments: Sequence[Ball], size: Ball, principal: Principal) -> Rotation:
    """The rotation of a body from that along its principal axes, which are the rows of a matrix.

    The attitude is W Rz(angle) M, where M takes the momentum from the principal axes to z, and W is constant.
    """

    def to_z(speeds: Sequence[Ball]) -> Matrix:
        x, y, z = (moment * rate / size for moment, rate in zip(moments, speeds, strict=True))
        across = (x * x + y * y).sqrt()
        return product(about(0, across, z), about(2, x / across, y / across))

    begin, _ = principal(Fraction(0))
    constant = product(product(body.attitude, transposed(rows)), transposed(to_z(begin)))

    def at(t: Fraction) -> tuple[Matrix, Triple]:
        speeds, angle = principal(t)
        attitude = product(product(constant, about(2, *angle.sin_cos())), product(to_z(speeds), rows))
        return attitude, applied(transposed(rows), speeds)

    return at
