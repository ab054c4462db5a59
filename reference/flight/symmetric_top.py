"""Rotation of a body with two equal moments without torque: a steady precession, in elementary functions.

With the moments A, A, C and k the axis of the third, Omega = L/A + (1 - C/A) Omega_k k. The angular momentum L is constant in
space, k is constant in the body, and Omega_k is constant, so that the attitude rotates steadily about both,

    R(t) = R(0) exp(t L/A) exp(t (1 - C/A) Omega_k k),

with L and k in the body frame at t = 0 (Landau and Lifshitz, Mechanics, par. 33 and 36).
"""

import numpy as np

from bodycheck.reference.flight.elliptic import PI, Wide
from bodycheck.reference.flight.torque_free import remainder
from bodycheck.reference.kinematics import multiply, normalise
from bodycheck.reference.scene import Quaternion, Vector
from bodycheck.reference.trajectory import Array


def rotation(moments: Vector, rates: Vector, quaternion: Quaternion, times: Array) -> tuple[Array, Array]:
    """Attitude and angular velocity of a symmetric body.

    Parameters
    ----------
    moments
        Principal moments A, B, C (kg m^2), of which exactly two are equal.
    rates
        Angular velocity at t = 0, along the principal axes (rad/s).
    quaternion
        Attitude at t = 0 (w, x, y, z, body to world).
    times
        (n,) times in any order (s).

    Returns
    -------
    tuple of arrays
        (n, 4) attitudes w, x, y, z, body to world, and (n, 3) angular velocities along the principal axes (rad/s).
    """
    axis = figure_axis(moments)
    precession, spin = angular_rates(moments, rates)
    momentum = [Wide(moment) * Wide(rate) for moment, rate in zip(moments, rates, strict=True)]
    size = np.hypot(np.hypot(momentum[0], momentum[1]), momentum[2])
    direction = np.array([float(part / size) for part in momentum]) if size > 0 else np.zeros(3)
    wide = times.astype(Wide)
    half_precession, half_spin = (remainder(rate * wide, 4 * PI)[0] / 2 for rate in (precession, spin))
    about_momentum = np.column_stack([np.cos(half_precession), np.outer(np.sin(half_precession), direction)])
    about_axis = np.column_stack([np.cos(half_spin), np.outer(np.sin(half_spin), np.eye(3)[axis])])
    start = normalise(np.array(quaternion))
    attitude = multiply(multiply(np.broadcast_to(start, about_momentum.shape), about_momentum), about_axis)

    # In the body frame, the component of the angular velocity across the axis rotates in the opposite sense.
    across, other = (axis + 1) % 3, (axis + 2) % 3
    angle, _ = remainder(spin * wide, 2 * PI)
    cosine, sine = np.cos(angle), np.sin(angle)
    body_rates = np.empty((len(times), 3))
    body_rates[:, axis] = rates[axis]
    body_rates[:, across] = cosine * rates[across] + sine * rates[other]
    body_rates[:, other] = cosine * rates[other] - sine * rates[across]
    return attitude, body_rates


def figure_axis(moments: Vector) -> int:
    """Index, among I, J, K, of the axis whose moment differs from the other two."""
    return next(axis for axis, moment in enumerate(moments) if moments.count(moment) == 1)


def angular_rates(moments: Vector, rates: Vector) -> tuple[Wide, Wide]:
    """The rates |L|/A of the precession and (1 - C/A) Omega_k of the spin (rad/s).

    moments: principal moments (kg m^2). rates: angular velocity along the principal axes (rad/s).
    """
    axis = figure_axis(moments)
    equal, own = Wide(moments[axis - 1]), Wide(moments[axis])
    across = np.hypot(Wide(rates[axis - 1]), Wide(rates[axis - 2]))
    along = Wide(rates[axis])
    return Wide(np.hypot(across, own / equal * along)), Wide((equal - own) / equal * along)
