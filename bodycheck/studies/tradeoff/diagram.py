"""Work-precision diagrams: errors against cost on log scales, with a curve for each method through its time steps."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any

from bodycheck.reports.charts import INK, Spec, log_axis, method_scale, zoomable
from bodycheck.reports.lines import Line
from bodycheck.reports.quantities import Quantity, bound
from bodycheck.reports.series import rounded
from bodycheck.results.key import RunKey
from bodycheck.studies.tradeoff.measurements import Measured

#: Significant digits of stored costs, so that different measured costs remain different.
COST_DIGITS = 6

#: Factor by which a diagram extends below the truth's own error.
BAND = 10.0

#: If all errors exceed the truth's own error by this factor, the latter is left out, so that the curves have more room.
FAR = 1e4

#: Properties of marks without tooltips and without descriptions for screen readers.
QUIET = {"clip": True, "tooltip": None, "aria": False}


def diagram(quantity: Quantity, points: Sequence[Measured], lines: Mapping[RunKey, Line], truth_error: float = 0.0) -> Spec:
    """Return a chart of errors against computing time per simulated second, with the Pareto front of the methods shown.

    Zeros are left out, because a log scale cannot show them. The parameter `hidden` of the chart holds the labels of methods
    that are switched off.

    Parameters
    ----------
    quantity
        The quantity of the errors.
    points
        Runs of one case, at least one with an error other than zero.
    lines
        Lines by method.
    truth_error
        The truth's own error in the quantity; 0 if it is not known. Errors below it count as equal to it.
    """
    drawn = list(dict.fromkeys(lines[point.method] for point in points))
    x = {
        "field": "cost",
        "type": "quantitative",
        "title": "Computing time per simulated second, s",
        "scale": {"type": "log", "nice": False, "padding": 12},
        "axis": log_axis("x") | {"grid": False},
    }
    y = {
        "field": "error",
        "type": "quantitative",
        "title": quantity.label,
        "scale": {"type": "log", "nice": False, "domain": _domain(points, truth_error)},
        "axis": log_axis("y"),
    }
    cheapest_first = [{"field": "cost"}, {"field": "bounded"}]
    measured = {
        "data": {"values": _columns(points, lines)},
        "transform": [
            {"filter": "indexof(hidden, datum.method) < 0"},
            {"flatten": ["timestep", "cost", "low", "high", "error"]},
            {"calculate": f"max(datum.error, {truth_error!r})", "as": "bounded"},
            {"window": [{"op": "min", "field": "bounded", "as": "least"}], "sort": cheapest_first, "frame": [None, 0]},
            {"window": [{"op": "lag", "field": "least", "as": "before"}], "sort": cheapest_first},
            {"calculate": "datum.before == null || datum.bounded < datum.before", "as": "front"},
            {"filter": "datum.error > 0"},
        ],
        "encoding": {"x": x, "y": y, "color": method_scale("color", drawn)},
        "layer": [_curves(drawn), *_front(), *_points(quantity)],
    }
    layers: list[Spec] = [_truth(truth_error, quantity, y), measured] if truth_error else [measured]
    return zoomable(layers, height=320) | {"params": [{"name": "hidden", "value": []}]}


def _columns(points: Sequence[Measured], lines: Mapping[RunKey, Line]) -> list[dict[str, Any]]:
    """Return a row for each method with its points in arrays, from the largest time step to the smallest."""
    methods: dict[str, list[Measured]] = defaultdict(list)
    for point in sorted(points, key=lambda point: -point.step):
        methods[lines[point.method].label].append(point)
    return [
        {
            "method": method,
            "timestep": [point.step for point in method_points],
            "cost": rounded((point.cost for point in method_points), COST_DIGITS),
            "low": rounded((point.cost_low for point in method_points), COST_DIGITS),
            "high": rounded((point.cost_high for point in method_points), COST_DIGITS),
            "error": rounded(point.error for point in method_points),
        }
        for method, method_points in methods.items()
    ]


def _domain(points: Sequence[Measured], truth_error: float) -> list[float]:
    errors = [point.error for point in points if point.error > 0]
    least = min(errors)
    near = truth_error > 0 and least < FAR * truth_error
    return [min(least / 2, truth_error / BAND) if near else least / 2, 2 * max(errors)]


def _curves(lines: Sequence[Line]) -> Spec:
    order = {"field": "timestep", "type": "quantitative", "sort": "descending"}
    scales = {channel: method_scale(channel, lines) for channel in ("strokeDash", "strokeWidth")}
    return {"mark": {"type": "line", "clip": True, "aria": False}, "encoding": {**scales, "order": order}}


def _front() -> list[Spec]:
    """Return two layers: the front as a staircase, and rings around its points."""
    on_front, ink = [{"filter": "datum.front"}], {"color": {"value": INK}}
    order = {"field": "cost", "type": "quantitative"}
    step = {"type": "line", "interpolate": "step-after", "strokeWidth": 6, "opacity": 0.13}
    ring = {"type": "point", "filled": False, "size": 130, "strokeWidth": 1.2, "opacity": 0.75}
    return [
        {"transform": on_front, "mark": step | QUIET, "encoding": {**ink, "order": order}},
        {"transform": on_front, "mark": ring | QUIET, "encoding": ink},
    ]


def _points(quantity: Quantity) -> list[Spec]:
    """Return two layers: the spread of the repeated timings, and the points; the point nearest to the pointer is larger."""
    hover = {"type": "point", "on": "pointermove", "nearest": True, "clear": "pointerout", "encodings": ["x", "y"]}
    return [
        {"mark": {"type": "rule", "opacity": 0.35, **QUIET}, "encoding": {"x": {"field": "low"}, "x2": {"field": "high"}}},
        {
            "params": [{"name": "hover", "select": hover}],
            "mark": {"type": "point", "clip": True, "filled": True, "opacity": 1, "aria": False},
            "encoding": {
                "size": {"condition": {"param": "hover", "empty": False, "value": 90}, "value": 22},
                "tooltip": _tooltip(quantity),
            },
        },
    ]


def _tooltip(quantity: Quantity) -> Spec:
    """Return the tooltip of a point.

    In its expression, `datum` is either the row, or an object whose attribute `datum` is the row.
    """
    row = "(datum.datum || datum)"
    unit = f" + ' {quantity.unit}'" if quantity.unit else ""
    return {
        "value": {
            "expr": f"{{'method': {row}.method, 'time step': format({row}.timestep * 1e3, '.4~g') + ' ms', "
            f"'{quantity.title.lower()}': format({row}.error, '.4~g'){unit}, "
            f"'computing time': format({row}.cost, '.3~g') + ' s', "
            f"'repeated timings': format({row}.low, '.3~g') + ' to ' + format({row}.high, '.3~g') + ' s'}}"
        }
    }


def _truth(truth_error: float, quantity: Quantity, y: Spec) -> Spec:
    """Return a layer with the truth's own error as a grey band with a label."""
    label = f"the truth's own error, {bound(truth_error, 2)} {quantity.unit}".rstrip()
    edge = {**y, "field": "floor"}
    text = {"type": "text", "align": "left", "baseline": "top", "dx": 4, "dy": 3, "fontSize": 10, "text": label, "color": INK}
    return {
        "data": {"values": [{"floor": truth_error}]},
        "layer": [
            {
                "mark": {"type": "rect", "color": "#888888", "opacity": 0.28, **QUIET},
                "encoding": {"y": edge, "y2": {"value": "height"}},
            },
            {"mark": {"type": "rule", "color": "#888888", **QUIET}, "encoding": {"y": edge}},
            {"mark": {**text, "opacity": 0.8, **QUIET}, "encoding": {"x": {"value": 0}, "y": edge}},
        ],
    }
