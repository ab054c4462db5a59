"""Energies and angular momentum of one body, by the same formulas for the truth and for every engine [G 2.32-2.34]."""

from dataclasses import dataclass

from bodycheck.reference.inertia import angular_momentum
from bodycheck.reference.kinematics import dot, rotate
from bodycheck.reference.scene import Scene
from bodycheck.reference.scenes import Scenes
from bodycheck.reference.trajectory import Array, Trajectory


@dataclass(frozen=True, eq=False)
class Observables:
    """Energies and angular momenta of a body at n instants, or of the bodies of m scenes.

    Attributes
    ----------
    translational_energy, rotational_energy, potential_energy
        (n,) or (m, n) energies (J); the potential energy is counted from the height of the scene's initial position, so that it
        does not depend on where the origin is.
    angular_momentum, body_angular_momentum
        (n, 3) or (m, n, 3) angular momentum about the centre of mass (kg m^2/s), in the world frame and in the body frame.
    """

    translational_energy: Array
    rotational_energy: Array
    potential_energy: Array
    angular_momentum: Array
    body_angular_momentum: Array

    @property
    def kinetic_energy(self) -> Array:
        """Kinetic energy (n,) or (m, n), J."""
        return self.translational_energy + self.rotational_energy

    @property
    def total_energy(self) -> Array:
        """Kinetic and potential energy together (n,) or (m, n), J."""
        return self.kinetic_energy + self.potential_energy


def observe(scene: Scene | Scenes, trajectory: Trajectory) -> Observables:
    """Energies and angular momenta of a scene's body at every instant of a trajectory.

    Many scenes are observed at once, with trajectories that have the scenes as their first axis. Each is observed as if it were
    alone, to the last bit.
    """
    mass: float | Array
    weight: float | Array
    height: float | Array
    if isinstance(scene, Scene):
        mass, weight, height = scene.body.mass, scene.body.mass * scene.gravity, scene.initial.position[2]
        momentum = angular_momentum(scene.body, trajectory.angular_velocity)
    else:
        mass, weight, height = (each[:, None] for each in (scene.mass, scene.mass * scene.gravity, scene.position[:, 2]))
        momentum = scene.moments[:, None, :] * trajectory.angular_velocity
    return Observables(
        translational_energy=mass * dot(trajectory.velocity, trajectory.velocity) / 2,
        rotational_energy=dot(momentum, trajectory.angular_velocity) / 2,
        potential_energy=weight * (trajectory.position[..., 2] - height),
        angular_momentum=rotate(trajectory.quaternion, momentum),
        body_angular_momentum=momentum,
    )
