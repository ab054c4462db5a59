"""The physical content of a case: one rigid body, its initial state and its surroundings, in SI units.

World frame: z points up and gravity acts along -z. Body frame: axes I, J, K through the centre of mass; they are the principal
axes unless `Body.axes` says otherwise. Scenes are made of plain tuples of floats, so that a scene is immutable, hashable and
cheap to send to another process.

A `Definition` keeps what the case file says about the body and its initial rotation. Its numbers are the doubles nearest to the
decimals of the file, and they are taken as exact: the truth of a scene is the motion of these numbers. `exact.start` computes
what follows from them with many digits. Engines get the nearest doubles.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Literal, SupportsFloat

#: Three components, in the unit and the frame that the context states.
Vector = tuple[float, float, float]

#: The components w, x, y, z of a quaternion.
Quaternion = tuple[float, float, float, float]


def vector_of(components: Iterable[SupportsFloat]) -> Vector:
    """Convert three components, such as an array (3,) of any floating-point type, to a tuple of doubles."""
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


#: The set of the forces and moments of friction at a point of contact; see `Plane`.
Cone = Literal["product", "one"]


@dataclass(frozen=True)
class Plane:
    """A plane through the origin with Coulomb friction: the plane z = 0, or this plane turned about y.

    Attributes
    ----------
    friction
        Coefficient of friction mu; infinite if nothing slips.
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
    rolling_friction, torsional_friction
        The largest moments along the plane and about its normal, over the normal force (m).
    cone
        Whether friction and each of these moments have limits of their own ("product"), or one that they share ("one").
    """

    friction: float = 0.0
    law: Literal["area", "corners", "decoupled"] = "area"
    pressure: Literal["uniform", "balanced"] = "uniform"
    incline: float = 0.0
    restitution: float = 0.0
    rolling_friction: float = 0.0
    torsional_friction: float = 0.0
    cone: Cone = "product"

    @property
    def normal(self) -> Vector:
        """The unit normal of the plane, world frame; it points upwards out of the plane."""
        return math.sin(self.incline), 0.0, math.cos(self.incline)


@dataclass(frozen=True)
class Push:
    """A constant force that acts on a body for some time.

    Attributes
    ----------
    force
        The force, world frame (N).
    point
        The point where the force acts, relative to the centre of mass, body frame (m).
    start, end
        The instants at which the force sets in and ends (s).
    body
        The index of the body among the bodies of the scene.
    """

    force: Vector
    point: Vector = (0.0, 0.0, 0.0)
    start: float = 0.0
    end: float = math.inf
    body: int = 0


@dataclass(frozen=True)
class EulerAngles:
    """An attitude given by the z-x-z Euler angles phi, theta and psi (rad)."""

    phi: float
    theta: float
    psi: float


@dataclass(frozen=True)
class AlongPlane:
    """The attitude of a plane that is turned about y by its incline (rad), which no quaternion of doubles states exactly."""

    incline: float


#: An attitude: a quaternion w, x, y, z of any length, Euler angles, or the attitude of an inclined plane.
Attitude = Quaternion | EulerAngles | AlongPlane


@dataclass(frozen=True)
class EulerRates:
    """An angular velocity given by the rates of the z-x-z Euler angles, dphi, dtheta and dpsi (rad/s)."""

    dphi: float
    dtheta: float
    dpsi: float


@dataclass(frozen=True)
class Solid:
    """A homogeneous solid.

    Attributes
    ----------
    shape
        Its shape.
    mass
        Its mass (kg).
    position
        Its centre of mass, relative to any origin, along the axes of the body frame (m).
    attitude
        The attitude of its axes in the frame of the body.
    """

    shape: Shape
    mass: float
    position: Vector = (0.0, 0.0, 0.0)
    attitude: Attitude = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Particle:
    """A point mass (kg), and its position relative to any origin along the axes of the body frame (m)."""

    mass: float
    position: Vector


@dataclass(frozen=True)
class Tensor:
    """A mass (kg), and the rows of a symmetric inertia tensor about the centre of mass in the frame of the body (kg m^2)."""

    mass: float
    rows: tuple[Vector, Vector, Vector]


#: The data from which the inertia of a body follows, in the frame of the body.
Given = Solid | Tensor | tuple[Particle, ...] | tuple[Solid, ...]


@dataclass(frozen=True)
class Nearest:
    """The doubles of the scene that was made from a definition; for their meaning, see `Body` and `State`."""

    moments: Vector
    axes: Quaternion
    quaternion: Quaternion
    angular_velocity: Vector


@dataclass(frozen=True)
class Definition:
    """The body and its initial rotation as the file states them.

    Attributes
    ----------
    inertia
        A solid, which is alone and in the frame of the body; an inertia tensor; or the particles or solids that the body
        consists of.
    attitude
        The initial attitude of the body.
    rotation
        The initial angular velocity in the frame of the body (rad/s), or the rates of the Euler angles of the attitude.
    nearest
        The doubles of the scene that was made from this definition; None before a scene is made.
    """

    inertia: Given
    attitude: Attitude = (1.0, 0.0, 0.0, 0.0)
    rotation: Vector | EulerRates = (0.0, 0.0, 0.0)
    nearest: Nearest | None = field(default=None, compare=False)


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
        The body and its initial rotation as the case file states them; `body` and `initial` hold the nearest doubles. None if
        only the doubles are known. A part of the definition counts only while the scene still has the doubles made from it, so
        that a scene in which they are replaced is the scene of the new numbers; see `valid` and `exact.start`.
    """

    body: Body
    initial: State
    gravity: float = 0.0
    plane: Plane | None = None
    drag: float = 0.0
    pushes: tuple[Push, ...] = ()
    definition: Definition | None = None

    @property
    def conserves(self) -> bool:
        """True if energy and angular momentum about the centre of mass are conserved: there is no plane, drag or push."""
        return self.plane is None and not self.drag and not self.pushes


@dataclass(frozen=True)
class Valid:
    """The parts of a scene's definition that still count: True for each part whose doubles the scene still has."""

    inertia: bool
    attitude: bool
    rotation: bool


def valid(scene: Scene) -> Valid:
    """Return which parts of a scene's definition still count: the parts whose doubles the scene still has."""
    nearest = scene.definition.nearest if scene.definition is not None else None
    if nearest is None:
        return Valid(inertia=False, attitude=False, rotation=False)
    body, initial = scene.body, scene.initial
    return Valid(
        inertia=(body.moments, body.axes) == (nearest.moments, nearest.axes),
        attitude=initial.quaternion == nearest.quaternion,
        rotation=initial.angular_velocity == nearest.angular_velocity,
    )
