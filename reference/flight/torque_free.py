"""Rotation of a rigid body without torque, in closed form, for any principal moments.

The angular velocity in the body frame is given by Jacobi's elliptic functions, and the attitude by the phase of an integral of
the third kind. This is the classical solution (Jacobi 1850; Landau and Lifshitz, Mechanics, par. 37; van Zon and Schofield,
J. Comput. Phys. 225, 145, 2007), arranged so that no digits cancel. With moments I1 <= I2 <= I3 all constants follow from

    E1 = L^2 - 2 T I1 = I2 (I2 - I1) w2^2 + I3 (I3 - I1) w3^2,
    E2 = L^2 - 2 T I2 = I3 (I3 - I2) w3^2 - I1 (I2 - I1) w1^2,
    E3 = 2 T I3 - L^2 = I1 (I3 - I1) w1^2 + I2 (I3 - I2) w2^2.

Only E2 is a difference. Its sign tells which axis p the angular momentum encircles in the body frame, that of the largest (+)
or of the smallest moment (-); r is the other one. On the separatrix E2 is zero, and near it all of its digits would be lost,
so E2 is computed with a hundred digits. With u = u0 + lambda t,

    Lp = Mp dn u,  Mp^2 = Ip Er / (I3 - I1),        lambda^2 = |Ip - I2| Er / (I1 I2 I3),
    L2 = M2 sn u,  M2^2 = I2 Ep / |Ip - I2|,        k^2  = |I2 - Ir| Ep / (|Ip - I2| Er),
    Lr = Mr cn u,  Mr^2 = Ir Ep / (I3 - I1),        k'^2 = (I3 - I1) |E2| / (|Ip - I2| Er).

The attitude is given by Euler angles about the fixed L, with one of the extreme axes, f, as the figure axis K and the other,
g, as J: L = |L| (sin theta sin psi, sin theta cos psi, cos theta) along (2, g, f), so that

    dphi/dt = |L| (L2^2/I2 + Lg^2/Ig) / (L2^2 + Lg^2) = |L|/Ig + |L| (1/I2 - 1/Ig) (M2/Mg)^2 sn^2 u / (1 + nu sn^2 u),

whose integral is a mean precession and the phase of Jacobi's Theta(u + i eta), nu = k^2 sc^2(eta, k'). f is the axis for
which nu <= 1, that is, the one closer to being an axis of symmetry. About the other axis phi would advance much faster than
the motion itself.
"""

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bodycheck.reference.exact.numbers import MP, NEGLIGIBLE, Real, Vector3, Wide, doubles, real, wide
from bodycheck.reference.exact.start import Start
from bodycheck.reference.flight.elliptic import (
    PI,
    ThetaSeries,
    WideArray,
    complete,
    first_kind,
    jacobi,
    quarter_period,
    theta_series,
)
from bodycheck.reference.flight.turning import Turning
from bodycheck.reference.kinematics import conjugate, normalise
from bodycheck.reference.trajectory import Array


@dataclass(frozen=True)
class Polhode:
    """The motion of the angular momentum in the body frame, with the symbols of the module.

    Attributes
    ----------
    order
        Indices, among I, J, K, of the axes 1, 2, 3.
    handedness
        +1 if that order is right-handed, -1 if it is left-handed.
    p
        Index of the axis p in that order, 0 or 2.
    unit
        The unit of angular velocity (rad/s), a power of two, whose inverse is the unit of time. The unit of the moments is
        another power of two, which has no effect.
    moments
        I1, I2, I3.
    gaps
        I2 - I1 and I3 - I2.
    e
        E1, E2, E3.
    momentum
        |L|.
    size
        M1, M2, M3.
    sign
        Signs of L1, L2, L3 where sn u and cn u are positive.
    rate
        lambda.
    start
        u0, in [-K, K].
    k, kc
        The moduli k and k'.
    quarter
        K.
    """

    order: tuple[int, int, int]
    handedness: int
    p: int
    unit: Wide
    moments: tuple[Wide, Wide, Wide]
    gaps: tuple[Wide, Wide]
    e: tuple[Wide, Wide, Wide]
    momentum: Wide
    size: tuple[Wide, Wide, Wide]
    sign: tuple[float, float, float]
    rate: Wide
    start: Wide
    k: Wide
    kc: Wide
    quarter: Wide


@dataclass(frozen=True, eq=False)
class Precession:
    """The rotation about the angular momentum.

    Attributes
    ----------
    f, g
        Indices, in the order 1, 2, 3, of the axes that take the roles of K and J: 0 and 2, or 2 and 0.
    rate
        Mean of dphi/dt, in the unit of the polhode.
    sense
        Sign with which the phase of Theta enters phi.
    series
        Series of Theta and of the elliptic functions of the polhode.
    """

    f: int
    g: int
    rate: Wide
    sense: float
    series: ThetaSeries


