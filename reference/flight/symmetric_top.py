"""Rotation of a body with two equal moments without torque: a steady precession, in elementary functions.

With the moments A, A, C and k the axis of the third, Omega = L/A + (1 - C/A) Omega_k k. The angular momentum L is constant in
space, k is constant in the body, and Omega_k is constant, so that the attitude rotates steadily about both,

    R(t) = R(0) exp(t L/A) exp(t (1 - C/A) Omega_k k),

with L and k in the body frame at t = 0 (Landau and Lifshitz, Mechanics, par. 33 and 36).
"""

import numpy as np

from bodycheck.reference.exact.numbers import MP, Real, Vector3, Wide, doubles, wide
from bodycheck.reference.exact.start import Start
from bodycheck.reference.flight.elliptic import PI
from bodycheck.reference.flight.torque_free import remainder
from bodycheck.reference.flight.turning import Turning
from bodycheck.reference.kinematics import multiply, normalise
from bodycheck.reference.trajectory import Array


def rotation(start: Start, times: Array) -> Turning:
    """The rotation of a body of which exactly two moments are equal from its start, at times (n,) in any order, s."""
    moments, rates = start.moments, start.rates
    axis = figure_axis(moments)
    precession, spin = angular_rates(moments, rates)
    momentum = [moment * rate for moment, rate in zip(moments, rates, strict=True)]
    size = MP.sqrt(sum(part * part for part in momentum))
    direction = np.array([float(part / size) for part in momentum])
    elapsed = times.astype(Wide)
    half_precession, half_spin = (remainder(wide(rate) * elapsed, 4 * PI)[0] / 2 for rate in (precession, spin))
    about_momentum = np.column_stack([np.cos(half_precession), np.outer(np.sin(half_precession), direction)])
    about_axis = np.column_stack([np.cos(half_spin), np.outer(np.sin(half_spin), np.eye(3)[axis])])
    first = normalise(np.array(doubles(start.attitude)))
    attitude = multiply(multiply(np.broadcast_to(first, about_momentum.shape), about_momentum), about_axis)

    # In the body frame, the component of the angular velocity across the axis rotates in the opposite sense.
    across, other = (axis + 1) % 3, (axis + 2) % 3
    at_start = doubles(rates)
    angle, _ = remainder(wide(spin) * elapsed, 2 * PI)
    cosine, sine = np.cos(angle), np.sin(angle)
    body_rates, amplitude = np.empty((len(times), 3)), np.empty(3)
    body_rates[:, axis] = at_start[axis]
    body_rates[:, across] = cosine * at_start[across] + sine * at_start[other]
    body_rates[:, other] = cosine * at_start[other] - sine * at_start[across]
    amplitude[:] = np.hypot(at_start[across], at_start[other])
    amplitude[axis] = abs(at_start[axis])
    return Turning(attitude, body_rates, amplitude, 0.0, float(precession + abs(spin)))


def figure_axis(moments: Vector3) -> int:
    """Index, among I, J, K, of the axis whose moment differs from the other two."""
    return next(axis for axis, moment in enumerate(moments) if moments.count(moment) == 1)


def angular_rates(moments: Vector3, rates: Vector3) -> tuple[Real, Real]:
    """The rates |L|/A of the precession and (1 - C/A) Omega_k of the spin (rad/s).

    moments: principal moments (kg m^2). rates: angular velocity along the principal axes (rad/s).
    """
    axis = figure_axis(moments)
    equal, own = moments[axis - 1], moments[axis]
    along = rates[axis]
    precession = MP.sqrt(rates[axis - 1] ** 2 + rates[axis - 2] ** 2 + (own / equal * along) ** 2)
    return precession, (equal - own) / equal * along
