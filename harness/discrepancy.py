"""How far a run is from the truth: errors against it, and drifts of what mechanics conserves."""

from dataclasses import dataclass, fields

import numpy as np

from bodycheck.observables import observe
from bodycheck.outcome import Completed, Run
from bodycheck.reference.kinematics import geodesic_angle, normalise
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import Truth


@dataclass(frozen=True, eq=False)
class Discrepancy:
    """Differences at n instants, each (n,) and never negative.

    position_error (m), velocity_error (m/s): Euclidean distance. attitude_error: geodesic angle (rad).
    angular_velocity_error: Euclidean distance of the body rates (rad/s). energy_drift, rotational_energy_drift,
    angular_momentum_drift: distance from the run's own initial value, relative (see `drifts`).
    truth_error: the truth's own bound (rad), below which an attitude error says nothing.
    """

    t: Array
    position_error: Array
    velocity_error: Array
    attitude_error: Array
    angular_velocity_error: Array
    energy_drift: Array
    rotational_energy_drift: Array
    angular_momentum_drift: Array
    truth_error: Array

    def maxima(self) -> dict[str, float]:
        """The largest value of every column, by its name."""
        return {name: float(getattr(self, name).max()) for name in COLUMNS}


COLUMNS = tuple(field.name for field in fields(Discrepancy) if field.name != "t")


def compare(truth: Truth, run: Run) -> Discrepancy:
    """The discrepancy of a completed run from the truth of its case, at the run's own instants.

    Raises `ValueError` for a run that has no trajectory.
    """
    if not isinstance(run.outcome, Completed):
        raise ValueError(f"the run has no trajectory to compare, its status is {run.outcome.status}: {run.outcome.reason}")
    trajectory = run.outcome.trajectory
    truth = truth.at(trajectory.t)
    reference = truth.trajectory
    energy, rotational_energy, angular_momentum = drifts(trajectory, truth)
    return Discrepancy(
        t=trajectory.t,
        position_error=_distance(trajectory.position, reference.position),
        velocity_error=_distance(trajectory.velocity, reference.velocity),
        attitude_error=geodesic_angle(reference.quaternion, normalise(trajectory.quaternion)),
        angular_velocity_error=_distance(trajectory.angular_velocity, reference.angular_velocity),
        energy_drift=energy,
        rotational_energy_drift=rotational_energy,
        angular_momentum_drift=angular_momentum,
        truth_error=truth.error,
    )


def drifts(trajectory: Trajectory, truth: Truth) -> tuple[Array, Array, Array]:
    """How far total energy, rotational energy and inertial angular momentum are from their initial values, each (n,).

    Relative to the size of the initial value. Where that is zero, an energy is taken relative to the truth's largest kinetic
    energy, and an angular momentum to the one that this energy would give the body's largest moment.
    """
    scene = truth.scene
    seen = observe(scene, trajectory)
    kinetic = float(observe(scene, truth.trajectory).kinetic_energy.max()) or 1.0
    momentum = float(np.sqrt(2 * kinetic * max(scene.body.moments)))
    return (
        _drift(seen.total_energy[:, None], kinetic),
        _drift(seen.rotational_energy[:, None], kinetic),
        _drift(seen.angular_momentum, momentum),
    )


def _distance(one: Array, other: Array) -> Array:
    return np.asarray(np.linalg.norm(one - other, axis=1))


def _drift(values: Array, scale_at_rest: float) -> Array:
    initial = float(np.linalg.norm(values[0]))
    return np.asarray(np.linalg.norm(values - values[0], axis=1)) / (initial or scale_at_rest)
