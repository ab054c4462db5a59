"""Parts of charts as Vega-Lite specifications, which are plain dictionaries.

Text and rules have the colour of the text around the chart, so that the same specification suits light and dark screens and
paper.
"""

from collections.abc import Sequence
from typing import Any

from bodycheck.reports.lines import Line

#: A Vega-Lite specification.
Spec = dict[str, Any]

#: The colour of the text around a chart.
INK = "currentColor"

#: Colours of the components of a vector, or of the parts of a sum.
COMPONENT_COLOURS = ("#009e73", "#b35c8d", "#8c8500")

#: Instructions for the reader of a `zoomable` chart.
ZOOMING = "Drag a chart to pan it, zoom with a pinch or with Ctrl and the wheel, and double-click to reset."


def without_legend(spec: Spec) -> Spec:
    """Return a chart without its legend, for a page that has its own legend."""
    return {**spec, "config": {**spec["config"], "legend": {"disable": True}}}


def zoomable(layers: list[Spec], height: int) -> Spec:
    """Return a chart of layers that zoom and pan together; `height` is in pixels.

    The wheel zooms only with Ctrl, which browsers also report for a pinch. Without Ctrl, it scrolls the page.
    """
    zoom = {"type": "interval", "zoom": "wheel![event.ctrlKey || event.metaKey]"}
    layers[-1]["layer"][0]["params"] = [{"name": "window", "select": zoom, "bind": "scales"}]
    return framed(layers, height)


def framed(layers: list[Spec], height: int) -> Spec:
    """Return a chart of layers in the common width and colours of all charts; `height` is in pixels."""
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
            "axis": {**text, **rules, "labelOverlap": "greedy", "labelSeparation": 6},
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


def log_axis(channel: str) -> Spec:
    """Return the axis of a logarithmic scale on a channel, `x` or `y`.

    Powers of ten are written as 1e-3. Ticks between them are faint, and have labels only if the axis spans less than two
    decades.
    """
    power = "abs(log(datum.value) / LN10 - round(log(datum.value) / LN10)) < 1e-6"
    near = f"log(domain('{channel}')[1] / domain('{channel}')[0]) < 2 * LN10"
    # These opacities are multiplied by those of the configuration.
    return {
        "tickCount": 7,
        "labelExpr": f"{power} || {near} ? replace(format(datum.value, '~e'), '+', '') : ''",
        "gridOpacity": {"condition": {"test": power, "value": 1}, "value": 0.25},
        "tickOpacity": {"condition": {"test": power, "value": 1}, "value": 0},
    }


def method_scale(channel: str, lines: Sequence[Line]) -> Spec:
    """Return the encoding of methods on a channel (color, strokeDash or strokeWidth) by the style of their lines."""
    values = {
        "color": [line.colour for line in lines],
        "strokeDash": [list(line.dash) for line in lines],
        "strokeWidth": [line.width for line in lines],
    }
    scale = {"type": "ordinal", "domain": [line.label for line in lines], "range": values[channel]}
    return {"field": "method", "type": "ordinal", "sort": None, "scale": scale}
