"""The equations of a rolling coin: derived from the Lagrangian, and what they say of small wobbles and of large ones."""

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest
import sympy as sp

from bodycheck.reference.contact.coin import angles, bodily
from bodycheck.reference.contact.coin.start import Coin
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.integration.collocation import integrate
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import WideArray
from tests.support.coins import as_coin, rolling

#: A wobble between the tilts 0.9 and 1.3, far from flat.
WOBBLE = rolling(1.2, (0.3, 4.0, -9.0))

#: The rate of the tilt with which a small wobble begins.
AMPLITUDE = 1e-6


def followed(coin: Coin, start: WideArray, times: Array) -> WideArray:
    return integrate(angles.equations(coin), start, times, stages=24, first=0.5, most=20_000, memory=1).states


def energy_of(coin: Coin, state: WideArray) -> np.longdouble:
    """The energy for each unit of mass in a state (8,), counted from the plane."""
    theta, p, q, s = state[[angles.THETA, angles.P, angles.Q, angles.S]]
    r, h = coin.radius, coin.half_length
    kinetic = (coin.across + r * r + h * h) * p * p + coin.across * q * q + coin.along * s * s + (q * h - s * r) ** 2
    return np.longdouble(kinetic / 2 + coin.gravity * (h * np.cos(theta) + r * np.sin(theta)))


def test_the_equations_follow_from_the_lagrangian_with_the_constraints_of_rolling() -> None:
    """D'Alembert's principle: virtual displacements obey the constraints, and so x and y follow the three angles."""
    t = sp.Symbol("t")
    a, c, r, h, g = sp.symbols("A C r h g", positive=True)
    theta, phi, psi, x, y = (sp.Function(name)(t) for name in ("theta", "phi", "psi", "x", "y"))
    sine, cosine = sp.sin(theta), sp.cos(theta)
    p, q, s = theta.diff(t), phi.diff(t) * sine, phi.diff(t) * cosine + psi.diff(t)
    kappa, u = phi.diff(t) * cosine, h * q - r * s
    height = h * cosine + r * sine
    lagrangian = (x.diff(t) ** 2 + y.diff(t) ** 2 + height.diff(t) ** 2 + a * (p**2 + q**2) + c * s**2) / 2 - g * height
    outward = p * (h * cosine + r * sine)
    rolled = {x: u * sp.cos(phi) + outward * sp.sin(phi), y: u * sp.sin(phi) - outward * sp.cos(phi)}

    def euler(coordinate: sp.Expr) -> sp.Expr:
        return lagrangian.diff(coordinate.diff(t)).diff(t) - lagrangian.diff(coordinate)

    def principle(angle: sp.Expr) -> sp.Expr:
        made = euler(angle) + sum(euler(place) * rate.diff(angle.diff(t)) for place, rate in rolled.items())
        made = made.subs({place.diff(t, 2): rate.diff(t) for place, rate in rolled.items()})
        return made.subs({place.diff(t): rate for place, rate in rolled.items()}).doit()

    turned = q * r + kappa * h
    of_p = (a + r**2 + h**2) * p.diff(t) - (a * kappa * q - c * q * s + turned * u - r * g * cosine + h * g * sine)
    of_q = (a + h**2) * q.diff(t) - h * r * s.diff(t) - (c * p * s - a * kappa * p - h * p * turned)
    of_s = (c + r**2) * s.diff(t) - h * r * q.diff(t) - r * p * turned

    def vanishes(equation: sp.Expr) -> bool:
        """Whether an equation is one for any values of the angles, their rates and their accelerations."""
        for order in (2, 1):
            equation = equation.subs({angle.diff(t, order): sp.Symbol(f"{angle.func}{order}") for angle in (theta, phi, psi)})
        squares = {}
        for angle in (theta, phi):
            one, other = sp.symbols(f"sin_{angle.func} cos_{angle.func}")
            equation, squares[one] = equation.subs({sp.sin(angle): one, sp.cos(angle): other}), 1 - other**2
        numerator = sp.numer(sp.together(equation))
        for one, square in squares.items():
            numerator = sp.rem(numerator, one**2 - square, one)
        return bool(sp.expand(numerator) == 0)

    assert vanishes(principle(theta) - of_p)
    assert vanishes(principle(psi) - of_s)
    assert vanishes(principle(phi) - sine * of_q - cosine * of_s)
    assert not vanishes(principle(theta) - of_p + sp.Symbol("g") * sine / 10**6)


