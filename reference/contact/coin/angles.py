"""The rolling coin by Appell's equations in z-x-z Euler angles, and the forces at its rim.

theta is the tilt of K against the vertical, between 0 (flat) and pi/2 (upright). The angular velocity has the components p
along the line of nodes n, q along e = K x n, which points up the coin's slope, and s along K. When the coin rolls on the circle
of radius r at the distance h from the centre of mass, the centre has the velocity (q h - s r, -p h, p r) along n, e, K, so that
p, q and s are quasi-velocities of all six coordinates. With kappa = q cot theta, the moments A = B and C per unit of mass, and
u = q h - s r,

    (A + r^2 + h^2) p' = A kappa q - C q s + r q u + h kappa u - r g cos theta + h g sin theta
    (A + h^2) q' - h r s' = C p s - A kappa p - h p (q r + kappa h)
    (C + r^2) s' - h r q' = r p (q r + kappa h)

(Appell, Rend. Circ. Mat. Palermo 14, 1900, for h = 0; the tests derive these equations from the Lagrangian).
"""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.contact.coin.start import Coin
from bodycheck.reference.integration.collocation import Derivatives
from bodycheck.reference.kinematics import euler_from_quaternion, quaternion_from_euler
from bodycheck.reference.witness import WideArray

#: The indices of the components of a state.
THETA, P, Q, S, PHI, PSI, X, Y = range(8)

#: The number of roundings of the angular velocity up to which q is zero at the start.
_ROUNDINGS = 4.0


@dataclass(frozen=True, eq=False)
class Accelerated:
    """The rates of change of p, q and s, and the acceleration of the centre of mass along n, e and K, as arrays (n,)."""

    p: WideArray
    q: WideArray
    s: WideArray
    acceleration: tuple[WideArray, WideArray, WideArray]


def initial(coin: Coin) -> WideArray:
    """The state (8,) of a coin at its start: `THETA`, `P`, `Q`, `S`, `PHI`, `PSI`, `X`, `Y`."""
    phi, theta, psi = euler_from_quaternion(coin.quaternion)
    along_i, along_j, along_k = coin.spin
    p = along_i * np.cos(psi) - along_j * np.sin(psi)
    q = along_i * np.sin(psi) + along_j * np.cos(psi)
    # Without this rounding, a coin that falls on its face comes close to it, but never lands.
    q = q if abs(q) > _ROUNDINGS * np.finfo(q.dtype).eps * np.sqrt(coin.spin @ coin.spin) else np.zeros_like(q)
    return np.array([theta, p, q, along_k, phi, psi, *coin.position[:2]], dtype=coin.position.dtype)


def accelerated(coin: Coin, states: WideArray) -> Accelerated:
    """The accelerations of a coin in states (n, 8)."""
    theta, p, q, s = states[:, THETA], states[:, P], states[:, Q], states[:, S]
    r, h, a, c, g = coin.radius, coin.half_length, coin.across, coin.along, coin.gravity
    cosine, sine = np.cos(theta), np.sin(theta)
    kappa, u = q * cosine / sine, q * h - s * r
    turned = q * r + kappa * h
    dp = q * (a * kappa - c * s) + turned * u + g * (h * sine - r * cosine)
    dp = dp / (a + r * r + h * h)
    right_q, right_s = p * (c * s - a * kappa - h * turned), r * p * turned
    determinant = a * c + a * r * r + c * h * h
    dq = ((c + r * r) * right_q + h * r * right_s) / determinant
    ds = (h * r * right_q + (a + h * h) * right_s) / determinant
    acceleration = (
        h * dq - r * ds + p * turned,
        kappa * u - h * dp - r * p * p,
        r * dp - h * p * p - q * u,
    )
    return Accelerated(dp, dq, ds, acceleration)


def equations(coin: Coin) -> Derivatives:
    """The derivatives (n, 8) of states (n, 8)."""

    def derivatives(states: WideArray) -> WideArray:
        spin_rates = accelerated(coin, states)
        theta, p, q, s, phi = (states[:, part] for part in (THETA, P, Q, S, PHI))
        cosine, sine, dphi = np.cos(theta), np.sin(theta), q / np.sin(theta)
        along, outward = q * coin.half_length - s * coin.radius, p * (coin.half_length * cosine + coin.radius * sine)
        to_x, to_y = np.cos(phi), np.sin(phi)
        return np.stack(
            [
                p,
                spin_rates.p,
                spin_rates.q,
                spin_rates.s,
                dphi,
                s - dphi * cosine,
                along * to_x + outward * to_y,
                along * to_y - outward * to_x,
            ],
            axis=1,
        )

    return derivatives


def forces(coin: Coin, states: WideArray) -> tuple[WideArray, WideArray]:
    """The tangential and the normal force (n,) of the plane, in units of the coin's weight, in states (n, 8)."""
    along, up, out = accelerated(coin, states).acceleration
    cosine, sine = np.cos(states[:, THETA]), np.sin(states[:, THETA])
    tangential = np.hypot(along, out * sine - up * cosine)
    return tangential / coin.gravity, 1 + (up * sine + out * cosine) / coin.gravity


def poses(coin: Coin, states: WideArray) -> tuple[WideArray, WideArray, WideArray, WideArray]:
    """Positions (n, 3), velocities (n, 3), attitudes (n, 4), and angular velocities (n, 3) along the body's axes, of states."""
    theta, p, q, s, phi, psi = (states[:, part] for part in (THETA, P, Q, S, PHI, PSI))
    r, h = coin.radius, coin.half_length
    cosine, sine = np.cos(theta), np.sin(theta)
    rates = equations(coin)(states)
    position = np.stack([states[:, X], states[:, Y], h * cosine + r * sine], axis=1)
    velocity = np.stack([rates[:, X], rates[:, Y], p * (r * cosine - h * sine)], axis=1)
    spin = np.stack([p * np.cos(psi) + q * np.sin(psi), q * np.cos(psi) - p * np.sin(psi), s], axis=1)
    return position, velocity, quaternion_from_euler(phi, theta, psi), spin
