"""What the second closed form is made of: elliptic functions, the integral of a swing, and phases after many turns."""

from fractions import Fraction

import numpy as np
import pytest

from bodycheck.reference.independent.arithmetic import WIDE_EPS, Real, turns, wide
from bodycheck.reference.independent.border import MP
from bodycheck.reference.independent.jacobi import argument, functions, modulus
from bodycheck.reference.independent.swing import LARGEST_ARGUMENT, integrated, swing

#: Complementary moduli, and arguments as parts of the quarter period.
COMPLEMENTARY = ["1", "0.99999999", "0.7", "0.1", "1e-5", "1e-14", "1e-30"]
PARTS = ["0", "1e-12", "0.2", "-0.5", "0.500001", "0.9", "-0.99", "0.9999999", "1"]


def real(value: np.longdouble) -> Real:
    """A number of the wide type with a hundred digits."""
    numerator, denominator = value.as_integer_ratio()
    return MP.mpf(numerator) / denominator


def jacobi(u: Real, kc: Real) -> tuple[Real, Real, Real]:
    """sn u, cn u and dn u by the theta functions of mpmath."""
    sn, cn, dn = (MP.re(MP.ellipfun(name, u, m=1 - kc * kc)) for name in ("sn", "cn", "dn"))
    return sn, cn, dn


@pytest.mark.parametrize("kc", COMPLEMENTARY)
def test_elliptic_functions(kc: str) -> None:
    of = modulus(MP.mpf(kc))
    arguments = [of.quarter * MP.mpf(part) for part in PARTS]
    found = functions(of, np.array([wide(u) for u in arguments]))
    for *values, u in zip(*found, arguments, strict=True):
        for value, expected in zip(values, jacobi(u, MP.mpf(kc)), strict=True):
            # A rounding of u, which is at most K, and one in each of the transformations.
            assert abs(real(value) - expected) <= WIDE_EPS * (len(of.means) + 2 + of.quarter)


@pytest.mark.parametrize("kc", COMPLEMENTARY)
def test_the_argument_is_the_inverse(kc: str) -> None:
    of = modulus(MP.mpf(kc))
    with MP.workdps(200):  # the parameter m = k^2 alone loses the digits of k'
        quarter = MP.ellipk(1 - MP.mpf(kc) ** 2)
    assert abs(of.quarter - quarter) <= 1e-50 * of.quarter
    for part in PARTS:
        u = of.quarter * MP.mpf(part)
        sn, cn, _ = jacobi(u, MP.mpf(kc))
        # The means are equal to 36 digits where Landen's transformations end.
        assert abs(argument(of, 3 * sn, 3 * max(cn, MP.zero)) - u) <= 1e-30


def test_on_the_separatrix_the_functions_are_hyperbolic() -> None:
    of = modulus(MP.zero)
    u = np.array([0, -2, 0.5, 40], dtype=np.longdouble)
    sn, cn, dn = functions(of, u)
    np.testing.assert_allclose((sn - np.tanh(u)).astype(float), 0, atol=1e-50)
    np.testing.assert_array_equal(cn, dn)
    np.testing.assert_allclose((cn * np.cosh(u)).astype(float), 1, rtol=1e-15)
    assert abs(argument(of, MP.tanh(-60), MP.sech(60)) + 60) < 1e-40


@pytest.mark.parametrize(("kc", "nu"), [("1", 0.0), ("0.7", 0.3), ("0.1", 1.0), ("0", 0.3), ("0", 1.0), ("1e-3", 0.5)])
def test_the_integral_of_a_swing(kc: str, nu: float) -> None:
    of = modulus(MP.mpf(kc))
    ends = [MP.mpf(part) * min(of.quarter, 30) for part in ("0", "0.01", "0.37", "0.8", "1")]
    found = integrated(swing(of, np.longdouble(nu)), np.array([wide(u) for u in ends]))

    def integrand(u: Real) -> Real:
        sn, cn, _ = jacobi(u, MP.mpf(kc)) if of.mean else (MP.tanh(u), MP.sech(u), None)
        return cn * cn / (1 + MP.mpf(nu) * sn * sn)

    with MP.workdps(25):
        for u, value in zip(ends, found, strict=True):
            expected = MP.quad(integrand, MP.linspace(0, u, 2 + int(u))) if u else MP.zero
            # The panels are summed with a rounding each, of a value below K <= LARGEST_ARGUMENT that is itself at most 2.
            assert abs(real(value) - expected) <= WIDE_EPS * LARGEST_ARGUMENT


@pytest.mark.parametrize("rate", ["0.123456789012345678901234567890", "1591549.430918953357688837633725", "3.1e-9"])
def test_phases_keep_their_digits_after_many_turns(rate: str) -> None:
    times = np.array([0.0, 1.0, 1234567.891, -98765.4321, 1e-7])
    offset = MP.mpf("0.3")
    count, left = turns(offset, MP.mpf(rate), times)
    for time, whole, part in zip(times.tolist(), count, left, strict=True):
        expected = Fraction("0.3") + Fraction(rate) * Fraction(time)
        assert abs(Fraction(int(whole)) + Fraction(*part.as_integer_ratio()) - expected) <= Fraction(4 * WIDE_EPS)
        assert abs(part) <= 0.5