def test_the_code_has_these_equations() -> None:
    coin = as_coin(WOBBLE)
    r, h, a, c, g = coin.radius, coin.half_length, coin.across, coin.along, coin.gravity
    states = np.random.default_rng(1).uniform(0.2, 1.4, (50, 8)).astype(Wide)
    theta, p, q, s = states[:, :4].T
    found = angles.accelerated(coin, states)
    kappa, u = q / np.tan(theta), q * h - s * r
    turned = q * r + kappa * h
    of_p = (a + r * r + h * h) * found.p - (
        a * kappa * q - c * q * s + turned * u - r * g * np.cos(theta) + h * g * np.sin(theta)
    )
    of_q = (a + h * h) * found.q - h * r * found.s - (c * p * s - a * kappa * p - h * p * turned)
    of_s = (c + r * r) * found.s - h * r * found.q - r * p * turned
    # Some tens of roundings of numbers up to 20.
    assert max(float(np.abs(each).max()) for each in (of_p, of_q, of_s)) < 1e-16


def test_both_formulations_have_one_acceleration_and_one_force() -> None:
    coin = as_coin(WOBBLE)
    states = np.random.default_rng(2).uniform(0.2, 1.4, (50, 8)).astype(Wide)
    position, velocity, quaternion, spin = angles.poses(coin, states)
    others = np.concatenate([quaternion, spin, position], axis=1)
    for one, other in zip(angles.forces(coin, states), bodily.forces(coin, others), strict=True):
        assert np.abs(one - other).max() < 1e-15 * np.abs(one).max()
    _, moved, _, _ = bodily.poses(coin, others)
    assert np.abs(moved - velocity).max() < 1e-17


def thin(spin: float) -> tuple[Coin, WideArray]:
    """A thin homogeneous disk of radius 1 under gravity 1 that is upright, with the spin s along its axis."""
    one = Wide(1)
    coin = replace(as_coin(WOBBLE), radius=one, half_length=0 * one, across=one / 4, along=one / 2, gravity=one)
    upright = np.arctan2(one, 0 * one)
    return coin, np.array([upright, 0, 0, spin, 0, 0, 0, 0], dtype=Wide)


def wobble_square(coin: Coin, start: WideArray) -> float:
    """The square of the frequency of a small wobble about a steady motion; negative where it grows.

    It is that of half the difference of wobbles to either side, which differs from its limit by the square of the amplitude.
    """
    times, nudge = np.array([0.0, 0.5, 1.0]), np.zeros_like(start)
    nudge[angles.P] = AMPLITUDE
    one, other = (followed(coin, start + side * nudge, times)[:, angles.THETA] for side in (1, -1))
    tilts = one - other
    # tilt(t) is a sine of t, so that the tilts at t and 2t have the ratio 2 cos(frequency t).
    cosine = complex(tilts[2] / tilts[1] / 2)
    return float((np.arccos(cosine) / 0.5).real ** 2 - (np.arccos(cosine) / 0.5).imag ** 2)


@pytest.mark.parametrize("share", [0.5, 0.99, 1.01, 2.0])
def test_straight_rolling_is_stable_above_the_known_spin(share: float) -> None:
    """For a thin disk from s^2 = g / 3r on; the wobble has (12 s^2 - 4 g / r) / 5."""
    spin = math.sqrt(share / 3)
    expected = (12 * spin**2 - 4) / 5
    coin, start = thin(spin)
    assert wobble_square(coin, start) == pytest.approx(expected, abs=1e-9)
    assert (expected > 0) == (share > 1)


@pytest.mark.parametrize("share", [0.5, 0.99, 1.01, 2.0])
def test_spinning_upright_is_stable_above_the_known_rate(share: float) -> None:
    """For a thin disk from 4 g / 5r on, the square of the rate about the vertical; the wobble has that rate^2 - 4 g / 5r."""
    rate = math.sqrt(0.8 * share)
    coin, start = thin(0.0)
    start[angles.Q] = rate
    assert wobble_square(coin, start) == pytest.approx(rate**2 - 0.8, abs=1e-9)


def test_a_thick_coin_that_rolls_straight_on_its_rim_wobbles_as_the_linear_theory_says() -> None:
    """Its centre of mass is above the rim, and its velocity is along the line of nodes."""
    coin = as_coin(WOBBLE)
    r, h, a, c, g = (float(each) for each in (coin.radius, coin.half_length, coin.across, coin.along, coin.gravity))
    spin, tilt = 1.3, np.arctan2(coin.radius, coin.half_length)
    start = np.array([tilt, 0, 0, spin, 0, 0, 0, 0], dtype=Wide)
    by_spin = c * (c + r * r) / (a * c + a * r * r + c * h * h) * (c + r * r + h * h)
    expected = (by_spin * spin**2 - g * math.hypot(r, h)) / (a + r * r + h * h)
    assert wobble_square(coin, start) == pytest.approx(expected, abs=1e-9)


