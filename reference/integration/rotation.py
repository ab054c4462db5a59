"""A rotation in a floating-point type that may be wider than double precision."""

from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

#: An array of a wide type; the types of heyoka are not NumPy's own floating-point types.
WideArray = NDArray[Any]


@dataclass(frozen=True, eq=False)
class Rotation:
    """Attitudes and angular velocities at n instants, in a wide type.

    Attributes
    ----------
    quaternion
        (n, 4) unit quaternions w, x, y, z, body to world.
    angular_velocity
        (n, 3) angular velocities in the body frame (rad/s).
    """

    quaternion: WideArray
    angular_velocity: WideArray
