"""The sizes of the numbers that figures are differences of, by which the effect of rounding on a figure is estimated.

There are two, as they answer two questions. `in_run` measures the numbers that were rounded in a run. A size may be zero, for
example for a body that stays at the origin, where rounding does nothing. `in_scene` is never zero: it serves the limits that
are written into case files, and a limit of zero would fail on every other machine.
"""

from dataclasses import replace

import numpy as np

from bodycheck.figures.conservation import angular_momentum_size, energy_size, rotational_energy_size
from bodycheck.figures.definition import Scales
from bodycheck.reference.observables import observe
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import Truth


def in_run(truth: Truth, trajectory: Trajectory) -> Scales:
    """Return the sizes of the numbers in a trajectory of a truth's scene."""
    scene = truth.scene
    seen, reference = observe(scene, trajectory), observe(scene, truth.trajectory)
    duration, rate = float(trajectory.t[-1]), largest(trajectory.angular_velocity)
    # What is rounded are the coordinates, which count from the origin.
    weighed = scene.body.mass * scene.gravity * np.abs(trajectory.position[:, 2])
    return Scales(
        length=largest(trajectory.position),
        speed=largest(trajectory.velocity),
        angle=max(1.0, rate * duration),
        rate=rate,
        duration=duration,
        energy=float((seen.kinetic_energy + weighed).max()) / float(energy_size(reference)),
        rotational_energy=float(seen.rotational_energy.max()) / float(rotational_energy_size(reference)),
        angular_momentum=largest(seen.angular_momentum) / float(angular_momentum_size(scene, reference)),
    )


def in_scene(truth: Truth) -> Scales:
    """Return the sizes of the numbers in a truth, at least those of a body that turns by 1 rad and moves by its own size."""
    run, body = in_run(truth, truth.trajectory), truth.scene.body
    length = max(run.length, float(np.sqrt(max(body.moments) / body.mass)))
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


def largest(vectors: Array) -> float:
    """Return the largest Euclidean length of vectors (n, k)."""
    return float(np.linalg.norm(vectors, axis=1).max())
