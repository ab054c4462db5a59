"""The part of the tradeoff report about batches, in which every cost has the error of the same run beside it."""

from collections.abc import Mapping, Sequence
from typing import Any

from bodycheck.reports.charts import INK, Spec, log_axis, method_scale, zoomable
from bodycheck.reports.lines import Line
from bodycheck.reports.quantities import QUANTITIES, count, listing, milliseconds, number, verb
from bodycheck.reports.series import rounded
from bodycheck.reports.study import Chart
from bodycheck.reports.tables import Entry, Table
from bodycheck.results.key import RunKey
from bodycheck.studies.tradeoff.measurements import CaseMeasurements, Row, method_of

#: Lines by method.
Lines = Mapping[RunKey, Line]

#: For each quantity, the column of its error in the case itself, and the column of its largest error in any scene of a batch.
ERRORS = {
    "attitude": ("attitude_error", "worst_attitude_error"),
    "position": ("position_error", "worst_position_error"),
}

#: Explanations for readers.
READING = (
    "A batch is the scene of the case and copies of it, turned about the vertical by different angles, that the engine steps "
    "at once. Their truths are that of the case, turned likewise. The time is that of one step of one scene: the wall time of "
    "the whole run over all its steps and scenes, with the sampling of states. It is of the same run as the errors. "
    "The time of processors is that of all threads together; what else the machine does is not in it.",
)


def notices(rows: Sequence[Row]) -> tuple[str, ...]:
    """Return sentences about the limits of batches: their devices, and the engines and mechanisms without larger batches."""
    batches = [row for row in rows if row.get("batch") is not None]
    devices = sorted({str(row["device"]) for row in batches})
    together = {row["engine"] for row in batches if row["batch"] > 1}
    alone = [name for name in dict.fromkeys(row["engine"] for row in batches) if name not in together]
    single = (text,) if (text := without(rows)) else ()
    where = f"All batches ran on the device {listing(devices)}." if len(devices) == 1 else f"Batches ran on {listing(devices)}."
    if not alone or not together:
        return (where, *single)
    have = verb(len(alone), "steps", "step")
    larger = f"{listing(alone)} {have} one scene at a time, and {verb(len(alone), 'has', 'have')} no larger batches."
    return (where, larger, *single)


def without(rows: Sequence[Row]) -> str:
    """Return a sentence that names the mechanisms, which have no batches; empty if there are none."""
    names = list(dict.fromkeys(str(row["case"]) for row in rows if row["kind"] == "mechanism"))
    if not names:
        return ""
    which = f"{listing(names)} {verb(len(names), 'is a mechanism', 'are mechanisms')}"
    return f"{which}, and {verb(len(names), 'has', 'have')} no batches: mechanisms are stepped one at a time."


def charts(case: CaseMeasurements, lines: Lines) -> tuple[Chart, ...]:
    """Return the charts of the cost and of the error over the number of scenes; none if there is nothing to draw."""
    rows = [row for row in case.batches if row["status"] == "ok" and row["time_per_step"]]
    if case.primary not in ERRORS or len({row["batch"] for row in rows}) < 2:
        return ()
    quantity = QUANTITIES[ERRORS[case.primary][0]]
    worst = f"{quantity.title}, the worst of all scenes"
    drawn = [lines[method_of(row)] for row in rows]
    methods = list(dict.fromkeys(drawn))
    alt = f"over the number of scenes in a batch, on log scales, for {count(len(methods), 'method')}."
    shown = []
    for title, label, column, factor in (
        ("Time per step and scene in batches", "Time per step and scene, us", "time_per_step", 1e6),
        (f"{worst} in batches", f"{worst}, {quantity.unit}", ERRORS[case.primary][1], 1.0),
    ):
        measured = [row for row in rows if row.get(column)]
        if measured:
            shown.append(Chart(title, _diagram(measured, lines, column, factor, label, case.primary), f"{label}, {alt}"))
    return tuple(shown)


