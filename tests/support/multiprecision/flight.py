"""The motion of the body in a case file: free flight, with the numbers of the file and nothing rounded."""

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass

from tests.support.multiprecision.arithmetic import MP, Matrix, Real, Vector, dot, real, vector
from tests.support.multiprecision.attitudes import from_euler_zxz, from_quaternion, quaternion, rates_in_body
from tests.support.multiprecision.inertia import Table, mass_and_inertia
from tests.support.multiprecision.rotation import rotation


@dataclass(frozen=True)
class Moment:
    """The state of a body at one instant.

    Attributes
    ----------
    position, velocity
        Of the centre of mass, in the world (m, m/s), as vectors (3, 1).
    attitude
        Rotation matrix (3, 3), from the body frame of the file to the world.
    angular_velocity
        In the body frame of the file (rad/s), as a vector (3, 1).
    """

    position: Vector
    velocity: Vector
    attitude: Matrix
    angular_velocity: Vector

    @property
    def quaternion(self) -> list[Real]:
        """The attitude as a unit quaternion w, x, y, z; its sign is arbitrary."""
        return quaternion(self.attitude)


@dataclass(frozen=True)
class Flight:
    """A body in free flight.

    Attributes
    ----------
    mass
        Mass (kg).
    inertia
        Inertia tensor (3, 3) about the centre of mass, along the axes of the body frame of the file (kg m^2).
    gravity
        Along -z (m/s^2).
    start
        State at t = 0.
    """

    mass: Real
    inertia: Matrix
    gravity: Real
    start: Moment

    @property
    def energy(self) -> Real:
        """The energy (J), which is constant; the potential energy is counted from the start."""
        spin = self.start.angular_velocity
        kinetic = self.mass * dot(self.start.velocity, self.start.velocity) + dot(spin, self.inertia * spin)
        return kinetic / 2

    @property
    def angular_momentum(self) -> Vector:
        """The angular momentum about the centre of mass in the world (kg m^2/s), which is constant."""
        return self.start.attitude * (self.inertia * self.start.angular_velocity)

    def motion(self, times: Sequence[float]) -> list[Moment]:
        """The states at times (s), in any order."""
        turns = rotation(self.inertia, self.start.attitude, self.start.angular_velocity, times)
        return [Moment(*self._translation(MP.mpf(t)), *turn) for t, turn in zip(times, turns, strict=True)]

    def _translation(self, t: Real) -> tuple[Vector, Vector]:
        """Position and velocity of the centre of mass at time t: the parabola."""
        fall = vector([0, 0, -self.gravity])
        return self.start.position + self.start.velocity * t + fall * (t * t / 2), self.start.velocity + fall * t


def read(text: str) -> Flight:
    """The body in free flight that the text of a case file describes. Raises `ValueError` for a plane or drag."""
    document = tomllib.loads(text)
    scene, initial = document.get("scene", {}), document.get("initial", {})
    if "plane" in scene or scene.get("drag", {}).get("quadratic"):
        raise ValueError("the body is not in free flight")
    mass, inertia = mass_and_inertia(document["body"])
    return Flight(mass, inertia, real(scene.get("gravity", 0.0)), _start(initial))


def _start(initial: Table) -> Moment:
    """The state at t = 0 that the table [initial] of a case file states."""
    angles = [real(angle) for angle in initial.get("euler_zxz", (0.0, 0.0, 0.0))]
    stated = initial.get("quaternion")
    attitude = from_euler_zxz(angles) if stated is None else from_quaternion([real(part) for part in stated])
    if "euler_rates" in initial:
        rates = rates_in_body(attitude, angles[2] if stated is None else None, [real(rate) for rate in initial["euler_rates"]])
    else:
        rates = vector(map(real, initial.get("angular_velocity", (0.0, 0.0, 0.0))))
    position, velocity = (vector(map(real, initial.get(key, (0.0, 0.0, 0.0)))) for key in ("position", "velocity"))
    return Moment(position, velocity, attitude, rates)
