"""Charts as Vega-Lite specifications: plain dictionaries. Those of runs name their datasets and hold no data.

A chart of errors over time reads the datasets `series`, a row a method with `method`, `timestep`, an array a quantity, and
`every`, which says that the pointer finds one point of so many; `times`, a row a time step with the array `t`; `floor`, a row
with the arrays `t` and `truth_error`. The charts of the angular momentum read `momentum`, a row with the arrays `t`, `I`, `J`,
`K` and `x`, `y`, `z`. With `datasets` set to these, a specification is complete. The parameter `hidden` holds the names of
methods that are switched off.

Text and rules have the colour of the text around the chart, so that one specification suits light, dark and paper.
"""

from collections.abc import Sequence
from typing import Any

from bodycheck.reports.lines import Line
from bodycheck.reports.quantities import Quantity

Spec = dict[str, Any]

FRAMES = {"body": ("I", "J", "K"), "inertial": ("x", "y", "z")}
COMPONENT_COLOURS = ("#009e73", "#b35c8d", "#8c8500")
COMPONENT_DASHES = ((1, 0), (7, 3), (2, 2))
INK = "currentColor"

#: What the reader of a `zoomable` chart can do.
ZOOMING = "Drag to pan, zoom with Ctrl and the wheel or a pinch, double-click to reset."


def over_time(quantity: Quantity, lines: Sequence[Line]) -> Spec:
    """A quantity over time on a log scale, one line a method; the truth's own error is a grey floor under attitude errors.

    Zeros have no place on a log scale and are left out.
    """
    scale = {"type": "log", "nice": False}
    y = {
        "field": "value",
        "type": "quantitative",
        "title": quantity.label,
        "scale": scale,
        "axis": log_axis("y"),
        "stack": None,
    }
    methods = {
        "data": {"name": "series"},
        "transform": [
            {"filter": "indexof(hidden, datum.method) < 0"},
            {"lookup": "timestep", "from": {"data": {"name": "times"}, "key": "timestep", "fields": ["t"]}},
            {"flatten": ["t", quantity.name], "as": ["t", "value"]},
            {"filter": "datum.value > 0"},
        ],
        "encoding": {"x": _time(), "y": y, "color": method_scale("color", lines)},
        "layer": [
            {
                "mark": {"type": "line", "clip": True, "aria": False},
                "encoding": {
                    "strokeDash": method_scale("strokeDash", lines),
                    "strokeWidth": method_scale("strokeWidth", lines),
                },
            },
            {"transform": [{"window": [{"op": "row_number", "as": "row"}]}, {"filter": "datum.row % datum.every == 0"}]}
            | _points(_tooltip("method", quantity.title, quantity.unit)),
        ],
    }
    layers: list[Spec] = [methods]
    if quantity.name == "attitude_error":
        layers.insert(0, _floor(y))
    return zoomable(layers, height=260) | {"params": [{"name": "hidden", "value": []}]}


def momentum(frame: str) -> Spec:
    """The truth's angular momentum by its components in one frame of `FRAMES`, on the scale that both frames share."""
    components = FRAMES[frame]
    everything = [component for those in FRAMES.values() for component in those]
    unit = "kg m²/s"
    y = {"type": "quantitative", "title": f"Angular momentum, {unit}", "axis": {"tickCount": 6, "format": "~g"}}
    source = {"name": "momentum"}
    curves = {
        "data": source,
        "transform": [
            {"flatten": ["t", *components]},
            {"fold": list(components), "as": ["component", "value"]},
        ],
        "encoding": {
            "x": _time(),
            "y": {**y, "field": "value"},
            "color": _components("color", components, COMPONENT_COLOURS),
        },
        "layer": [
            {
                "mark": {"type": "line", "clip": True, "strokeWidth": 1.5, "aria": False},
                "encoding": {"strokeDash": _components("strokeDash", components, COMPONENT_DASHES)},
            },
            _points(_tooltip("component", "angular momentum", unit)),
        ],
    }
    bounds = {
        "data": source,
        "transform": [
            {"flatten": everything},
            {"fold": everything, "as": ["component", "value"]},
            {"aggregate": [{"op": op, "field": "value", "as": op} for op in ("min", "max")]},
            {"fold": ["min", "max"], "as": ["end", "bound"]},
        ],
        "mark": {"type": "point", "opacity": 0, "tooltip": None, "aria": False},
        "encoding": {"y": {**y, "field": "bound"}},
    }
    return zoomable([bounds, curves], height=220)


def without_legend(spec: Spec) -> Spec:
    """The same chart, for a page that has a legend of its own."""
    return {**spec, "config": {**spec["config"], "legend": {"disable": True}}}


