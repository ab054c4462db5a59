"""The sizes of the numbers whose differences are figures, from which the effect of rounding on a figure is estimated.

Two functions answer two questions. `in_run` returns the sizes of the numbers that were rounded in a run. Such a size may be
zero, for example for a body that stays at the origin, where rounding has no effect. The sizes of `in_scene` are never zero:
they are used for limits written into case files, and a limit of zero would fail on every other machine.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bodycheck.figures import mechanisms
from bodycheck.figures.conservation import angular_momentum_size, energy_size, rotational_energy_size
from bodycheck.figures.definition import Scales
from bodycheck.reference.mechanisms.exact import nearest_inertia
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.observables import masses
from bodycheck.reference.mechanisms.observables import observe as observe_mechanism
from bodycheck.reference.observables import observe
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import Truth


def in_run(truth: Truth, trajectory: Trajectory) -> Scales:
    """Return the sizes of the numbers in a trajectory of a truth's scene."""
    duration, rate = float(trajectory.t[-1]), largest(trajectory.angular_velocity)
    scene = truth.scene
    energies = _in_mechanism(scene, truth, trajectory) if isinstance(scene, Mechanism) else _in_body(scene, truth, trajectory)
    return Scales(
        length=largest(trajectory.position),
        speed=largest(trajectory.velocity),
        angle=max(1.0, rate * duration),
        rate=rate,
        duration=duration,
        energy=energies[0],
        rotational_energy=energies[1],
        angular_momentum=energies[2],
    )


def in_scene(truth: Truth) -> Scales:
    """Return the sizes of the numbers in a truth, at least those for a turn by 1 rad and a motion by the body's size."""
    run, scene = in_run(truth, truth.trajectory), truth.scene
    length = max(run.length, _extent(scene) if isinstance(scene, Mechanism) else _gyration(scene.body.moments, scene.body.mass))
    rate = max(run.rate, 1 / run.duration)
    return replace(
        run,
        length=length,
        speed=max(run.speed, length / run.duration),
        angle=rate * run.duration,
        rate=rate,
        energy=max(run.energy, 1.0),
        rotational_energy=max(run.rotational_energy, 1.0),
        angular_momentum=max(run.angular_momentum, 1.0),
    )


def _in_body(scene: Scene, truth: Truth, trajectory: Trajectory) -> tuple[float, float, float]:
    """Return the relative sizes of the energy, the rotational energy and the angular momentum of a single body."""
    seen, reference = observe(scene, trajectory), observe(scene, truth.trajectory)
    # Rounding affects the coordinates, which are measured from the origin.
    weighed = scene.body.mass * scene.gravity * np.abs(trajectory.position[:, 2])
    energy_error, momentum_error = truth.bounds.energy_error[0], truth.bounds.angular_momentum_error[0]
    return (
        float(np.fmax.reduce(seen.kinetic_energy + weighed)) / float(energy_size(reference, energy_error)),
        float(np.fmax.reduce(seen.rotational_energy)) / float(rotational_energy_size(reference, momentum_error)),
        largest(seen.angular_momentum) / float(angular_momentum_size(scene, reference, momentum_error)),
    )


def _in_mechanism(mechanism: Mechanism, truth: Truth, trajectory: Trajectory) -> tuple[float, float, float]:
    """Return the relative sizes of the energy, the rotational energy and the momenta of a mechanism.

    The size of the rotational energy is 0, because it is no figure of a mechanism.
    """
    seen, reference = observe_mechanism(mechanism, trajectory), observe_mechanism(mechanism, truth.trajectory)
    mass = masses(mechanism)[:, None]
    weighed = (mass * mechanism.gravity * np.abs(trajectory.position[..., 2])).sum(axis=0)
    momentum = float(mass.sum()) * largest(trajectory.position) * largest(trajectory.velocity)
    energies = np.fmax.reduce(seen.kinetic_energy + np.abs(seen.potential_energy) + weighed)
    return (
        float(energies) / float(energy_size(reference, truth.bounds.energy_error[0])),
        0.0,
        max(1.0, momentum / mechanisms.angular_momentum_size(mechanism, truth, reference)),
    )


def _extent(mechanism: Mechanism) -> float:
    """Return the size (m) of a mechanism: the largest radius of gyration of a body, about the origin of its frame."""
    bodies = [nearest_inertia(body) for body in mechanism.bodies]
    return max(float(np.hypot(_gyration(body.tensor[:3], body.mass), np.linalg.norm(body.centre))) for body in bodies)


def _gyration(moments: Sequence[float], mass: float) -> float:
    """Return the largest radius of gyration (m) of a mass (kg) with given moments of inertia (kg m^2)."""
    return float(np.sqrt(max(moments) / mass))


def largest(vectors: Array) -> float:
    """Return the largest Euclidean length of vectors (..., k), ignoring unknown vectors (NaN)."""
    return float(np.fmax.reduce(np.linalg.norm(vectors, axis=-1), axis=None))
