"""Energies and momenta of a mechanism, by the same formulas for the truth and for every engine."""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.kinematics import dot, rotate
from bodycheck.reference.mechanisms import exact, kinematics
from bodycheck.reference.mechanisms.control import Stops
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism
from bodycheck.reference.trajectory import Array, Trajectory


@dataclass(frozen=True, eq=False)
class MechanismObservables:
    """Energies and momenta of a mechanism at n instants.

    Attributes
    ----------
    kinetic_energy
        (n,) kinetic energy of the bodies and of the armatures (J).
    potential_energy
        (n,) potential energy (J) of gravity, springs, elastic stops and constant efforts. The energy of gravity is zero at the
        initial heights and the energy of efforts at the initial coordinates, so that both are independent of the origin. The
        energy of an elastic stop is that of its spring wherever the coordinate is beyond the stop. Controllers have none.
    momentum
        (n, 3) linear momentum, world (kg m/s).
    angular_momentum
        (n, 3) angular momentum of the bodies about their common centre of mass, world (kg m^2/s).
    """

    kinetic_energy: Array
    potential_energy: Array
    momentum: Array
    angular_momentum: Array

    @property
    def total_energy(self) -> Array:
        """The sum of kinetic and potential energy (n,), J."""
        return self.kinetic_energy + self.potential_energy


def observe(mechanism: Mechanism, trajectory: Trajectory) -> MechanismObservables:
    """The energies and momenta of a mechanism at every instant of a trajectory (b, n, ...)."""
    mass = masses(mechanism)[:, None]
    tensors = np.stack([tensor(body) for body in mechanism.bodies])
    spin = np.einsum("bij,bnj->bni", tensors, trajectory.angular_velocity)
    kinetic = mass * dot(trajectory.velocity, trajectory.velocity) + dot(spin, trajectory.angular_velocity)
    turning, stored = _of_joints(mechanism, trajectory)
    heights = trajectory.position[..., 2] - kinematics.initial(mechanism).position[..., 2]
    momenta = mass[..., None] * trajectory.velocity
    momentum, whole = momenta.sum(axis=0), mass.sum() or 1.0  # bodies without mass have no momentum
    centre = (mass[..., None] * trajectory.position).sum(axis=0) / whole
    orbital = np.cross(trajectory.position - centre, momenta - mass[..., None] * (momentum / whole))
    return MechanismObservables(
        kinetic_energy=kinetic.sum(axis=0) / 2 + turning,
        potential_energy=(mass * mechanism.gravity * heights).sum(axis=0) + stored,
        momentum=momentum,
        angular_momentum=(orbital + rotate(trajectory.quaternion, spin)).sum(axis=0),
    )


def floats(mechanism: Mechanism) -> bool:
    """Return whether nothing holds or pushes the mechanism, so that only gravity changes its linear momentum.

    Its angular momentum about the common centre of mass is then conserved, and without gravity also its linear momentum.
    """
    if mechanism.plane is not None or mechanism.pushes:
        return False
    held = any(joint.parent == WORLD and joint.form.transmits for joint in mechanism.joints)
    return not held and not any(WORLD in loop.bodies for loop in mechanism.loops)


def masses(mechanism: Mechanism) -> Array:
    """The masses (b,) of the bodies (kg)."""
    return np.array([exact.nearest_inertia(body).mass for body in mechanism.bodies])


def tensor(body: JointedBody) -> Array:
    """The inertia tensor (3, 3) of a body about its centre of mass, along its axes (kg m^2)."""
    xx, yy, zz, xy, xz, yz = exact.nearest_inertia(body).tensor
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _of_joints(mechanism: Mechanism, trajectory: Trajectory) -> tuple[Array, Array]:
    """The kinetic energy (n,), J, of armatures, and the potential energy (n,), J, of springs, elastic stops and efforts."""
    kinetic, potential = np.zeros(len(trajectory)), np.zeros(len(trajectory))
    if not any(has_energy(joint) for joint in mechanism.joints):
        return kinetic, potential
    motion = kinematics.joints(mechanism, trajectory)
    for joint, (held, moving) in zip(mechanism.joints, places(mechanism), strict=True):
        if not has_energy(joint):
            continue
        coordinate, rate = motion.position[:, held][:, 0], motion.velocity[:, moving][:, 0]
        kinetic += joint.armature * rate**2 / 2
        potential += joint.stiffness * (coordinate - joint.rest) ** 2 / 2 - joint.effort * (coordinate - joint.start[0])
        potential += _of_stops(joint, coordinate)
    return kinetic, potential


def has_energy(joint: Joint) -> bool:
    """Return whether a joint has an energy of its own."""
    return bool(joint.armature or joint.stiffness or joint.effort or (joint.stops is not None and joint.stops.stiffness))


def _of_stops(joint: Joint, coordinate: Array) -> Array:
    """The energy (n,), J, of the springs of elastic stops."""
    if joint.stops is None:
        return np.zeros_like(coordinate)
    return joint.stops.stiffness * stretch_of_stops(joint.stops, coordinate) ** 2 / 2


def stretch_of_stops(stops: Stops, coordinate: Array) -> Array:
    """The distance (n,) of a coordinate beyond a stop (rad or m); zero between the stops."""
    lower, upper = (limit if limit is not None else side * np.inf for side, limit in ((-1, stops.lower), (1, stops.upper)))
    return np.asarray(np.maximum(np.maximum(lower - coordinate, coordinate - upper), 0.0))