def table(case: CaseMeasurements) -> Table:
    """Return the table of the batches of a case, with the time of a step of one scene and the errors of the same run."""
    shown = [name for name in ERRORS if any(row.get(ERRORS[name][0]) is not None for row in case.batches)]
    errors = [column for name in shown for column in ERRORS[name]]
    heads = [
        text
        for name in shown
        for quantity in [QUANTITIES[ERRORS[name][0]]]
        for text in (quantity.label, f"Worst {quantity.label[:1].lower()}{quantity.label[1:]}")
    ]
    words = ("Engine", "Integrator", "Device", "Precision")
    figures = ("Time step, ms", "Scenes", "Time per step and scene, us", "Of processors, us", *heads, "Failed scenes")
    rows = tuple(
        (
            Entry(f"{row['engine']} {row['version']}".rstrip()),
            Entry(row["integrator"]),
            Entry(str(row["device"])),
            Entry(str(row["precision"])),
            Entry(milliseconds(row["timestep"], 4).removesuffix(" ms"), row["timestep"]),
            Entry(str(row["batch"]), row["batch"]),
            _microseconds(row["time_per_step"]),
            _microseconds(row.get("processor_time_per_step")),
            *(Entry(number(row.get(column), 3), row.get(column)) for column in errors),
            Entry("–" if row.get("failed_scenes") is None else str(row["failed_scenes"]), row.get("failed_scenes")),
        )
        for row in case.batches
    )
    failed = tuple(row["status"] != "ok" for row in case.batches)
    reasons = dict.fromkeys(
        f"{row['engine']} {row['integrator']}, {row['batch']} scenes: {row['reason']}"
        for row in case.batches
        if row["status"] != "ok"
    )
    return Table(
        columns=(*words, *figures),
        numeric=(False,) * len(words) + (True,) * len(figures),
        rows=rows,
        failed=failed,
        notes=(
            "Errors are those of the case itself, and the worst of all scenes of the batch that did not fail.",
            *(f"{text}." for text in reasons),
        ),
    )


def _microseconds(value: float | None) -> Entry:
    return Entry("–") if value is None else Entry(number(1e6 * value, 3), value)


def _diagram(rows: Sequence[Row], lines: Lines, column: str, factor: float, label: str, quantity: str) -> Spec:
    """Return a chart of a column over the number of scenes in a batch, with a curve for each method and time step.

    The values of the column are multiplied by `factor`. The tooltip of each point has the time and the errors. The parameter
    `hidden` of the chart holds the labels of methods that are switched off.
    """
    drawn = list(dict.fromkeys(lines[method_of(row)] for row in rows))
    scale = {"type": "log", "nice": False, "padding": 12}
    of_case, worst = ERRORS[quantity]
    values: list[dict[str, Any]] = [
        {
            "method": lines[method_of(row)].label,
            "step": row["timestep"],
            "scenes": row["batch"],
            "value": next(iter(rounded([factor * row[column]]))),
            "time": next(iter(rounded([1e6 * row["time_per_step"]]))),
            "own": row.get(of_case),
            "worst": row.get(worst),
        }
        for row in rows
    ]
    curves = {channel: method_scale(channel, drawn) for channel in ("strokeDash", "strokeWidth")}
    measured = {
        "data": {"values": values},
        "transform": [{"filter": "indexof(hidden, datum.method) < 0"}],
        "encoding": {
            "x": {
                "field": "scenes",
                "type": "quantitative",
                "title": "Scenes in a batch",
                "scale": scale,
                "axis": log_axis("x") | {"grid": False},
            },
            "y": {"field": "value", "type": "quantitative", "title": label, "scale": scale, "axis": log_axis("y")},
            "color": method_scale("color", drawn),
            "detail": {"field": "step"},
        },
        "layer": [
            {"mark": {"type": "line", "clip": True, "aria": False}, "encoding": curves},
            {
                "mark": {
                    "type": "point",
                    "clip": True,
                    "filled": True,
                    "opacity": 1,
                    "aria": False,
                    "size": 30,
                    "stroke": INK,
                    "strokeWidth": 0,
                },
                "encoding": {"tooltip": _tooltip(quantity)},
            },
        ],
    }
    return zoomable([measured], height=260) | {"params": [{"name": "hidden", "value": []}]}


def _tooltip(quantity: str) -> Spec:
    """Return the tooltip of a point, with its time and errors.

    In its expression, `datum` is either the row, or an object whose attribute `datum` is the row.
    """
    unit, row = QUANTITIES[ERRORS[quantity][0]].unit, "(datum.datum || datum)"
    return {
        "value": {
            "expr": f"{{'method': {row}.method, 'time step': format({row}.step * 1e3, '.4~g') + ' ms', 'scenes': {row}.scenes, "
            f"'time per step and scene': format({row}.time, '.3~g') + ' us', "
            f"'{quantity} error of the case': format({row}.own, '.4~g') + ' {unit}', "
            f"'the worst of all scenes': format({row}.worst, '.4~g') + ' {unit}'}}"
        }
    }
