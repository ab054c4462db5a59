"""Lagrange's top: a symmetric body on a ball joint, its centre of mass on the axis of symmetry, and the spherical pendulum.

With I1 and I3 the moments about the fixed point, mu = M g r, u = cos theta, and the angular momenta Lz about the vertical and
L3 about the axis of symmetry,

    (du/dt)^2 = (1 - u^2) 2 (E - mu u) / I1 - (Lz - L3 u)^2 / I1^2 = (2 mu / I1) (u - u1) (u - u2) (u - u3),
    u = u1 + (u2 - u1) sn^2(lambda t + tau0),    lambda^2 = mu (u3 - u1) / (2 I1),    k^2 = (u2 - u1) / (u3 - u1).

The attitude is represented by the Cayley-Klein parameters w + i z = cos(theta / 2) exp(i (phi + psi) / 2) and x + i y =
sin(theta / 2) exp(i (phi - psi) / 2), since the derivative of each of their phases has only one pole:

    d/dt (phi + psi) =  L3 (1/I3 - 1/I1) + (Lz + L3) / (I1 (1 + u)),
    d/dt (phi - psi) = -L3 (1/I3 - 1/I1) + (Lz - L3) / (I1 (1 - u)).

The integrals are of the third kind, by Carlson's R_J with positive terms only. A top that passes exactly through the vertical
has Lz = L3 or Lz = -L3; there the amplitude changes its sign and the phase has no pole.
"""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.exact.numbers import MP, Quaternion4, Real, Vector3, Wide, wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.exact.rotations import matrix
from bodycheck.reference.independent.jacobi import Modulus, argument, functions, modulus
from bodycheck.reference.mechanisms.forms.carlson import third_kind
from bodycheck.reference.mechanisms.forms.motion import WIDE_EPS
from bodycheck.reference.trajectory import Array

#: Size of a number, relative to the terms of which it is the sum, up to which it differs from zero only by rounding. If two
#: roots of the cubic are equal, they have only half of the hundred digits.
_ZERO = MP.mpf(10) ** -38

#: Bound of the error of the attitude, in roundings to the wide type, for each radian of the phases.
ROUNDINGS = 64 * WIDE_EPS

#: Relative error of the phase of the elliptic functions.
_PHASE = 4 * WIDE_EPS


@dataclass(frozen=True, eq=False)
class Top:
    """A top.

    Attributes
    ----------
    across, along
        I1 and I3: moments of inertia about the fixed point, across and along the axis of symmetry (kg m^2).
    weight
        mu = M g r (J) > 0.
    attitude
        Unit quaternion from the body's frame, whose z is the axis of symmetry towards the centre of mass, to the world.
    rates
        Angular velocity in the body's frame (rad/s).
    """

    across: Real
    along: Real
    weight: Real
    attitude: Quaternion4
    rates: Vector3


@dataclass(frozen=True, eq=False)
class Turned:
    """A rotation at n instants: quaternions (n, 4) to the world, body rates (n, 3), rad/s, and bounds (n,) of both errors."""

    attitude: WideArray
    rates: WideArray
    error: Array
    rates_error: Array


@dataclass(frozen=True, eq=False)
class _Nutation:
    """The motion of u = cos theta: see the docstring of the module.

    Attributes
    ----------
    low, high
        1 + u1 and 1 - u2, which are exactly zero for a top that passes through the vertical.
    width
        u2 - u1, which is zero for a steady precession.
    rate, start
        lambda and tau0.
    elliptic, square
        The modulus k, and k^2.
    """

    low: Real
    high: Real
    width: Real
    rate: Real
    start: Real
    elliptic: Modulus
    square: Real


@dataclass(frozen=True, eq=False)
class _Constants:
    """Constants of the motion: (Lz + L3) / I1, (Lz - L3) / I1, L3 / I3, L3 (1/I3 - 1/I1), and the initial cos theta."""

    sum: Real
    difference: Real
    spin: Real
    drift: Real
    cosine: Real


