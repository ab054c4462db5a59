"""Find the symptoms of a wrong motion of a mechanism: in its states, in its energy, and against the truth."""

from collections.abc import Iterator

import numpy as np

from bodycheck.figures.conservation import energy_size
from bodycheck.reference.kinematics import geodesic_angle, normalise
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.observables import observe
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import Truth, distance
from bodycheck.studies.extremes.symptoms import (
    ATTITUDE_LOST_RAD,
    ENERGY_CHANGE_LIMIT,
    MAX_RELATIVE_ENERGY,
    POSITION_LOST_FRACTION,
    SECULAR_CORRELATION,
    VISIBLE_MOTION,
    Symptom,
    rank_correlation,
)


def of_itself(mechanism: Mechanism, trajectory: Trajectory) -> Iterator[Symptom]:
    """Yield the symptoms of a motion that are visible without comparison with a truth."""
    gap = kinematics.gaps(mechanism, trajectory).max(initial=0.0)
    if gap > POSITION_LOST_FRACTION * _reach(trajectory):
        yield Symptom("inaccurate", f"joints or loops come apart by {gap:.3g} m")
    if not mechanism.conserves:
        return
    change = energy_change(mechanism, trajectory)
    late = float(change[-max(1, len(change) // 10) :].mean())
    if abs(late) > ENERGY_CHANGE_LIMIT and abs(rank_correlation(change)) >= SECULAR_CORRELATION:
        status = "energy-gain" if late > 0 else "energy-loss"
        yield Symptom(status, f"energy changed by {change[-1]:.3g} of the kinetic energy")
    elif np.abs(change).max() > ENERGY_CHANGE_LIMIT:
        yield Symptom("inaccurate", f"energy off by {change.min():.3g} to {change.max():.3g} of the kinetic energy")


def of_truth(trajectory: Trajectory, truth: Truth) -> Iterator[Symptom]:
    """Yield the symptoms of a motion that differs too much from the truth, which must have the same instants."""
    position, attitude = errors(trajectory, truth)
    way = float(np.nansum(np.linalg.norm(np.diff(truth.trajectory.position, axis=-2), axis=-1), axis=-1).max())
    far = max(POSITION_LOST_FRACTION * way, VISIBLE_MOTION * _reach(truth.trajectory))
    if (position - truth.bounds.position_error > far).any():
        yield Symptom("inaccurate", f"a body is {np.fmax.reduce(position):.3g} m off after a path of {way:.3g} m")
    lost = attitude - truth.bounds.error > ATTITUDE_LOST_RAD
    if lost.any():
        yield Symptom("inaccurate", f"an attitude is lost at t = {trajectory.t[np.argmax(lost)]:.3g} s")


def errors(trajectory: Trajectory, truth: Truth) -> tuple[Array, Array]:
    """Return the largest errors over the bodies of position (n,), in m, and of attitude (n,), in rad."""
    exact = truth.trajectory
    attitude = geodesic_angle(exact.quaternion, normalise(trajectory.quaternion))
    return np.asarray(distance(trajectory.position, exact.position).max(axis=0)), np.asarray(attitude.max(axis=0))


def energy_change(mechanism: Mechanism, trajectory: Trajectory) -> Array:
    """Return the change (n,) of the energy since the start, relative to the kinetic energy, at most `MAX_RELATIVE_ENERGY`."""
    seen = observe(mechanism, trajectory)
    energy = seen.total_energy
    return np.asarray(np.minimum((energy - energy[0]) / energy_size(seen), MAX_RELATIVE_ENERGY))


def _reach(trajectory: Trajectory) -> float:
    """Return the largest distance (m) of a body from the place where the first body begins."""
    return float(np.fmax.reduce(np.linalg.norm(trajectory.position - trajectory.position[0, 0], axis=-1), axis=None))
