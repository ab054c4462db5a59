"""The physical content of a case: one rigid body, its initial state and its surroundings, in SI units.

World frame: z points up and gravity acts along -z. Body frame: axes I, J, K through the centre of mass; they are the principal
axes unless `Body.axes` says otherwise. Scenes are made of plain tuples of floats, so that a scene is immutable, hashable and
cheap to send to another process.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, SupportsFloat

if TYPE_CHECKING:
    from bodycheck.reference.definition import Definition

#: Three components, in the unit and the frame that the context states.
Vector = tuple[float, float, float]

#: The components w, x, y, z of a quaternion.
Quaternion = tuple[float, float, float, float]


def vector_of(components: Iterable[SupportsFloat]) -> Vector:
    """Three components as doubles, such as those of an array (3,) of any floating-point type."""
    x, y, z = components
    return float(x), float(y), float(z)


@dataclass(frozen=True)
class Brick:
    """Homogeneous rectangular block; `semi_axes` are its half-lengths a, b, c along I, J, K (m)."""

    semi_axes: Vector


@dataclass(frozen=True)
class Ellipsoid:
    """Homogeneous ellipsoid; `semi_axes` are a, b, c along I, J, K (m)."""

    semi_axes: Vector


@dataclass(frozen=True)
class Cylinder:
    """Homogeneous circular cylinder about K, with its radius and half its length along K (m)."""

    radius: float
    half_length: float


@dataclass(frozen=True)
class Sphere:
    """Homogeneous sphere, with its radius (m)."""

    radius: float


#: Every shape that a body can have.
Shape = Brick | Ellipsoid | Cylinder | Sphere


@dataclass(frozen=True)
class Body:
    """A rigid body.

    Attributes
    ----------
    mass
        Mass (kg).
    moments
        Principal moments of inertia A, B, C (kg m^2).
    shape
        Shape, or None where only mass and moments are given; only a body with a shape can touch the plane.
    axes
        Unit quaternion (w, x, y, z) that rotates components along the principal axes to components in the body frame.
    """

    mass: float
    moments: Vector
    shape: Shape | None = None
    axes: Quaternion = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class State:
    """Pose and velocity of a body at one instant.

    Attributes
    ----------
    position
        Position of the centre of mass, world frame (m).
    quaternion
        Unit quaternion (w, x, y, z) that rotates body components to world components.
    velocity
        Velocity of the centre of mass, world frame (m/s).
    angular_velocity
        Angular velocity, body frame (rad/s).
    """

    position: Vector = (0.0, 0.0, 0.0)
    quaternion: Quaternion = (1.0, 0.0, 0.0, 0.0)
    velocity: Vector = (0.0, 0.0, 0.0)
    angular_velocity: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Plane:
    """A plane through the origin with Coulomb friction: z = 0, or this turned about y.

    Attributes
    ----------
    friction
        Coefficient of friction mu; infinite where nothing slips.
    law
        The law of friction of the truth: over the whole face of the body ("area"), at its corners alone ("corners"), or the
        book's law, in which translation and spin are braked independently of each other ("decoupled").
    pressure
        The distribution of the load over the face: the same everywhere ("uniform"), or shifted so that it balances the moment
        of friction about the centre of mass ("balanced").
    incline
        The angle by which z = 0 is turned about y (rad): x points downhill.
    restitution
        Coefficient of restitution e: the ratio of the normal velocities after and before an impact.
    """

    friction: float = 0.0
    law: Literal["area", "corners", "decoupled"] = "area"
    pressure: Literal["uniform", "balanced"] = "uniform"
    incline: float = 0.0
    restitution: float = 0.0

    @property
    def normal(self) -> Vector:
        """The unit normal of the plane, out of it."""
        return math.sin(self.incline), 0.0, math.cos(self.incline)


@dataclass(frozen=True)
class Push:
    """A constant force on a body for some time.

    Attributes
    ----------
    force
        The force, world frame (N).
    point
        Where it acts, from the centre of mass along the axes of the body's frame (m).
    start, end
        From when until when it acts (s).
    body
        The place of the body among those of the scene.
    """

    force: Vector
    point: Vector = (0.0, 0.0, 0.0)
    start: float = 0.0
    end: float = math.inf
    body: int = 0


@dataclass(frozen=True)
class Scene:
    """One body in its surroundings.

    Attributes
    ----------
    body
        The body.
    initial
        Its state at t = 0.
    gravity
        Magnitude of the gravitational acceleration, along -z (m/s^2).
    plane
        The plane that the body lies on, or None for free flight.
    drag
        Coefficient c (kg/m) of the quadratic drag F = -c |v| v at the centre of mass.
    pushes
        Constant forces on the body.
    definition
        What the case file says of the body and its initial rotation, of which the doubles of `body` and `initial` are the
        nearest; None where these are all that is known. It counts only as long as they are the ones that follow from it, so
        that a scene in which they are replaced is the scene of the new numbers; see `exact.start`.
    """

    body: Body
    initial: State
    gravity: float = 0.0
    plane: Plane | None = None
    drag: float = 0.0
    pushes: tuple[Push, ...] = ()
    definition: "Definition | None" = None

    @property
    def conserves(self) -> bool:
        """Whether energy and angular momentum about the centre of mass are conserved: there are no plane, drag and pushes."""
        return self.plane is None and not self.drag and not self.pushes
