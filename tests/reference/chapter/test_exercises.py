"""Exercises 1-13 of the chapter, worked in exact form with SymPy, and our functions against the answers."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
import sympy as sp
from sympy import Rational, cos, pi, sin, sqrt
from sympy.physics.vector import ReferenceFrame

from bodycheck.reference.chapter import orientation, particles, placing, rotation_vector
from bodycheck.reference.inertia import principal_moments
from bodycheck.reference.kinematics import quaternion_from_euler, rotate
from bodycheck.reference.scene import Brick, Sphere

INERTIAL = ReferenceFrame("inertial")
PHI, THETA, PSI, XI, T, M = sp.symbols("phi theta psi xi t m", real=True)


def axes_by_sympy(phi: sp.Expr, theta: sp.Expr, psi: sp.Expr) -> sp.Matrix:
    """A1 by SymPy's own reference frames, which know nothing of this package: its columns are the body axes."""
    body = ReferenceFrame("body")
    body.orient_body_fixed(INERTIAL, (phi, theta, psi), "ZXZ")
    return INERTIAL.dcm(body)


def floats(exact: sp.Matrix) -> np.ndarray:
    return np.array(exact.evalf(25), dtype=float)


def close(found: np.ndarray, exact: sp.Matrix | Sequence[sp.Expr]) -> bool:
    """Equal up to some roundings of numbers of size 1."""
    return bool(np.abs(np.asarray(found) - floats(sp.Matrix(exact)).reshape(np.shape(found))).max() < 1e-15)


def zxz(*triad: sp.Expr) -> np.ndarray:
    return orientation.zxz(*(np.asarray(float(angle)) for angle in triad))


def test_exercise_1_eliminating_z2() -> None:
    """z2 = z1 +- sqrt(d^2 - (x2 - x1)^2 - (y2 - y1)^2): both signs keep the constraint of [G 2.1], and no other z2 does."""
    x1, y1, z1, x2, y2, z2 = sp.symbols("x1 y1 z1 x2 y2 z2", real=True)
    d = sp.Symbol("d", positive=True)
    constraint = (x2 - x1) ** 2 + (y2 - y1) ** 2 + (z2 - z1) ** 2 - d**2
    root = sqrt(d**2 - (x2 - x1) ** 2 - (y2 - y1) ** 2)
    # A quadratic in z2 has no more than two roots.
    assert sp.degree(constraint, z2) == 2
    assert all(sp.expand(constraint.subs(z2, z1 + sign * root)) == 0 for sign in (1, -1))
    r2 = (Rational(1, 2), Rational(1, 3), root.subs({x1: 0, y1: 0, x2: Rational(1, 2), y2: Rational(1, 3), d: 1}))
    pair = np.array([[0.0, 0.0, 0.0], [float(each) for each in r2], [1.0, 0.0, 0.0]])
    assert particles.separations(pair)[0] == pytest.approx(1, rel=1e-15, abs=0)


def test_exercise_2_three_spheres_meet_in_two_points() -> None:
    """The text says one: three spheres of radius 1 about the corners of a small triangle meet above and below it."""
    x, y, z = sp.symbols("x y z", real=True)
    corners = [(0, 0), (1, 0), (0, 1)]
    meeting = sp.solve([(x - a) ** 2 + (y - b) ** 2 + z**2 - 1 for a, b in corners], [x, y, z], dict=True)
    half, height = Rational(1, 2), sqrt(2) / 2
    assert {(point[x], point[y], point[z]) for point in meeting} == {(half, half, height), (half, half, -height)}


def test_exercises_3_4_8_and_9_matrices_in_terms_of_the_elementary_ones() -> None:
    """A1 = Rz(-phi) Rx(-theta) Rz(-psi) is [G 2.14], Goldstein's 4-47, and its transpose his 4-46, inertial to body."""

    def rx(a: sp.Expr) -> sp.Matrix:
        return sp.Matrix([[1, 0, 0], [0, cos(a), sin(a)], [0, -sin(a), cos(a)]])

    def rz(a: sp.Expr) -> sp.Matrix:
        return sp.Matrix([[cos(a), sin(a), 0], [-sin(a), cos(a), 0], [0, 0, 1]])

    a1 = rz(-PHI) * rx(-THETA) * rz(-PSI)
    assert sp.simplify(a1 - axes_by_sympy(PHI, THETA, PSI)) == sp.zeros(3)
    assert sp.simplify(a1.T - rz(PSI) * rx(THETA) * rz(PHI)) == sp.zeros(3)
    # Rx leaves x alone and, seen from the turned body, carries y to where z was seen, backwards.
    assert rx(PHI) * sp.Matrix([1, 0, 0]) == sp.Matrix([1, 0, 0])
    assert rx(pi / 2) * sp.Matrix([0, 1, 0]) == sp.Matrix([0, 0, -1])
    triad = Rational(3, 10), Rational(7, 10), Rational(-11, 10)
    exact = a1.subs(dict(zip((PHI, THETA, PSI), triad, strict=True)))
    assert close(zxz(*triad), exact)
    assert close(orientation.inertial_to_body("zxz", *(np.asarray(float(angle)) for angle in triad)), exact.T)
    assert close(orientation.rx(np.asarray(0.3)), rx(Rational(3, 10)))
    assert close(orientation.rz(np.asarray(0.3)), rz(Rational(3, 10)))


