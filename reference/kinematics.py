"""Attitude and angular velocity: unit quaternions and z-x-z Euler angles [G 2.10-2.21].

Quaternions are (w, x, y, z) and rotate body components to world components. The Euler angles are phi (about the vertical k),
theta (about the line of nodes) and psi (about the body axis K), in rad, as in Gans and in Goldstein. Every function works on
arrays with any leading axes and keeps the floating-point type of its input, so that extended precision is preserved.
"""

from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Float = TypeVar("Float", bound=np.floating[Any])

#: An array of any floating-point type.
Floats = NDArray[Float]


def dot(a: Floats[Float], b: Floats[Float]) -> Floats[Float]:
    """Inner products (...) of vectors or quaternions (..., k), with the products of components added in order.

    The inner product of two vectors is the same, to the last bit, whatever other vectors the arrays contain. The result is the
    sum over the last axis, in a fifth of its time.
    """
    total = a[..., 0] * b[..., 0]
    for k in range(1, a.shape[-1]):
        total = total + a[..., k] * b[..., k]
    return np.asarray(total)


def cross(a: Floats[Float], b: Floats[Float]) -> Floats[Float]:
    """Cross products (..., 3) of vectors (..., 3), in a third of the time of np.cross."""
    x, y, z = a[..., 0], a[..., 1], a[..., 2]
    p, q, r = b[..., 0], b[..., 1], b[..., 2]
    first = y * r - z * q
    products = np.empty((*first.shape, 3), dtype=first.dtype)
    products[..., 0], products[..., 1], products[..., 2] = first, z * p - x * r, x * q - y * p
    return products


def multiply(p: Floats[Float], q: Floats[Float]) -> Floats[Float]:
    """Hamilton product p q (..., 4) of quaternions (..., 4): the rotation q followed, in the world frame, by the rotation p."""
    pw, px, py, pz = (p[..., part] for part in range(4))
    qw, qx, qy, qz = (q[..., part] for part in range(4))
    return np.stack(
        [
            pw * qw - px * qx - py * qy - pz * qz,
            pw * qx + px * qw + py * qz - pz * qy,
            pw * qy - px * qz + py * qw + pz * qx,
            pw * qz + px * qy - py * qx + pz * qw,
        ],
        axis=-1,
    )


def conjugate(q: Floats[Float]) -> Floats[Float]:
    """Conjugates (..., 4) of quaternions (..., 4): the inverse rotations if `q` has unit length."""
    return np.asarray(q * np.array([1, -1, -1, -1], dtype=q.dtype))


def normalise(q: Floats[Float]) -> Floats[Float]:
    """Quaternions (..., 4) scaled to unit length; NaN where the length is zero."""
    return np.asarray(q / np.sqrt(dot(q, q))[..., None])


def about(axis: Floats[Float], angle: Floats[Float]) -> Floats[Float]:
    """Unit quaternions (n, 4) of rotations about unit axes (n, 3), or about one axis (3,), by angles (n,), in rad."""
    half = angle / 2
    return np.concatenate([np.cos(half)[:, None], np.sin(half)[:, None] * axis], axis=1)


def rotate(q: Floats[Float], v: Floats[Float]) -> Floats[Float]:
    """World components (..., 3) of vectors v (..., 3) in the body frame, for unit quaternions q (..., 4), body to world."""
    w, x, y, z = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    a, b, c = v[..., 0], v[..., 1], v[..., 2]
    # Twice the cross product of the quaternion's vector and v. Components take a third of the time of np.cross.
    r, s, t = 2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)
    return np.stack(
        [a + w * r + (y * t - z * s), b + w * s + (z * r - x * t), c + w * t + (x * s - y * r)],
        axis=-1,
    )


