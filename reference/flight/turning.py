"""The result of every closed form of a rotation without torque."""

from dataclasses import dataclass, replace
from typing import Any

from bodycheck.reference.kinematics import conjugate, multiply, normalise
from bodycheck.reference.trajectory import Array


@dataclass(frozen=True, eq=False)
class Turning:
    """A rotation at n instants, along the principal axes of the body, or the rotations of m bodies with leading axes (m,).

    Attributes
    ----------
    attitude
        (..., n, 4) unit quaternions w, x, y, z, from the principal axes to the world.
    angular_velocity
        (..., n, 3) angular velocity along the principal axes (rad/s).
    amplitude
        (..., 3) largest size of each component of the angular velocity over all time (rad/s).
    first_angle, angle_rate
        (...) the angle at t = 0 (rad) and the sum of the rates (rad/s) of the angles that were reduced to one turn; the error
        of the rotation grows with them.
    """

    attitude: Array
    angular_velocity: Array
    amplitude: Array
    first_angle: Any
    angle_rate: Any


def placed(turning: Turning, attitude: Array) -> Turning:
    """Return a rotation turned so that it starts from a given attitude at t = 0, its first instant, which is left out.

    attitude: (..., 4) quaternions of any length, from the principal axes to the world.
    """
    first = multiply(normalise(attitude), conjugate(turning.attitude[..., 0, :]))[..., None, :]
    rest = turning.attitude[..., 1:, :], turning.angular_velocity[..., 1:, :]
    return replace(turning, attitude=multiply(first, rest[0]), angular_velocity=rest[1])