C100, S100 = cos(pi / 100), sin(pi / 100)
TRIADS = {
    "a": (pi / 4, pi / 4, pi / 4),
    "b": (pi / 3, sp.Integer(0), pi / 3),
    "c": (pi / 3, pi / 4, -pi / 3),
    "d": (pi / 3, pi / 100, -pi / 3),
    "e": (sp.Integer(0), pi / 2, pi / 2),
}
#: I, J, K in the inertial frame, by hand.
BODY_AXES = {
    "a": (
        (Rational(1, 2) - sqrt(2) / 4, Rational(1, 2) + sqrt(2) / 4, Rational(1, 2)),
        (-Rational(1, 2) - sqrt(2) / 4, -Rational(1, 2) + sqrt(2) / 4, Rational(1, 2)),
        (Rational(1, 2), -Rational(1, 2), sqrt(2) / 2),
    ),
    "b": ((-Rational(1, 2), sqrt(3) / 2, 0), (-sqrt(3) / 2, -Rational(1, 2), 0), (0, 0, 1)),
    "c": (
        (Rational(1, 4) + 3 * sqrt(2) / 8, sqrt(3) / 4 - sqrt(6) / 8, -sqrt(6) / 4),
        (sqrt(3) / 4 - sqrt(6) / 8, Rational(3, 4) + sqrt(2) / 8, sqrt(2) / 4),
        (sqrt(6) / 4, -sqrt(2) / 4, sqrt(2) / 2),
    ),
    "d": (
        (Rational(1, 4) + 3 * C100 / 4, sqrt(3) / 4 - sqrt(3) * C100 / 4, -sqrt(3) * S100 / 2),
        (sqrt(3) / 4 - sqrt(3) * C100 / 4, Rational(3, 4) + C100 / 4, S100 / 2),
        (sqrt(3) * S100 / 2, -S100 / 2, C100),
    ),
    "e": ((0, 0, 1), (-1, 0, 0), (0, -1, 0)),
}


@pytest.mark.parametrize("part", TRIADS)
def test_exercise_5_body_axes(part: str) -> None:
    by_hand = sp.Matrix(BODY_AXES[part]).T
    assert sp.simplify(axes_by_sympy(*TRIADS[part]) - by_hand) == sp.zeros(3)
    assert close(zxz(*TRIADS[part]), by_hand)


#: K, up to its length, and the angles phi = alpha + pi/2 and theta = beta that bring it there.
DIRECTIONS = {
    "a": ((0, 1, 0), pi, pi / 2),
    "b": ((1, 1, 1), 3 * pi / 4, sp.acos(sqrt(3) / 3)),
    "c": ((1, 1, 0), 3 * pi / 4, pi / 2),
    "d": ((1, 0, 0), pi / 2, pi / 2),
    "e": ((1, 0, 1), pi / 2, pi / 4),
    "f": ((0, 1, 1), pi, pi / 4),
}


@pytest.mark.parametrize("part", DIRECTIONS)
def test_exercise_6_angles_that_orient_k(part: str) -> None:
    """psi stays free: it turns the body about K and leaves K where it is."""
    vector, phi, theta = DIRECTIONS[part]
    k = axes_by_sympy(phi, theta, PSI)[:, 2]
    assert sp.simplify(k - sp.Matrix(vector) / sp.Matrix(vector).norm()) == sp.zeros(3, 1)
    for psi in (0.0, 0.7, -2.0):
        placed = placing.place_along("K", np.array(vector, dtype=float), np.asarray(psi))
        found = orientation.zxz_angles(placed)
        expected = float(phi), float(theta), psi
        # phi = pi and -pi are one.
        assert max(abs(math.remainder(float(x) - y, math.tau)) for x, y in zip(found, expected, strict=True)) < 1e-15
        assert close(placed[:, 2], k)


