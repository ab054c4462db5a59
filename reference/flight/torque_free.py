"""Rotation of a rigid body without torque, in closed form, for any principal moments.

The angular velocity in the body frame is given by Jacobi's elliptic functions, and the attitude by the phase of an integral of
the third kind. This is the classical solution (Jacobi 1850; Landau and Lifshitz, Mechanics, par. 37; van Zon and Schofield,
J. Comput. Phys. 225, 145, 2007), arranged so that no digits cancel. With moments I1 <= I2 <= I3 all constants follow from

    E1 = L^2 - 2 T I1 = I2 (I2 - I1) w2^2 + I3 (I3 - I1) w3^2,
    E2 = L^2 - 2 T I2 = I3 (I3 - I2) w3^2 - I1 (I2 - I1) w1^2,
    E3 = 2 T I3 - L^2 = I1 (I3 - I1) w1^2 + I2 (I3 - I2) w2^2.

Only E2 is a difference. Its sign tells which axis p the angular momentum encircles in the body frame, the axis of the largest
moment (+) or of the smallest moment (-); r is the other of these two axes. On the separatrix E2 is zero, and near it all of its
digits would be lost, so E2 is computed with a hundred digits. With u = u0 + lambda t,

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
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.exact import pairs
from bodycheck.reference.exact.numbers import MP, Vector3, Wide, doubles, wide
from bodycheck.reference.exact.start import Start
from bodycheck.reference.flight.constants import Branch, Constants, branch, constants
from bodycheck.reference.flight.elliptic import (
    PI,
    ThetaSeries,
    WideArray,
    Wides,
    complete,
    first_kind,
    jacobi,
    quarter_period,
    theta_series,
)
from bodycheck.reference.flight.turning import Turning, placed
from bodycheck.reference.trajectory import Array


@dataclass(frozen=True, eq=False)
class Polhode:
    """The motion of the angular momentum in the body frame, with the symbols of the module.

    It describes one body, or m bodies on the same branch. For m bodies the attributes are arrays (m,), except `branch`, and
    `order` is (m, 3).

    Attributes
    ----------
    order
        Indices, among I, J, K, of the axes 1, 2, 3.
    handedness
        +1 if the axes 1, 2, 3 are right-handed, -1 if they are left-handed.
    branch
        The axes p and f, and whether k > k'.
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

    order: NDArray[np.int_]
    handedness: Any
    branch: Branch
    unit: Wides
    moments: tuple[Wides, Wides, Wides]
    gaps: tuple[Wides, Wides]
    e: tuple[Wides, Wides, Wides]
    momentum: Wides
    size: tuple[Wides, Wides, Wides]
    sign: tuple[Any, Any, Any]
    rate: Wides
    start: Wides
    k: Wides
    kc: Wides
    quarter: Wides

    @property
    def p(self) -> int:
        """Index of the axis p in the order 1, 2, 3: 0 or 2."""
        return self.branch.p


