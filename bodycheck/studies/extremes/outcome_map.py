"""The outcomes of runs over spin and time step, as a heat map."""

from collections.abc import Sequence

from bodycheck.reports.charts import INK, Spec
from bodycheck.studies.extremes.rows import STATUSES, Row

#: Colours of Okabe and Ito, which colour-blind readers can distinguish, and further colours that are as light, so that black
#: letters are readable on all of them.
COLOURS = {
    "ok": "#009e73",
    "inaccurate": "#f0e442",
    "energy-loss": "#56b4e9",
    "energy-gain": "#e69f00",
    "frozen": "#c9b79c",
    "diverged": "#d55e00",
    "reset": "#cc79a7",
    "crashed": "#d96a6a",
    "timeout": "#a9a9a9",
    "unsupported": "#dedede",
}

#: Letters in the cells.
LETTERS = {
    "ok": "",
    "inaccurate": "I",
    "energy-loss": "−",
    "energy-gain": "+",
    "frozen": "F",
    "diverged": "D",
    "reset": "R",
    "crashed": "C",
    "timeout": "T",
    "unsupported": "U",
}

#: Height of a cell (pixels).
CELL = 26


def outcome_map(rows: Sequence[Row]) -> Spec:
    """Return a complete chart with a cell for each spin and time step. Its colour and letter show the status of the run."""
    seen = [status for status in STATUSES if any(row.status == status for row in rows)]
    values = [{"spin": row.value, "step": row.timestep, "status": row.status, "detail": row.detail} for row in rows]
    text = {"labelColor": INK, "titleColor": INK, "labelFontSize": 11, "titleFontSize": 11, "titleFontWeight": "normal"}
    quiet = {"domain": False, "ticks": False, "grid": False}
    powers = {"labelExpr": "replace(format(datum.value, '~e'), '+', '')", "labelAngle": 0}
    legend = {f"datum.label == '{status}'": f"{LETTERS[status]} {status}".strip() for status in seen}
    label = " : ".join(f"{test} ? '{shown}'" for test, shown in legend.items()) + " : datum.label"
    colour = {"type": "nominal", "scale": {"domain": seen, "range": [COLOURS[status] for status in seen]}}
    return {
        "data": {"values": values},
        "width": 560,
        "height": CELL * len({row.timestep for row in rows}),
        "encoding": {
            "x": {"field": "spin", "type": "ordinal", "title": "Spin, rad/s", "axis": powers},
            "y": {"field": "step", "type": "ordinal", "sort": "descending", "title": "Time step, s", "axis": powers},
        },
        "layer": [
            {
                "mark": {"type": "rect", "aria": False, "stroke": None},
                "encoding": {
                    "color": {**colour, "field": "status", "legend": {"labelExpr": label}},
                    "tooltip": [
                        {"field": "spin", "title": "spin, rad/s", "type": "quantitative"},
                        {"field": "step", "title": "time step, s", "type": "quantitative"},
                        {"field": "status", "type": "nominal"},
                        {"field": "detail", "title": "reason", "type": "nominal"},
                    ],
                },
            },
            {
                "transform": [{"calculate": f"{LETTERS!r}[datum.status]", "as": "letter"}],
                "mark": {"type": "text", "color": "black", "fontSize": 12, "aria": False, "tooltip": None},
                "encoding": {"text": {"field": "letter", "type": "nominal"}},
            },
        ],
        "config": {
            "background": None,
            "font": "system-ui, sans-serif",
            "view": {"stroke": None},
            "axis": {**text, **quiet},
            "scale": {"bandPaddingInner": 0.06},
            "legend": {"labelColor": INK, "orient": "top", "title": None, "symbolType": "square", "labelLimit": 300},
        },
    }
