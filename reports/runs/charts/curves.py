"""The curves of one case as datasets for `time_charts`, with few enough points to be stored in a page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from bodycheck.figures.columns import truth_bounds
from bodycheck.judging.discrepancy import compare
from bodycheck.judging.judgement import Verdict
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.observables import Observables, observe
from bodycheck.reference.scene import Scene
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import Truth
from bodycheck.reports.quantities import PLOTTED, QUANTITIES, bound, count, listing, number
from bodycheck.reports.runs.charts import coincidence, joint_curves, sensor_curves
from bodycheck.reports.runs.charts.time_charts import FRAMES
from bodycheck.reports.series import corners, ends, envelope, rounded
from bodycheck.results.outcome import Completed

#: The most instants of the curves of the angular momentum.
MOST_CORNERS = 800

#: The curves of joints have 1/`SHARE` of the instants of the angular momentum, but at least `FEWEST_CORNERS` instants.
SHARE, FEWEST_CORNERS = 4, 40

#: About the most points of a chart with a tooltip. Each is an element of the page and takes time to draw.
MOST_FOUND = 600

#: The significant digits of instants.
INSTANT_DIGITS = 7

#: The truth's own error is drawn if the largest error of any run is below this multiple of it; for attitudes it is always
#: drawn.
FAR = 1e4

#: Smaller values, far below the rounding of any scene, count as zero so that they do not stretch a logarithmic scale.
SMALLEST = 1e-20


@dataclass(frozen=True)
class Drawn:
    """A chart over time in words: `alt` describes it for readers who cannot see it, and `notes` say what is left out."""

    alt: str
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Curves:
    """The charts of one case.

    Parameters
    ----------
    datasets
        The datasets by the names that `time_charts` uses.
    drawn
        Descriptions of the charts that have a curve, by the name of the quantity.
    blank
        The quantities that are always zero in every run.
    momentum
        A description of the charts of the angular momentum; empty if there are none.
    joints
        Descriptions of the charts of the joints of a mechanism, by the kind of coordinate; empty if there are none.
    sensors
        Titles and descriptions of the charts of sensors, by their numbers; empty if there are none.
    """

    datasets: dict[str, list[dict[str, Any]]]
    drawn: Mapping[str, Drawn]
    blank: tuple[str, ...]
    momentum: str
    joints: Mapping[str, Drawn] = field(default_factory=dict)
    sensors: Mapping[int, tuple[str, Drawn]] = field(default_factory=dict)


def draw(
    verdicts: Mapping[str, Verdict], known: Mapping[tuple[str, float], Truth], points: int, instants: int = MOST_CORNERS
) -> Curves:
    """Return the curves of completed runs and of their truths.

    The trajectory of each run is read and compared with its truth again, one run at a time, since verdicts store no series.

    Parameters
    ----------
    verdicts
        Verdicts on completed runs of one case, by the label of their method.
    known
        The truths of the case, by the label of their set of results and the time step (s).
    points
        The most points of a curve.
    instants
        The most instants of the curves of the angular momentum.
    """
    truths = {sampling: truth for (_, sampling), truth in known.items()}
    datasets: dict[str, list[dict[str, Any]]] = {"times": [], "series": [], "floor": [], "momentum": []}
    peaks: dict[str, dict[str, float]] = {}
    gaps: dict[str, list[str]] = {}
    shapes: dict[tuple[str, str], dict[str, Array]] = {}
    for sampling, truth in truths.items():
        t = truth.trajectory.t
        datasets["times"].append({"timestep": sampling, "t": rounded(t[ends(len(t), points)], INSTANT_DIGITS)})
    every = max(1, points * len(verdicts) // MOST_FOUND)
    for label, verdict in verdicts.items():
        row: dict[str, Any] = {"method": label, "timestep": verdict.run.method.sampling, "every": every}
        series = compare(known[verdict.label, verdict.run.method.sampling], verdict.run, PLOTTED).series
        for name in PLOTTED:
            if (values := series.get(name)) is not None:
                shown = np.where(values < SMALLEST, 0.0, values)
                shapes.setdefault((name, verdict.label), {})[label] = envelope(shown, points)
                row[name] = rounded(shapes[name, verdict.label][label])
                finite = np.isfinite(shown)
                peaks.setdefault(name, {})[label] = float(shown[finite].max(initial=0.0))
                gaps.setdefault(name, []).extend([label] if not finite.all() else [])
        datasets["series"].append(row)
    alike = _alike(shapes)
    for row in datasets["series"]:
        row |= {f"{name}_band": width[row["method"]] for name, (width, _) in alike.items() if row["method"] in width}
    momentum = ""
    if truths:
        largest = max(truths.values(), key=lambda truth: float(np.nan_to_num(truth.bounds.error).max()))
        datasets["floor"] = [_floor(largest, peaks, points)]
        scene = largest.scene
        if isinstance(scene, Scene) and (seen := observe(scene, largest.trajectory)).angular_momentum.any():
            datasets["momentum"] = [_momentum(largest, seen, instants)]
            momentum = _constancy(seen)
    drawn = {
        name: _words(name, own, gaps[name], alike[name][1]) for name, own in peaks.items() if any(own.values()) or gaps[name]
    }
    blank = tuple(name for name in peaks if name not in drawn)
    joints = {}
    if truths and isinstance(mechanism := truths[min(truths)].scene, Mechanism):
        moved = _joints(mechanism, verdicts, known, truths[min(truths)], instants)
        datasets |= {"joints": moved} if moved else {}
        joints = {kind: Drawn(*told) for kind, told in joint_curves.described(moved, mechanism).items()}
    sensors = {}
    if truths and (sensed := next((verdict.run.sensors for verdict in verdicts.values()), ())):
        readings = _readings(sensed, verdicts, known, truths[min(truths)], instants)
        datasets |= {"sensors": readings} if readings else {}
        charts = sensor_curves.described(readings, sensed)
        sensors = {number: (title, Drawn(alt, notes)) for number, (title, alt, notes) in charts.items()}
    return Curves(datasets, drawn, blank, momentum, joints, sensors)


def _readings(
    sensors: tuple[Sensor, ...],
    verdicts: Mapping[str, Verdict],
    known: Mapping[tuple[str, float], Truth],
    truth: Truth,
    instants: int,
) -> list[dict[str, Any]]:
    """Return the curves of the sensors of a case in runs and truth. truth: the truth at the smallest time step."""
    runs = {label: (each.run, known[each.label, each.run.method.sampling]) for label, each in verdicts.items()}
    return sensor_curves.rows(sensors, truth, runs, max(FEWEST_CORNERS, instants // SHARE))


def _joints(
    mechanism: Mechanism,
    verdicts: Mapping[str, Verdict],
    known: Mapping[tuple[str, float], Truth],
    truth: Truth,
    instants: int,
) -> list[dict[str, Any]]:
    """Return the curves of the joints of a mechanism in runs and truth. truth: the truth at the smallest time step."""
    runs = {
        label: (verdict.run.outcome.trajectory, known[verdict.label, verdict.run.method.sampling].trajectory)
        for label, verdict in verdicts.items()
        if isinstance(verdict.run.outcome, Completed)
    }
    return joint_curves.rows(mechanism, truth.trajectory, runs, max(FEWEST_CORNERS, instants // SHARE))


def _floor(truth: Truth, peaks: Mapping[str, Mapping[str, float]], points: int) -> dict[str, Any]:
    """Return the error bound of the truth in each plotted quantity; empty if all errors of runs are much larger (see `FAR`).

    peaks: the largest values by the name of the quantity and the label of the method.
    """
    t, bounds = truth.trajectory.t, truth_bounds(truth)
    row: dict[str, Any] = {"t": rounded(t[ends(len(t), points)], INSTANT_DIGITS)}
    for name in PLOTTED:
        near = name in bounds and (
            name == "attitude_error" or min(peaks.get(name, {"": np.inf}).values()) < FAR * np.fmax.reduce(bounds[name])
        )
        row[name] = rounded(envelope(bounds[name], points)) if near else []
    return row


def _momentum(truth: Truth, seen: Observables, instants: int) -> dict[str, Any]:
    values = np.hstack([seen.body_angular_momentum, seen.angular_momentum])
    kept = corners(truth.trajectory.t, values, instants)
    t, thinned = truth.trajectory.t[kept], values[kept]
    names = [component for those in FRAMES.values() for component in those]
    return {"t": rounded(t, INSTANT_DIGITS), **{name: rounded(column) for name, column in zip(names, thinned.T, strict=True)}}


def _constancy(seen: Observables) -> str:
    """Return a description of the variation of the angular momentum's components in the body frame and the inertial frame."""
    body, inertial = (float(np.ptp(momentum, axis=0).max()) for momentum in (seen.body_angular_momentum, seen.angular_momentum))
    size = float(np.linalg.norm(seen.angular_momentum[0]))
    return (
        f"Both charts show the same vector, of size {number(size)} kg m²/s. Its components along the body's axes vary by up to "
        f"{bound(body, 2)} kg m²/s, and those along the inertial axes by up to {bound(inertial, 2)} kg m²/s."
        + ("" if np.isfinite(seen.angular_momentum).all() else " It is left out where it is not a finite number.")
    )


