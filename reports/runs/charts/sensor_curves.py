"""The readings of sensors over time, in the truth and in runs that differ visibly from it, as the dataset `sensors`.

A row is one curve: `sensor`, the number of the chart, `component`, `method`, and the arrays `t` and `value`. The force and the
moment of a wrench have a chart each. `time_charts.readings` draws the curves.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bodycheck.figures.sensors import true_readings
from bodycheck.reference.sensors.errors import parts
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.reports.quantities import listing
from bodycheck.reports.runs.charts.joint_curves import DIGITS, MOST_RUNS, SEEN, TRUTH
from bodycheck.reports.series import corners, rounded
from bodycheck.results.outcome import Completed, Run

#: The most charts of a case.
MOST_CHARTS = 12


@dataclass(frozen=True)
class Chart:
    """A chart of a sensor or of a part of it.

    Attributes
    ----------
    title
        Its title.
    sensor, part
        The index of the sensor among those of the case, and the components.
    names
        The names of the components.
    """

    title: str
    sensor: int
    part: slice
    names: tuple[str, ...]


def charts(sensors: Sequence[Sensor]) -> list[Chart]:
    """Return the charts of the first sensors of a case."""
    drawn = []
    for index, sensor in enumerate(sensors):
        for name, part in parts(sensor):
            components = tuple(component.removeprefix(".") or "value" for component in sensor.form.components[part])
            drawn.append(Chart(f"{name}, {sensor.type}, {sensor.form.units[part][0]}", index, part, components))
    return drawn[:MOST_CHARTS]


def rows(sensors: tuple[Sensor, ...], truth: Truth, runs: Mapping[str, tuple[Run, Truth]], most: int) -> list[dict[str, Any]]:
    """Return the rows of the dataset `sensors`.

    Parameters
    ----------
    sensors, truth
        The sensors of the case, and a truth of its motion.
    runs
        The runs, each with the truth at the same instants, by the labels of their methods.
    most
        The most instants of a curve.
    """
    drawn_rows: list[dict[str, Any]] = []
    exact, drawn = true_readings(truth, sensors), charts(sensors)
    if not isinstance(exact, NoTruth):
        for number, chart in enumerate(drawn):
            drawn_rows += _rows(number, chart, TRUTH, truth.trajectory.t, exact[chart.sensor].values, most)
    shown = dict.fromkeys(range(len(drawn)), 0)
    for label, (run, at_its_instants) in runs.items():
        sensed = run.outcome.sensed if isinstance(run.outcome, Completed) else None
        if sensed is None:
            continue
        beside = true_readings(at_its_instants, sensors)
        for number, chart in enumerate(drawn):
            values = sensed.readings[chart.sensor][1:]
            known = None if isinstance(beside, NoTruth) else beside[chart.sensor].values[1:, chart.part]
            if known is not None and not _differs(values[:, chart.part], known):
                continue
            if shown[number] < MOST_RUNS:
                shown[number] += 1
                drawn_rows += _rows(number, chart, label, at_its_instants.trajectory.t[1:], values, most)
    return drawn_rows


def described(data: list[dict[str, Any]], sensors: Sequence[Sensor]) -> dict[int, tuple[str, str, tuple[str, ...]]]:
    """Return the title, a description and notes of each chart that has a curve, by its number."""
    descriptions: dict[int, tuple[str, str, tuple[str, ...]]] = {}
    for number, chart in enumerate(charts(sensors)):
        curves = [row for row in data if row["sensor"] == number]
        if curves:
            methods = [method for method in dict.fromkeys(row["method"] for row in curves) if method != TRUTH]
            notes = (f"Dashed: {listing(methods)}, where the difference is seen.",) if methods else ()
            descriptions[number] = chart.title, " ".join((f"Readings over time: {chart.title}.", *notes)), notes
    return descriptions


def _rows(number: int, chart: Chart, method: str, t: Array, values: Array, most: int) -> list[dict[str, Any]]:
    """Return the rows of the components of a chart that have a number. values: the readings (n, k) of the sensor, or none."""
    drawn_rows = []
    for name, column in zip(chart.names, values[:, chart.part].T, strict=True):
        known = np.isfinite(column)
        if known.any():
            kept = corners(t[known], column[known][:, None], most)
            points = {"t": rounded(t[known][kept], DIGITS), "value": rounded(column[known][kept], DIGITS)}
            drawn_rows.append({"sensor": number, "component": name, "method": method, **points})
    return drawn_rows


def _differs(values: Array, exact: Array) -> bool:
    """Return whether readings (n, k) differ visibly from the exact ones; those that are not known are ignored."""
    if exact.shape != values.shape:
        return True
    known = np.isfinite(values) & np.isfinite(exact)
    size = float(np.ptp(exact[known])) if known.any() else 0.0
    return bool((np.abs(values - exact)[known] > SEEN * (size or 1.0)).any())
