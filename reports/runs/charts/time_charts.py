"""Charts over time in a report of runs: Vega-Lite specifications that refer to datasets by name and contain no data.

Each specification is stored once in a page and drawn with the datasets of every case, which `curves` makes:

- `series`: one row for each method, with `method`, `timestep`, one array for each quantity, and `every`, the stride between
  points with a tooltip; for a curve that lies below one that looks the same, the width in pixels of a band around it, such as
  `attitude_error_band`.
- `times`: one row for each time step, with the array `t`.
- `floor`: one row with the array `t` and one array for each quantity, empty where its floor is not drawn.
- `joints`: one row for each curve of a joint; see `joint_curves`.
- `sensors`: one row for each curve of a component of a sensor; see `sensor_curves`.
- `momentum`: one row with the arrays `t`, `I`, `J`, `K` (body frame) and `x`, `y`, `z` (inertial frame).

A specification is complete if its entry `datasets` is set to these datasets. Its parameter `hidden` is the list of the methods
that the reader has switched off, and `chosen` is the name of the highlighted method; it is empty if no method is highlighted.
"""

from collections.abc import Sequence
from typing import Any

from bodycheck.reports.charts import COMPONENT_COLOURS, Spec, log_axis, method_scale, zoomable
from bodycheck.reports.lines import Line
from bodycheck.reports.quantities import Quantity
from bodycheck.reports.runs.charts import joint_curves

#: The axes of each frame.
FRAMES = {"body": ("I", "J", "K"), "inertial": ("x", "y", "z")}
#: The opacity of the curves of all other methods if a method is highlighted.
FADED = 0.2
#: The opacity of the band around a curve that lies below one that looks the same.
BAND_OPACITY = 0.35
#: The width of the band of a stop, in pixels.
BAND = 9
#: The dash patterns of the three components: lengths on and off, in pixels.
COMPONENT_DASHES = ((1, 0), (7, 3), (2, 2))


def over_time(quantity: Quantity, lines: Sequence[Line]) -> Spec:
    """Return the chart of a quantity over time on a logarithmic scale, with one line for each method.

    Zeros are left out, because they have no place on a logarithmic scale. The truth's own error is a grey area, if the dataset
    `floor` contains it.
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
                "transform": [{"filter": f"datum['{quantity.name}_band'] > 0 && chosen === ''"}],
                "mark": {"type": "line", "clip": True, "aria": False, "opacity": BAND_OPACITY},
                "encoding": {"strokeWidth": {"field": f"{quantity.name}_band", "type": "quantitative", "scale": None}},
            },
            {
                "mark": {"type": "line", "clip": True, "aria": False},
                "encoding": {
                    "opacity": {"condition": {"test": "chosen === '' || datum.method === chosen", "value": 1}, "value": FADED},
                    "strokeDash": method_scale("strokeDash", lines),
                    "strokeWidth": method_scale("strokeWidth", lines),
                },
            },
            {"transform": [{"window": [{"op": "row_number", "as": "row"}]}, {"filter": "datum.row % datum.every == 0"}]}
            | _points(_tooltip("method", quantity.title, quantity.unit)),
        ],
    }
    layers: list[Spec] = [methods]
    if quantity.bounded:
        layers.insert(0, _floor(quantity.name, y))
    return zoomable(layers, height=260) | {"params": [{"name": "hidden", "value": []}, {"name": "chosen", "value": ""}]}


def momentum(frame: str) -> Spec:
    """Return the chart of the truth's angular momentum in one of `FRAMES`, on a scale that both frames share."""
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


