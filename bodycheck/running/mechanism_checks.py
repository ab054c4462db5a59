"""What is checked of the states of a run of a mechanism: that they are possible, begin as the scene does, and change."""

import numpy as np

from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.observables import masses, observe
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.results.outcome import AdapterFault, Diverged
from bodycheck.running.body_checks import DIVERGED_ENERGY_RATIO, START_TOLERANCE, VISIBLE_MOTION


def divergence(mechanism: Mechanism, trajectory: Trajectory) -> Diverged | None:
    """Find the first instant at which a state is not finite or has an impossible kinetic energy; None if there is none."""
    t, states = trajectory.t, _states(trajectory)
    finite = np.isfinite(states).all(axis=(0, 2))
    if not finite.all():
        return Diverged(f"not a number at t = {t[np.argmin(finite)]:.6g} s", trajectory=trajectory)
    with np.errstate(all="ignore"):  # states that cannot be may overflow
        kinetic = observe(mechanism, trajectory).kinetic_energy
        most = _largest_kinetic_energy(mechanism, trajectory)
    beyond = kinetic > DIVERGED_ENERGY_RATIO * most
    if most > 0 and beyond.any():
        first = int(np.argmax(beyond))
        reason = f"kinetic energy {kinetic[first] / most:.3g} times the most possible at t = {t[first]:.6g} s"
        return Diverged(reason, trajectory=trajectory)
    return None


def check_start(mechanism: Mechanism, trajectory: Trajectory) -> None:
    """Raise `AdapterFault` if the run does not begin at the state of the mechanism, as with a wrong frame or order."""
    if trajectory.t[0] != 0:
        return
    initial = kinematics.initial(mechanism)
    for place, body in enumerate(mechanism.bodies):
        got, asked = trajectory.body(place), initial.body(place)
        pairs = {
            "position": (got.position[0], asked.position[0]),
            "velocity": (got.velocity[0], asked.velocity[0]),
            "angular velocity": (got.angular_velocity[0], asked.angular_velocity[0]),
        }
        for name, (one, other) in pairs.items():
            if np.linalg.norm(one - other) > START_TOLERANCE * max(1.0, float(np.linalg.norm(other))):
                raise AdapterFault(f"at t = 0 the {name} of the body {body.name} is {one.tolist()}, not {other.tolist()}")
        turned = float(geodesic_angle(got.quaternion[0], asked.quaternion[0]))
        if turned > START_TOLERANCE:
            raise AdapterFault(f"at t = 0 the attitude of the body {body.name} is {turned:.3g} rad from that of the scene")


def standstill(trajectory: Trajectory, timestep: float) -> Diverged | None:
    """Return `Diverged` if the states are equal to the last bit at all samples although a body must move; else None.

    With velocity v a position changes by v h in a step h, and with spin w an attitude turns by |w| h, for any forces. Motion
    that rounding can hide and full turns between samples do not count. A mechanism at rest may be in equilibrium.
    """
    states = _states(trajectory)
    if len(trajectory) < 2 or (states != states[:, :1]).any():
        return None
    first = trajectory.part(slice(0, 1))
    spin = np.linalg.norm(first.angular_velocity, axis=-1)
    with np.errstate(all="ignore"):  # numbers that overflow are not judged
        moves = (np.abs(first.velocity) * timestep > VISIBLE_MOTION * np.abs(first.position)).any()
        partly = np.abs(np.sin(spin * np.diff(trajectory.t) / 2)) > VISIBLE_MOTION
        turns = ((spin * timestep > VISIBLE_MOTION) & partly).any()
    if not (moves or turns):
        return None
    return Diverged("the state never changes although bodies move", trajectory=trajectory)


def _states(trajectory: Trajectory) -> Array:
    """Return the states (b, n, 13) of a trajectory."""
    parts = (trajectory.position, trajectory.quaternion, trajectory.velocity, trajectory.angular_velocity)
    return np.concatenate(parts, axis=-1)


def _largest_kinetic_energy(mechanism: Mechanism, trajectory: Trajectory) -> float:
    """Return an upper bound of the kinetic energy (J) in the whole run.

    Let E be the kinetic energy and that of the springs. Gravity works at the rate -g P_z, which is at most g sqrt(2 M E) with
    the mass M of all bodies, so that sqrt(E) grows by at most g sqrt(M / 2) a second. Constant efforts add at most what they
    did over the largest displacements of the run. Damping and friction only take away.
    """
    seen = observe(mechanism, kinematics.initial(mechanism))
    springs = sum(joint.stiffness * (joint.start[0] - joint.rest) ** 2 / 2 for joint in mechanism.joints if joint.stiffness)
    mass, duration = float(masses(mechanism).sum()), float(trajectory.t[-1])
    held = np.sqrt(seen.kinetic_energy[0] + springs) + mechanism.gravity * np.sqrt(mass / 2) * duration
    return float(held**2) + _work_of_efforts(mechanism, trajectory)


def _work_of_efforts(mechanism: Mechanism, trajectory: Trajectory) -> float:
    """Return the work (J) of the constant efforts over the largest displacements of a run."""
    if not any(joint.effort for joint in mechanism.joints):
        return 0.0
    motion = kinematics.joints(mechanism, trajectory).position
    own = zip(mechanism.joints, places(mechanism), strict=True)
    moved = (abs(joint.effort) * np.abs(motion[:, held] - joint.start[0]).max() for joint, (held, _) in own if joint.effort)
    return float(sum(moved))
