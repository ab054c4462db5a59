"""The physical content of a case: a body, its initial state and its surroundings, in SI units.

World frame: z up, gravity along -z. Body frame: axes I, J, K through the centre of mass, principal unless a body says else.
Plain tuples of floats, so that a scene is immutable, hashable and cheap to send to another process.
"""

from dataclasses import dataclass
from typing import Literal

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


@dataclass(frozen=True)
class Brick:
    """Rectangular block of half-lengths a, b, c along I, J, K (m)."""

    semi_axes: Vector


@dataclass(frozen=True)
class Ellipsoid:
    """Solid ellipsoid of semi-axes a, b, c along I, J, K (m)."""

    semi_axes: Vector


@dataclass(frozen=True)
class Cylinder:
    """Solid circular cylinder about K (m)."""

    radius: float
    half_length: float


@dataclass(frozen=True)
class Sphere:
    """Solid sphere (m)."""

    radius: float


Shape = Brick | Ellipsoid | Cylinder | Sphere


@dataclass(frozen=True)
class Body:
    """A rigid body: mass (kg), principal moments A, B, C (kg m^2), and its shape where it has one.

    axes: unit quaternion (w, x, y, z) that takes components along the principal axes to the body frame, whose axes are I, J, K.
    """

    mass: float
    moments: Vector
    shape: Shape | None = None
    axes: Quaternion = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class State:
    """Where a body is and how it moves.

    position: of the centre of mass, world frame (m). quaternion: unit, (w, x, y, z), takes body to world components.
    velocity: of the centre of mass, world frame (m/s). angular_velocity: body frame (rad/s).
    """

    position: Vector = (0.0, 0.0, 0.0)
    quaternion: Quaternion = (1.0, 0.0, 0.0, 0.0)
    velocity: Vector = (0.0, 0.0, 0.0)
    angular_velocity: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Plane:
    """The plane z = 0 with Coulomb friction; `law` and `pressure` say what the truth models."""

    friction: float = 0.0
    law: Literal["area", "corners", "decoupled"] = "area"
    pressure: Literal["uniform", "balanced"] = "uniform"


@dataclass(frozen=True)
class Scene:
    """One body in its surroundings: gravity (m/s^2), a plane to lie on, quadratic drag (kg/m, F = -k |v| v)."""

    body: Body
    initial: State
    gravity: float = 0.0
    plane: Plane | None = None
    drag: float = 0.0

    @property
    def conserves(self) -> bool:
        """Whether energy and angular momentum stay what they are: neither friction nor drag acts."""
        return self.plane is None and not self.drag
