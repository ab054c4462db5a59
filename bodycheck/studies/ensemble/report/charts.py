"""The charts of the report of an ensemble: histograms, tails and maps. Their size does not depend on the number of members."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from bodycheck.reference.trajectory import Array
from bodycheck.reports.charts import INK, Spec, framed, log_axis, method_scale, zoomable
from bodycheck.reports.lines import Line
from bodycheck.reports.quantities import QUANTITIES, Quantity
from bodycheck.reports.series import rounded
from bodycheck.studies.ensemble.findings.aggregates import Figure
from bodycheck.studies.ensemble.findings.maps import Map
from bodycheck.studies.ensemble.findings.sensitivity import FAILURE

#: Height of a chart and of a map (pixels).
HEIGHT, MAP_HEIGHT = 260, 320

#: The colour of cells whose members did not fail, readable on white and on the dark ground.
SOUND = "#888888"

#: Opacity of these cells.
FAINT = 0.18


def histogram(figure: Figure, lines: Sequence[Line]) -> Spec:
    """Return the chart of the histograms of a figure of all methods over a log scale: the share of the members in each bin.

    lines: the lines of the methods, by their indices.
    """
    quantity = QUANTITIES[figure.name]
    centres = rounded(np.sqrt(figure.edges[:-1] * figure.edges[1:]))
    rows = [
        {
            "method": lines[index].label,
            "value": centres,
            "share": rounded(distribution.histogram / max(1, distribution.count)),
        }
        for index, distribution in figure.distributions.items()
    ]
    y = {
        "field": "share",
        "type": "quantitative",
        "title": "Share of the members",
        "axis": {"format": "%", "tickCount": 5},
        "stack": None,
    }
    return _over_values(quantity, rows, y, _drawn(figure, lines), "share of the members", {"interpolate": "step"})


def tail(figure: Figure, lines: Sequence[Line]) -> Spec:
    """Return the chart of the share of members with a larger value, or without any, on log scales.

    lines: the lines of the methods, by their indices.
    """
    quantity = QUANTITIES[figure.name]
    rows = []
    for index, distribution in figure.distributions.items():
        values, shares = distribution.tail
        drawn = np.isfinite(values) & (values > 0)
        rows.append({"method": lines[index].label, "value": rounded(values[drawn]), "share": rounded(shares[drawn])})
    y = {
        "field": "share",
        "type": "quantitative",
        "title": "Share of the members with more",
        "scale": {"type": "log", "nice": False},
        "axis": log_axis("y"),
    }
    return _over_values(quantity, rows, y, _drawn(figure, lines), "share of the members with as much or more", {})


def failure_map(drawn: Map, index: int) -> Spec:
    """Return the map of a method: cells with the share of failed members, or with the mean of a figure."""
    of_failures = drawn.figure == FAILURE
    cells = _cells(drawn, index)
    title = "Share of the members that failed" if of_failures else f"Mean {QUANTITIES[drawn.figure].label.lower()}"
    colour: dict[str, Any] = {
        "field": "value",
        "type": "quantitative",
        "title": title,
        "scale": {"scheme": "viridis", "reverse": True, "type": "sqrt" if of_failures else "log", "nice": False},
        "legend": {
            "orient": "top",
            "gradientLength": 240,
            "format": "~g" if of_failures else "~e",
            "title": title,
            "titleLimit": 400,
            "titleColor": INK,
            "titleFontWeight": "normal",
        },
    }
    if of_failures:
        colour["scale"]["domainMin"] = 0
    ends = {name: {"field": name, "type": "quantitative"} for name in ("x2", "y2")}
    place_of = {
        "x": {"field": "x", "type": "quantitative", "title": drawn.x, "scale": _scale(drawn.x_edges), "axis": {"grid": False}},
        "y": {"field": "y", "type": "quantitative", "title": drawn.y, "scale": _scale(drawn.y_edges), "axis": {"grid": False}},
        "x2": {"field": "x2"},
        "y2": {"field": "y2"},
    }
    tooltip = [
        {"field": "x", "type": "quantitative", "title": f"{drawn.x} from", "format": ".3~g"},
        {**ends["x2"], "title": "to", "format": ".3~g"},
        {"field": "y", "type": "quantitative", "title": f"{drawn.y} from", "format": ".3~g"},
        {**ends["y2"], "title": "to ", "format": ".3~g"},
        {"field": "members", "type": "quantitative"},
        {"field": "value", "type": "quantitative", "title": title.lower(), "format": ".3~g"},
    ]
    rect = {"type": "rect", "aria": False}
    sound: list[Spec] = [{"mark": rect | {"color": SOUND, "opacity": FAINT}, "encoding": {"tooltip": tooltip}}]
    coloured: Spec = {"mark": rect, "encoding": {"color": colour, "tooltip": tooltip}}
    coloured |= {"transform": [{"filter": "datum.value > 0"}]}
    layers: list[Spec] = [{"data": {"values": cells}, "encoding": place_of, "layer": [*sound, coloured]}]
    return framed(layers, MAP_HEIGHT)


def _over_values(
    quantity: Quantity, rows: list[dict[str, Any]], y: Spec, lines: Sequence[Line], share_title: str, options: dict[str, str]
) -> Spec:
    """Return a chart of shares over the values of a figure, with a line for each method and a tooltip at the nearest point."""
    x = {
        "field": "value",
        "type": "quantitative",
        "title": quantity.label,
        "scale": {"type": "log", "nice": False, "padding": 8},
        "axis": log_axis("x"),
    }
    hover = {"type": "point", "on": "pointermove", "nearest": True, "clear": "pointerout", "encodings": ["x", "y"]}
    tooltip = [
        {"field": "method", "type": "nominal"},
        {"field": "value", "type": "quantitative", "title": quantity.label.lower(), "format": ".4~g"},
        {"field": "share", "type": "quantitative", "title": share_title, "format": ".4~g"},
    ]
    line = {"type": "line", "clip": True, "aria": False, "tooltip": None} | options
    style = {channel: method_scale(channel, lines) for channel in ("strokeDash", "strokeWidth")}
    points = {
        "params": [{"name": "hover", "select": hover}],
        "mark": {"type": "point", "clip": True, "filled": True, "aria": False},
        "encoding": {"opacity": {"condition": {"param": "hover", "empty": False, "value": 1}, "value": 0}, "tooltip": tooltip},
    }
    layer: Spec = {
        "data": {"values": rows},
        "transform": [{"filter": "indexof(hidden, datum.method) < 0"}, {"flatten": ["value", "share"]}],
        "encoding": {"x": x, "y": y, "color": method_scale("color", lines)},
        "layer": [{"mark": line, "encoding": style}, points],
    }
    return zoomable([layer], HEIGHT) | {"params": [{"name": "hidden", "value": []}]}


def _drawn(figure: Figure, lines: Sequence[Line]) -> list[Line]:
    return [lines[index] for index in figure.distributions]


def _cells(drawn: Map, index: int) -> list[dict[str, Any]]:
    """Return the cells of a map that have members, each with its ends."""
    count, values = drawn.members[index], drawn.values[index]
    x, y = rounded(drawn.x_edges), rounded(drawn.y_edges)
    return [
        {
            "x": x[column],
            "x2": x[column + 1],
            "y": y[row],
            "y2": y[row + 1],
            "members": int(count[row, column]),
            "value": rounded([float(values[row, column])], 3)[0],
        }
        for row, column in np.argwhere(count > 0).tolist()
    ]


def _scale(edges: Array) -> dict[str, Any]:
    """Return the scale of an axis: logarithmic if the widths of the cells grow by a constant factor."""
    widths = np.diff(edges)
    log = bool(edges[0] > 0 and widths[-1] > 1.5 * widths[0])
    return {"type": "log" if log else "linear", "nice": False, "zero": False} if not log else {"type": "log", "nice": False}
