"""Diagnose a run: its status, the message of the engine, and the symptoms in its states.

The states of the run and the signals of its engine are both used. For example, a run was reset if the engine reports a reset
and the motion begins again. If the scene has a truth, the motion is compared with it; otherwise the run is judged by the
quantities that it should conserve.
"""

from dataclasses import dataclass

import numpy as np

from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.trajectory import Trajectory
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.results.outcome import Completed, Diverged, Outcome, Unsupported
from bodycheck.studies.extremes.rows import HEALTHY, NOTHING, STATUSES
from bodycheck.studies.extremes.symptoms import errors, of_itself, of_truth, restart


@dataclass(frozen=True)
class Diagnosis:
    """One of `STATUSES`, the message of the engine, and a description of the symptoms."""

    status: str
    engine_said: str
    detail: str


def diagnose(scene: AnyScene, outcome: Outcome, truth: Truth | NoTruth) -> Diagnosis:
    """The diagnosis of a run of a scene; truth: at the run's own instants, or why there is none."""
    with np.errstate(all="ignore"):  # overflow is a symptom
        match outcome:
            case Completed():
                return _completed(scene, outcome.trajectory, truth)
            case Diverged():
                return _diverged(scene, outcome)
            case Crashed(reason):
                return Diagnosis("crashed", reason, "the engine raised an error")
            case TimedOut(_) | Unsupported(_):
                return Diagnosis(outcome.status, NOTHING, outcome.reason)


def _completed(scene: AnyScene, trajectory: Trajectory, truth: Truth | NoTruth) -> Diagnosis:
    symptoms = list(of_itself(scene, trajectory))
    if isinstance(truth, Truth):
        symptoms += of_truth(scene, trajectory, truth)
        position, attitude = errors(scene, trajectory, truth)
        turned, moved = np.fmax.reduce(attitude), np.fmax.reduce(position)
        nothing = f"attitude off by {turned:.3g} rad, centre of mass by {moved:.3g} m"
        if np.isnan(moved):
            nothing = "nothing gained energy or sank into the plane; mechanics gives no motion to compare with"
    else:
        nothing = f"judged by what is conserved alone: {truth.reason}"
    status = max((symptom.status for symptom in symptoms), key=STATUSES.index, default="ok")
    texts = [symptom.text for symptom in symptoms]
    if not symptoms or isinstance(truth, NoTruth):
        texts.append(nothing)
    return Diagnosis(status, HEALTHY, "; ".join(texts))


def _diverged(scene: AnyScene, outcome: Diverged) -> Diagnosis:
    """Diagnose a run that its states or its engine ended, including the symptoms before the end."""
    before = states(outcome)
    symptoms = list(of_itself(scene, before)) if before is not None else []
    earlier = [f"before, {symptom.text}" for symptom in symptoms]
    if outcome.signal == "none":
        frozen = any(symptom.status == "frozen" for symptom in symptoms)
        return Diagnosis("frozen" if frozen else "diverged", HEALTHY, "; ".join([outcome.reason, *earlier]))
    if outcome.trajectory is None or before is None:
        return Diagnosis("diverged", outcome.reason, "there are no states to look at")
    again = None if isinstance(scene, Mechanism) else restart(scene, outcome.trajectory.part(slice(-2, None)))
    status = "silent-reset" if outcome.signal == "reset" and again is not None else "diverged"
    return Diagnosis(status, outcome.reason, "; ".join([again or "its states show no break", *earlier]))


def states(outcome: Outcome) -> Trajectory | None:
    """Return the valid states of a run: all if it completed, those before the end if it diverged; None if there are none."""
    match outcome:
        case Completed():
            return outcome.trajectory
        case Diverged(trajectory=Trajectory() as trajectory):
            parts = (trajectory.position, trajectory.velocity, trajectory.angular_velocity)
            sound = np.isfinite(np.concatenate(parts, axis=-1)).all(axis=-1).reshape(-1, len(trajectory)).all(axis=0)
            before = trajectory.part(slice(0, int(np.argmin(sound)) if not sound.all() else len(trajectory) - 1))
            return before if len(before) else None
        case _:
            return None
