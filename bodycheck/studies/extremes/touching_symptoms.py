"""Find the symptoms of a wrong motion of bodies that touch: energy that they gain, depth, and distance from the truth."""

from collections.abc import Iterator

import numpy as np

from bodycheck.figures.touching import energy_from_plane, gained
from bodycheck.reference.bodies import motions
from bodycheck.reference.contact.observables import depth
from bodycheck.reference.contact.touching import touching
from bodycheck.reference.kinematics import geodesic_angle, normalise
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.support import reach
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import Truth, distance
from bodycheck.studies.extremes.symptoms import ATTITUDE_LOST_RAD, ENERGY_CHANGE_LIMIT, POSITION_LOST_FRACTION, Symptom


def of_itself(scene: AnyScene, trajectory: Trajectory) -> Iterator[Symptom]:
    """Yield the symptoms of a motion that are visible without comparison with a truth."""
    for body, motion in zip(touching(scene), motions(scene, trajectory), strict=True):
        if (deepest := depth(body, motion).max()) > POSITION_LOST_FRACTION * _size(scene, trajectory):
            yield Symptom("inaccurate", f"sinks {deepest:.3g} m into the plane")
            break
    gain = gained(scene, trajectory).max() / (float(energy_from_plane(scene, trajectory)[0]) or 1.0)
    if gain > ENERGY_CHANGE_LIMIT:
        yield Symptom("energy-gain", f"energy up by {gain:.3g} of the initial one, which is counted from the plane")


def of_truth(scene: AnyScene, trajectory: Trajectory, truth: Truth) -> Iterator[Symptom]:
    """Yield the symptoms of a motion that differs too much from the truth, which must have the same instants."""
    position, attitude = errors(scene, trajectory, truth)
    ways = [np.nansum(np.linalg.norm(np.diff(own.position, axis=0), axis=1)) for own in motions(scene, truth.trajectory)]
    way = float(max(ways))
    if (position - truth.bounds.position_error > POSITION_LOST_FRACTION * max(way, _size(scene, trajectory))).any():
        yield Symptom("inaccurate", f"a body is {np.fmax.reduce(position):.3g} m off after a path of {way:.3g} m")
    lost = attitude - truth.bounds.error > ATTITUDE_LOST_RAD
    if lost.any():
        yield Symptom("inaccurate", f"an attitude is lost at t = {trajectory.t[np.argmax(lost)]:.3g} s")


def errors(scene: AnyScene, trajectory: Trajectory, truth: Truth) -> tuple[Array, Array]:
    """Return the largest errors over the bodies of position (n,), in m, and of attitude (n,), in rad; NaN without a truth."""
    pairs = list(zip(motions(scene, trajectory), motions(scene, truth.trajectory), strict=True))
    position = np.max([distance(own.position, exact.position) for own, exact in pairs], axis=0)
    attitude = np.max([geodesic_angle(exact.quaternion, normalise(own.quaternion)) for own, exact in pairs], axis=0)
    return np.asarray(position), np.asarray(attitude)


def _size(scene: AnyScene, trajectory: Trajectory) -> float:
    """Return how far (m) the largest body reaches towards the plane at the start."""
    first = [motion.quaternion[:1] for motion in motions(scene, trajectory)]
    return max(float(reach(body.shape, own, body.normal)[0]) for body, own in zip(touching(scene), first, strict=True))