def zoomable(layers: list[Spec], height: int) -> Spec:
    """Layers that zoom and pan together. The wheel alone scrolls the page; with Ctrl, which a pinch sends too, it zooms."""
    zoom = {"type": "interval", "zoom": "wheel![event.ctrlKey || event.metaKey]"}
    layers[-1]["layer"][0]["params"] = [{"name": "window", "select": zoom, "bind": "scales"}]
    return framed(layers, height)


def framed(layers: list[Spec], height: int) -> Spec:
    """Layers in the width and the colours of all charts."""
    text = {"labelColor": INK, "titleColor": INK, "labelFontSize": 11, "titleFontSize": 11, "titleFontWeight": "normal"}
    rules = {
        "domainColor": INK,
        "tickColor": INK,
        "gridColor": INK,
        "gridOpacity": 0.12,
        "domainOpacity": 0.5,
        "tickOpacity": 0.5,
    }
    return {
        "width": 560,
        "height": height,
        "layer": layers,
        "config": {
            "background": None,
            "font": "system-ui, sans-serif",
            "view": {"stroke": None},
            "axis": {**text, **rules, "labelOverlap": "greedy"},
            "legend": {
                "labelColor": INK,
                "orient": "top",
                "title": None,
                "symbolType": "stroke",
                "symbolSize": 300,
                "labelLimit": 300,
            },
        },
    }


def _points(tooltip: Spec) -> Spec:
    """Points that are seen only near the pointer."""
    hover = {"type": "point", "on": "pointermove", "nearest": True, "clear": "pointerout", "encodings": ["x", "y"]}
    return {
        "params": [{"name": "hover", "select": hover}],
        "mark": {"type": "point", "clip": True, "filled": True, "size": 50, "aria": False},
        "encoding": {"opacity": {"condition": {"param": "hover", "empty": False, "value": 1}, "value": 0}, "tooltip": tooltip},
    }


def _floor(y: Spec) -> Spec:
    return {
        "data": {"name": "floor"},
        "transform": [{"flatten": ["t", "truth_error"], "as": ["t", "value"]}, {"filter": "datum.value > 0"}],
        "mark": {
            "type": "area",
            "clip": True,
            "tooltip": None,
            "aria": False,
            "color": "#888888",
            "opacity": 0.28,
            "line": {"color": "#888888", "strokeWidth": 1, "opacity": 1},
        },
        "encoding": {"x": _time(), "y": y, "y2": {"value": "height"}},
    }


def log_axis(channel: str) -> Spec:
    """Ticks with powers of ten as 1e-3; those between are faint, and labelled only where fewer than two decades are seen."""
    power = "abs(log(datum.value) / LN10 - round(log(datum.value) / LN10)) < 1e-6"
    near = f"log(domain('{channel}')[1] / domain('{channel}')[0]) < 2 * LN10"
    # The opacities here are shares of those that the configuration gives.
    return {
        "tickCount": 7,
        "labelExpr": f"{power} || {near} ? replace(format(datum.value, '~e'), '+', '') : ''",
        "gridOpacity": {"condition": {"test": power, "value": 1}, "value": 0.25},
        "tickOpacity": {"condition": {"test": power, "value": 1}, "value": 0},
    }


def _time() -> Spec:
    return {
        "field": "t",
        "type": "quantitative",
        "title": "Time, s",
        "scale": {"nice": False},
        "axis": {"grid": False, "tickCount": 6},
    }


def _tooltip(field: str, reading: str, unit: str) -> Spec:
    """What the pointer shows of the nearest point. There `datum` is the point, which has its row as its own `datum`."""
    row = "(datum.datum || datum)"
    suffix = f" + ' {unit}'" if unit else ""
    value = f"format({row}.value, '.4~g'){suffix}"
    return {
        "value": {"expr": f"{{'{field}': {row}.{field}, 'time': format({row}.t, '.7~g') + ' s', '{reading.lower()}': {value}}}"}
    }


def method_scale(channel: str, lines: Sequence[Line]) -> Spec:
    """The encoding of methods by their lines' color, strokeDash or strokeWidth."""
    values = {
        "color": [line.colour for line in lines],
        "strokeDash": [list(line.dash) for line in lines],
        "strokeWidth": [line.width for line in lines],
    }
    scale = {"type": "ordinal", "domain": [line.label for line in lines], "range": values[channel]}
    return {"field": "method", "type": "ordinal", "sort": None, "scale": scale}


def _components(channel: str, components: Sequence[str], values: Sequence[Any]) -> Spec:
    ranges = [list(value) if isinstance(value, tuple) else value for value in values]
    return {"field": "component", "type": "nominal", "scale": {"domain": list(components), "range": ranges}}