#: cos(Omega/2) = cos(theta/2) cos((phi + psi)/2): where phi + psi = 0 that is theta, where theta = 0 it is phi + psi.
TOTAL_ANGLES = {
    "a": 2 * sp.acos(cos(pi / 8) * sqrt(2) / 2),
    "b": 2 * pi / 3,
    "c": pi / 4,
    "d": pi / 100,
    "e": 2 * pi / 3,
}


@pytest.mark.parametrize("part", TRIADS)
def test_exercise_7_total_rotation_angle(part: str) -> None:
    exact = TOTAL_ANGLES[part]
    trace = axes_by_sympy(*TRIADS[part]).trace()
    assert sp.simplify(sp.expand_trig(2 * cos(exact / 2) ** 2 - 1) - (trace - 1) / 2) == 0
    _, found = orientation.axis_and_angle(zxz(*TRIADS[part]))
    # The matrix is rounded by 1e-16, which is what can be known of the angle.
    assert float(found) == pytest.approx(float(exact.evalf(25)), abs=1e-15)


S2, S3, S6 = sqrt(2), sqrt(3), sqrt(6)
#: A1 of exercise 10, by hand: I along i + j + k, and a turn xi about it.
PLACED = sp.Matrix(
    [
        [1 / S3, -sin(XI) / S2 + cos(XI) / S6, -cos(XI) / S2 - sin(XI) / S6],
        [1 / S3, sin(XI) / S2 + cos(XI) / S6, cos(XI) / S2 - sin(XI) / S6],
        [1 / S3, -2 * cos(XI) / S6, 2 * sin(XI) / S6],
    ]
)


def test_exercise_10_i_along_the_diagonal() -> None:
    """Body components of any vector are A2 times its inertial ones; those of 3 i are three times the first row of A1."""
    assert sp.simplify(PLACED.T * PLACED) == sp.eye(3)
    assert sp.simplify(PLACED.det()) == 1
    alpha, beta, angle = pi / 4, sp.acos(1 / S3), XI
    body = ReferenceFrame("body")
    aligned = ReferenceFrame("aligned")
    aligned.orient_body_fixed(INERTIAL, (alpha, -pi / 2, beta - pi / 2), "ZXZ")
    body.orient_axis(aligned, aligned.x, angle)
    assert sp.simplify(INERTIAL.dcm(body) - PLACED) == sp.zeros(3)
    answer = sp.Matrix([S3, 3 * cos(XI) / S6 - 3 * sin(XI) / S2, -3 * cos(XI) / S2 - 3 * sin(XI) / S6])
    assert sp.simplify(PLACED.T * sp.Matrix([3, 0, 0]) - answer) == sp.zeros(3, 1)
    for xi in (0.0, 0.6, -2.2):
        placed = placing.place_along("I", np.array([1.0, 1.0, 1.0]), np.asarray(xi))
        exact = {XI: sp.Float(xi, 30)}
        assert close(placed, PLACED.subs(exact))
        # Entries times 3.
        np.testing.assert_allclose(placed.T @ [3.0, 0.0, 0.0], floats(answer.subs(exact)).ravel(), rtol=0, atol=2e-15)


def test_exercise_11_angular_momentum_of_the_turning_block() -> None:
    """While xi grows and the aligned axis stays: (13/3) m xi' I, which is (13/9) sqrt(3) m xi' (i + j + k)."""
    semi_axes, spin = (1, 2, 3), Rational(5, 2)
    a, b, c = semi_axes
    moments = sp.Matrix([M * (b**2 + c**2) / 3, M * (a**2 + c**2) / 3, M * (a**2 + b**2) / 3])
    axes = PLACED.subs(XI, spin * T)
    i, j, k = (axes[:, column] for column in range(3))
    omega = sp.simplify(sp.Matrix([k.dot(j.diff(T)), i.dot(k.diff(T)), j.dot(i.diff(T))]))
    assert omega == sp.Matrix([spin, 0, 0])
    in_body = moments.multiply_elementwise(omega)
    assert in_body == sp.Matrix([Rational(13, 3) * M * spin, 0, 0])
    in_inertial = Rational(13, 9) * S3 * M * spin * sp.ones(3, 1)
    assert sp.simplify(axes * in_body - in_inertial) == sp.zeros(3, 1)

    now, mass = 0.4, 2.0
    exact = {T: sp.Float(now, 30), M: 2}
    placed = placing.place_along("I", np.array([1.0, 1.0, 1.0]), np.asarray(float(spin) * now))
    rates = rotation_vector.rates_of_axes(placed, floats(axes.diff(T).subs(exact)))
    momentum = np.array(principal_moments(Brick((1.0, 2.0, 3.0)), mass)) * rates
    # Angular momenta of 21 kg m^2/s, from moments and rates with a rounding each.
    np.testing.assert_allclose(momentum, floats(in_body.subs(exact)).ravel(), rtol=0, atol=2e-14)
    np.testing.assert_allclose(placed @ momentum, floats(in_inertial.subs(exact)).ravel(), rtol=0, atol=2e-14)


