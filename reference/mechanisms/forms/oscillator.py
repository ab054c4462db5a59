"""One coordinate q with inertia I, damping d, stiffness k, a constant force F and dry friction f, in closed form.

    I q'' + d q' + k (q - rest) + f sign(q') = F

In each phase between two reversals of the velocity the equation is linear. With a the force at the start of the phase, with
friction and without damping, divided by I, and tau the time since the start of the phase,

    q = q0 + v0 B(tau) + a C(tau),    q' = v0 B'(tau) + a B(tau),

where B is the motion without a force from q = 0 with the velocity 1, and C the integral of B. With the rates lambda1 <= lambda2
of the characteristic equation, B is

    exp(-lambda1 tau) (1 - exp(-(lambda2 - lambda1) tau)) / (lambda2 - lambda1),

which does not cancel if the two rates are close to each other, and exp(-gamma tau) sin(omega tau) / omega if they are complex.
At the end of a phase the joint sticks if the force on it is at most f.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.numbers import MP, Real, Wide, wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.mechanisms.forms.motion import WIDE_EPS, JointForm
from bodycheck.reference.trajectory import Array

#: Bound of the relative error of the terms of a phase, in roundings to the wide type.
ROUNDINGS = 32 * WIDE_EPS

#: The largest number of phases; each takes some 30 microseconds.
MOST_PHASES = 20_000

#: Number of terms of the series of C for arguments up to 1, for which the two terms of the closed form would cancel.
_TERMS = 26


@dataclass(frozen=True, eq=False)
class Oscillator:
    """The constants of the equation in the docstring of the module, and the initial state, in SI units. I > 0; d, k, f >= 0."""

    inertia: Real
    damping: Real
    stiffness: Real
    rest: Real
    force: Real
    friction: Real
    start: Real
    velocity: Real


@dataclass(frozen=True, eq=False)
class Rates:
    """The rates, solutions of the characteristic equation lambda^2 - 2 gamma lambda + omega0^2 = 0, with a hundred digits.

    Attributes
    ----------
    gamma, square
        d / 2I and k / I.
    complex
        Whether gamma^2 < k / I.
    root
        The square root of |gamma^2 - k / I|.
    slow, fast
        The smaller and the larger rate if they are real; both gamma if they are complex.
    """

    gamma: Real
    square: Real
    complex: bool
    root: Real
    slow: Real
    fast: Real


@dataclass(frozen=True, eq=False)
class Phase:
    """The start of a phase: its time (s), the coordinate and velocity then, and a as in the docstring of the module."""

    time: Real
    position: Real
    velocity: Real
    acceleration: Real


def rates_of(system: Oscillator) -> Rates:
    """The rates of an oscillator."""
    gamma, square = system.damping / (2 * system.inertia), system.stiffness / system.inertia
    gap = gamma * gamma - square
    root = MP.sqrt(abs(gap))
    if gap < 0:
        return Rates(gamma, square, True, root, gamma, gamma)
    fast = gamma + root
    return Rates(gamma, square, False, root, square / fast if fast else fast, fast)


def follow(system: Oscillator, times: Array) -> JointForm:
    """The motion at times (n,) >= 0, s, in any order.

    Raises `OutOfReach` if dry friction gives `MOST_PHASES` phases or more.
    """
    rates = rates_of(system)
    steps = phases(system, rates, float(np.max(times, initial=0.0)))
    first, q, v, a = (
        np.array([wide(value) for value in column], dtype=Wide)
        for column in zip(*((step.time, step.position, step.velocity, step.acceleration) for step in steps), strict=True)
    )
    t = times.astype(Wide)
    at = np.maximum(np.searchsorted(first, t, side="right") - 1, 0)
    tau, q, v, a = t - first[at], q[at], v[at], a[at]
    b, db, c = responses(rates, tau)
    velocity = v * db + a * b
    # Bounds of the sizes of B and C without their oscillation and decay, to which the rounding errors are proportional.
    largest_b = _least(tau, rates.root if rates.complex else 2 * rates.root)
    largest_c = np.abs(c) + _least(np.minimum(tau * tau / 2, tau * _least(tau, rates.fast)), rates.square / 2)
    angle = 1 + (wide(rates.root) * t if rates.complex else np.zeros_like(t))
    error = ROUNDINGS * angle * (np.abs(q) + np.abs(v) * largest_b + np.abs(a) * largest_c)
    velocity_error = ROUNDINGS * angle * (np.abs(v) + np.abs(a) * largest_b)
    # An error of the time at which a phase begins shifts the motion in time.
    late = 2 * WIDE_EPS * t * (first[at] > 0)
    error = error + late * np.abs(velocity)
    velocity_error = velocity_error + late * (np.abs(a) + np.abs(v) * (2 * wide(rates.gamma) + wide(rates.root)))
    return JointForm((q + v * b + a * c)[:, None], velocity[:, None], error.astype(float), velocity_error.astype(float))


def _least(value: WideArray, rate: Real) -> WideArray:
    """The smaller of each value and 1 / rate; the values if the rate is zero."""
    return np.minimum(value, 1 / wide(rate)) if rate else value


def phases(system: Oscillator, rates: Rates, until: float) -> list[Phase]:
    """The phases that begin until the time `until` (s); in the last phase the joint rests, or moves at least until then."""
    listed: list[Phase] = []
    swing: tuple[Real, Real] | None = None
    time, q, v = MP.mpf(0), system.start, system.velocity
    while len(listed) < MOST_PHASES:
        applied = system.force - system.stiffness * (q - system.rest)
        sense = MP.sign(v) if v else MP.sign(applied)
        if not v and abs(applied) <= system.friction:
            listed.append(Phase(time, q, v, MP.mpf(0)))
            return listed
        a = (applied - sense * system.friction) / system.inertia
        listed.append(Phase(time, q, v, a))
        lasting = _reversal(rates, v, a) if system.friction else None
        if lasting is None or time + lasting > until:
            return listed
        if v:
            b, c = _exactly(rates, lasting)
        elif swing is None:
            # Every swing from rest lasts equally long.
            b, c = swing = _exactly(rates, lasting)
        else:
            b, c = swing
        time, q, v = time + lasting, q + v * b + a * c, MP.mpf(0)
    raise OutOfReach(f"dry friction: the velocity changes its sign more than {MOST_PHASES} times")


def _reversal(rates: Rates, v: Real, a: Real) -> Real | None:
    """The time (s) until the velocity next becomes zero; None if it never does."""
    if rates.complex:
        across = MP.sign(v) * (rates.gamma * v - a)
        return (MP.atan2(abs(v) * rates.root, across) if v else MP.pi) / rates.root
    if not v or rates.fast * v == a:
        return None
    needed = v / (rates.fast * v - a)
    if needed <= 0 or 2 * rates.root * needed >= 1:
        return None
    return -MP.log1p(-2 * rates.root * needed) / (2 * rates.root) if rates.root else needed


def _exactly(rates: Rates, tau: Real) -> tuple[Real, Real]:
    """B and C at the time tau (s) since the start of a phase, in arithmetic of a hundred digits, of which some cancel."""
    decay = MP.exp(-rates.slow * tau)
    if rates.complex:
        b = decay * MP.sin(rates.root * tau) / rates.root
        return b, (1 - decay * MP.cos(rates.root * tau) - rates.gamma * b) / rates.square
    b = decay * (-MP.expm1(-2 * rates.root * tau) / (2 * rates.root) if rates.root else tau)
    if rates.slow:
        # C = (1 - A) / omega0^2 with A = B' + 2 gamma B.
        return b, (1 - decay - rates.slow * b) / rates.square
    return b, (tau - b) / rates.fast if rates.fast else tau * tau / 2


def responses(rates: Rates, tau: WideArray) -> tuple[WideArray, WideArray, WideArray]:
    """B, B' and C (n,) at the times tau (n,) >= 0 since the start of a phase."""
    gamma, square, root, slow, fast = (wide(value) for value in (rates.gamma, rates.square, rates.root, rates.slow, rates.fast))
    decay = np.exp(-slow * tau)
    if rates.complex:
        sine, cosine = np.sin(root * tau), np.cos(root * tau)
        b, db = decay * sine / root, decay * (cosine - gamma / root * sine)
        c = (1 - decay * (cosine + gamma / root * sine)) / square
        small = np.sqrt(square) * tau < 1
    else:
        shrunk = np.expm1(-2 * root * tau)
        share = -shrunk / (2 * root) if root else tau
        b = decay * share
        apart = 2 * root * tau > 1
        db = decay * np.where(apart, (fast * (1 + shrunk) - slow) / (2 * root or Wide(1)), 1 - fast * share)
        small = fast * tau < 1
        c = _slow_and_fast(slow, fast, root, tau, b, decay)
    if np.any(small):
        c = np.where(small, _series(gamma, square, np.where(small, tau, Wide(0))), c)
    return b, db, c