def geodesic_angle(p: Floats[Float], q: Floats[Float]) -> Floats[Float]:
    """Angle (...), rad, in [0, pi], of the single rotation between attitudes p and q (..., 4); p and -p are the same attitude.

    It is computed with atan2 from the relative quaternion, which is accurate near 0 and near pi, where the arccos of [G 2.26]
    loses half of the digits.
    """
    relative = multiply(conjugate(p), q)
    vector = relative[..., 1:]
    return np.asarray(2 * np.arctan2(np.sqrt(dot(vector, vector)), np.abs(relative[..., 0])))


def quaternion_from_euler(phi: Floats[Float], theta: Floats[Float], psi: Floats[Float]) -> Floats[Float]:
    """Unit quaternions of z-x-z Euler angles: the rotation A1 of [G 2.14].

    Parameters
    ----------
    phi, theta, psi
        (...) angles (rad), of one shape.

    Returns
    -------
    array
        (..., 4) quaternions w, x, y, z, body to world.
    """
    half_sum, half_difference, half_theta = (phi + psi) / 2, (phi - psi) / 2, theta / 2
    c, s = np.cos(half_theta), np.sin(half_theta)
    return np.stack(
        [c * np.cos(half_sum), s * np.cos(half_difference), s * np.sin(half_difference), c * np.sin(half_sum)], axis=-1
    )


def euler_from_quaternion(q: Floats[Float]) -> tuple[Floats[Float], Floats[Float], Floats[Float]]:
    """The z-x-z Euler angles (phi, theta, psi), each (...), rad, of unit quaternions (..., 4); theta is in [0, pi].

    Where theta = 0 only phi + psi is determined, and where theta = pi only phi - psi. In both cases phi = 0 and psi is the
    whole angle, which is the book's convention [G p. 45].
    """
    w, x, y, z = np.moveaxis(q, -1, 0)
    sin_half, cos_half = np.hypot(x, y), np.hypot(w, z)
    half_sum = np.where(cos_half > 0, np.arctan2(z, w), 0)
    half_difference = np.where(sin_half > 0, np.arctan2(y, x), -half_sum)
    # Where theta = pi, phi - psi is determined, and the same convention makes psi the whole angle.
    half_sum = np.where(cos_half > 0, half_sum, -half_difference)
    return half_sum + half_difference, 2 * np.arctan2(sin_half, cos_half), half_sum - half_difference


def body_rates(
    theta: Floats[Float], psi: Floats[Float], dphi: Floats[Float], dtheta: Floats[Float], dpsi: Floats[Float]
) -> Floats[Float]:
    """Angular velocity in the body frame from Euler angles and their rates [G 2.21a].

    Parameters
    ----------
    theta, psi
        (...) angles (rad); the angle phi has no effect.
    dphi, dtheta, dpsi
        (...) rates of the angles (rad/s).

    Returns
    -------
    array
        (..., 3) angular velocity (rad/s) along I, J, K.
    """
    s, c = np.sin(theta), np.cos(theta)
    return np.stack(
        [
            dphi * s * np.sin(psi) + dtheta * np.cos(psi),
            dphi * s * np.cos(psi) - dtheta * np.sin(psi),
            dphi * c + dpsi,
        ],
        axis=-1,
    )


def euler_rates(
    theta: Floats[Float], psi: Floats[Float], angular_velocity: Floats[Float]
) -> tuple[Floats[Float], Floats[Float], Floats[Float]]:
    """Rates of the Euler angles from the angular velocity in the body frame: the inverse of [G 2.21a].

    The rates are singular where sin(theta) = 0; the caller avoids this, for instance by a change of chart.

    Parameters
    ----------
    theta, psi
        (...) angles (rad).
    angular_velocity
        (..., 3) angular velocity (rad/s) along I, J, K.

    Returns
    -------
    tuple of arrays
        dphi, dtheta, dpsi, each (...), rad/s.
    """
    x, y, z = np.moveaxis(angular_velocity, -1, 0)
    dphi = (x * np.sin(psi) + y * np.cos(psi)) / np.sin(theta)
    return dphi, x * np.cos(psi) - y * np.sin(psi), z - dphi * np.cos(theta)