def test_exercise_12_angular_momentum_of_a_dumbbell() -> None:
    """Unit spheres of mass m, their centres at the ends of the rod, along K: C = 4m/5 and A = B = 4m/5 + 2m = 14m/5.

    l = A omega + (C - A) (omega . K) K, with the inertial rotation vector of [G 2.21b], is written out.
    """
    dphi, dtheta, dpsi = sp.symbols("dphi dtheta dpsi", real=True)
    about, across = Rational(4, 5) * M, Rational(14, 5) * M
    axes = axes_by_sympy(PHI, THETA, PSI)
    spin = dphi * cos(THETA) + dpsi
    body_rates = sp.Matrix(
        [
            dphi * sin(THETA) * sin(PSI) + dtheta * cos(PSI),
            dphi * sin(THETA) * cos(PSI) - dtheta * sin(PSI),
            spin,
        ]
    )
    answer = sp.Matrix(
        [
            across * (dtheta * cos(PHI) - dphi * sin(THETA) * cos(THETA) * sin(PHI)) + about * spin * sin(THETA) * sin(PHI),
            across * (dtheta * sin(PHI) + dphi * sin(THETA) * cos(THETA) * cos(PHI)) - about * spin * sin(THETA) * cos(PHI),
            across * dphi * sin(THETA) ** 2 + about * spin * cos(THETA),
        ]
    )
    assert sp.simplify(axes * sp.diag(across, across, about) * body_rates - answer) == sp.zeros(3, 1)

    values = {PHI: 0.4, THETA: 1.1, PSI: -0.8, dphi: 0.7, dtheta: -1.3, dpsi: 2.9, M: 1.5}
    exact = answer.subs({symbol: sp.Float(value, 30) for symbol, value in values.items()})
    phi, theta, psi = (np.asarray(values[symbol]) for symbol in (PHI, THETA, PSI))
    rates = rotation_vector.body_rate_matrix(theta, psi) @ np.array([values[dphi], values[dtheta], values[dpsi]])
    sphere = principal_moments(Sphere(1.0), 1.5)[0]
    momentum = np.array([2 * sphere + 3.0, 2 * sphere + 3.0, 2 * sphere]) * rates
    np.testing.assert_allclose(orientation.zxz(phi, theta, psi) @ momentum, floats(exact).ravel(), rtol=0, atol=1e-14)


def test_exercise_13_rate_of_change_of_a_point_of_the_body() -> None:
    """dR/dt of R = X I + Y J + Z K, by differentiating I, J, K, is Omega x R with the rotation vector of [G 2.21a]."""
    point, angles, rates = sp.Matrix(sp.symbols("X Y Z")), (PHI, THETA, PSI), sp.symbols("dphi dtheta dpsi")
    axes = axes_by_sympy(*angles)
    derivative = sp.zeros(3)
    for angle, rate in zip(angles, rates, strict=True):
        derivative += rate * axes.diff(angle)
    dphi, dtheta, dpsi = rates
    omega = sp.Matrix(
        [
            dphi * sin(THETA) * sin(PSI) + dtheta * cos(PSI),
            dphi * sin(THETA) * cos(PSI) - dtheta * sin(PSI),
            dphi * cos(THETA) + dpsi,
        ]
    )
    # Both sides turned to the inertial frame, where neither needs an inverse.
    assert sp.simplify(derivative * point - axes * omega.cross(point)) == sp.zeros(3, 1)

    values = dict(zip((*angles, *rates), (0.2, 1.0, 0.7, 0.3, -0.5, 2.0), strict=True))
    phi, theta, psi = (np.asarray(values[angle]) for angle in angles)
    moving = floats(derivative.subs(values))
    found = rotation_vector.rates_of_axes(orientation.zxz(phi, theta, psi), moving)
    r = np.array([0.1, -0.4, 0.3])
    world = rotate(quaternion_from_euler(phi, theta, psi), np.cross(found, r))
    np.testing.assert_allclose(world, moving @ r, rtol=0, atol=1e-15)