@dataclass(frozen=True, eq=False)
class Precession:
    """The rotation about the angular momentum, of one body or of m bodies.

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
    rate: Wides
    sense: float
    series: ThetaSeries


def polhode(moments: Sequence[Any], rates: Sequence[Any]) -> Polhode | None:
    """The polhode for principal moments (kg m^2) and an angular velocity along the principal axes (rad/s).

    The numbers have any type and are taken as exact: E1, E2, E3 and the differences of moments are computed with a hundred
    digits and rounded once. The result is None for a steady spin.
    """
    invariants = constants(moments, rates)
    chosen = branch(invariants)
    apart, e_r, e_p = (
        (invariants.high, invariants.e1, invariants.e3) if chosen.p == 2 else (invariants.low, invariants.e3, invariants.e1)
    )
    if not apart * e_r * e_p > 0:
        return None
    _, cn, dn = _functions_at_start(invariants, chosen)
    return polhodes(invariants, chosen) if cn * cn + dn * dn > 0 else None


@functools.lru_cache(maxsize=64)
def polhode_of(start: Start) -> Polhode | None:
    """The polhode of a start, or None for a steady spin."""
    return polhode(start.moments, start.rates)


def polhodes(c: Constants, chosen: Branch) -> Polhode:
    """The polhode of a body that is not in a steady spin, or the polhodes of m such bodies on the same branch."""
    p, r = chosen.p, 2 - chosen.p
    e, moments = (c.e1, c.e2, c.e3), (c.i1, c.i2, c.i3)
    apart, other = (c.high, c.low) if p == 2 else (c.low, c.high)
    first, last = np.copysign(1.0, c.w1.astype(float)), np.copysign(1.0, c.w3.astype(float))
    # dL2/dt = (1/I1 - 1/I3) L3 L1 for a right-handed order of the axes 1, 2, 3, and the negative of this for a left-handed
    # order.
    middle = c.handedness * first * last
    scale = apart * e[r]
    kc = np.sqrt(c.span * abs(c.e2) / scale)
    sn, cn, dn = _functions_at_start(c, chosen)
    momenta = [moment * rate for moment, rate in zip(moments, (c.w1, c.w2, c.w3), strict=True)]
    return Polhode(
        order=c.order,
        handedness=c.handedness,
        branch=chosen,
        unit=c.unit,
        moments=moments,
        gaps=(c.low, c.high),
        e=e,
        momentum=np.sqrt(momenta[0] * momenta[0] + momenta[1] * momenta[1] + momenta[2] * momenta[2]),
        size=_amplitudes(c, p),
        sign=(first, middle, last),
        rate=np.sqrt(scale / (c.i1 * c.i2 * c.i3)),
        start=first_kind(np.copysign(Wide(1), middle * c.w2) * sn, cn, dn),
        k=np.sqrt(other * e[p] / scale),
        kc=kc,
        quarter=quarter_period(kc),
    )


def _amplitudes(c: Constants, p: int) -> tuple[Wides, Wides, Wides]:
    """The amplitudes M1, M2, M3 of the angular momentum along the axes 1, 2, 3; p: index of the axis that it encircles."""
    e_p, e_r, apart = (c.e3, c.e1, c.high) if p == 2 else (c.e1, c.e3, c.low)
    first, last = (e_p, e_r) if p == 2 else (e_r, e_p)
    return np.sqrt(c.i1 * first / c.span), np.sqrt(c.i2 * e_p / apart), np.sqrt(c.i3 * last / c.span)


def _functions_at_start(c: Constants, chosen: Branch) -> tuple[Wides, Wides, Wides]:
    """The absolute values of sn u, cn u and dn u at t = 0."""
    m1, m2, m3 = _amplitudes(c, chosen.p)
    one, middle, three = abs(c.i1 * c.w1) / m1, abs(c.i2 * c.w2) / m2, abs(c.i3 * c.w3) / m3
    return (middle, one, three) if chosen.p == 2 else (middle, three, one)


@functools.lru_cache(maxsize=16)
def precession(motion: Polhode) -> Precession:
    """The rotation about the angular momentum for one polhode, or for those of m bodies."""
    i, e, size, (low, high) = motion.moments, motion.e, motion.size, motion.gaps
    f = motion.branch.f
    g = 2 - f
    # Ig - I2, with its sign, and |I2 - If|.
    gap_g, gap_f = (-low, high) if g == 0 else (high, low)
    around_g, around_f = e[g] / e[f], abs(gap_g) / gap_f
    nu = i[f] / i[g] * (around_g if g == motion.p else around_f)
    k2 = motion.k**2
    # With many bodies, nu and k' are zero for none of them; see `constants_of_many`.
    parts = (nu, k2, k2 * (1 + nu))
    eta = first_kind(*(np.sqrt(part / (nu + k2)) for part in parts)) if np.all(nu > 0) else Wide(0)
    third_kind = complete(motion.kc, 1 + nu, Wide(0), Wide(1)) if np.all(motion.kc > 0) else None
    mean = 1 / (1 + nu) if third_kind is None else third_kind / motion.quarter
    excess = motion.momentum * gap_g / (i[1] * i[g]) * (size[1] / size[g]) ** 2
    return Precession(
        f=f,
        g=g,
        rate=motion.momentum / i[g] + excess * mean,
        sense=1.0 if g == 0 else -1.0,  # the opposite of the sign of Ig - I2
        series=theta_series(motion.k, motion.kc, motion.quarter, eta, motion.branch.hyperbolic),
    )


def half_period(motion: Polhode) -> Wides:
    """The time (s) after which L2 and Lr have changed sign and Lp has its first value again: 2 K / lambda."""
    return 2 * motion.quarter / motion.rate / motion.unit


def remainder(value: WideArray, period: Wides) -> tuple[Array, Array]:
    """Values (..., n) minus the nearest multiple of the period, and the number (..., n) of periods, both in double precision.

    period: a number, or an array (..., 1) with one period for each row.
    """
    count = np.rint(value.astype(float) * (1 / period).astype(float))
    return (value - period * count.astype(Wide)).astype(float), count


def rotation(start: Start, times: Array) -> Turning:
    """The rotation of a body without torque from its start, at times (n,) in any order, s."""
    t = np.concatenate(([0.0], times))
    motion = polhode_of(start)
    turning = steady_spin(start.rates, t) if motion is None else tumbling(motion, t)
    return placed(turning, np.array(doubles(start.attitude)))


def steady_spin(rates: Vector3, t: Array) -> Turning:
    """A steady spin with the angular velocity `rates` (rad/s) at times t (n,), s, from any attitude."""
    speed = MP.sqrt(sum(rate * rate for rate in rates))
    return spinning(np.array(doubles(rates)), wide(speed), t)


def steady_spins(rates: Array, t: Array) -> Turning:
    """Steady spins with the angular velocities `rates` (m, 3), rad/s, at times t (n,), s, from any attitudes."""
    x, y, z = (pairs.squares(rates[:, axis]) for axis in range(3))
    return spinning(rates, pairs.root(x + y + z).high, t)


def spinning(rates: Array, speed: Wides, t: Array) -> Turning:
    """Steady spins with angular velocities `rates` (..., 3) of magnitude `speed` (...), rad/s, at times t (n,), s."""
    speed = np.asarray(speed)
    turn, _ = remainder(speed[..., None] * t.astype(Wide), 4 * PI)
    axis = (rates / speed[..., None]).astype(float)
    sine = np.sin(turn / 2)
    attitude = np.stack([np.cos(turn / 2), *(sine * axis[..., each, None] for each in range(3))], axis=-1)
    constant = np.broadcast_to(rates[..., None, :], (*turn.shape, 3))
    return Turning(attitude, constant, np.abs(rates), np.zeros_like(speed, dtype=float), speed.astype(float))


def tumbling(motion: Polhode, t: Array) -> Turning:
    """The rotation of a body on a polhode, or of m bodies, at times t (n,), s, from any attitudes."""
    turn = precession(motion)
    elapsed = t.astype(Wide) * _column(motion.unit)
    u, half_periods = remainder(_column(motion.start) + _column(motion.rate) * elapsed, _column(2 * motion.quarter))
    secular, _ = remainder(_column(turn.rate) * elapsed, 2 * PI)
    sn, cn, dn, phase = jacobi(turn.series, u)
    parity = 1 - 2 * (half_periods - 2 * np.floor(half_periods / 2))
    elliptic = [parity * sn] * 3
    elliptic[motion.p], elliptic[2 - motion.p] = dn, parity * cn

    axes = (1, turn.g, turn.f)
    # Angular momentum is an axial vector: its components along a left-handed order of axes have the opposite sign.
    handedness = motion.handedness if turn.g == 2 else -motion.handedness
    middle, g, f = (_factor(handedness * motion.sign[n] * motion.size[n] / motion.momentum) * elliptic[n] for n in axes)
    # psi is computed from the ratio of the amplitudes, which is accurate even where both are below the smallest normal number.
    slope = _factor(handedness * motion.sign[1] * (motion.size[1] / motion.size[turn.g]))
    psi = np.arctan2(slope * elliptic[1], _factor(handedness * motion.sign[turn.g]) * elliptic[turn.g])
    phi = secular + turn.sense * phase
    across, along = np.hypot(middle, g), 1 + np.abs(f)
    # tan(theta/2) has two forms; the form without cancellation depends on the sign of cos(theta).
    half_sine, half_cosine = np.where(f > 0, (across, along), (along, across)) / np.hypot(across, along)
    half_sum, half_difference = (phi + psi) / 2, (phi - psi) / 2
    vector = (half_sine * np.cos(half_difference), half_sine * np.sin(half_difference), half_cosine * np.sin(half_sum))

    attitude, body_rates = np.empty((*u.shape, 4)), np.empty((*u.shape, 3))
    amplitude = np.empty((*u.shape[:-1], 3))
    attitude[..., 0] = half_cosine * np.cos(half_sum)
    for n, part, momentum in zip(axes, vector, (middle, g, f), strict=True):
        axis = motion.order[..., n]
        _put(attitude, 1 + axis, _factor(handedness) * part)
        _put(body_rates, axis, _factor(handedness * (motion.unit * motion.momentum / motion.moments[n])) * momentum)
        _put(amplitude[..., None, :], axis, _factor(motion.unit * motion.size[n] / motion.moments[n]))
    angle_rate = (motion.unit * (motion.rate + abs(turn.rate))).astype(float)
    return Turning(attitude, body_rates, amplitude, abs(motion.start).astype(float), angle_rate)


def _column(values: Wides) -> WideArray:
    """Numbers (...) as (..., 1), to be combined with instants (n,)."""
    return np.asarray(values, dtype=Wide)[..., None]


def _factor(values: Any) -> Array:
    """Numbers (...) as (..., 1), in double precision."""
    return np.asarray(values).astype(float)[..., None]


def _put(vectors: Array, axis: NDArray[np.int_], part: Array) -> None:
    """Set the component along an axis of vectors (n, k), or along one axis (m,) for each row of vectors (m, n, k)."""
    if not axis.ndim:
        vectors[..., axis] = part
        return
    for each in set(axis.tolist()):
        rows = axis == each
        vectors[..., each][rows] = part[rows]
