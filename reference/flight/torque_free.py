"""Rotation of a rigid body without torque, in closed form, for any principal moments.

The angular velocity in the body frame is given by Jacobi's elliptic functions, and the attitude by the phase of an integral of
the third kind. This is the classical solution (Jacobi 1850; Landau and Lifshitz, Mechanics, par. 37; van Zon and Schofield,
J. Comput. Phys. 225, 145, 2007), arranged so that no digits cancel. With moments I1 <= I2 <= I3 all constants follow from

    E1 = L^2 - 2 T I1 = I2 (I2 - I1) w2^2 + I3 (I3 - I1) w3^2,
    E2 = L^2 - 2 T I2 = I3 (I3 - I2) w3^2 - I1 (I2 - I1) w1^2,
    E3 = 2 T I3 - L^2 = I1 (I3 - I1) w1^2 + I2 (I3 - I2) w2^2.

Only E2 is a difference. Its sign tells which axis p the angular momentum encircles in the body frame, that of the largest (+)
or of the smallest moment (-); r is the other one. On the separatrix E2 is zero, and near it all of its digits would be lost,
so E2 is computed in rational arithmetic. With u = u0 + lambda t,

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

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from bodycheck.reference.flight.elliptic import (
    PI,
    ThetaSeries,
    Wide,
    WideArray,
    complete,
    first_kind,
    jacobi,
    quarter_period,
    theta_series,
)
from bodycheck.reference.kinematics import conjugate, normalise
from bodycheck.reference.scene import Quaternion, Vector
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
    moments
        I1, I2, I3 (kg m^2).
    e
        E1, E2, E3 (kg^2 m^4/s^2).
    momentum
        |L| (kg m^2/s).
    size
        M1, M2, M3 (kg m^2/s).
    sign
        Signs of L1, L2, L3 where sn u and cn u are positive.
    rate
        lambda (rad/s).
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
    moments: tuple[Wide, Wide, Wide]
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
        Mean of dphi/dt (rad/s).
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


def nearest(value: Fraction) -> Wide:
    """The number of the wide type that is nearest to a rational number."""
    exponent = value.numerator.bit_length() - value.denominator.bit_length() - 80
    return Wide(np.ldexp(Wide(round(value / Fraction(2) ** exponent)), exponent))


def polhode(moments: Vector, rates: Vector) -> Polhode | None:
    """The polhode for principal moments (kg m^2) and an angular velocity along the principal axes (rad/s).

    None for a steady spin.
    """
    order = sorted(range(3), key=moments.__getitem__)
    i, w = [Wide(moments[axis]) for axis in order], [Wide(rates[axis]) for axis in order]
    (i1, i2, i3), (w1, _, w3) = ([Fraction(vector[axis]) for axis in order] for vector in (moments, rates))
    e1 = i[1] * (i[1] - i[0]) * w[1] ** 2 + i[2] * (i[2] - i[0]) * w[2] ** 2
    e2 = nearest(i3 * (i3 - i2) * w3**2 - i1 * (i2 - i1) * w1**2)
    e3 = i[0] * (i[2] - i[0]) * w[0] ** 2 + i[1] * (i[2] - i[1]) * w[1] ** 2
    e = (e1, e2, e3)
    p = 2 if e2 >= 0 else 0
    r = 2 - p
    span, apart = i[2] - i[0], abs(i[p] - i[1])
    if not apart * e[r] * e[p] > 0:
        return None
    size = [np.sqrt(i[1] * e[p] / apart)] * 3
    size[p], size[r] = np.sqrt(i[p] * e[r] / span), np.sqrt(i[r] * e[p] / span)
    sn, cn, dn = (abs(i[axis] * w[axis]) / size[axis] for axis in (1, r, p))
    if not cn * cn + dn * dn > 0:
        return None
    handedness = 1 if order in ([0, 1, 2], [1, 2, 0], [2, 0, 1]) else -1
    first, last = math.copysign(1, rates[order[0]]), math.copysign(1, rates[order[2]])
    # dL2/dt = (1/I1 - 1/I3) L3 L1 for a right-handed order of the axes 1, 2, 3, and the negative of it for a left-handed one.
    middle = handedness * first * last
    scale = apart * e[r]
    kc = np.sqrt(span * abs(e2) / scale)
    return Polhode(
        order=(order[0], order[1], order[2]),
        handedness=handedness,
        p=p,
        moments=(i[0], i[1], i[2]),
        e=e,
        momentum=np.sqrt(sum((i[axis] * w[axis]) ** 2 for axis in range(3))),
        size=(size[0], size[1], size[2]),
        sign=(first, middle, last),
        rate=np.sqrt(scale / (i[0] * i[1] * i[2])),
        start=first_kind(math.copysign(1, middle * rates[order[1]]) * sn, cn, dn),
        k=np.sqrt(abs(i[1] - i[r]) * e[p] / scale),
        kc=kc,
        quarter=quarter_period(kc),
    )


def precession(motion: Polhode) -> Precession:
    """The rotation about the angular momentum for a polhode."""
    i, e, size = motion.moments, motion.e, motion.size
    f = 2 if i[2] * (i[1] - i[0]) <= i[0] * (i[2] - i[1]) else 0
    g = 2 - f
    around_g, around_f = e[g] / e[f], abs(i[g] - i[1]) / abs(i[1] - i[f])
    nu = i[f] / i[g] * (around_g if g == motion.p else around_f)
    k2 = motion.k**2
    eta = first_kind(*(np.sqrt(part / (nu + k2)) for part in (nu, k2, k2 * (1 + nu)))) if nu > 0 else Wide(0)
    mean = complete(motion.kc, 1 + nu, Wide(0), Wide(1)) / motion.quarter if motion.kc > 0 else 1 / (1 + nu)
    excess = motion.momentum * (i[g] - i[1]) / (i[1] * i[g]) * (size[1] / size[g]) ** 2
    return Precession(
        f=f,
        g=g,
        rate=motion.momentum / i[g] + excess * mean,
        sense=float(-np.sign(excess)),
        series=theta_series(motion.k, motion.kc, motion.quarter, eta),
    )


def half_period(motion: Polhode) -> Wide:
    """The time (s) after which L2 and Lr have changed sign and Lp has the same value: 2 K / lambda."""
    return 2 * motion.quarter / motion.rate


def remainder(value: WideArray, period: Wide) -> tuple[Array, Array]:
    """Values (n,) minus the nearest whole number of periods, and these whole numbers (n,), both in double precision."""
    count = np.rint(value.astype(float) * float(1 / period))
    return (value - period * count.astype(Wide)).astype(float), count


def left_factor(q: Array) -> Array:
    """The matrix (4, 4) that multiplies a quaternion (4,) from the left by the quaternion q (4,)."""
    w, x, y, z = q
    return np.array([[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]])


def rotation(moments: Vector, rates: Vector, quaternion: Quaternion, times: Array) -> tuple[Array, Array]:
    """Attitude and angular velocity of a body without torque.

    Parameters
    ----------
    moments
        Principal moments A, B, C (kg m^2).
    rates
        Angular velocity at t = 0, along the principal axes (rad/s).
    quaternion
        Attitude at t = 0 (w, x, y, z, body to world), of any length.
    times
        (n,) times in any order (s).

    Returns
    -------
    tuple of arrays
        (n, 4) attitudes w, x, y, z, body to world, and (n, 3) angular velocities along the principal axes (rad/s).
    """
    start = left_factor(normalise(np.array(quaternion)))
    t = np.concatenate(([0.0], times))
    motion = polhode(moments, rates)
    attitude, body_rates = steady_spin(rates, t) if motion is None else tumbling(motion, t)
    to_start = left_factor(conjugate(attitude[:, 0]))
    return attitude[:, 1:].T @ (start @ to_start).T, body_rates[:, 1:].T


def steady_rate(rates: Vector) -> Wide:
    """The magnitude |Omega| of an angular velocity (rad/s)."""
    return Wide(np.sqrt(sum(Wide(rate) ** 2 for rate in rates)))


def steady_spin(rates: Vector, t: Array) -> tuple[Array, Array]:
    """Attitudes (4, n), up to a constant rotation, and angular velocities (3, n) of a steady spin at times t (n,), s."""
    speed = steady_rate(rates)
    turn, _ = remainder(speed * t.astype(Wide), 4 * PI)
    axis = np.array(rates) / float(speed) if speed > 0 else np.zeros(3)
    half = turn / 2
    return np.vstack([np.cos(half), np.outer(axis, np.sin(half))]), np.repeat([rates], len(t), axis=0).T


def tumbling(motion: Polhode, t: Array) -> tuple[Array, Array]:
    """Attitudes (4, n), up to a constant rotation, and angular velocities (3, n) of a body on a polhode at times t (n,), s."""
    turn = precession(motion)
    wide = t.astype(Wide)
    u, half_periods = remainder(motion.start + motion.rate * wide, 2 * motion.quarter)
    secular, _ = remainder(turn.rate * wide, 2 * PI)
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

    attitude, body_rates = np.empty((4, len(t))), np.empty((3, len(t)))
    attitude[0] = half_cosine * np.cos(half_sum)
    for n, part, momentum in zip(axes, vector, (middle, g, f), strict=True):
        attitude[1 + motion.order[n]] = handedness * part
        body_rates[motion.order[n]] = handedness * float(motion.momentum / motion.moments[n]) * momentum
    return attitude, body_rates
