"""Compute the truth of a case, cross-check it, and convert both to JSON."""

import math
import time
from collections.abc import Iterable, Sequence
from dataclasses import asdict, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bodycheck.casefile.content import Case, check_case
from bodycheck.errors import BadInput
from bodycheck.figures.columns import bounds_of
from bodycheck.reference.candidate import candidate_of
from bodycheck.reference.certified import Certificate, proved
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.mechanisms.coordinates import by_name
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.planar import Stop
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Plane, Scene
from bodycheck.reference.sensors.readings import SensorTruth
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import Truth

#: The largest number of instants at which a truth is computed at once, which takes some 5 s in flight, 30 s in a slide, and 0.5
#: GiB.
MAX_INSTANTS = 300_000

#: A body that still slides after this number of durations of its case counts as not stopping.
STOP_HORIZON = 100


def truth(case: Case, times: ArrayLike | None = None) -> Truth:
    """Return the reference trajectory of a case with its error bound, at its instants or at ascending times (n,) >= 0 s.

    Raises `bodycheck.reference.errors.NotModelled` for a scene that the reference does not model, and
    `bodycheck.reference.errors.OutOfReach` for a motion that it cannot compute, `BadInput` for invalid times, and `TypeError`
    for anything that is not a `Case`.
    """
    # The process of a command plans truths, and its workers compute them.
    from bodycheck.reference.truth import truth as truth_of_scene

    check_case(case)
    return truth_of_scene(case.scene, _instants(case, times))