def joints(kind: str) -> Spec:
    """Return the chart of the joint coordinates of one kind: a colour for each coordinate, solid for the truth, else dashed.

    Targets are thin and dotted. A stop is a band on its outer side in the colour of its joint.
    """
    title, unit = {"angle": ("Angle", "rad"), "slide": ("Displacement", "m")}[kind]
    is_truth, is_target = (f"datum.method === '{name}'" for name in (joint_curves.TRUTH, joint_curves.TARGET))
    is_stop = f"datum.method === '{joint_curves.STOP}'"
    y = {
        "field": "value",
        "type": "quantitative",
        "title": f"{title}, {unit}",
        "scale": {"zero": False},
        "axis": {"tickCount": 6, "format": "~g"},
    }
    # A legend would have the opacity and the form of the bands.
    legend = {"symbolOpacity": 1, "symbolStrokeWidth": 2}
    colour = {"field": "joint", "type": "nominal", "sort": None, "scale": {"scheme": "tableau10"}, "legend": legend}

    def styled(truth: Any, target: Any, other: Any) -> Spec:
        return {"condition": [{"test": is_truth, "value": truth}, {"test": is_target, "value": target}], "value": other}

    def band(beyond: str, offset: int) -> Spec:
        return {
            "data": {"name": "joints"},
            "transform": [
                {"filter": f"datum.kind === '{kind}' && {is_stop} && datum.beyond === '{beyond}'"},
                {"flatten": ["t", "value"]},
            ],
            "mark": {"type": "rect", "clip": True, "tooltip": None, "aria": False, "opacity": 0.35, "y2Offset": offset},
            "encoding": {"x": {"value": 0}, "x2": {"value": "width"}, "y": y, "y2": {"field": "value"}, "color": colour},
        }

    curves = _curves("joints", f"datum.kind === '{kind}' && !({is_stop})", y, colour, _tooltip("joint", title, unit))
    curves["layer"][0]["encoding"] = {"strokeDash": styled([1, 0], [1.5, 3], [5, 4]), "strokeWidth": styled(2, 1.3, 1.4)}
    layers = [band("lower", BAND), band("upper", -BAND), curves]
    return zoomable(layers, height=260) | {"params": [{"name": "hidden", "value": []}, {"name": "chosen", "value": ""}]}


def readings(number: int) -> Spec:
    """Return the chart of the readings of a sensor: a colour for each component, solid for the truth, else dashed."""
    y = {"field": "value", "type": "quantitative", "title": "Reading", "axis": {"tickCount": 6, "format": "~g"}}
    colour = {"field": "component", "type": "nominal", "sort": None, "scale": {"scheme": "tableau10"}}
    curves = _curves("sensors", f"datum.sensor === {number}", y, colour, _tooltip("component", "Reading", ""))
    is_truth = f"datum.method === '{joint_curves.TRUTH}'"
    curves["layer"][0]["encoding"] = {"strokeDash": {"condition": {"test": is_truth, "value": [1, 0]}, "value": [5, 4]}}
    return zoomable([curves], height=220) | {"params": [{"name": "hidden", "value": []}, {"name": "chosen", "value": ""}]}


def _curves(name: str, chosen: str, y: Spec, colour: Spec, tooltip: Spec) -> Spec:
    """Return the curves of a dataset with these rows, and their points with a tooltip."""
    return {
        "data": {"name": name},
        "transform": [{"filter": chosen}, {"filter": "indexof(hidden, datum.method) < 0"}, {"flatten": ["t", "value"]}],
        "encoding": {"x": _time(), "y": y, "color": colour, "detail": {"field": "method", "type": "nominal"}},
        "layer": [{"mark": {"type": "line", "clip": True, "aria": False}}, _points(tooltip)],
    }


def _points(tooltip: Spec) -> Spec:
    """Return a layer of points of which only the one nearest to the pointer is visible."""
    hover = {"type": "point", "on": "pointermove", "nearest": True, "clear": "pointerout", "encodings": ["x", "y"]}
    return {
        "params": [{"name": "hover", "select": hover}],
        "mark": {"type": "point", "clip": True, "filled": True, "size": 50, "aria": False},
        "encoding": {"opacity": {"condition": {"param": "hover", "empty": False, "value": 1}, "value": 0}, "tooltip": tooltip},
    }


def _floor(name: str, y: Spec) -> Spec:
    return {
        "data": {"name": "floor"},
        "transform": [{"flatten": ["t", name], "as": ["t", "value"]}, {"filter": "datum.value > 0"}],
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


def _time() -> Spec:
    return {
        "field": "t",
        "type": "quantitative",
        "title": "Time, s",
        "scale": {"nice": False},
        "axis": {"grid": False, "tickCount": 6},
    }


def _tooltip(field: str, reading: str, unit: str) -> Spec:
    """Return the tooltip of a point: the value of `field`, the time, and the reading with its unit.

    In its expression, `datum` is either the row or the point, whose entry `datum` is the row.
    """
    row = "(datum.datum || datum)"
    suffix = f" + ' {unit}'" if unit else ""
    value = f"format({row}.value, '.4~g'){suffix}"
    return {
        "value": {"expr": f"{{'{field}': {row}.{field}, 'time': format({row}.t, '.4~g') + ' s', '{reading.lower()}': {value}}}"}
    }


def _components(channel: str, components: Sequence[str], values: Sequence[Any]) -> Spec:
    ranges = [list(value) if isinstance(value, tuple) else value for value in values]
    return {"field": "component", "type": "nominal", "scale": {"domain": list(components), "range": ranges}}
