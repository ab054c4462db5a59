"""Charts of a quantity by release, with a line for each method and rings where it changed."""

from collections.abc import Mapping, Sequence
from typing import Any

from bodycheck.reports.charts import Spec, framed, log_axis, method_scale
from bodycheck.reports.lines import Line
from bodycheck.reports.quantities import Quantity, number
from bodycheck.reports.series import rounded

#: Line of a method, version, number or None, and the number that it changed from as text, empty if it did not change.
Point = tuple[Line, str, float | None, str]

#: Area of the ring that marks a change (square pixels).
RING = 150


def release_chart(quantity: Quantity, versions: Sequence[str], points: Sequence[Point]) -> Spec:
    """Return a complete chart of a quantity against versions, in their order.

    Zeros, which a log scale cannot show, and missing numbers leave gaps. The parameter `hidden` holds the labels of methods
    that are switched off.
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
        {"field": "label", "type": "nominal", "title": quantity.title.lower()},
    ]
    scales = {channel: method_scale(channel, lines) for channel in ("strokeDash", "strokeWidth")}
    # Releases are not numbers, so that only the vertical axis zooms.
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
    shown = number(value) if not before else f"{before} → {number(value)}"
    label = f"{shown} {quantity.unit}".rstrip()
    return {"method": line.label, "version": version, "value": drawn, "label": label, "changed": bool(before and drawn)}