class Hypergeometric:
    """q and s as functions of the tilt, through given values at one tilt.

    The equations of q and s, divided by p, are linear in the tilt: q_theta = -b q + k s - q cot theta and
    s_theta = l q + b s. Hence s'' + cot(theta) s' = (k l + b^2 + b cot theta) s, which is Legendre's equation for h = 0
    (Chaplygin 1897, Appell and Korteweg 1900), with conical functions. In w = exp(2 i theta) it has the regular singular points
    0, 1 and infinity for any h, so that s is a sum of hypergeometric functions.
    """

    def __init__(self, coin: Coin, tilt: mpmath.mpf, q: mpmath.mpf, s: mpmath.mpf) -> None:
        r, h, a, c = (mpmath.mpf(str(each)) for each in (coin.radius, coin.half_length, coin.across, coin.along))
        determinant = a * c + a * r**2 + c * h**2
        self.b, self.l = h * r * c / determinant, a * r**2 / determinant
        d = c * (c + r**2) / determinant * self.l + self.b**2
        root = mpmath.sqrt(1 - 4 * (d - 1j * self.b))
        self.at_zero = ((1 + root) / 4, (1 - root) / 4)
        root = mpmath.sqrt(1 - 4 * (d + 1j * self.b))
        self.at_infinity = ((-1 + root) / 4, (-1 - root) / 4)
        columns = [self._both(place, tilt) for place in (0, 1)]
        self.weights = mpmath.lu_solve(mpmath.matrix([[column[row] for column in columns] for row in (0, 1)]), [q, s])

    def _both(self, place: int, tilt: mpmath.mpf) -> tuple[mpmath.mpc, mpmath.mpc]:
        rho, other = self.at_zero[place], self.at_zero[1 - place]
        first, second = (rho - each for each in self.at_infinity)
        third, w = 1 + rho - other, mpmath.expj(2 * tilt)
        value = mpmath.hyp2f1(first, second, third, w)
        slope = first * second / third * mpmath.hyp2f1(first + 1, second + 1, third + 1, w)
        power = mpmath.exp(2j * rho * tilt)
        s = power * value
        return (2j * power * (rho * value + w * slope) - self.b * s) / self.l, s

    def __call__(self, tilt: mpmath.mpf) -> tuple[mpmath.mpf, mpmath.mpf]:
        columns = [self._both(place, tilt) for place in (0, 1)]
        q, s = (sum(weight * column[row] for weight, column in zip(self.weights, columns, strict=True)) for row in (0, 1))
        return q.real, s.real


@pytest.mark.parametrize("thickness", [1.0, 0.0])
def test_a_wobble_is_that_of_hypergeometric_functions_and_a_quadrature(thickness: float) -> None:
    """q and s follow from the tilt, p from the energy, and the time is the integral of 1/p over the tilt."""
    coin = as_coin(WOBBLE)
    coin = replace(coin, half_length=coin.half_length * Wide(thickness))
    start = angles.initial(coin)
    start[angles.P] = 0.06
    times = np.linspace(0.0, 3.0, 7)
    states = followed(coin, start, times)
    theta, p = states[:, angles.THETA], states[:, angles.P]
    assert (p > 0).all()  # the wobble has not turned back
    r, h, a, c, g = (mpmath.mpf(str(each)) for each in (coin.radius, coin.half_length, coin.across, coin.along, coin.gravity))
    tilts = [mpmath.mpf(str(tilt)) for tilt in theta]
    spins = Hypergeometric(coin, tilts[0], *(mpmath.mpf(str(start[part])) for part in (angles.Q, angles.S)))
    energy = mpmath.mpf(str(energy_of(coin, start)))

    def rate(tilt: mpmath.mpf) -> mpmath.mpf:
        q, s = spins(tilt)
        rest = energy - g * (h * mpmath.cos(tilt) + r * mpmath.sin(tilt)) - (a * q**2 + c * s**2 + (q * h - s * r) ** 2) / 2
        return mpmath.sqrt(2 * rest / (a + r**2 + h**2))

    for tilt, state in zip(tilts, states, strict=True):
        q, s = spins(tilt)
        assert float(abs(q - mpmath.mpf(str(state[angles.Q])))) < 1e-15
        assert float(abs(s - mpmath.mpf(str(state[angles.S])))) < 1e-15
    passed = mpmath.quad(lambda tilt: 1 / rate(tilt), [tilts[0], tilts[-1]])
    # mpmath has 15 digits.
    assert float(passed) == pytest.approx(times[-1], rel=1e-13)
