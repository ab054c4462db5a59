"""What is checked of the states of a run of a single body: that they are possible, begin as the scene does, and change.

`mechanism_checks` has the same functions for mechanisms.
"""

import math

import numpy as np

from bodycheck.reference.inertia import angular_momentum
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.observables import observe
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Trajectory
from bodycheck.results.outcome import AdapterFault, Diverged

#: Smallest motion per step that is visible in single precision, relative to the position or in rad.
VISIBLE_MOTION = 1e-6

#: Largest deviation of a state at t = 0 from that of the scene: an angle (rad), and of vectors relative to the larger of their
#: length and 1. Single precision is within a tenth of it, and a wrong axis, frame, sign or order of a quaternion is beyond it.
START_TOLERANCE = 1e-4

#: Ratio of the kinetic energy to the largest possible one, above which a run has diverged.
DIVERGED_ENERGY_RATIO = 100.0


def divergence(scene: Scene, trajectory: Trajectory) -> Diverged | None:
    """Find the first instant at which a state is not finite or has an impossible kinetic energy; None if there is none."""
    t = trajectory.t
    states = (trajectory.position, trajectory.quaternion, trajectory.velocity, trajectory.angular_velocity)
    finite = np.isfinite(np.hstack(states)).all(axis=1)
    if not finite.all():
        return Diverged(f"not a number at t = {t[np.argmin(finite)]:.6g} s", trajectory=trajectory)
    with np.errstate(all="ignore"):  # states that cannot be may overflow
        kinetic = observe(scene, trajectory).kinetic_energy
    most = _largest_kinetic_energy(scene, float(t[-1]))
    beyond = kinetic > DIVERGED_ENERGY_RATIO * most
    if most > 0 and beyond.any():
        first = int(np.argmax(beyond))
        reason = f"kinetic energy {kinetic[first] / most:.3g} times the most possible at t = {t[first]:.6g} s"
        return Diverged(reason, trajectory=trajectory)
    return None


def check_start(scene: Scene, trajectory: Trajectory) -> None:
    """Raise `AdapterFault` if the run does not begin at the state of the scene, as with a wrong frame or order."""
    if trajectory.t[0] != 0:
        return
    initial = scene.initial
    pairs = {
        "position": (trajectory.position[0], initial.position),
        "velocity": (trajectory.velocity[0], initial.velocity),
        "angular velocity": (trajectory.angular_velocity[0], initial.angular_velocity),
    }
    for name, (got, asked) in pairs.items():
        if math.dist(got, asked) > START_TOLERANCE * max(1.0, math.hypot(*asked)):
            raise AdapterFault(f"at t = 0 its {name} is {got.tolist()}, not {list(asked)}")
    turned = float(geodesic_angle(trajectory.quaternion[0], np.array(initial.quaternion)))
    if turned > START_TOLERANCE:
        raise AdapterFault(f"at t = 0 its attitude is {turned:.3g} rad from that of the scene")


def standstill(scene: Scene, trajectory: Trajectory, timestep: float) -> Diverged | None:
    """Return `Diverged` if the states are equal to the last bit at all samples although the body must move; else None.

    With velocity v the position changes by v h in a step h, and with spin w the attitude turns by |w| h, for any forces. A body
    at rest falls if nothing supports it. Motion that rounding can hide and full turns between samples do not count.
    """
    states = np.hstack([trajectory.position, trajectory.quaternion, trajectory.velocity, trajectory.angular_velocity])
    if len(states) < 2 or (states != states[0]).any():
        return None
    position, velocity = trajectory.position[0], trajectory.velocity[0]
    spin = math.hypot(*trajectory.angular_velocity[0])
    with np.errstate(all="ignore"):  # numbers that overflow are not judged
        moves = (np.abs(velocity) * timestep > VISIBLE_MOTION * np.abs(position)).any()
        turns = spin * timestep > VISIBLE_MOTION and (np.abs(np.sin(spin * np.diff(trajectory.t) / 2)) > VISIBLE_MOTION).any()
    falls = scene.plane is None and scene.gravity > 0 and not velocity.any()
    if not (moves or turns or falls):
        return None
    return Diverged("the state never changes although the body moves", trajectory=trajectory)


def _largest_kinetic_energy(scene: Scene, duration: float) -> float:
    """Return an upper bound of the kinetic energy (J): that of a fall for the whole duration, and of the least moment."""
    speed = math.hypot(*scene.initial.velocity) + scene.gravity * duration
    momentum = math.hypot(*angular_momentum(scene.body, np.array(scene.initial.angular_velocity)))
    return scene.body.mass * speed**2 / 2 + momentum**2 / (2 * min(scene.body.moments))
