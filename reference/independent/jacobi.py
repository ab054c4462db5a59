"""Jacobi's elliptic functions and the integral of the first kind by the arithmetic-geometric mean.

Both moduli enter through the complementary modulus k' alone, which may be arbitrarily small, or zero. The means are a_0 = 1,
b_0 = k', a_(n+1) = (a_n + b_n) / 2, b_(n+1) = sqrt(a_n b_n).
"""

import math
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.independent.arithmetic import Real, Wide, WideArray, wide
from bodycheck.reference.independent.border import MP

#: Relative difference of two means at which they are equal in the wide type after one more step, and in a hundred digits.
_EQUAL, _EXACTLY_EQUAL = MP.mpf(10) ** -18, MP.mpf(10) ** -60

#: Size of an argument below which its functions are taken as the functions of zero.
_SMALLEST_ARGUMENT = Wide(1e-60)


@dataclass(frozen=True, eq=False)
class Modulus:
    """A modulus of elliptic functions, by its arithmetic-geometric means.

    Attributes
    ----------
    means
        The pairs a_n, b_n until they are equal in the wide type; none for k' = 0.
    mean
        Their limit, which is zero for k' = 0.
    wide_means, wide_mean
        The same in the wide type.
    """

    means: tuple[tuple[Real, Real], ...]
    mean: Real
    wide_means: tuple[tuple[np.longdouble, np.longdouble], ...]
    wide_mean: np.longdouble

    @property
    def quarter(self) -> Real:
        """The quarter period K = pi / (2 mean); infinite for k' = 0."""
        return MP.pi / (2 * self.mean) if self.mean else MP.inf


def modulus(kc: Real) -> Modulus:
    """The modulus with the complementary modulus k' = kc in [0, 1]."""
    if not kc:
        return Modulus((), MP.zero, (), Wide(0))
    a, b = MP.one, kc
    means: list[tuple[Real, Real]] = []
    while a - b > _EXACTLY_EQUAL * a:
        if not means or means[-1][0] - means[-1][1] > _EQUAL * means[-1][0]:
            means.append((a, b))
        a, b = (a + b) / 2, MP.sqrt(a * b)
    return Modulus(tuple(means), a, tuple((wide(a), wide(b)) for a, b in means), wide(a))


def argument(modulus: Modulus, sn: Real, cn: Real) -> Real:
    """The argument u in [-K, K] from numbers proportional to sn u and cn u >= 0, by Landen's descending transformation.

    The amplitude phi is transformed by tan(phi_(n+1) - phi_n) = (b_n / a_n) tan(phi_n), and u = phi_N / (2^N mean) [DLMF
    19.8.12, 22.20.4]. The amplitude is kept as the direction of a complex number, and its whole turns are counted in double
    precision.
    """
    if not modulus.mean:
        return MP.asinh(sn / cn)
    x, y = cn, abs(sn)
    angle = _angle(x, y)
    for a, b in modulus.means:
        landed = b / a * y
        angle = 2 * angle + _angle(x, landed) - _angle(x, y)
        x, y = x * x - y * landed, x * (y + landed)
        size = MP.hypot(x, y)
        x, y = x / size, y / size
    last = MP.atan2(y, x)
    last += 2 * MP.pi * round((angle - float(last)) / (2 * math.pi))
    u = last / (2 ** len(modulus.means) * modulus.mean)
    return u if sn >= 0 else -u


def _angle(x: Real, y: Real) -> float:
    """The angle (rad) of a direction, in double precision."""
    largest = max(abs(x), abs(y))
    return math.atan2(float(y / largest), float(x / largest))


def functions(modulus: Modulus, u: WideArray) -> tuple[WideArray, WideArray, WideArray]:
    """sn u, cn u and dn u for arguments u (n,) in [-K, K], by Gauss's transformation (Bulirsch, Numer. Math. 7, 78, 1965)."""
    size: WideArray = np.maximum(np.abs(u), _SMALLEST_ARGUMENT)
    if not modulus.mean:
        decay = np.exp(-size)
        hyperbolic: WideArray = 2 * decay / (1 + decay * decay)
        return np.copysign(np.tanh(size), u), hyperbolic, hyperbolic
    angle = size * modulus.wide_mean
    # c is a_n cs u at the level n of the means; the last level has the trigonometric functions, and n = 0 the modulus itself.
    dn: WideArray = np.ones_like(angle)
    c: WideArray = modulus.wide_mean * np.cos(angle) / np.sin(angle)
    for a, b in reversed(modulus.wide_means):
        ratio = c * c / ((a + b) / 2)
        c, dn = c * dn, (b + ratio) / (a + ratio)
    sn: WideArray = Wide(1) / np.hypot(c, Wide(1))
    return np.copysign(sn, u), c * sn, dn
