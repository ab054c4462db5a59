"""A figure by release, a line a method, with rings where it changed."""

from collections.abc import Mapping, Sequence
from typing import Any

from bodycheck.reports.charts import Spec, framed, log_axis, method_scale
from bodycheck.reports.lines import Line
from bodycheck.reports.quantities import Quantity, number
from bodycheck.reports.series import rounded

#: A method, a version, a figure, None where there is none, and from what it changed, empty where it did not.
Point = tuple[Line, str, float | None, str]

#: Area of what marks a change (pixels).
RING = 150


def release_chart(quantity: Quantity, versions: Sequence[str], points: Sequence[Point]) -> Spec:
    """A figure against versions, in their order, complete with its data.

    Zeros have no place on a log scale; they and what is not there leave a gap. The parameter `hidden` holds the labels of
    methods that are switched off.
    """
    lines = list(dict.fromkeys(line for line, *_ in points))
    label = {"labelAngle": -60, "labelFontSize": 10, "labelOverlap": False, "grid": False}
    x = {"field": "version", "type": "ordinal", "sort": list(versions), "title": "Release", "axis": label}
    y = {
        "field": "value",
        "type": "quantitative",
        "title": quantity.label,
        "scale": {"type": "log", "nice": False, "padding": 12},
        "axis": log_axis("y"),
    }
    tooltip = [
        {"field": "method", "type": "nominal"},
        {"field": "version", "type": "nominal", "title": "release"},
        {"field": "told", "type": "nominal", "title": quantity.title.lower()},
    ]
    scales = {channel: method_scale(channel, lines) for channel in ("strokeDash", "strokeWidth")}
    # Releases are no numbers: what is zoomed is the figure alone.
    zoom = {"type": "interval", "encodings": ["y"], "zoom": "wheel![event.ctrlKey || event.metaKey]"}
    ring = {"type": "point", "clip": True, "aria": False, "filled": False, "size": RING, "strokeWidth": 1.6, "opacity": 0.9}
    layers: list[Spec] = [
        {
            "data": {"values": [_values(point, quantity) for point in points]},
            "transform": [{"filter": "indexof(hidden, datum.method) < 0"}],
            "encoding": {"x": x, "y": y, "color": method_scale("color", lines)},
            "layer": [
                {
                    "params": [{"name": "window", "select": zoom, "bind": "scales"}],
                    "mark": {"type": "line", "clip": True, "aria": False, "opacity": 0.8},
                    "encoding": scales,
                },
                {
                    "transform": [{"filter": "isValid(datum.value)"}],
                    "mark": {"type": "point", "clip": True, "filled": True, "size": 26, "opacity": 1, "aria": False},
                    "encoding": {"tooltip": tooltip},
                },
                {"transform": [{"filter": "datum.changed"}], "mark": ring, "encoding": {"tooltip": tooltip}},
            ],
        }
    ]
    return framed(layers, height=300) | {"params": [{"name": "hidden", "value": []}]}


def _values(point: Point, quantity: Quantity) -> Mapping[str, Any]:
    line, version, value, before = point
    drawn = rounded([value])[0] if value else None
    told = number(value) if not before else f"{before} → {number(value)}"
    said = f"{told} {quantity.unit}".rstrip()
    return {"method": line.label, "version": version, "value": drawn, "told": said, "changed": bool(before and drawn)}
