"""How far a run is from the truth: errors against it, and drifts of what mechanics conserves."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass

import numpy as np

from bodycheck.reference.contact_observables import measured_stop, penetration, tilt
from bodycheck.reference.kinematics import geodesic_angle, normalise
from bodycheck.reference.observables import Observables, observe
from bodycheck.reference.planar import Stop
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import Truth, distance
from bodycheck.running.outcome import Completed, Run

CONSERVED = ("energy", "rotational_energy", "angular_momentum")

#: Of a scene that conserves energy and angular momentum.
COLUMNS = (
    *("position_error", "velocity_error", "attitude_error", "angular_velocity_error"),
    *(f"{name}_drift" for name in CONSERVED),
    "truth_error",
)

STOP_COLUMNS = ("stop_time_error", "stop_position_error", "stop_yaw_error", "creep")


LOAD_COLUMNS = ("mean_load", "peak_load", "time_in_contact")


#: s, m, rad, m/s of a stop; m and rad, over time; weights of the body and a part of 1, where the engine tells its loads.
CONTACT_COLUMNS = (*STOP_COLUMNS, "penetration", "tilt", *LOAD_COLUMNS)

#: What stands in the place of the drifts where friction or drag act, and what is measured on a plane.
FURTHER_COLUMNS = (*(f"{name}_error" for name in CONSERVED), *CONTACT_COLUMNS)


@dataclass(frozen=True, eq=False)
class Discrepancy:
    """Differences at n instants t (n,), by the name of their column, each (n,) and never negative.

    position_error (m), velocity_error (m/s): Euclidean distance. attitude_error: geodesic angle (rad).
    angular_velocity_error: Euclidean distance of the body rates (rad/s). energy_drift, rotational_energy_drift,
    angular_momentum_drift: distance from the run's own initial value, relative (see `drifts`); where friction or drag act,
    energy_error and so on: distance from the truth's value, relative likewise.
    truth_error: the truth's own bound (rad), below which an attitude error says nothing.
    On a plane also penetration (m) and tilt (rad), and in `figures` those of the stop (see
    `bodycheck.reference.contact_observables`).
    """

    t: Array
    series: Mapping[str, Array]
    figures: Mapping[str, float]

    def maxima(self) -> dict[str, float]:
        """The largest value of every column, and the figures that are one number, by their names."""
        return {name: float(values.max()) for name, values in self.series.items()} | dict(self.figures)


def compare(truth: Truth, run: Run) -> Discrepancy:
    """The discrepancy of a completed run from the truth of its case, at the run's own instants.

    Raises `ValueError` for a run that has no trajectory.
    """
    if not isinstance(run.outcome, Completed):
        raise ValueError(f"the run has no trajectory to compare, its status is {run.outcome.status}: {run.outcome.reason}")
    trajectory = run.outcome.trajectory
    truth = truth.at(trajectory.t)
    reference = truth.trajectory
    scene, suffix = truth.scene, "drift" if truth.scene.conserves else "error"
    on_plane = {"penetration": penetration(scene, trajectory), "tilt": tilt(trajectory)} if scene.plane is not None else {}
    return Discrepancy(
        trajectory.t,
        {
            "position_error": distance(trajectory.position, reference.position),
            "velocity_error": distance(trajectory.velocity, reference.velocity),
            "attitude_error": geodesic_angle(reference.quaternion, normalise(trajectory.quaternion)),
            "angular_velocity_error": distance(trajectory.angular_velocity, reference.angular_velocity),
            **{f"{name}_{suffix}": values for name, values in zip(CONSERVED, drifts(trajectory, truth), strict=True)},
            "truth_error": truth.error,
            **on_plane,
        },
        (stop_figures(scene, truth.stop, trajectory) if truth.stop is not None else {})
        | (asdict(run.outcome.load) if run.outcome.load is not None else {}),
    )


def distance_from_ideal(name: str, value: float) -> float:
    """Return how far a figure of a column is from its ideal value: 0 for an error, 1 (the body's weight) for a load."""
    return abs(value - 1.0) if name in LOAD_COLUMNS else value


def drifts(trajectory: Trajectory, truth: Truth) -> tuple[Array, Array, Array]:
    """How far total energy, rotational energy and inertial angular momentum are from what they should be, each (n,).

    That is the trajectory's own initial value, or where friction or drag act the truth's value at each instant. Relative to
    their `sizes`.
    """
    scene = truth.scene
    seen, reference = observe(scene, trajectory), observe(scene, truth.trajectory)

    def relative(values: Array, expected: Array, size: float) -> Array:
        return distance(values, values[:1] if scene.conserves else expected) / size

    energy, rotational_energy, momentum = sizes(scene, reference)
    return (
        relative(seen.total_energy[:, None], reference.total_energy[:, None], energy),
        relative(seen.rotational_energy[:, None], reference.rotational_energy[:, None], rotational_energy),
        relative(seen.angular_momentum, reference.angular_momentum, momentum),
    )


def sizes(scene: Scene, reference: Observables) -> tuple[float, float, float]:
    """What total energy, rotational energy (J) and angular momentum (kg m^2/s) are relative to: their size at the beginning.

    Where that is zero, an energy is taken relative to the truth's largest kinetic energy, and an angular momentum to the one
    that this energy would give the body's largest moment.
    """
    kinetic = float(reference.kinetic_energy.max()) or 1.0
    return (
        abs(float(reference.total_energy[0])) or kinetic,
        abs(float(reference.rotational_energy[0])) or kinetic,
        float(np.linalg.norm(reference.angular_momentum[0])) or float(np.sqrt(2 * kinetic * max(scene.body.moments))),
    )


def stop_figures(scene: Scene, expected: Stop, trajectory: Trajectory) -> dict[str, float]:
    """`STOP_COLUMNS` of a trajectory whose truth stops.

    creep: mean speed of the centre of mass along the plane from the stop on.
    """
    stop = measured_stop(scene, trajectory)
    later = float(trajectory.t[-1]) - stop.time
    crept = math.dist(trajectory.position[-1, :2], stop.position[:2])
    return {
        "stop_time_error": abs(stop.time - expected.time),
        "stop_position_error": math.dist(stop.position[:2], expected.position[:2]),
        "stop_yaw_error": abs(stop.yaw - expected.yaw),
        "creep": crept / later if later > 0 else 0.0,
    }