def polhode(moments: Sequence[Any], rates: Sequence[Any]) -> Polhode | None:
    """The polhode for principal moments (kg m^2) and an angular velocity along the principal axes (rad/s).

    The numbers are of any type and are meant exactly: E1, E2, E3 and the differences of moments are computed with a hundred
    digits and rounded once. None for a steady spin.
    """
    order = sorted(range(3), key=moments.__getitem__)
    i, _ = scaled([real(moments[axis]) for axis in order])
    w, unit = scaled([real(rates[axis]) for axis in order])
    exact_gaps = i[1] - i[0], i[2] - i[1], i[2] - i[0]
    axial, transverse = i[2] * exact_gaps[1] * w[2] ** 2, i[0] * exact_gaps[0] * w[0] ** 2
    difference = axial - transverse
    if abs(difference) <= NEGLIGIBLE * (axial + transverse):
        difference = real(0)
    middle_part = i[1] * w[1] ** 2
    e1 = wide(middle_part * exact_gaps[0] + i[2] * exact_gaps[2] * w[2] ** 2)
    e3 = wide(i[0] * exact_gaps[2] * w[0] ** 2 + middle_part * exact_gaps[1])
    e = (e1, wide(difference), e3)
    p = 2 if e[1] >= 0 else 0
    r = 2 - p
    i1, i2, i3 = (wide(moment) for moment in i)
    low, high, span = (wide(gap) for gap in exact_gaps)
    apart, other = (high, low) if p == 2 else (low, high)
    if not apart * e[r] * e[p] > 0:
        return None
    wide_moments, wide_rates = (i1, i2, i3), tuple(wide(rate) for rate in w)
    size = [np.sqrt(i2 * e[p] / apart)] * 3
    size[p], size[r] = np.sqrt(wide_moments[p] * e[r] / span), np.sqrt(wide_moments[r] * e[p] / span)
    sn, cn, dn = (abs(wide_moments[axis] * wide_rates[axis]) / size[axis] for axis in (1, r, p))
    if not cn * cn + dn * dn > 0:
        return None
    handedness = 1 if order in ([0, 1, 2], [1, 2, 0], [2, 0, 1]) else -1
    first, last = math.copysign(1, wide_rates[0]), math.copysign(1, wide_rates[2])
    # dL2/dt = (1/I1 - 1/I3) L3 L1 for a right-handed order of the axes 1, 2, 3, and the negative of it for a left-handed one.
    middle = handedness * first * last
    scale = apart * e[r]
    kc = np.sqrt(span * abs(e[1]) / scale)
    return Polhode(
        order=(order[0], order[1], order[2]),
        handedness=handedness,
        p=p,
        unit=unit,
        moments=wide_moments,
        gaps=(low, high),
        e=e,
        momentum=np.sqrt(sum((moment * rate) ** 2 for moment, rate in zip(wide_moments, wide_rates, strict=True))),
        size=(size[0], size[1], size[2]),
        sign=(first, middle, last),
        rate=np.sqrt(scale / (i1 * i2 * i3)),
        start=first_kind(math.copysign(1, middle * wide_rates[1]) * sn, cn, dn),
        k=np.sqrt(other * e[p] / scale),
        kc=kc,
        quarter=quarter_period(kc),
    )


@functools.lru_cache(maxsize=64)
def polhode_of(start: Start) -> Polhode | None:
    """The polhode of a start, or None for a steady spin."""
    return polhode(start.moments, start.rates)


def scaled(values: list[Real]) -> tuple[list[Real], Wide]:
    """Numbers in the unit of a power of two, in which the largest is between 1/2 and 1, and this unit."""
    _, exponent = MP.frexp(max(abs(value) for value in values))
    return [MP.ldexp(value, -exponent) for value in values], Wide(np.ldexp(Wide(1), exponent))


@functools.lru_cache(maxsize=64)
def precession(motion: Polhode) -> Precession:
    """The rotation about the angular momentum for a polhode."""
    i, e, size, (low, high) = motion.moments, motion.e, motion.size, motion.gaps
    f = 2 if i[2] * low <= i[0] * high else 0
    g = 2 - f
    # Ig - I2, with its sign, and |I2 - If|.
    gap_g, gap_f = (-low, high) if g == 0 else (high, low)
    around_g, around_f = e[g] / e[f], abs(gap_g) / gap_f
    nu = i[f] / i[g] * (around_g if g == motion.p else around_f)
    k2 = motion.k**2
    eta = first_kind(*(np.sqrt(part / (nu + k2)) for part in (nu, k2, k2 * (1 + nu)))) if nu > 0 else Wide(0)
    mean = complete(motion.kc, 1 + nu, Wide(0), Wide(1)) / motion.quarter if motion.kc > 0 else 1 / (1 + nu)
    excess = motion.momentum * gap_g / (i[1] * i[g]) * (size[1] / size[g]) ** 2
    return Precession(
        f=f,
        g=g,
        rate=motion.momentum / i[g] + excess * mean,
        sense=float(-np.sign(excess)),
        series=theta_series(motion.k, motion.kc, motion.quarter, eta),
    )


