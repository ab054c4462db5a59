"""What a case file says of a body and of its initial rotation, before anything is computed from it.

The numbers are the doubles nearest to the decimals of the file, and they are meant exactly: the truth of a scene is the motion
of these numbers. `exact.start` computes what follows from them with many digits. Engines get the nearest doubles.
"""

from dataclasses import dataclass, field

from bodycheck.reference.scene import Quaternion, Scene, Shape, Vector


@dataclass(frozen=True)
class EulerAngles:
    """An attitude by the z-x-z Euler angles phi, theta and psi (rad)."""

    phi: float
    theta: float
    psi: float


#: An attitude: a quaternion w, x, y, z of any length, or Euler angles.
Attitude = Quaternion | EulerAngles


@dataclass(frozen=True)
class EulerRates:
    """An angular velocity by the rates of the z-x-z Euler angles, dphi, dtheta and dpsi (rad/s)."""

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
        Its centre of mass, in the frame of the body, from any origin (m).
    attitude
        Its axes in the frame of the body.
    """

    shape: Shape
    mass: float
    position: Vector = (0.0, 0.0, 0.0)
    attitude: Attitude = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Particle:
    """A point mass (kg), and its position in the frame of the body, from any origin (m)."""

    mass: float
    position: Vector


@dataclass(frozen=True)
class Tensor:
    """A mass (kg), and the rows of a symmetric inertia tensor about the centre of mass in the frame of the body (kg m^2)."""

    mass: float
    rows: tuple[Vector, Vector, Vector]


#: What a body is made of, in the frame of the body.
Given = Solid | Tensor | tuple[Particle, ...] | tuple[Solid, ...]


@dataclass(frozen=True)
class Nearest:
    """The doubles that the scene of a definition was given when it was made: see `scene.Body` and `scene.State`."""

    moments: Vector
    axes: Quaternion
    quaternion: Quaternion
    angular_velocity: Vector


@dataclass(frozen=True)
class Definition:
    """What the file says of the body and of its initial rotation.

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
        The doubles of the scene that was made of it; None before there is one.
    """

    inertia: Given
    attitude: Attitude = (1.0, 0.0, 0.0, 0.0)
    rotation: Vector | EulerRates = (0.0, 0.0, 0.0)
    nearest: Nearest | None = field(default=None, compare=False)


@dataclass(frozen=True)
class Valid:
    """Which parts of the definition of a scene the scene still has."""

    inertia: bool
    attitude: bool
    rotation: bool


def valid(scene: Scene) -> Valid:
    """Which parts of the definition of a scene the scene still has: those whose doubles are the ones that it was made with."""
    nearest = scene.definition.nearest if scene.definition is not None else None
    if nearest is None:
        return Valid(inertia=False, attitude=False, rotation=False)
    body, initial = scene.body, scene.initial
    return Valid(
        inertia=(body.moments, body.axes) == (nearest.moments, nearest.axes),
        attitude=initial.quaternion == nearest.quaternion,
        rotation=initial.angular_velocity == nearest.angular_velocity,
    )
