"""Charts of the largest error of runs over the time step, for cases that were run with several time steps."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite

import numpy as np

from bodycheck.judging.judgement import Verdict
from bodycheck.reference.trajectory import Array
from bodycheck.reports.charts import Spec, framed, log_axis, method_scale
from bodycheck.reports.lines import Line, assign
from bodycheck.reports.quantities import QUANTITIES, Quantity, count, listing
from bodycheck.reports.runs.charts import coincidence
from bodycheck.reports.runs.charts.time_charts import BAND_OPACITY
from bodycheck.reports.study import Chart
from bodycheck.results.key import RunKey

#: The quantities that are drawn, each in its own chart.
DRAWN = ("attitude_error", "position_error")

#: Smaller errors, far below the rounding of any scene, are left out, since they would stretch the logarithmic scale.
SMALLEST = 1e-20

#: The longest label, in characters, for which two labels fit side by side above a chart.
SHORT_LABEL = 28


@dataclass(frozen=True)
class StepCharts:
    """The charts of a case over the time step, and the lines that they draw."""

    charts: tuple[Chart, ...]
    lines: tuple[Line, ...]


def over_steps(verdicts: Sequence[Verdict]) -> StepCharts:
    """Return a chart for each quantity in which any method has errors at two or more time steps. verdicts: on one case."""
    lines = assign(verdict.key.over_cases.over_steps for verdict in verdicts)
    charts, drawn = [], dict[Line, None]()
    for name in DRAWN:
        errors = {line: own for line, own in _errors(verdicts, lines, name).items() if len(own) > 1}
        drawn |= dict.fromkeys(errors)
        if errors:
            charts.append(_chart(QUANTITIES[name], errors))
    return StepCharts(tuple(charts), tuple(drawn))


def _errors(verdicts: Sequence[Verdict], lines: Mapping[RunKey, Line], name: str) -> dict[Line, dict[float, float]]:
    """Return the errors of each method by time step (s), without errors within the error bound of the truth."""
    found: dict[Line, dict[float, float]] = {}
    for verdict in verdicts:
        maxima = {} if verdict.discrepancy is None else verdict.discrepancy.maxima()
        error = maxima.get(name, 0.0)
        if isfinite(error) and error > SMALLEST and QUANTITIES[name].within_truth(maxima) is None:
            line = lines[verdict.key.over_cases.over_steps]
            found.setdefault(line, {})[verdict.run.method.timestep] = error
    return found


def _alike(errors: Mapping[Line, Mapping[float, float]]) -> list[list[str]]:
    """Return the labels of methods of one set of results whose errors at the same time steps coincide, in groups."""
    by_steps: dict[tuple[str, frozenset[float]], dict[str, Array]] = {}
    for line, by_step in errors.items():
        values = np.array([by_step[step] for step in sorted(by_step)])
        by_steps.setdefault((line.results, frozenset(by_step)), {})[line.label] = values
    return [group for curves in by_steps.values() for group in coincidence.coinciding(curves)]


def _chart(quantity: Quantity, errors: Mapping[Line, Mapping[float, float]]) -> Chart:
    ends = [
        f"{line.label} from {quantity.with_unit(own[max(own)])} to {quantity.with_unit(own[min(own)])}"
        for line, own in errors.items()
    ]
    alt = (
        f"Largest {quantity.title.lower()} over the time step on log scales, for {count(len(errors), 'method')}. "
        f"From the largest time step to the smallest: {listing(ends)}."
    )
    alike = _alike(errors)
    sentence = coincidence.told(alike)
    return Chart(quantity.title, _specification(quantity, errors, alike), alt, (sentence,) if sentence else ())


def _specification(quantity: Quantity, errors: Mapping[Line, Mapping[float, float]], alike: Sequence[Sequence[str]]) -> Spec:
    """Return the chart. Both scales are logarithmic, so the curve of a method of order p has the slope p."""
    lines, bands = list(errors), coincidence.bands(alike)
    rows = [
        {"method": line.label, "step": step * 1e3, "error": float(f"{error:.4g}"), "band": bands.get(line.label, 0)}
        for line, own in errors.items()
        for step, error in sorted(own.items())
    ]
    scale = {"type": "log", "nice": False, "padding": 10}
    x = {
        "field": "step",
        "type": "quantitative",
        "title": "Time step, ms",
        "scale": scale,
        "axis": {"grid": False, "format": "~g", "tickCount": 5},
    }
    y = {"field": "error", "type": "quantitative", "title": quantity.label, "scale": scale, "axis": log_axis("y")}
    colour = method_scale("color", lines)
    dash = method_scale("strokeDash", lines)
    tooltip = [
        {"field": "method"},
        {"field": "step", "title": "time step, ms", "format": ".4~g"},
        {"field": "error", "title": quantity.label.lower(), "format": ".4~g"},
    ]
    point = {"type": "point", "filled": True, "opacity": 1, "size": 30, "aria": False}
    layers: list[Spec] = [
        {
            "data": {"values": rows},
            "transform": [{"filter": "indexof(hidden, datum.method) < 0"}],
            "encoding": {"x": x, "y": y, "color": colour},
            "layer": [
                {
                    "transform": [{"filter": "datum.band > 0"}],
                    "mark": {"type": "line", "aria": False, "opacity": BAND_OPACITY},
                    "encoding": {"strokeWidth": {"field": "band", "type": "quantitative", "scale": None}},
                },
                {"mark": {"type": "line", "strokeWidth": 1.5, "aria": False}, "encoding": {"strokeDash": dash}},
                {"mark": point, "encoding": {"tooltip": tooltip}},
            ],
        }
    ]
    made = framed(layers, height=260)
    # A legend in one row would be cut at the edge of the chart.
    columns = 2 if max(len(line.label) for line in lines) <= SHORT_LABEL else 1
    legend = made["config"]["legend"] | {"columns": columns}
    return made | {"config": made["config"] | {"legend": legend}, "params": [{"name": "hidden", "value": []}]}
