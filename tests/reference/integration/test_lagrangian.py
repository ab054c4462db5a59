"""The equations of motion, written by hand, are those that SymPy derives from the Lagrangian."""

import functools

import numpy as np
import pytest
import sympy as sp
from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols

from bodycheck.reference.integration import lagrangian

MOMENTS = sp.symbols("A B C", positive=True)
THETA, PHI, PSI = ANGLES = dynamicsymbols("theta phi psi")
RATES = [angle.diff() for angle in ANGLES]
ACCELERATIONS = [rate.diff() for rate in RATES]


@functools.cache
def derived() -> LagrangesMethod:
    """[G 2.34] with the body rates of [G 2.21a]."""
    dtheta, dphi, dpsi = RATES
    omega = (
        dphi * sp.sin(THETA) * sp.sin(PSI) + dtheta * sp.cos(PSI),
        dphi * sp.sin(THETA) * sp.cos(PSI) - dtheta * sp.sin(PSI),
        dphi * sp.cos(THETA) + dpsi,
    )
    kinetic_energy = sum(moment * rate**2 for moment, rate in zip(MOMENTS, omega, strict=True)) / 2
    method = LagrangesMethod(kinetic_energy, ANGLES)
    method.form_lagranges_equations()
    return method


def vanishes(expression: sp.Expr) -> bool:
    """Whether a rational function of moments, rates, sines and cosines is zero: its numerator is, as a polynomial."""
    plain = {angle: sp.Symbol(name) for angle, name in zip(ANGLES, ("theta", "phi", "psi"), strict=True)}
    plain |= {rate: sp.Symbol(f"d{plain[angle]}") for angle, rate in zip(ANGLES, RATES, strict=True)}
    # Derivatives first: they contain the angles.
    for found in (RATES, ANGLES):
        expression = expression.xreplace({each: plain[each] for each in found})
    numerator = sp.expand(sp.numer(sp.together(expression)))
    for angle in (plain[THETA], plain[PSI]):
        sine, cosine = sp.Symbol("sine"), sp.cos(angle)
        numerator = numerator.xreplace({sp.sin(angle): sine})
        numerator = sp.rem(numerator, sine**2 + cosine**2 - 1, sine).xreplace({sine: sp.sin(angle)})
    return sp.expand(numerator) == 0


@pytest.fixture
def symbolic(monkeypatch: pytest.MonkeyPatch) -> None:
    """Lets the hand-written functions run on symbols: their sines and cosines become SymPy's."""
    monkeypatch.setattr(lagrangian, "math", sp)


@pytest.mark.usefixtures("symbolic")
def test_mass_matrix_is_that_of_the_lagrangian() -> None:
    by_hand = sp.Matrix(lagrangian.rotational_mass_matrix(MOMENTS, THETA, PSI))
    assert all(vanishes(entry) for entry in by_hand - derived().mass_matrix)


@pytest.mark.usefixtures("symbolic")
def test_accelerations_are_those_of_the_lagrangian() -> None:
    by_hand = lagrangian.angular_accelerations(MOMENTS, THETA, PSI, *RATES)
    left_over = derived().eom.xreplace(dict(zip(ACCELERATIONS, by_hand, strict=True)))
    assert all(vanishes(equation) for equation in left_over)


@pytest.mark.usefixtures("symbolic")
def test_a_wrong_sign_does_not_pass() -> None:
    ddtheta, ddphi, ddpsi = lagrangian.angular_accelerations(MOMENTS, THETA, PSI, *RATES)
    left_over = derived().eom.xreplace(dict(zip(ACCELERATIONS, (ddtheta, ddphi, -ddpsi), strict=True)))
    assert not any(vanishes(equation) for equation in left_over[1:])


def test_the_12_equations_are_free_fall_and_the_accelerations() -> None:
    moments = (1.0, 1.5, 2.0)
    state = np.array([1.0, 2.0, 3.0, 0.7, 0.4, -0.3, 4.0, 5.0, 6.0, 0.1, 0.2, 0.3])
    accelerations = lagrangian.angular_accelerations(moments, 0.7, -0.3, 0.1, 0.2, 0.3)
    expected = [*state[6:], 0.0, 0.0, -9.81, *accelerations]
    np.testing.assert_array_equal(lagrangian.equations(np.array(moments), 9.81)(0.0, state), expected)
