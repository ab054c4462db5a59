"""The angular velocity in both frames from the rates of the Euler angles [G 2.21], and from any moving axes [G 2.41].

Angles phi, theta, psi (...) are in rad and rates in rad/s; arrays broadcast over their leading axes. The angular velocity in
the body frame is `kinematics.body_rates`, and its inverse is `kinematics.euler_rates`.
"""

import numpy as np

from bodycheck.reference.kinematics import Float, Floats, body_rates, euler_rates

#: Signs of the components when the frames are exchanged. Relative to the body the world turns by the angles -psi, -theta, -phi,
#: so that exchanging the frames exchanges phi and psi and changes the sign of the second component.
FRAME_EXCHANGE_SIGNS = np.array([1, -1, 1])


class SingularAngles(ValueError):
    """The angular velocity does not determine the rates of the Euler angles, because sin(theta) = 0."""


def inertial_rates(
    phi: Floats[Float], theta: Floats[Float], dphi: Floats[Float], dtheta: Floats[Float], dpsi: Floats[Float]
) -> Floats[Float]:
    """Angular velocity in the inertial frame from Euler angles and their rates [G 2.21b].

    Parameters
    ----------
    phi, theta
        (...) angles (rad); the angle psi has no effect.
    dphi, dtheta, dpsi
        (...) rates of the angles (rad/s).

    Returns
    -------
    array
        (..., 3) angular velocity (rad/s) along i, j, k.
    """
    return np.asarray(body_rates(theta, phi, dpsi, dtheta, dphi) * FRAME_EXCHANGE_SIGNS)


def body_rate_matrix(theta: Floats[Float], psi: Floats[Float]) -> Floats[Float]:
    """A_Omega (..., 3, 3), which maps (dphi, dtheta, dpsi) to the angular velocity in the body frame [G 2.21c]."""
    theta, psi = np.broadcast_arrays(theta, psi)
    return np.stack([body_rates(theta, psi, *unit) for unit in np.eye(3)], axis=-1)


def inertial_rate_matrix(phi: Floats[Float], theta: Floats[Float]) -> Floats[Float]:
    """A_omega (..., 3, 3), which maps (dphi, dtheta, dpsi) to the angular velocity in the inertial frame [G 2.21d]."""
    phi, theta = np.broadcast_arrays(phi, theta)
    return np.stack([inertial_rates(phi, theta, *unit) for unit in np.eye(3)], axis=-1)


def inverse_body_rate_matrix(theta: Floats[Float], psi: Floats[Float]) -> Floats[Float]:
    """The inverse of A_Omega (..., 3, 3), which maps the angular velocity in the body frame to (dphi, dtheta, dpsi).

    Raises `SingularAngles` if an angle theta is a multiple of pi to its own rounding.
    """
    _require_regular(theta)
    theta, psi = np.broadcast_arrays(theta, psi)
    return np.stack([np.stack(euler_rates(theta, psi, unit), axis=-1) for unit in np.eye(3)], axis=-1)


def inverse_inertial_rate_matrix(phi: Floats[Float], theta: Floats[Float]) -> Floats[Float]:
    """The inverse of A_omega (..., 3, 3), which maps the angular velocity in the inertial frame to (dphi, dtheta, dpsi).

    Raises `SingularAngles` if an angle theta is a multiple of pi to its own rounding.
    """
    _require_regular(theta)
    phi, theta = np.broadcast_arrays(phi, theta)
    # With phi and psi exchanged, `euler_rates` returns the rates in the order (dpsi, dtheta, dphi).
    return np.stack([np.stack(euler_rates(theta, phi, unit)[::-1], axis=-1) for unit in np.diag(FRAME_EXCHANGE_SIGNS)], axis=-1)


def rates_of_axes(axes: Floats[Float], derivatives: Floats[Float]) -> Floats[Float]:
    """Angular velocity (..., 3), rad/s, in the body frame from the moving body axes: K.dJ/dt, I.dK/dt, J.dI/dt [G 2.41].

    axes: matrices A1 (..., 3, 3), whose columns are I, J, K in the inertial frame. derivatives: their derivatives with respect
    to time (..., 3, 3), 1/s.
    """
    i, j, k = np.moveaxis(axes, -1, 0)
    di, dj, dk = np.moveaxis(derivatives, -1, 0)
    return np.stack([(k * dj).sum(axis=-1), (i * dk).sum(axis=-1), (j * di).sum(axis=-1)], axis=-1)


def _require_regular(theta: Floats[Float]) -> None:
    """Raise `SingularAngles` if the sine of an angle theta (...) is zero to the rounding of the angle."""
    float_type = np.finfo(np.result_type(float, theta))
    # The floating-point number next to a multiple of pi differs from it by up to half a rounding of the angle, so that sin(pi)
    # is 1.2e-16 and not 0. Below the smallest normal number 1 / sin(theta) would overflow.
    singular = np.abs(np.sin(theta)) <= np.maximum(float_type.eps * np.abs(theta), float_type.tiny)
    if singular.any():
        where = np.atleast_1d(theta)[np.atleast_1d(singular)][0]
        raise SingularAngles(
            f"sin(theta) = 0 at theta = {where}: the angular velocity determines the sum or the difference of the rates of phi "
            "and psi there, not each of them"
        )
