"""The rolling coin by Newton's and Euler's equations with a quaternion: the witness of the Euler angles.

With rho from the centre of mass to the rim's lowest point and omega the angular velocity, all along the axes of the body, the
centre of a rolling coin has the velocity rho x omega. The force F at the rim, per unit of mass, is the acceleration of the
centre minus the gravitational acceleration, and its moment rho x F turns the body:

    I omega' - rho x (rho x omega') = I omega x omega + rho x (rho' x omega + g z)

Here rho' is the rate of change of rho relative to the world.
"""

import numpy as np

from bodycheck.reference.contact.coin.start import Coin
from bodycheck.reference.integration.collocation import Derivatives
from bodycheck.reference.kinematics import conjugate, cross, multiply, normalise, rotate
from bodycheck.reference.witness import WideArray

_Vectors = tuple[WideArray, WideArray, WideArray]


def initial(coin: Coin) -> WideArray:
    """The state (10,) of a coin at its start: attitude (4), angular velocity (3) along its axes, position (3)."""
    return np.concatenate([coin.quaternion, coin.spin, coin.position])


def equations(coin: Coin) -> Derivatives:
    """The derivatives (n, 10) of states (n, 10)."""

    def derivatives(states: WideArray) -> WideArray:
        turning, velocity, _ = accelerated(coin, states)
        quaternion = normalise(states[:, :4])
        rates = np.concatenate([np.zeros_like(states[:, :1]), states[:, 4:7]], axis=1)
        # The length of the quaternion has no effect above, and does not change.
        return np.concatenate([multiply(states[:, :4], rates) / 2, turning, rotate(quaternion, velocity)], axis=1)

    return derivatives


def accelerated(coin: Coin, states: WideArray) -> _Vectors:
    """Angular acceleration, and velocity and acceleration of the centre of mass, each (n, 3), along the axes of the body."""
    moments = np.array([coin.across, coin.across, coin.along])
    omega = states[:, 4:7]
    upward = _upward(states)
    axis = np.zeros_like(omega)
    axis[:, 2] = 1
    steep = np.hypot(upward[:, :1], upward[:, 1:2])
    uphill = (upward - upward[:, 2:] * axis) / steep
    rho = -coin.half_length * axis - coin.radius * uphill
    turned = cross(omega, axis)
    slope_rate = (upward * turned).sum(axis=1, keepdims=True)
    uphill_rate = uphill * (upward[:, 2:] * slope_rate / steep**2) - (slope_rate * axis + upward[:, 2:] * turned) / steep
    rho_rate = -coin.half_length * turned - coin.radius * uphill_rate
    pushed = cross(rho_rate, omega) + coin.gravity * upward
    right = cross(moments * omega, omega) + cross(rho, pushed)
    turning = _solved(moments, rho, right)
    return turning, cross(rho, omega), cross(rho_rate, omega) + cross(rho, turning)


def forces(coin: Coin, states: WideArray) -> tuple[WideArray, WideArray]:
    """The tangential and the normal force (n,) of the plane, in units of the coin's weight, in states (n, 10)."""
    _, _, acceleration = accelerated(coin, states)
    upward = _upward(states)
    raised = (acceleration * upward).sum(axis=1)
    along = acceleration - raised[:, None] * upward
    return np.sqrt((along * along).sum(axis=1)) / coin.gravity, 1 + raised / coin.gravity


def poses(coin: Coin, states: WideArray) -> tuple[WideArray, WideArray, WideArray, WideArray]:
    """Positions (n, 3), velocities (n, 3), attitudes (n, 4), and angular velocities (n, 3) along the body's axes, of states."""
    quaternion = normalise(states[:, :4])
    _, velocity, _ = accelerated(coin, states)
    return states[:, 7:], rotate(quaternion, velocity), quaternion, states[:, 4:7]


def _upward(states: WideArray) -> WideArray:
    """The vertical (n, 3) along the axes of the body."""
    up = np.zeros_like(states[:, :3])
    up[:, 2] = 1
    return np.asarray(rotate(conjugate(normalise(states[:, :4])), up))


def _solved(moments: WideArray, rho: WideArray, right: WideArray) -> WideArray:
    """The solution a (n, 3) of I a - rho x (rho x a) = right, for moments (3,) of inertia.

    The matrix is the diagonal matrix of moments + rho^2 minus the product rho rho^T, so that its inverse is known (Sherman and
    Morrison).
    """
    diagonal = moments + (rho * rho).sum(axis=1, keepdims=True)
    one, other = right / diagonal, rho / diagonal
    share = (rho * one).sum(axis=1, keepdims=True) / (1 - (rho * other).sum(axis=1, keepdims=True))
    solution: WideArray = one + share * other
    return solution