def half_period(motion: Polhode) -> Wide:
    """The time (s) after which L2 and Lr have changed sign and Lp has the same value: 2 K / lambda."""
    return 2 * motion.quarter / motion.rate / motion.unit


def remainder(value: WideArray, period: Wide) -> tuple[Array, Array]:
    """Values (n,) minus the nearest whole number of periods, and these whole numbers (n,), both in double precision."""
    count = np.rint(value.astype(float) * float(1 / period))
    return (value - period * count.astype(Wide)).astype(float), count


def left_factor(q: Array) -> Array:
    """The matrix (4, 4) that multiplies a quaternion (4,) from the left by the quaternion q (4,)."""
    w, x, y, z = q
    return np.array([[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]])


def rotation(start: Start, times: Array) -> Turning:
    """The rotation of a body without torque from its start, at times (n,) in any order, s."""
    t = np.concatenate(([0.0], times))
    motion = polhode_of(start)
    turning = steady_spin(start.rates, t) if motion is None else tumbling(motion, t)
    # The rotation of the closed form begins anywhere; it is placed so that it begins with the attitude of the start.
    first = left_factor(normalise(np.array(doubles(start.attitude)))) @ left_factor(conjugate(turning.attitude[0]))
    return replace(turning, attitude=turning.attitude[1:] @ first.T, angular_velocity=turning.angular_velocity[1:])


def steady_spin(rates: Vector3, t: Array) -> Turning:
    """A steady spin with the angular velocity `rates` (rad/s) at times t (n,), s, from any attitude."""
    speed = MP.sqrt(sum(rate * rate for rate in rates))
    turn, _ = remainder(wide(speed) * t.astype(Wide), 4 * PI)
    axis = np.array([float(rate / speed) for rate in rates])
    attitude = np.column_stack([np.cos(turn / 2), np.outer(np.sin(turn / 2), axis)])
    constant = np.array(doubles(rates))
    return Turning(attitude, np.tile(constant, (len(t), 1)), np.abs(constant), 0.0, float(speed))


def tumbling(motion: Polhode, t: Array) -> Turning:
    """The rotation of a body on a polhode at times t (n,), s, from any attitude."""
    turn = precession(motion)
    elapsed = t.astype(Wide) * motion.unit
    u, half_periods = remainder(motion.start + motion.rate * elapsed, 2 * motion.quarter)
    secular, _ = remainder(turn.rate * elapsed, 2 * PI)
    sn, cn, dn, phase = jacobi(turn.series, u)
    parity = 1 - 2 * (half_periods - 2 * np.floor(half_periods / 2))
    elliptic = [parity * sn] * 3
    elliptic[motion.p], elliptic[2 - motion.p] = dn, parity * cn

    axes = (1, turn.g, turn.f)
    # Angular momentum is an axial vector: its components along a left-handed order of axes have the opposite sign.
    handedness = motion.handedness if turn.g == 2 else -motion.handedness
    middle, g, f = (handedness * float(motion.sign[n] * motion.size[n] / motion.momentum) * elliptic[n] for n in axes)
    # psi is computed from the ratio of the amplitudes, which is accurate even where both are below the smallest normal number.
    slope = handedness * motion.sign[1] * float(motion.size[1] / motion.size[turn.g])
    psi = np.arctan2(slope * elliptic[1], handedness * motion.sign[turn.g] * elliptic[turn.g])
    phi = secular + turn.sense * phase
    across, along = np.hypot(middle, g), 1 + np.abs(f)
    # tan(theta/2) has two forms; this is the one without cancellation for the sign of cos(theta).
    half_sine, half_cosine = np.where(f > 0, (across, along), (along, across)) / np.hypot(across, along)
    half_sum, half_difference = (phi + psi) / 2, (phi - psi) / 2
    vector = (half_sine * np.cos(half_difference), half_sine * np.sin(half_difference), half_cosine * np.sin(half_sum))

    attitude, body_rates, amplitude = np.empty((len(t), 4)), np.empty((len(t), 3)), np.empty(3)
    attitude[:, 0] = half_cosine * np.cos(half_sum)
    for n, part, momentum in zip(axes, vector, (middle, g, f), strict=True):
        axis = motion.order[n]
        attitude[:, 1 + axis] = handedness * part
        body_rates[:, axis] = handedness * float(motion.unit * motion.momentum / motion.moments[n]) * momentum
        amplitude[axis] = float(motion.unit * motion.size[n] / motion.moments[n])
    angle_rate = float(motion.unit * (motion.rate + abs(turn.rate)))
    return Turning(attitude, body_rates, amplitude, abs(float(motion.start)), angle_rate)