def _slow_and_fast(
    slow: np.longdouble, fast: np.longdouble, root: np.longdouble, tau: WideArray, b: WideArray, decay: WideArray
) -> WideArray:
    """C (n,) for real rates and fast tau >= 1, as (1 - B' - 2 gamma B) / omega0^2 or as the difference of two terms."""
    near = slow * tau >= 0.5
    first = -np.expm1(-slow * tau) / slow if slow else tau
    second = -np.expm1(-fast * tau) / fast if fast else tau
    different = (first - second) / (2 * root) if root else np.zeros_like(tau)
    both = (1 - decay - slow * b) / (slow * fast) if slow else np.zeros_like(tau)
    value: WideArray = np.where(near, both, different)
    return value


def _series(gamma: Any, square: Any, tau: WideArray) -> WideArray:
    """C by its Taylor series."""
    term, after = tau, -gamma * tau * tau
    total: WideArray = tau * term / 2 + tau * after / 3
    for n in range(_TERMS):
        # The recurrence b_(n+2) (n+2) (n+1) = -2 gamma (n+1) b_(n+1) - omega0^2 b_n, times powers of tau, from b_1 = 1.
        term, after = after, -(2 * gamma * tau * after * (n + 2) + square * tau * tau * term) / ((n + 3) * (n + 2))
        total = total + tau * after / (n + 4)
    return total
