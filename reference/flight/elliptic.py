"""Jacobi's elliptic functions, and the phase of the integral of the third kind, by theta series of a few terms.

The series converge quickly for every modulus. Functions take both moduli, k and k' (k^2 + k'^2 = 1), so that no digits are lost
at either end: for small oscillations (k near 0) and at the separatrix (k' near 0). Constants are computed in the widest
floating-point type of the machine, so that thousands of periods can be subtracted from an argument without loss of digits;
arrays are in double precision. Equations are cited from the NIST Digital Library of Mathematical Functions [DLMF].

Functions take numbers, or arrays (m,) with one number for each of m members. The value of a member does not depend on the other
members: every operation acts on each element separately, and iterations end separately for each member.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.trajectory import Array

#: An array of the wide type.
WideArray = NDArray[np.longdouble]

#: A number of the wide type, or an array (m,) of them, one for each member.
Wides = Any

#: The number pi in the wide type.
PI = 4 * np.arctan(Wide(1))

#: Value used for the quarter period of modulus 1. It is finite, so that the separatrix needs no special case.
SEPARATRIX_QUARTER_PERIOD = np.finfo(Wide).max ** Wide(0.75)

#: Argument x at which sech(x) is negligible in double precision and cosh(6 x) does not yet overflow.
LARGEST_SECH_ARGUMENT = 100.0

#: The signs (-1)^n of the terms of a theta series, n = 0 to 3.
ALTERNATING_SIGNS = np.array([1.0, -1.0, 1.0, -1.0])


def complete(kc: Wides, p: Wides, a: Wides, b: Wides) -> Wides:
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
    number or array (m,)
        The integral.
    """

    def advance(a: Wides, b: Wides, root: Wides, mean: Wides, kc: Wides, product: Wides) -> tuple[Wides, ...]:
        a, b, root, mean = a + b / root, 2 * (b + a * product / root), root + product / root, mean + kc
        kc = 2 * np.sqrt(product)
        return a, b, root, mean, kc, kc * mean

    def converged(_a: Wides, _b: Wides, _root: Wides, mean: Wides, kc: Wides, _product: Wides) -> Any:
        return abs(mean - kc) <= 1e-10 * mean

    root = np.sqrt(p)
    a, b, root, mean, kc, product = _each_until(converged, advance, (a, b / root, root, Wide(1), kc, kc))
    a, b, root, mean = a + b / root, 2 * (b + a * product / root), root + product / root, mean + kc
    return PI / 2 * (b + a * mean) / (mean * (mean + root))


def quarter_period(kc: Wides) -> Wides:
    """The quarter period K for the complementary modulus kc >= 0.

    For kc = 0 it is a very large number; an array kc must not contain zeros.
    """
    return complete(kc, Wide(1), Wide(1), Wide(1)) if np.all(kc > 0) else SEPARATRIX_QUARTER_PERIOD


def first_kind(sn: Wides, cn: Wides, dn: Wides) -> Wides:
    """The inverse of the elliptic functions: u = sn R_F(cn^2, dn^2, 1) [DLMF 19.25.5].

    R_F is computed by duplication [DLMF 19.26.18] and its series to the seventh order [DLMF 19.36.1].

    Parameters
    ----------
    sn, cn, dn
        Values of the functions at u; the sign of cn has no effect. cn and dn must not both be zero.

    Returns
    -------
    number or array (m,)
        The argument u in [-K, K].
    """

    def advance(x: Wides, y: Wides, z: Wides) -> tuple[Wides, ...]:
        rx, ry, rz = np.sqrt(x), np.sqrt(y), np.sqrt(z)
        shift = rx * ry + rx * rz + ry * rz
        return (x + shift) / 4, (y + shift) / 4, (z + shift) / 4

    def converged(x: Wides, y: Wides, z: Wides) -> Any:
        mean = (x + y + z) / 3
        return abs(x - mean) + abs(y - mean) + abs(z - mean) < 4e-3 * mean

    x, y, z = _each_until(converged, advance, (cn * cn, dn * dn, Wide(1)))
    mean = (x + y + z) / 3
    dx, dy = 1 - x / mean, 1 - y / mean
    dz = -dx - dy
    e2, e3 = dx * dy - dz * dz, dx * dy * dz
    second = e2 * (-1 / Wide(10) + e2 * (1 / Wide(24) - e2 * 5 / 208))
    third = e3 * (1 / Wide(14) + e2 * (-3 / Wide(44) + e2 / 16) + e3 * 3 / 104)
    return sn * (1 + second + third) / np.sqrt(mean)


def _each_until(
    converged: Callable[..., Any], advance: Callable[..., tuple[Wides, ...]], state: tuple[Wides, ...]
) -> tuple[Wides, ...]:
    """Return the converged state of an iteration; each member is advanced only until it has converged."""
    done = converged(*state)
    if not np.ndim(done):
        while not done:
            state = advance(*state)
            done = converged(*state)
        return state
    parts = last = tuple(np.empty(done.shape, dtype=Wide) for _ in state)
    for whole, part in zip(last, state, strict=True):
        whole[...] = part
    left = np.arange(done.size)
    while True:
        left, parts = left[~done], tuple(part[~done] for part in parts)
        if not len(left):
            return last
        parts = advance(*parts)
        for whole, part in zip(last, parts, strict=True):
            whole[left] = part
        done = converged(*parts)