def follow(top: Top, times: Array) -> Turned:
    """The rotation at times (n,), s, in any order."""
    conserved = _constants(top)
    path = _nutation(top, conserved)
    t = times.astype(Wide)
    if path.width:
        reduced, count, tau = _phase(path, t)
        sn, cn, dn = functions(path.elliptic, reduced)
        parity = 1 - 2 * (count % 2)
        sn, cn = parity * sn, parity * cn
    else:
        count, reduced, tau = np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)
        sn, cn, dn = np.zeros_like(t), np.ones_like(t), np.ones_like(t)
    low, high, width = wide(path.low), wide(path.high), wide(path.width)
    root = np.sqrt(width / 2)
    cosine = np.sqrt((low + width * sn * sn) / 2) if path.low else root * sn
    sine = np.sqrt((high + width * cn * cn) / 2) if path.high else root * cn
    first, second = _phases(top, conserved, path, t, reduced, count)
    # The quotients cn / sine and sn / cosine have finite limits.
    over_sine = cn / sine if path.high else np.full_like(t, 1 / root if path.width else Wide(0))
    over_cosine = sn / cosine if path.low else np.full_like(t, 1 / root if path.width else Wide(0))
    nodding = -width * wide(path.rate) * dn * over_sine * over_cosine
    swaying = np.zeros_like(t)
    if conserved.sum:
        swaying = swaying + wide(conserved.sum) * sine / cosine / 2
    if conserved.difference:
        swaying = swaying + wide(conserved.difference) * cosine / sine / 2
    psi = first - second
    rates = np.stack(
        [
            swaying * np.sin(psi) + nodding * np.cos(psi),
            swaying * np.cos(psi) - nodding * np.sin(psi),
            np.full_like(t, wide(conserved.spin)),
        ],
        axis=1,
    )
    attitude = np.stack([cosine * np.cos(first), sine * np.cos(second), sine * np.sin(second), cosine * np.sin(first)], axis=1)
    return _bounded(top, conserved, path, attitude, rates, np.abs(first) + np.abs(second), tau)


def _bounded(
    top: Top, conserved: _Constants, path: _Nutation, attitude: WideArray, rates: WideArray, turned: WideArray, tau: WideArray
) -> Turned:
    """The rotation with bounds of its errors, from roundings of the phases and the motion during an error of the time."""
    speed = np.sqrt((rates * rates).sum(axis=1))
    late = _PHASE * (np.abs(tau) + abs(wide(path.start)) + 1) / (wide(path.rate) if path.rate else Wide(1))
    error = ROUNDINGS * (1 + turned) + late * speed
    # The body rates change by their rotation with psi and by gravity.
    pull = wide((top.weight + abs(conserved.spin) ** 2 * top.along) / top.across)
    rates_error = speed * error + late * (pull + speed * abs(wide(conserved.spin)))
    return Turned(attitude, rates, error.astype(float), rates_error.astype(float))


def _constants(top: Top) -> _Constants:
    """The constants of the motion. Sums that differ from zero only by rounding are exactly zero."""
    p, q, r = top.rates
    upright = matrix(top.attitude)[2]
    terms = (upright[0] * top.across * p, upright[1] * top.across * q, upright[2] * top.along * r)
    vertical, axial = sum(terms), top.along * r
    size = sum(abs(term) for term in terms) + abs(axial)
    both, difference = (value if abs(value) > _ZERO * size else MP.mpf(0) for value in (vertical + axial, vertical - axial))
    return _Constants(both / top.across, difference / top.across, r, r - axial / top.across, upright[2])


def _nutation(top: Top, conserved: _Constants) -> _Nutation:
    """The path of u, from the roots of the cubic."""
    p, q, _ = top.rates
    upright = matrix(top.attitude)[2]
    u0, speed = conserved.cosine, upright[0] * q - upright[1] * p
    drop = 2 * top.weight / top.across
    energy = p * p + q * q + drop * u0
    vertical, axial = (conserved.sum + conserved.difference) / 2, (conserved.sum - conserved.difference) / 2
    # f(u) = drop u^3 - (energy + axial^2) u^2 + (2 vertical axial - drop) u + energy - vertical^2.
    b, c, d = -(energy + axial**2) / drop, 2 * vertical * axial / drop - 1, (energy - vertical**2) / drop
    steep = drop * (3 * u0 * u0 + 2 * b * u0 + c)
    if abs(speed) <= _ZERO * MP.sqrt(drop) and abs(steep) <= _ZERO * drop * (1 + abs(b)):
        return _Nutation(1 + u0, 1 - u0, MP.mpf(0), MP.mpf(0), MP.mpf(0), modulus(MP.one), MP.mpf(0))
    u1, u2, u3 = _roots(b, c, d)
    low = 1 + u1 if conserved.sum else MP.mpf(0)
    high = 1 - u2 if conserved.difference or 1 - u2 > _ZERO else MP.mpf(0)
    width = 2 - low - high
    above = u3 - 1 + high
    elliptic = modulus(MP.sqrt(above / (above + width)) if above > _ZERO * width else MP.zero)
    rate = MP.sqrt(top.weight * (above + width) / (2 * top.across))
    sn, cn = (MP.sqrt(max(value, MP.mpf(0)) / width) for value in (1 + u0 - low, 1 - u0 - high))
    start = argument(elliptic, -sn if speed < 0 else sn, cn)
    return _Nutation(low, high, width, rate, start, elliptic, width / (above + width))


