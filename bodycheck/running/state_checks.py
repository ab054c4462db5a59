"""Check that the states of a run are possible, begin at the initial state of the scene, and change."""

import math

import numpy as np

from bodycheck.figures.definition import observe
from bodycheck.reference.bodies import bodies, initial, of_bodies
from bodycheck.reference.inertia import angular_momentum
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.mechanisms.observables import masses
from bodycheck.reference.mechanisms.observables import observe as observe_mechanism
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.results.outcome import AdapterFault, Diverged

#: Smallest motion per step that is visible in single precision, relative to the position or in rad.
VISIBLE_MOTION = 1e-6

#: Largest deviation of a state at t = 0 from the state of the scene: an angle (rad), and for vectors relative to the larger of
#: their length and 1. Errors of single precision are below a tenth of it; a wrong axis, frame, sign or order of a quaternion
#: exceeds it.
START_TOLERANCE = 1e-4

#: A run has diverged if the ratio of its kinetic energy to the largest possible kinetic energy exceeds this.
DIVERGED_ENERGY_RATIO = 100.0


def divergence(scene: AnyScene, trajectory: Trajectory) -> Diverged | None:
    """Find the first instant at which a state is not finite or has an impossible kinetic energy; None if there is none."""
    t = trajectory.t
    finite = np.isfinite(_states(trajectory)).all(axis=(0, 2))
    if not finite.all():
        return Diverged(f"not a number at t = {t[np.argmin(finite)]:.6g} s", trajectory=trajectory)
    with np.errstate(all="ignore"):  # impossible states may overflow
        kinetic = observe(scene, trajectory).kinetic_energy
        most = _largest_kinetic_energy(scene, trajectory)
    beyond = kinetic > DIVERGED_ENERGY_RATIO * most
    if most > 0 and beyond.any():
        first = int(np.argmax(beyond))
        reason = f"kinetic energy {kinetic[first] / most:.3g} times the most possible at t = {t[first]:.6g} s"
        return Diverged(reason, trajectory=trajectory)
    return None


def check_start(scene: AnyScene, trajectory: Trajectory) -> None:
    """Raise `AdapterFault` if the run does not begin at the state of the scene, for example with a wrong frame."""
    if trajectory.t[0] != 0:
        return
    start, run = initial(scene), of_bodies(trajectory)
    for index, body in enumerate(bodies(scene)):
        subject = f"the {{}} of the body {body.name}" if isinstance(scene, Mechanism) else "its {}"
        got, asked = run.body(index), start.body(index)
        pairs = {
            "position": (got.position[0], asked.position[0]),
            "velocity": (got.velocity[0], asked.velocity[0]),
            "angular velocity": (got.angular_velocity[0], asked.angular_velocity[0]),
        }
        for name, (vector, exact) in pairs.items():
            if np.linalg.norm(vector - exact) > START_TOLERANCE * max(1.0, float(np.linalg.norm(exact))):
                raise AdapterFault(f"at t = 0 {subject.format(name)} is {vector.tolist()}, not {exact.tolist()}")
        angle = float(geodesic_angle(got.quaternion[0], asked.quaternion[0]))
        if angle > START_TOLERANCE:
            raise AdapterFault(f"at t = 0 {subject.format('attitude')} is {angle:.3g} rad from the attitude of the scene")


def standstill(scene: AnyScene, trajectory: Trajectory, timestep: float) -> Diverged | None:
    """Return `Diverged` if the states are equal to the last bit at all samples although a body must move; else None.

    With velocity v a position changes by v h in a step h, and with spin w an attitude turns by |w| h, whatever the forces. A
    single body at rest falls if nothing supports it; a mechanism at rest may be in equilibrium. Motions that rounding can hide,
    and full turns between samples, are not expected to change a state.
    """
    states = _states(trajectory)
    if len(trajectory) < 2 or (states != states[:, :1]).any():
        return None
    first = of_bodies(trajectory).part(slice(0, 1))
    spin = np.linalg.norm(first.angular_velocity, axis=-1)
    with np.errstate(all="ignore"):  # numbers that overflow are not judged
        moves = (np.abs(first.velocity) * timestep > VISIBLE_MOTION * np.abs(first.position)).any()
        partly = np.abs(np.sin(spin * np.diff(trajectory.t) / 2)) > VISIBLE_MOTION
        turns = ((spin * timestep > VISIBLE_MOTION) & partly).any()
    single = isinstance(scene, Scene)
    falls = single and scene.plane is None and scene.gravity > 0 and not first.velocity.any()
    if not (moves or turns or falls):
        return None
    subject = "the body moves" if single else "bodies move"
    return Diverged(f"the state never changes although {subject}", trajectory=trajectory)


def _states(trajectory: Trajectory) -> Array:
    """Return the states (b, n, 13) of a trajectory."""
    states = of_bodies(trajectory)
    return np.concatenate((states.position, states.quaternion, states.velocity, states.angular_velocity), axis=-1)


def _largest_kinetic_energy(scene: AnyScene, trajectory: Trajectory) -> float:
    """Return an upper bound of the kinetic energy (J) in the whole run."""
    duration = float(trajectory.t[-1])
    if isinstance(scene, Mechanism):
        return _largest_in_mechanism(scene, trajectory, duration)
    # A free body conserves its angular momentum, but a body in contact may turn about any of its axes. Its energy is at most
    # that of a fall for the whole duration and of a rotation about the axis of the least moment.
    speed = math.hypot(*scene.initial.velocity) + scene.gravity * duration
    momentum = math.hypot(*angular_momentum(scene.body, np.array(scene.initial.angular_velocity)))
    return scene.body.mass * speed**2 / 2 + momentum**2 / (2 * min(scene.body.moments))


def _largest_in_mechanism(mechanism: Mechanism, trajectory: Trajectory, duration: float) -> float:
    """Return an upper bound of the kinetic energy (J) of a mechanism in the whole run.

    Let E be the kinetic energy plus the energy of the springs. Gravity works at the rate -g P_z, which is at most g sqrt(2 M E)
    with the mass M of all bodies, so that sqrt(E) grows by at most g sqrt(M / 2) a second. Constant efforts add at most their
    work over the largest displacements of the run. Damping, friction and stops only remove energy. The work of controllers has
    no bound.
    """
    if mechanism.controllers:
        return math.inf
    seen = observe_mechanism(mechanism, initial(mechanism))
    springs = sum(joint.stiffness * (joint.start[0] - joint.rest) ** 2 / 2 for joint in mechanism.joints if joint.stiffness)
    growth = mechanism.gravity * np.sqrt(float(masses(mechanism).sum()) / 2) * duration
    return float((np.sqrt(seen.kinetic_energy[0] + springs) + growth) ** 2) + _work_of_efforts(mechanism, trajectory)


def _work_of_efforts(mechanism: Mechanism, trajectory: Trajectory) -> float:
    """Return the work (J) of the constant efforts over the largest displacements of a run."""
    if not any(joint.effort for joint in mechanism.joints):
        return 0.0
    motion = kinematics.joints(mechanism, trajectory).position
    columns = zip(mechanism.joints, places(mechanism), strict=True)
    moved = (abs(joint.effort) * np.abs(motion[:, held] - joint.start[0]).max() for joint, (held, _) in columns if joint.effort)
    return float(sum(moved))