@dataclass(frozen=True, eq=False)
class ThetaSeries:
    """Six theta series in the terms 1, c1, c2, c3 for u in [-K, K].

    The terms are c_n = cos(2 n z), or cosh(2 n z) in the hyperbolic case, with z = scale u. With m members, each has separate
    series, all in the same case.

    Attributes
    ----------
    rows
        (6, 4) or (m, 6, 4) coefficients of the numerators of sn, cn and dn, of their common denominator, and of the real and
        imaginary parts of Theta(u + i eta). Each series is divided by its leading function; `jacobi` multiplies by it.
    hyperbolic
        Whether the terms are hyperbolic.
    scale
        The factor z / u.
    slope
        The part of the phase of Theta(u + i eta) that is proportional to u, per unit of u (rad).
    """

    rows: Array
    hyperbolic: bool
    scale: Any
    slope: Any


def theta_series(k: Wides, kc: Wides, quarter: Wides, eta: Wides, hyperbolic: bool) -> ThetaSeries:
    """The theta series for one modulus, or for the moduli of m members.

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
    hyperbolic
        Whether k > k', for which the terms are hyperbolic. If k and k' are equal up to rounding, either choice is right.

    Returns
    -------
    ThetaSeries
        The series.
    """
    other = quarter_period(k)
    period, conjugate = (other, quarter) if hyperbolic else (quarter, other)
    n = np.arange(4, dtype=Wide)
    log_nome = np.asarray(np.maximum(-PI * conjugate / period, Wide(-1e4)))[..., None]
    shift = np.asarray(PI / 2 * eta / period)[..., None]
    integer = np.exp((n * n * log_nome).astype(float)) * 2
    integer[..., 0] = 1
    half = np.exp((n * (n + 1) * log_nome).astype(float))

    theta1, theta3 = _over_sine(ALTERNATING_SIGNS * half), integer
    theta2, theta4 = ALTERNATING_SIGNS * theta1, ALTERNATING_SIGNS * integer
    if hyperbolic:
        denominator, numerators = theta2, [theta1, theta4, theta3]
        turns = ((2 * n + 1) * shift).astype(float)
        real, imaginary = _over_cosine(half * np.cos(turns)), _over_sine(half * np.sin(turns))
    else:
        denominator, numerators = theta4, [theta1, theta2, theta3]
        growing = np.exp((n * n * log_nome + 2 * n * shift).astype(float))
        fading = np.exp((n * n * log_nome - 2 * n * shift).astype(float))
        real = ALTERNATING_SIGNS * (growing + fading)
        real[..., 0] = 1
        s = growing - fading
        imaginary = np.zeros_like(s)
        imaginary[..., 0] = s[..., 1] + s[..., 3]
        imaginary[..., 1], imaginary[..., 2] = -2 * s[..., 2], 2 * s[..., 3]
    rows = np.empty((*half.shape[:-1], 6, 4))
    for index, row in enumerate((*numerators, denominator, real, imaginary)):
        rows[..., index, :] = row
    # Each numerator is scaled so that its function has the right value, or sn the right derivative, at u = 0.
    at_zero = rows[..., 0] + (rows[..., 1] + (rows[..., 2] + rows[..., 3]))
    rows[..., :3, :] *= (at_zero[..., 3, None] / at_zero[..., :3])[..., None]
    rows[..., 0, :] *= np.asarray(2 * period / PI).astype(float)[..., None]
    scale, slope = (PI / 2 / period).astype(float), (-shift[..., 0] / quarter).astype(float)
    return ThetaSeries(rows, hyperbolic, scale, slope if hyperbolic else np.zeros_like(slope))


def _over_sine(h: Array) -> Array:
    """Coefficients (..., 4) of sum over n of h_n sin((2n + 1) v) / sin(v) in terms of 1, cos(2v), cos(4v), cos(6v)."""
    quotient = np.array(h)
    for n in (2, 1, 0):
        quotient[..., n] += quotient[..., n + 1]
    quotient[..., 1:] *= 2
    return quotient


def _over_cosine(h: Array) -> Array:
    """Coefficients (..., 4) of sum over n of h_n cos((2n + 1) v) / cos(v) in the terms of `_over_sine`.

    They follow from `_over_sine` at v + pi/2.
    """
    return ALTERNATING_SIGNS * _over_sine(ALTERNATING_SIGNS * h)


def jacobi(series: ThetaSeries, u: Array) -> tuple[Array, Array, Array, Array]:
    """sn u, cn u, dn u and the phase (rad) of Theta(u + i eta), each (..., n), for arguments u (..., n) in [-K, K].

    With the series of m members, the arguments are (m, n).
    """
    z = np.asarray(series.scale)[..., None] * u
    if series.hyperbolic:
        z = np.clip(z, -LARGEST_SECH_ARGUMENT, LARGEST_SECH_ARGUMENT)
        for_sn, for_cn = np.tanh(z), 1 / np.cosh(z)
        for_dn, for_phase = for_cn, for_sn
        c1 = np.cosh(2 * z)
    else:
        for_sn, for_cn = np.sin(z), np.cos(z)
        for_dn, for_phase = np.ones_like(z), 2 * for_sn * for_cn
        c1 = 1 - 2 * for_sn * for_sn
    c2 = 2 * c1 * c1 - 1
    c3 = (2 * c2 - 1) * c1
    first, second, third, last = (series.rows[..., n, None] for n in range(4))
    sums = first + (second * c1[..., None, :] + (third * c2[..., None, :] + last * c3[..., None, :]))
    sn, cn, dn, denominator, real, imaginary = (sums[..., row, :] for row in range(6))
    phase = np.asarray(series.slope)[..., None] * u + np.arctan2(for_phase * imaginary, real)
    return for_sn * sn / denominator, for_cn * cn / denominator, for_dn * dn / denominator, phase
