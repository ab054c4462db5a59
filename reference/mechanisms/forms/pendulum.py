"""The compound pendulum at any amplitude, by Jacobi's elliptic functions.

The angle phi from the stable equilibrium obeys phi'' = -omega^2 sin phi. With sigma the sign of the initial velocity,

    k^2 = sin^2(phi0 / 2) + (phi0' / 2 omega)^2,    k'^2 = cos^2(phi0 / 2) - (phi0' / 2 omega)^2,

    k < 1:  sin(phi / 2) = sigma k sn(u, k),  cos(phi / 2) = dn(u, k),  phi' = sigma 2 omega k cn(u, k),
    k = 1:  sin(phi / 2) = sigma tanh u,      cos(phi / 2) = sech u,    phi' = sigma 2 omega sech u,
    k > 1:  phi = sigma 2 am(u, 1 / k),                                 phi' = sigma 2 omega k dn(u, 1 / k),

where u = u0 + omega t, and u = u0 + k omega t for k > 1. Both moduli are computed with a hundred digits, so that no digits are
lost near the separatrix.
"""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.exact.numbers import MP, Real, Wide, wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.independent.jacobi import argument, functions, modulus
from bodycheck.reference.mechanisms.forms.motion import WIDE_EPS, JointForm
from bodycheck.reference.trajectory import Array

#: Bound of the relative error of the elliptic functions and of the angle from them, in roundings to the wide type.
ROUNDINGS = 32 * WIDE_EPS

#: Relative error of the phase u, in roundings to the wide type.
_PHASE = 4 * WIDE_EPS

#: Size of k'^2 up to which it differs from zero only by rounding.
_ZERO = MP.mpf(10) ** -80


@dataclass(frozen=True, eq=False)
class Pendulum:
    """A pendulum.

    Attributes
    ----------
    square
        omega^2 (1/s^2), > 0.
    equilibrium
        The coordinate (rad) of the stable equilibrium.
    start, velocity
        Initial coordinate (rad) and velocity (rad/s).
    """

    square: Real
    equilibrium: Real
    start: Real
    velocity: Real


def period(system: Pendulum) -> Real:
    """The time (s) of one oscillation, or of one revolution; infinite on the separatrix."""
    k2, kc2 = _moduli(system)
    omega = MP.sqrt(system.square)
    if abs(kc2) <= _ZERO:
        return MP.inf
    if kc2 > 0:
        return 4 * modulus(MP.sqrt(kc2)).quarter / omega
    return 2 * modulus(MP.sqrt(-kc2 / k2)).quarter / (omega * MP.sqrt(k2))


def follow(system: Pendulum, times: Array) -> JointForm:
    """The motion at times (n,), s, in any order."""
    k2, kc2 = _moduli(system)
    angle = system.start - system.equilibrium
    if not system.velocity and (k2 <= _ZERO or (abs(kc2) <= _ZERO)):
        return _resting(system, times)
    omega, k = MP.sqrt(system.square), MP.sqrt(k2)
    sense = -1 if system.velocity < 0 else 1
    turns = MP.nint(angle / (2 * MP.pi))
    half = sense * (angle / 2 - MP.pi * turns)
    rotating = kc2 < -_ZERO
    if rotating:
        elliptic, rate = modulus(MP.sqrt(-kc2) / k), k * omega
        begin = argument(elliptic, MP.sin(half), abs(MP.cos(half)))
    else:
        elliptic, rate = modulus(MP.sqrt(kc2) if kc2 > _ZERO else MP.zero), omega
        cn = abs(system.velocity) / (2 * omega) if elliptic.mean else abs(MP.cos(half))
        begin = argument(elliptic, MP.sin(half), cn)
    u = wide(begin) + wide(rate) * times.astype(Wide)
    reduced, count = _reduced(u, wide(2 * elliptic.quarter) if elliptic.mean else None)
    sn, cn_, dn = functions(elliptic, reduced)
    if rotating:
        phi = 2 * (np.arctan2(sn, cn_) + count * wide(MP.pi))
        velocity = dn * wide(2 * rate)
    else:
        parity = 1 - 2 * (count % 2)
        phi = 2 * np.arctan2(wide(k) * sn * parity, dn)
        velocity = parity * cn_ * wide(2 * omega * k)
    position = wide(system.equilibrium + 2 * MP.pi * turns) + sense * phi
    phase = _PHASE * (np.abs(u) + abs(wide(begin)) + 1)
    error = ROUNDINGS * (1 + np.abs(position) + np.abs(phi)) + phase * np.abs(velocity) / wide(rate)
    velocity_error = ROUNDINGS * wide(2 * omega * k) + phase * wide(system.square / rate)
    return JointForm(position[:, None], (sense * velocity)[:, None], error.astype(float), velocity_error.astype(float))


def _moduli(system: Pendulum) -> tuple[Real, Real]:
    """k^2 and k'^2."""
    half, speed = (system.start - system.equilibrium) / 2, system.velocity**2 / (4 * system.square)
    return MP.sin(half) ** 2 + speed, MP.cos(half) ** 2 - speed


def _reduced(u: WideArray, half_period: np.longdouble | None) -> tuple[WideArray, WideArray]:
    """Arguments minus the nearest whole number of half periods 2 K, and these whole numbers."""
    if half_period is None:
        return u, np.zeros_like(u)
    count: WideArray = np.rint(u / half_period)
    return u - count * half_period, count


def _resting(system: Pendulum, times: Array) -> JointForm:
    """The motion of a pendulum that rests in an equilibrium, at times (n,), s."""
    position = np.full((len(times), 1), wide(system.start), dtype=Wide)
    error = np.full(len(times), WIDE_EPS * float(abs(system.start)))
    return JointForm(position, np.zeros_like(position), error, np.zeros(len(times)))