def _roots(b: Real, c: Real, d: Real) -> tuple[Real, Real, Real]:
    """The three real roots of u^3 + b u^2 + c u + d, in ascending order."""
    p, q = c - b * b / 3, 2 * b**3 / 27 - b * c / 3 + d
    size = MP.sqrt(max(-p / 3, MP.mpf(0)))
    ratio = -q / (2 * size**3) if size else MP.mpf(0)
    angle = MP.acos(min(max(ratio, MP.mpf(-1)), MP.mpf(1))) / 3
    u1, u2, u3 = sorted(2 * size * MP.cos(angle - 2 * MP.pi * turn / 3) - b / 3 for turn in range(3))
    return u1, u2, u3


def _phase(path: _Nutation, t: WideArray) -> tuple[WideArray, WideArray, WideArray]:
    """The argument reduced to [-K, K], the number of half periods 2 K, and the argument itself."""
    tau = wide(path.start) + wide(path.rate) * t
    if not path.elliptic.mean:
        return tau, np.zeros_like(tau), tau
    period = wide(2 * path.elliptic.quarter)
    count = np.rint(tau / period)
    return tau - count * period, count, tau


def _phases(
    top: Top, conserved: _Constants, path: _Nutation, t: WideArray, reduced: WideArray, count: WideArray
) -> tuple[WideArray, WideArray]:
    """The phases (phi + psi) / 2 and (phi - psi) / 2 of the Cayley-Klein parameters (rad)."""
    begin_first, begin_second = _first_phases(top, path)
    first, second = wide(conserved.drift / 2) * t + wide(begin_first), wide(begin_second) - wide(conserved.drift / 2) * t
    if not path.width:
        first = first + (wide(conserved.sum / path.low / 2) if conserved.sum else 0) * t
        second = second + (wide(conserved.difference / path.high / 2) if conserved.difference else 0) * t
        return first, second
    for factor, smallest, rising in ((conserved.sum, path.low, True), (conserved.difference, 2 - path.low, False)):
        if not factor:
            continue
        begin = _one(_integral(path, np.array([wide(path.start)], dtype=Wide), smallest, rising=rising))
        turned = _integral(path, reduced, smallest, rising=rising)
        if path.elliptic.mean:
            quarter = np.array([wide(path.elliptic.quarter)], dtype=Wide)
            turned = turned + 2 * count * _one(_integral(path, quarter, smallest, rising=rising))
        grown = wide(factor / (2 * path.rate)) * (turned - begin)
        first, second = (first + grown, second) if rising else (first, second + grown)
    return first, second


def _one(values: WideArray) -> np.longdouble:
    return Wide(values[0])


def _integral(path: _Nutation, tau: WideArray, at_zero: Real, *, rising: bool) -> WideArray:
    """The integral from 0 to tau in [-K, K] of 1 / (1 + u) if `rising`, else of 1 / (1 - u). at_zero: 1 + u1 or 1 - u1."""
    sn, cn, dn = functions(path.elliptic, tau)
    x, y, one = cn * cn, dn * dn, np.ones_like(sn)
    begin, width, square = wide(at_zero), wide(path.width), sn * sn
    if not rising:
        p = (wide(path.high) + width * x) / begin
        return (tau + width / begin / 3 * sn * square * third_kind(x, y, one, p)) / begin
    ratio, k2 = path.width / at_zero, path.square
    if ratio * ratio < k2:
        return (tau - width / begin / 3 * sn * square * third_kind(x, y, one, 1 + wide(ratio) * square)) / begin
    # With the other parameter q of the integral, (p - 1) (q - 1) = k^2 sn^4 [DLMF 19.21.12], all terms are positive.
    small = wide(k2 / ratio)
    root = wide(MP.sqrt((1 + ratio) * (ratio + k2) / ratio))
    rest = small / 3 * sn * square * third_kind(x, y, one, 1 + small * square)
    value: WideArray = (np.arctan2(sn * root, cn * dn) / root + rest) / begin
    return value


def _first_phases(top: Top, path: _Nutation) -> tuple[Real, Real]:
    """The initial phases (rad), from the attitude, or from the derivative of a parameter that is zero at the start."""
    w, x, y, z = top.attitude
    p, q, r = top.rates
    first, second = MP.atan2(z, w), MP.atan2(y, x)
    if not path.width:
        return first, second
    if not path.low:
        # cos(theta / 2) is proportional to sn, which has the sign of tau, and grows from zero.
        sign = -1 if path.start < 0 else 1
        if abs(w) + abs(z) > _ZERO:
            first = MP.atan2(sign * z, sign * w)
        else:
            first = MP.atan2(x * q - y * p + w * r, -(x * p + y * q + z * r))
    if not path.high and abs(x) + abs(y) <= _ZERO:
        # sin(theta / 2) is proportional to cn >= 0, which falls to zero at tau = K and grows from zero at -K.
        sign = -1 if path.start > 0 else 1
        second = MP.atan2(sign * (w * q + z * p - x * r), sign * (w * p + y * r - z * q))
    return first, second
