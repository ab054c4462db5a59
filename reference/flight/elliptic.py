"""Jacobi's elliptic functions, and the phase of the integral of the third kind, by theta series of a few terms.

The series converge quickly for every modulus. Functions take both moduli, k and k' (k^2 + k'^2 = 1), so that no digits are lost
at either end: for small oscillations (k near 0) and at the separatrix (k' near 0). Constants are computed in the widest
floating-point type of the machine, so that thousands of periods can be subtracted from an argument without loss; arrays are
in double precision. Equations are cited from the NIST Digital Library of Mathematical Functions [DLMF].
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.trajectory import Array

#: An array of the wide type.
WideArray = NDArray[np.longdouble]

#: The number pi in the wide type.
PI = 4 * np.arctan(Wide(1))

#: Value used for the quarter period of modulus 1. It is finite, so that the separatrix needs no special case.
SEPARATRIX_QUARTER_PERIOD = np.finfo(Wide).max ** Wide(0.75)

#: Argument x at which sech(x) is negligible in double precision and cosh(6 x) does not yet overflow.
LARGEST_SECH_ARGUMENT = 100.0

#: The signs (-1)^n of the terms of a theta series, n = 0 to 3.
ALTERNATING_SIGNS = np.array([1.0, -1.0, 1.0, -1.0])

#: Coefficients of sin((2n + 1) v) / sin(v), one row for each n, in terms of 1, cos(2v), cos(4v), cos(6v).
SINE_RATIOS = np.array([[1.0, 0.0, 0.0, 0.0], [1.0, 2.0, 0.0, 0.0], [1.0, 2.0, 2.0, 0.0], [1.0, 2.0, 2.0, 2.0]])

#: Coefficients of cos((2n + 1) v) / cos(v) in the same terms.
COSINE_RATIOS = np.array([[1.0, 0.0, 0.0, 0.0], [-1.0, 2.0, 0.0, 0.0], [1.0, -2.0, 2.0, 0.0], [-1.0, 2.0, -2.0, 2.0]])


def complete(kc: Wide, p: Wide, a: Wide, b: Wide) -> Wide:
    """Complete elliptic integral in the general form of Bulirsch (Numer. Math. 13, 305, 1969).

    It is the integral over 0..pi/2 of (a cos^2 + b sin^2) / ((cos^2 + p sin^2) sqrt(cos^2 + kc^2 sin^2)).

    Parameters
    ----------
    kc
        Complementary modulus k' > 0.
    p
        Parameter of the integral of the third kind, p > 0.
    a, b
        Coefficients; for a, b >= 0 only positive terms are added, so that nothing cancels.

    Returns
    -------
    Wide
        The integral.
    """
    root, mean, product = np.sqrt(p), Wide(1), kc
    b = b / root
    while True:
        a, b, root = a + b / root, 2 * (b + a * product / root), root + product / root
        previous, mean = mean, mean + kc
        if abs(previous - kc) <= 1e-10 * previous:
            return Wide(PI / 2 * (b + a * mean) / (mean * (mean + root)))
        kc = 2 * np.sqrt(product)
        product = kc * mean


def quarter_period(kc: Wide) -> Wide:
    """The quarter period K for the complementary modulus kc >= 0; a very large number for kc = 0."""
    return complete(kc, Wide(1), Wide(1), Wide(1)) if kc > 0 else SEPARATRIX_QUARTER_PERIOD


def first_kind(sn: Wide, cn: Wide, dn: Wide) -> Wide:
    """Inverse of the elliptic functions: u = sn R_F(cn^2, dn^2, 1) [DLMF 19.25.5].

    R_F is computed by duplication [DLMF 19.26.18] and its series to the seventh order [DLMF 19.36.1].

    Parameters
    ----------
    sn, cn, dn
        Values of the functions at u; the sign of cn has no effect. cn and dn must not both be zero.

    Returns
    -------
    Wide
        The argument u in [-K, K].
    """
    x, y, z = cn * cn, dn * dn, Wide(1)
    while True:
        mean = (x + y + z) / 3
        dx, dy = 1 - x / mean, 1 - y / mean
        dz = -dx - dy
        if max(abs(dx), abs(dy), abs(dz)) < 2e-3:
            e2, e3 = dx * dy - dz * dz, dx * dy * dz
            second = e2 * (-1 / Wide(10) + e2 * (1 / Wide(24) - e2 * 5 / 208))
            third = e3 * (1 / Wide(14) + e2 * (-3 / Wide(44) + e2 / 16) + e3 * 3 / 104)
            return Wide(sn * (1 + second + third) / np.sqrt(mean))
        rx, ry, rz = np.sqrt(x), np.sqrt(y), np.sqrt(z)
        shift = rx * ry + rx * rz + ry * rz
        x, y, z = (x + shift) / 4, (y + shift) / 4, (z + shift) / 4


@dataclass(frozen=True, eq=False)
class ThetaSeries:
    """Six theta series in the terms 1, c1, c2, c3 for u in [-K, K].

    The terms are c_n = cos(2 n z), or cosh(2 n z) in the hyperbolic case, with z = scale u.

    Attributes
    ----------
    rows
        (6, 4) coefficients of the numerators of sn, cn and dn, of their common denominator, and of the real and imaginary parts
        of Theta(u + i eta). Each series is divided by its leading function; `jacobi` multiplies by it.
    hyperbolic
        Whether the terms are hyperbolic, which they are for k > k'.
    scale
        The factor z / u.
    slope
        The part of the phase of Theta(u + i eta) that is proportional to u, per unit of u (rad).
    """

    rows: Array
    hyperbolic: bool
    scale: float
    slope: float


def theta_series(k: Wide, kc: Wide, quarter: Wide, eta: Wide) -> ThetaSeries:
    """The theta series of one modulus.

    They are theta functions [DLMF 20.2, 22.2] of the smaller of the two nomes, which is at most exp(-pi), so that the neglected
    terms are below 1e-18 of the sum. Jacobi's imaginary transformation [DLMF 20.7.30-20.7.33] relates the two nomes.

    Parameters
    ----------
    k, kc
        Modulus and complementary modulus k'.
    quarter
        Quarter period K.
    eta
        Imaginary shift of Theta, in [0, K'), with k sc(eta, k') not much larger than 1.

    Returns
    -------
    ThetaSeries
        The series.
    """
    hyperbolic = bool(k > kc)
    other = quarter_period(k)
    period, conjugate = (other, quarter) if hyperbolic else (quarter, other)
    n = np.arange(4, dtype=Wide)
    log_nome = np.maximum(-PI * conjugate / period, Wide(-1e4))
    shift = PI / 2 * eta / period
    integer = np.exp((n * n * log_nome).astype(float)) * 2
    integer[0] = 1
    half = np.exp((n * (n + 1) * log_nome).astype(float))

    alternating = ALTERNATING_SIGNS * half
    theta1, theta2, theta3, theta4 = alternating @ SINE_RATIOS, half @ COSINE_RATIOS, integer, ALTERNATING_SIGNS * integer
    if hyperbolic:
        denominator, numerators = theta2, [theta1, theta4, theta3]
        turns = ((2 * n + 1) * shift).astype(float)
        real, imaginary = (half * np.cos(turns)) @ COSINE_RATIOS, (half * np.sin(turns)) @ SINE_RATIOS
    else:
        denominator, numerators = theta4, [theta1, theta2, theta3]
        growing = np.exp((n * n * log_nome + 2 * n * shift).astype(float))
        fading = np.exp((n * n * log_nome - 2 * n * shift).astype(float))
        real = ALTERNATING_SIGNS * (growing + fading)
        real[0] = 1
        _, s1, s2, s3 = growing - fading
        imaginary = np.array([s1 + s3, -2 * s2, 2 * s3, 0])
    at_zero = denominator.sum() / np.array([row.sum() for row in numerators])
    at_zero[0] *= float(2 * period / PI)
    rows = np.array([*(at_zero[:, None] * numerators), denominator, real, imaginary])
    return ThetaSeries(rows, hyperbolic, float(PI / 2 / period), float(-shift / quarter) if hyperbolic else 0.0)


def jacobi(series: ThetaSeries, u: Array) -> tuple[Array, Array, Array, Array]:
    """sn u, cn u, dn u and the phase (rad) of Theta(u + i eta), each (n,), for arguments u (n,) in [-K, K]."""
    terms = np.empty((4, len(u)))
    z = series.scale * u
    if series.hyperbolic:
        z = np.clip(z, -LARGEST_SECH_ARGUMENT, LARGEST_SECH_ARGUMENT)
        for_sn, for_cn = np.tanh(z), 1 / np.cosh(z)
        for_dn, for_phase = for_cn, for_sn
        c = np.cosh(2 * z)
    else:
        for_sn, for_cn = np.sin(z), np.cos(z)
        for_dn, for_phase = np.ones_like(z), 2 * for_sn * for_cn
        c = 1 - 2 * for_sn * for_sn
    terms[0] = 1
    terms[1] = c
    terms[2] = 2 * c * c - 1
    terms[3] = (2 * terms[2] - 1) * c
    sn, cn, dn, denominator, real, imaginary = series.rows @ terms
    phase = series.slope * u + np.arctan2(for_phase * imaginary, real)
    return for_sn * sn / denominator, for_cn * cn / denominator, for_dn * dn / denominator, phase
