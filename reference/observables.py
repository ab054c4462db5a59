"""Energies and angular momentum of a trajectory, by the same formulas for the truth and for every engine [G 2.32-2.34]."""

from dataclasses import dataclass

from bodycheck.reference.inertia import angular_momentum
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array, Trajectory


@dataclass(frozen=True, eq=False)
class Observables:
    """Energies and angular momenta of a body at n instants.

    Attributes
    ----------
    translational_energy, rotational_energy, potential_energy
        (n,) energies (J); the potential energy is counted from the height of the scene's initial position, so that it does not
        depend on where the origin is.
    angular_momentum, body_angular_momentum
        (n, 3) angular momentum about the centre of mass (kg m^2/s), in the world frame and in the body frame.
    """

    translational_energy: Array
    rotational_energy: Array
    potential_energy: Array
    angular_momentum: Array
    body_angular_momentum: Array

    @property
    def kinetic_energy(self) -> Array:
        """Kinetic energy (n,), J."""
        return self.translational_energy + self.rotational_energy

    @property
    def total_energy(self) -> Array:
        """Kinetic and potential energy together (n,), J."""
        return self.kinetic_energy + self.potential_energy


def observe(scene: Scene, trajectory: Trajectory) -> Observables:
    """Energies and angular momenta of a scene's body at every instant of a trajectory."""
    body = scene.body
    momentum = angular_momentum(body, trajectory.angular_velocity)
    return Observables(
        translational_energy=body.mass * (trajectory.velocity**2).sum(axis=1) / 2,
        rotational_energy=(momentum * trajectory.angular_velocity).sum(axis=1) / 2,
        potential_energy=body.mass * scene.gravity * (trajectory.position[:, 2] - scene.initial.position[2]),
        angular_momentum=rotate(trajectory.quaternion, momentum),
        body_angular_momentum=momentum,
    )
