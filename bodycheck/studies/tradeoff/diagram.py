"""Work-precision diagrams: what an error costs, a curve a method through its time steps, on log scales."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any

from bodycheck.reports.charts import INK, Spec, log_axis, method_scale, zoomable
from bodycheck.reports.lines import Line
from bodycheck.reports.quantities import Quantity, bound
from bodycheck.reports.series import rounded
from bodycheck.running.key import RunKey
from bodycheck.studies.tradeoff.recommendation import Measured

#: Of stored costs: none that were measured apart fall together.
COST_DIGITS = 6

#: How far below the truth's own error a diagram goes.
BAND = 10.0

#: An error so many times larger than the truth's own is drawn without it, so that the curves have the room.
FAR = 1e4

#: Marks that say nothing of their own.
QUIET = {"clip": True, "tooltip": None, "aria": False}


def diagram(quantity: Quantity, points: Sequence[Measured], lines: Mapping[RunKey, Line], truth_error: float = 0.0) -> Spec:
    """Errors in a quantity against seconds of computing for a simulated second, with the Pareto front of the methods shown.

    points: of one case, at least one error not zero. lines: by method. truth_error: the truth's own error in
    the quantity, 0 where it is not known; errors below it count as equal to it. Zeros have no place on a log scale and are
    left out. The parameter `hidden` holds the labels of methods that are switched off.
    """
    drawn = list(dict.fromkeys(lines[point.method] for point in points))
    x = {
        "field": "cost",
        "type": "quantitative",
        "title": "Computing time for a simulated second, s",
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
    cheapest_first = [{"field": "cost"}, {"field": "told"}]
    measured = {
        "data": {"values": _columns(points, lines)},
        "transform": [
            {"filter": "indexof(hidden, datum.method) < 0"},
            {"flatten": ["timestep", "cost", "low", "high", "error"]},
            {"calculate": f"max(datum.error, {truth_error!r})", "as": "told"},
            {"window": [{"op": "min", "field": "told", "as": "least"}], "sort": cheapest_first, "frame": [None, 0]},
            {"window": [{"op": "lag", "field": "least", "as": "before"}], "sort": cheapest_first},
            {"calculate": "datum.before == null || datum.told < datum.before", "as": "front"},
            {"filter": "datum.error > 0"},
        ],
        "encoding": {"x": x, "y": y, "color": method_scale("color", drawn)},
        "layer": [_curves(drawn), *_front(), *_points(quantity)],
    }
    layers: list[Spec] = [_truth(truth_error, y), measured] if truth_error else [measured]
    return zoomable(layers, height=320) | {"params": [{"name": "hidden", "value": []}]}


def _columns(points: Sequence[Measured], lines: Mapping[RunKey, Line]) -> list[dict[str, Any]]:
    """A row a method with its points in arrays, from the largest time step to the smallest."""
    methods: dict[str, list[Measured]] = defaultdict(list)
    for point in sorted(points, key=lambda point: -point.timestep):
        methods[lines[point.method].label].append(point)
    return [
        {
            "method": method,
            "timestep": [point.timestep for point in own],
            "cost": rounded((point.cost for point in own), COST_DIGITS),
            "low": rounded((point.cost_low for point in own), COST_DIGITS),
            "high": rounded((point.cost_high for point in own), COST_DIGITS),
            "error": rounded(point.error for point in own),
        }
        for method, own in methods.items()
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
    """The front as a step under the curves, and rings around its points."""
    own, ink = [{"filter": "datum.front"}], {"color": {"value": INK}}
    order = {"field": "cost", "type": "quantitative"}
    step = {"type": "line", "interpolate": "step-after", "strokeWidth": 6, "opacity": 0.13}
    ring = {"type": "point", "filled": False, "size": 130, "strokeWidth": 1.2, "opacity": 0.75}
    return [
        {"transform": own, "mark": step | QUIET, "encoding": {**ink, "order": order}},
        {"transform": own, "mark": ring | QUIET, "encoding": ink},
    ]


def _points(quantity: Quantity) -> list[Spec]:
    """The points, with the spread of the repeated timings; larger near the pointer."""
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
    """What the pointer shows of the nearest point. There `datum` is the point, which has its row as its own `datum`."""
    row = "(datum.datum || datum)"
    unit = f" + ' {quantity.unit}'" if quantity.unit else ""
    return {
        "value": {
            "expr": f"{{'method': {row}.method, 'time step': format({row}.timestep * 1e3, '.4~g') + ' ms', "
            f"'{quantity.title.lower()}': format({row}.error, '.4~g'){unit}, "
            f"'computing time': format({row}.cost, '.3~g') + ' s', "
            f"'in repeats': format({row}.low, '.3~g') + ' to ' + format({row}.high, '.3~g') + ' s'}}"
        }
    }


def _truth(truth_error: float, y: Spec) -> Spec:
    """The truth's own error as a grey band, named."""
    label = f"the truth's own error, {bound(truth_error, 2)} rad"
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
