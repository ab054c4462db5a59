"""Charts of the error of methods over their cost, with the chosen method marked, one for each kind of scene."""

import math
from collections.abc import Mapping, Sequence

from bodycheck.reports.charts import INK, Spec, framed, log_axis
from bodycheck.reports.quantities import count, number
from bodycheck.reports.runs.choices import ENOUGH, Choice, Option
from bodycheck.reports.study import Chart

#: Smaller errors (rad or m) are drawn as this one, since a logarithmic scale cannot show zero.
SMALLEST = 1e-18

#: The most engines in a legend, which says how many others there are.
MOST_ENGINES = 6


def error_over_cost(choice: Choice) -> Chart | None:
    """Return the chart of a choice; None if fewer than two of its methods have a cost."""
    options = {one: one.cost for one in choice.options if one.cost is not None}
    if len(options) < 2 or choice.chosen not in options:
        return None
    unit = choice.kind.figure.unit
    ends = f"{choice.chosen.name} has {number(choice.chosen.error, 2)} {unit}"
    alt = (
        f"Largest {choice.kind.figure.title.lower()} over the cost on log scales, for {count(len(options), 'method')}. "
        f"The marked method, {ends}."
    )
    return Chart(choice.kind.title, _specification(choice, options), alt)


def _specification(choice: Choice, options: Mapping[Option, float]) -> Spec:
    rows = [_row(choice, option, cost) for option, cost in options.items()]
    scale = {"type": "log", "nice": False, "padding": 18}
    x = {
        "field": "cost",
        "type": "quantitative",
        "title": "Computing time per second of motion, s",
        "scale": scale,
        "axis": log_axis("x") | {"tickCount": 3},
    }
    y = {
        "field": "error",
        "type": "quantitative",
        "title": choice.kind.figure.label,
        "scale": scale | {"padding": 28},  # room for a name below the lowest point
        "axis": log_axis("y"),
    }
    hues: dict[str, str] = {}
    for option in options:
        hues.setdefault(option.line.engine, option.line.colour)
    colour = {
        "field": "engine",
        "type": "nominal",
        "sort": None,
        "title": None,
        "scale": {"domain": list(hues), "range": list(hues.values())},
        "legend": {"symbolLimit": MOST_ENGINES, "orient": "top", "symbolType": "circle", "symbolSize": 80},
    }
    tooltip = [
        {"field": "method"},
        {"field": "error", "title": choice.kind.figure.label.lower(), "format": ".2~g"},
        {"field": "cost", "title": "s per second of motion", "format": ".2~g"},
    ]
    marked = {"filter": "datum.chosen"}
    text = {"type": "text", "fontSize": 12, "fontWeight": "bold", "color": INK, "aria": False}
    # The limit and its words are above a method that is accurate enough, whose name therefore stands below its point.
    text |= {"baseline": "top", "dy": 12} if choice.chosen.error <= ENOUGH else {"dy": -14}
    text["align"] = _align([row["cost"] for row in rows], next(row["cost"] for row in rows if row["chosen"]))
    layers: list[Spec] = [
        _limit(choice.kind.figure.unit),
        {
            "data": {"values": rows},
            "encoding": {"x": x, "y": y},
            "layer": [
                {
                    "mark": {"type": "point", "filled": True, "opacity": 1, "size": 60, "aria": False},
                    "encoding": {"color": colour, "tooltip": tooltip},
                },
                {"transform": [marked], "mark": {"type": "point", "size": 260, "strokeWidth": 2, "color": INK, "aria": False}},
                {"transform": [marked], "mark": text, "encoding": {"text": {"field": "method"}}},
            ],
        },
    ]
    return framed(layers, height=260)


def _limit(unit: str) -> Spec:
    """Return the layer with the line of the error (unit) that is accurate enough, and what it means in words."""
    return {
        "data": {"values": [{"error": ENOUGH, "text": f"{number(ENOUGH)} {unit}: accurate enough"}]},
        "encoding": {"y": {"field": "error", "type": "quantitative"}},
        "layer": [
            {"mark": {"type": "rule", "strokeDash": [4, 4], "color": INK, "opacity": 0.6, "aria": False}},
            {
                "mark": {"type": "text", "x": 4, "dy": -7, "align": "left", "color": INK, "aria": False},
                "encoding": {"text": {"field": "text"}},
            },
        ],
    }


def _align(costs: Sequence[float], chosen: float) -> str:
    """Return the alignment of the text at the chosen method, with which it stays within the chart."""
    low, high = math.log(min(costs)), math.log(max(costs))
    fraction = (math.log(chosen) - low) / (high - low) if high > low else 0.5
    return "left" if fraction < 0.3 else "right" if fraction > 0.7 else "center"


def _row(choice: Choice, option: Option, cost: float) -> Spec:
    return {
        "method": option.name,
        "engine": option.line.engine,
        "error": float(f"{max(option.error, SMALLEST):.3g}"),
        "cost": float(f"{cost:.3g}"),
        "chosen": option is choice.chosen,
    }