def _alike(shapes: Mapping[tuple[str, str], Mapping[str, Array]]) -> dict[str, tuple[dict[str, int], str]]:
    """Return the bands of curves that coincide, and a sentence about them, by quantity.

    shapes: the curves by quantity and label of the set of results; those of different sets are not compared, since each set has
    lines of its own.
    """
    groups: dict[str, list[list[str]]] = {}
    for (name, _), curves in shapes.items():
        groups.setdefault(name, []).extend(coincidence.coinciding(curves))
    return {name: (coincidence.bands(alike), coincidence.told(alike)) for name, alike in groups.items()}


def _words(name: str, peaks: Mapping[str, float], gaps: Sequence[str], alike: str) -> Drawn:
    """Return the description of a chart.

    peaks: the largest finite values by label. gaps: the labels with other values. alike: a sentence about curves that coincide.
    """
    quantity = QUANTITIES[name]
    worst, best = max(peaks, key=lambda label: peaks[label]), min(peaks, key=lambda label: peaks[label])
    zero = [label for label, peak in peaks.items() if peak == 0 and label not in gaps]
    notes = [f"Not drawn, because the value is always zero: {listing(zero)}."] if zero else []
    notes += [alike] if alike else []
    notes += [f"Left out where the value is not a finite number: {listing(gaps)}."] if gaps else []
    alt = (
        f"{quantity.title} over time on a log scale, for {count(len(peaks), 'method')}. "
        f"The largest value is {quantity.with_unit(peaks[worst])}, with {worst}. "
        f"The smallest maximum is {quantity.with_unit(peaks[best])}, with {best}."
    )
    return Drawn(alt, tuple(notes))