def batches(case: Case, samplings: Iterable[float]) -> tuple[tuple[float, ...], ...]:
    """Return samplings, without repetitions, in batches whose truths are computed together by `of_runs`.

    All samplings are in one batch, unless a case has so many instants that their truths need much memory and time. A batch has
    at most `MAX_INSTANTS` instants, or one sampling.
    """
    different, most = tuple(dict.fromkeys(samplings)), max(1, MAX_INSTANTS // case.samples)
    return tuple(different[first : first + most] for first in range(0, len(different), most))


def effort(case: Case) -> tuple[bool, int]:
    """Return a key that sorts cases by the time for their truths: the longest for closed loops, then for many bodies."""
    scene = case.scene
    return (bool(scene.loops), len(scene.bodies)) if isinstance(scene, Mechanism) else (False, 0)


def of_runs(case: Case, samplings: Iterable[float]) -> dict[float, Truth]:
    """Return the truths for the runs of a case with some samplings (`Method.sampling`), by sampling, from one computation.

    The computation covers all times at which such runs are sampled, and each truth is a part of it. Raises as `truth` does.
    """
    from bodycheck.running.instants import sampling_times  # reports of stored results need no simulation

    times = {sampling: sampling_times(case.instants, sampling) for sampling in samplings}
    whole = truth(case, np.unique(np.concatenate(list(times.values()))))
    return {sampling: whole.at(of_sampling) for sampling, of_sampling in times.items()}


def certify(case: Case, times: ArrayLike | None = None, limit: float = math.inf) -> Certificate:
    """Prove how far the truth of a case is off, and compare all methods of computing it.

    The times and exceptions are those of `truth`. Without python-flint there is no proof. limit: the time (s) for all of it,
    after which a proof of a tree ends at an earlier instant.
    """
    from bodycheck.reference import certificate

    begin = time.perf_counter()
    checked = certificate.certify(case.scene, _instants(case, times))
    try:
        from bodycheck.reference.proof.proving import enclosed
    except ImportError:
        return replace(checked, not_enclosed="python-flint is not installed: pip install 'bodycheck[proof]'")
    try:
        left = limit - (time.perf_counter() - begin)
        enclosure = enclosed(case.scene, checked.truth.trajectory, checked.truth.joints, candidate_of(case.scene), left)
        return proved(checked, enclosure)
    except NotEnclosed as reason:
        return replace(checked, not_enclosed=str(reason))


def stop_under(case: Case, law: Plane) -> Stop | None:
    """Return where and when the body of a case stops if a law of friction acts on its plane.

    The result is None if the body does not stop within `STOP_HORIZON` times the duration of the case, or if the reference has
    no truth under this law.
    """
    from bodycheck.reference.truth import truth as truth_of_scene

    assert isinstance(case.scene, Scene)  # nothing slides in a mechanism
    try:
        return truth_of_scene(replace(case.scene, plane=law), np.array([0.0, STOP_HORIZON * case.duration])).stop
    except (NotModelled, OutOfReach):
        return None


def _instants(case: Case, times: ArrayLike | None) -> Array:
    """Return the instants (n,) of a case, or other times (s). Raises `BadInput` for invalid times."""
    if times is None:
        return case.instants
    instants = np.asarray(times, dtype=float)
    if instants.ndim != 1 or len(instants) == 0:
        raise BadInput(f"instants of the shape {instants.shape}: must be a list of at least one")
    if not (np.isfinite(instants) & (instants >= 0)).all():
        raise BadInput("instants must be finite and at least 0 s")
    if (np.diff(instants) < 0).any():
        raise BadInput("instants must be in ascending order")
    return instants


def as_json(case: Case, truth: Truth) -> dict[str, Any]:
    """Return the JSON object of `bodycheck truth --json`: arrays by name, and the methods that computed them.

    `word` says how well the truth is known, for a shipped case from its certificate: enclosed, cross-checked or estimated.
    The bounds of the truth's errors are in the units of the figures of a run that they bound. The states of a mechanism are
    given by the names of its joints and bodies.
    """
    from bodycheck.running.certificates import word_of  # imports the reading of case files, which workers do not need

    trajectory = truth.trajectory
    return {
        "case": case.name,
        "model": truth.model,
        "reason": truth.reason,
        "backend": truth.backend,
        "witnesses": list(truth.witnesses),
        "word": word_of(case, compared=bool(truth.witnesses)),
        "t": trajectory.t.tolist(),
        **(_mechanism_as_json(truth.scene, truth) if isinstance(truth.scene, Mechanism) else _states_as_json(trajectory)),
        **{name: values.tolist() for name, values in bounds_of(truth).items()},
        **(_contact_as_json(truth) if touches(case.scene) else {}),
    }


def sensors_as_json(sensors: Sequence[Sensor], readings: Sequence[SensorTruth]) -> dict[str, Any]:
    """Return the additional JSON entries of `bodycheck truth --json` for a case with sensors.

    The entries are the readings of each sensor and the bounds of their errors, both by the names of the sensors, as a list of
    numbers for each instant, and the reasons of the sensors of which the reference has no model. Instants that are left out,
    because an impact happens there, have NaN.
    """
    both = list(zip(sensors, readings, strict=True))
    return {
        "sensors": {sensor.name: each.values.tolist() for sensor, each in both if not each.reason},
        "sensor_bounds": {sensor.name: each.bounds.tolist() for sensor, each in both if not each.reason},
        "sensors_not_modelled": {sensor.name: each.reason for sensor, each in both if each.reason},
    }


def _contact_as_json(truth: Truth) -> dict[str, Any]:
    """Return the events of bodies in contact, the smallest friction without slip, and the loads (N) at rest.

    Bodies are given by their indices, and the plane by -1. Values that mechanics does not determine are NaN here and in the
    states.
    """
    return {
        "events": [asdict(event) for event in truth.events],
        "friction": truth.friction,
        "interfaces": [asdict(pair) for pair in truth.interfaces],
    }


def _states_as_json(trajectory: Trajectory) -> dict[str, Any]:
    """Return the states of one body by name."""
    return {
        "position": trajectory.position.tolist(),
        "quaternion": trajectory.quaternion.tolist(),
        "velocity": trajectory.velocity.tolist(),
        "angular_velocity": trajectory.angular_velocity.tolist(),
    }


def _mechanism_as_json(mechanism: Mechanism, truth: Truth) -> dict[str, Any]:
    """Return the coordinates and velocities of joints and the states of bodies by their names, and the growth of errors."""
    assert truth.joints is not None  # the truth of a mechanism has joints
    joints = by_name(mechanism, truth.joints)
    return {
        "joints": {name: {key: values.tolist() for key, values in quantities.items()} for name, quantities in joints.items()},
        "bodies": {body.name: _states_as_json(truth.trajectory.body(index)) for index, body in enumerate(mechanism.bodies)},
        "growth": None if truth.growth is None else truth.growth.tolist(),
    }


def certificate_as_json(certificate: Certificate) -> dict[str, Any]:
    """Return the additional JSON entries of `bodycheck truth --certify --json`.

    The entries are the word that says how well the truth is known, with the time (s) until which it is proved, null for the
    whole motion, the distance from the exact motion (rad), the method of the proof and its time (s); the attitude differences
    (rad) of all pairs of methods, the bound according to the most accurate other method, and the growth of an error.
    """
    enclosure = certificate.enclosure
    return {
        "differences": [
            {"one": one, "other": other, "attitude": apart.tolist()} for (one, other), apart in certificate.differences.items()
        ],
        "word": certificate.word,
        "certificate": {
            "word": certificate.word,
            "until": None if enclosure is None else enclosure.until,
            "distance": certificate.distance,
            "way": None if enclosure is None else enclosure.way,
            "seconds": None if enclosure is None else enclosure.seconds,
        },
        "certified": certificate.certified,
        "certified_error": certificate.bound.tolist(),
        "digits": certificate.digits,
        "faults": list(certificate.faults),
        "growth": None if certificate.growth is None else certificate.growth.tolist(),
    }
