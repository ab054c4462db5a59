"""What every closed form of a rotation without torque gives."""

from dataclasses import dataclass

from bodycheck.reference.trajectory import Array


@dataclass(frozen=True, eq=False)
class Turning:
    """A rotation at n instants, along the principal axes of the body.

    Attributes
    ----------
    attitude
        (n, 4) unit quaternions w, x, y, z, from the principal axes to the world.
    angular_velocity
        (n, 3) angular velocity along the principal axes (rad/s).
    amplitude
        (3,) largest size of each component of the angular velocity over all time (rad/s).
    first_angle, angle_rate
        The angle at t = 0 (rad) and the sum of the rates (rad/s) of the angles that were reduced to one turn; the error of the
        rotation grows with them.
    """

    attitude: Array
    angular_velocity: Array
    amplitude: Array
    first_angle: float
    angle_rate: float
