"""Jacobi's elliptic functions and the phase of the third kind agree with mpmath for every modulus."""

import mpmath
import numpy as np
import pytest

from bodycheck.reference.flight.elliptic import Wide, complete, first_kind, jacobi, quarter_period, theta_series

EPS = float(np.finfo(float).eps)
WIDE_EPS = float(np.finfo(Wide).eps)


def wide(value: mpmath.mpf) -> Wide:
    return Wide(float(value)) + Wide(float(value - mpmath.mpf(float(value))))


@pytest.mark.parametrize("kc", ["1e-30", "1e-18", "1e-9", "1e-3", "0.1", "0.7", "0.71", "0.9", "0.999999", "0.999999999999"])
@pytest.mark.parametrize("nu", ["0", "1e-10", "0.1", "1"])
def test_elliptic_functions_for_every_modulus(kc: str, nu: str) -> None:
    with mpmath.workdps(80):
        complementary, characteristic = mpmath.mpf(kc), mpmath.mpf(nu)
        m = 1 - complementary**2
        quarter = mpmath.ellipk(m)
        mean = mpmath.elliprj(0, complementary**2, 1, 1 + characteristic) / 3 / quarter
        weight = mpmath.sqrt(characteristic * (1 + characteristic) * (characteristic + m))
        u = np.array([0.0, 1e-9, 0.3, 0.9, 0.999, 1.0]) * float(quarter)
        u = np.concatenate([-u, u])
        k, kc_, nu_ = wide(mpmath.sqrt(m)), wide(complementary), wide(characteristic)
        assert float(abs(quarter_period(kc_) / wide(quarter) - 1)) < 10 * WIDE_EPS
        third = complete(kc_, 1 + nu_, Wide(0), Wide(1)) / quarter_period(kc_)
        assert float(abs(third / wide(mean) - 1)) < 20 * WIDE_EPS

        eta = Wide(0)
        if nu_ > 0:
            eta = first_kind(*(np.sqrt(part / (nu_ + k * k)) for part in (nu_, k * k, k * k * (1 + nu_))))
        sn, cn, dn, phase = jacobi(theta_series(k, kc_, quarter_period(kc_), eta, bool(k > kc_)), u)
        for index, value in enumerate(map(mpmath.mpf, u.tolist())):
            s, c, d = (mpmath.re(mpmath.ellipfun(name, value, m=m)) for name in ("sn", "cn", "dn"))
            # Within a few roundings of 1, of which those of u, up to 70, are none: the functions are flat there.
            assert max(abs(s - sn[index]), abs(c - cn[index]), abs(d - dn[index])) < 4 * EPS
            integral = s**3 * mpmath.elliprj(c * c, d * d, 1, 1 + characteristic * s * s) / 3
            if abs(value) <= quarter:
                assert abs(phase[index] - weight * (mean * value - integral)) < 4 * EPS


@pytest.mark.parametrize("u", ["1e-15", "0.5", "3", "20", "60"])
def test_first_kind_inverts_the_elliptic_functions_near_the_separatrix(u: str) -> None:
    with mpmath.workdps(80):
        value, m = mpmath.mpf(u), 1 - mpmath.mpf("1e-30") ** 2
        functions = (wide(mpmath.re(mpmath.ellipfun(name, value, m=m))) for name in ("sn", "cn", "dn"))
        assert float(abs(first_kind(*functions) / wide(value) - 1)) < 20 * WIDE_EPS
