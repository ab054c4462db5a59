"""Diagnose a run: its status, the message of the engine, and the symptoms in its states.

The states of the run and the signals of its engine are both used. For example, a run was reset if the engine reports a reset
and the motion begins again. If the scene has a truth, the motion is compared with it; otherwise the run is judged by the
quantities that it should conserve.

A drift of a conserved quantity grows by one of few laws. Independent rounding errors add up like a random walk, with the square
root of the number of steps. Equal errors of all steps add up linearly. If the error of a step is proportional to the present
error, it grows exponentially.
"""

from dataclasses import dataclass

import numpy as np

from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.observables import observe
from bodycheck.reference.requirements import touches
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import NoTruth, Truth, distance
from bodycheck.results.outcome import Completed, Diverged, Outcome, Unsupported
from bodycheck.studies.extremes.rows import HEALTHY, NOTHING, STATUSES
from bodycheck.studies.extremes.symptoms import energy_change, errors, of_itself, of_truth, restart

#: Smallest number of samples from which a law is determined.
MIN_SAMPLES = 16

#: Fraction of the run, from its start, that is left out of the fit because the oscillation of the motion dominates in it.
FIT_START_FRACTION = 1 / 30

#: Powers of the number of steps, and the words for a drift whose power is closest to each of them.
POWERS = {0.0: "bounded", 0.5: "growing as the square root of the steps", 1.0: "growing linearly", 2.0: "growing quadratically"}

#: Power above which the growth may be exponential.
STEEP_POWER = 1.5

#: Ratio of the growth rate in the second half of a fit to the rate in its first half, above which the growth is faster than
#: exponential.
FASTER_RATIO = 1.5


@dataclass(frozen=True)
class Diagnosis:
    """The diagnosis of a run: one of `STATUSES`, the message of the engine, and a description of the symptoms."""

    status: str
    engine_said: str
    detail: str


@dataclass(frozen=True)
class Growth:
    """A relative drift at the end of a run, and the law of its growth; the law is empty if none can be determined."""

    drift: float
    law: str

    def __str__(self) -> str:
        return ", ".join(filter(None, (f"{self.drift:.3g}", self.law)))


def diagnose(scene: AnyScene, outcome: Outcome, truth: Truth | NoTruth) -> Diagnosis:
    """Return the diagnosis of a run of a scene. truth: the truth at the instants of the run, or why there is none."""
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
        held_alone = isinstance(scene, Mechanism) and not (scene.conserves or touches(scene))
        nothing = f"judged by {'its joints' if held_alone else 'what is conserved'} alone: {truth.reason}"
    status = max((symptom.status for symptom in symptoms), key=STATUSES.index, default="ok")
    texts = [symptom.text for symptom in symptoms]
    if not symptoms or isinstance(truth, NoTruth):
        texts.append(nothing)
    return Diagnosis(status, HEALTHY, "; ".join(texts))


def _diverged(scene: AnyScene, outcome: Diverged) -> Diagnosis:
    """Return the diagnosis of a diverged run, with the symptoms that its states show before the end."""
    before = states(outcome)
    symptoms = list(of_itself(scene, before)) if before is not None else []
    earlier = [f"before, {symptom.text}" for symptom in symptoms]
    if outcome.signal == "none":
        frozen = any(symptom.status == "frozen" for symptom in symptoms)
        return Diagnosis("frozen" if frozen else "diverged", HEALTHY, "; ".join([outcome.reason, *earlier]))
    if outcome.trajectory is None or before is None:
        return Diagnosis("diverged", outcome.reason, "there are no states to look at")
    again = None if isinstance(scene, Mechanism) else restart(scene, outcome.trajectory.part(slice(-2, None)))
    status = "reset" if outcome.signal == "reset" and again is not None else "diverged"
    return Diagnosis(status, outcome.reason, "; ".join([again or "its states show no break", *earlier]))


def states(outcome: Outcome) -> Trajectory | None:
    """Return the valid states of a run: all states if it completed, and the states before the failure if it diverged.

    Return None if there are none.
    """
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


def drifts(scene: AnyScene, outcome: Outcome) -> list[str]:
    """Return phrases about the drift of conserved quantities with the number of steps; empty if the scene conserves none."""
    trajectory = states(outcome)
    if trajectory is None or not scene.conserves:
        return []
    with np.errstate(all="ignore"):
        energy = growth(np.abs(energy_change(scene, trajectory)))
        if isinstance(scene, Mechanism):
            return [f"drift of the energy {energy}"]
        momentum = observe(scene, trajectory).angular_momentum
        size = float(np.linalg.norm(momentum[0])) or 1.0
        return [
            f"drift of the energy of rotation {energy}",
            f"of the angular momentum {growth(distance(momentum, momentum[:1]) / size)}",
        ]


def growth(drift: Array) -> Growth:
    """Return the law by which a relative drift (n,) >= 0 grows. The samples are equally spaced, and the first of them is zero.

    A line is fitted to the logarithm of the largest drift so far over the logarithm of the number of steps; its slope is the
    power. If the power exceeds `STEEP_POWER`, two lines are fitted to the second half of the run: over the logarithm of the
    number of steps, and over the number of steps. If the second line fits better, the growth is exponential.
    """
    largest = np.maximum.accumulate(drift)
    n = np.arange(len(drift), dtype=float)
    seen = (n >= FIT_START_FRACTION * len(drift)) & (largest > 0)
    last = float(drift[-1])
    if not np.isfinite(largest).all() or seen.sum() < MIN_SAMPLES:
        return Growth(last, "")
    n, size = n[seen], largest[seen]
    power, _ = _line(np.log(n), np.log(size))
    if power > STEEP_POWER:
        late, grown = np.array_split(n, 2)[1], np.array_split(np.log(size), 2)[1]
        (power, misfit), (_, other_misfit) = _line(np.log(late), grown), _line(late, grown)
        if other_misfit < misfit:
            first, second = (_line(*part)[0] for part in zip(np.array_split(late, 2), np.array_split(grown, 2), strict=True))
            return Growth(
                last, "growing faster than exponentially" if second > FASTER_RATIO * first else "growing exponentially"
            )
    return Growth(last, POWERS[min(POWERS, key=lambda law: abs(law - power))])


def _line(x: Array, y: Array) -> tuple[float, float]:
    """Return the slope of the line fitted to the points x, y (n,), and the root mean square of the deviations from it."""
    slope, intercept = np.polyfit(x, y, 1)
    return float(slope), float(np.sqrt(np.mean((y - slope * x - intercept) ** 2)))
