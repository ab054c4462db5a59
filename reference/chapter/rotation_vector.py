"""The rotation vector in both frames, its matrices and their inverses [G 2.21], and from any moving axes [G 2.41].

Angles phi, theta, psi (...) in rad, arrays that broadcast over leading axes; rates in rad/s. The body-frame vector from the
angles themselves is `kinematics.body_rates`, and `kinematics.euler_rates` its inverse.
"""

import numpy as np

from bodycheck.reference.kinematics import Float, Floats, body_rates, euler_rates

#: Seen from the body the world turns backwards, by {-psi, -theta, -phi}: exchanging the frames exchanges phi and psi, up to the
#: sign of the second component.
FRAME_EXCHANGE_SIGNS = np.array([1, -1, 1])


class SingularAngles(ValueError):
    """The rates of the Euler angles do not follow from the angular velocity, because sin(theta) = 0."""


def inertial_rates(
    phi: Floats[Float], theta: Floats[Float], dphi: Floats[Float], dtheta: Floats[Float], dpsi: Floats[Float]
) -> Floats[Float]:
    """Angular velocity (..., 3) in the inertial frame from Euler angles and their rates [G 2.21b]."""
    return np.asarray(body_rates(theta, phi, dpsi, dtheta, dphi) * FRAME_EXCHANGE_SIGNS)


def body_rate_matrix(theta: Floats[Float], psi: Floats[Float]) -> Floats[Float]:
    """A_Omega (..., 3, 3): the body-frame angular velocity is this times (dphi, dtheta, dpsi) [G 2.21c]."""
    theta, psi = np.broadcast_arrays(theta, psi)
    return np.stack([body_rates(theta, psi, *unit) for unit in np.eye(3)], axis=-1)


def inertial_rate_matrix(phi: Floats[Float], theta: Floats[Float]) -> Floats[Float]:
    """A_omega (..., 3, 3): the inertial angular velocity is this times (dphi, dtheta, dpsi) [G 2.21d]."""
    phi, theta = np.broadcast_arrays(phi, theta)
    return np.stack([inertial_rates(phi, theta, *unit) for unit in np.eye(3)], axis=-1)


def inverse_body_rate_matrix(theta: Floats[Float], psi: Floats[Float]) -> Floats[Float]:
    """The inverse of A_Omega (..., 3, 3): (dphi, dtheta, dpsi) are this times the body-frame angular velocity.

    Raises `SingularAngles` where theta is a multiple of pi, to its own rounding.
    """
    _require_regular(theta)
    theta, psi = np.broadcast_arrays(theta, psi)
    return np.stack([np.stack(euler_rates(theta, psi, unit), axis=-1) for unit in np.eye(3)], axis=-1)


def inverse_inertial_rate_matrix(phi: Floats[Float], theta: Floats[Float]) -> Floats[Float]:
    """The inverse of A_omega (..., 3, 3): (dphi, dtheta, dpsi) are this times the inertial angular velocity.

    Raises `SingularAngles` where theta is a multiple of pi, to its own rounding.
    """
    _require_regular(theta)
    phi, theta = np.broadcast_arrays(phi, theta)
    # `euler_rates` gives its rates in the order (dpsi, dtheta, dphi) here.
    return np.stack([np.stack(euler_rates(theta, phi, unit)[::-1], axis=-1) for unit in np.diag(FRAME_EXCHANGE_SIGNS)], axis=-1)


def rates_of_axes(axes: Floats[Float], derivatives: Floats[Float]) -> Floats[Float]:
    """Body-frame angular velocity (..., 3) from the moving body axes: K.dJ/dt, I.dK/dt, J.dI/dt [G 2.41].

    axes: A1 (..., 3, 3), whose columns are I, J, K in the inertial frame. derivatives: of A1 with respect to time (1/s).
    """
    i, j, k = np.moveaxis(axes, -1, 0)
    di, dj, dk = np.moveaxis(derivatives, -1, 0)
    return np.stack([(k * dj).sum(axis=-1), (i * dk).sum(axis=-1), (j * di).sum(axis=-1)], axis=-1)


def _require_regular(theta: Floats[Float]) -> None:
    float_type = np.finfo(np.result_type(float, theta))
    # An angle next to a multiple of pi is off it by half a rounding of the angle: sin(pi) is 1.2e-16, not 0. Below the
    # smallest normal number 1 / sin(theta) would overflow.
    singular = np.abs(np.sin(theta)) <= np.maximum(float_type.eps * np.abs(theta), float_type.tiny)
    if singular.any():
        where = np.atleast_1d(theta)[np.atleast_1d(singular)][0]
        raise SingularAngles(
            f"sin(theta) = 0 at theta = {where}: the angular velocity determines the sum or the difference of the rates of phi "
            "and psi there, not each of them"
        )
