"""The report of estimates: error over cost with intervals, and tables of all rows."""

from collections.abc import Iterator, Sequence

from bodycheck.adapters.engine_name import in_words
from bodycheck.adapters.method import Method
from bodycheck.reports.charts import INK, Spec, log_axis, method_scale, zoomable
from bodycheck.reports.finding import Finding
from bodycheck.reports.lines import Line, assign
from bodycheck.reports.notices import of_header
from bodycheck.reports.quantities import QUANTITIES, exactly, number
from bodycheck.reports.study import Chart, Part, StudyReport, animation_of
from bodycheck.reports.tables import Entry, Table
from bodycheck.results.header import Header
from bodycheck.results.key import RunKey
from bodycheck.studies.estimate import wording
from bodycheck.studies.estimate.quantities import AT_END
from bodycheck.studies.estimate.rows import ESTIMATE, EstimateRow, Estimates

#: Explanations for readers.
READING = (
    "An estimate is the error of a run from the engine's own limit as the time step goes to zero, found by runs with smaller "
    "and smaller time steps. What the model of the engine is worth is not asked. The interval is the estimate with a safety "
    "factor, which is measured for each class of scenes: how often such intervals are right is said above.",
    "“not-asymptotic”: the differences between the runs do not fall as they should, and the reason says what differs between "
    "the finest runs. “chaotic beyond T”: from the instant T on, one rounding at the start makes a difference above the "
    "allowed error, so that no time step helps. The horizon is the last instant until which a row is an estimate.",
    "The cost is the computing time of a simulated second. In the chart, the bars are the intervals, and the broken line is "
    "the error that is allowed.",
)


def present(header: Header, results: Estimates) -> StudyReport:
    """Return the contents of the report of a study."""
    by_engine: dict[str, list[EstimateRow]] = {}
    for row in results.rows:
        by_engine.setdefault(row.engine, []).append(row)
    return StudyReport(
        title="How wrong is this scene? Errors with intervals",
        headline=wording.headline(results),
        header=header,
        notices=tuple(of_header(header)),
        findings=tuple(Finding("Estimate", text) for text in wording.sentences(results) if text),
        parts=tuple(_part(results, engine, rows) for engine, rows in by_engine.items()),
        reading=READING,
    )


def _part(results: Estimates, engine: str, rows: Sequence[EstimateRow]) -> Part:
    """Return the part of one engine: a chart for each quantity, and the table of its rows."""
    lines = assign(_key(row) for row in rows)
    drawn = {_key(row) for row in rows if _is_drawn(row)}
    return Part(
        name=engine,
        title=in_words(engine, rows[0].version),
        texts=(),
        charts=tuple(_charts(results, rows, lines)),
        tables=(("All time steps that were tried", _table(rows)),),
        lines=tuple(line for key, line in lines.items() if key in drawn),
        animations=(animation_of(results.shown[engine]),) if engine in results.shown else (),
    )


def _key(row: EstimateRow) -> RunKey:
    return RunKey("", row.engine, Method.parse(row.integrator or "none", 0.0))


def _is_drawn(row: EstimateRow) -> bool:
    """Return whether a row has a point in a chart with logarithmic scales."""
    return row.verdict == ESTIMATE and bool(row.estimate) and bool(row.cost) and not row.quantity.endswith(AT_END)


def _charts(results: Estimates, rows: Sequence[EstimateRow], lines: dict[RunKey, Line]) -> Iterator[Chart]:
    for name in dict.fromkeys(row.quantity for row in rows if _is_drawn(row)):
        drawn = [row for row in rows if row.quantity == name and _is_drawn(row)]
        quantity = QUANTITIES[name]
        yield Chart(
            title=f"{quantity.title} over the cost",
            specification=_specification(results, drawn, lines, quantity.label),
            alt=f"{quantity.title} with intervals against the computing time of a simulated second, on log scales.",
        )


def _specification(results: Estimates, rows: Sequence[EstimateRow], lines: dict[RunKey, Line], label: str) -> Spec:
    """Return a chart of the errors of one quantity over the cost, with intervals and the allowed error."""
    values = [
        {
            "method": lines[_key(row)].label,
            "timestep": row.timestep,
            "cost": row.cost,
            "error": row.estimate,
            "low": row.low or row.estimate,
            "high": row.high,
        }
        for row in rows
    ]
    shown = [line for key, line in lines.items() if key in {_key(row) for row in rows}]
    scale = {"type": "log", "nice": False, "padding": 12}
    x = {"field": "cost", "type": "quantitative", "title": "Computing time per second, s", "scale": scale}
    y = {"field": "error", "type": "quantitative", "title": label, "scale": scale, "axis": log_axis("y")}
    layers: list[Spec] = [
        {
            "mark": {"type": "rule", "clip": True, "tooltip": None, "aria": False, "strokeWidth": 2, "opacity": 0.5},
            "encoding": {"y": y | {"field": "low"}, "y2": {"field": "high"}},
        },
        {
            "mark": {"type": "point", "clip": True, "filled": True, "opacity": 1, "size": 24},
            "encoding": {"y": y, "tooltip": [{"field": one} for one in ("method", "timestep", "cost", "error", "low", "high")]},
        },
    ]
    measured: Spec = {
        "data": {"values": values},
        "transform": [{"filter": "indexof(hidden, datum.method) < 0"}],
        "encoding": {"x": x | {"axis": log_axis("x") | {"grid": False}}, "color": method_scale("color", shown)},
        "layer": layers,
    }
    allowed: Spec = {
        "data": {"values": [{"error": results.error}]},
        "mark": {"type": "rule", "color": INK, "strokeDash": [6, 4], "clip": True, "tooltip": None, "aria": False},
        "encoding": {"y": y},
    }
    limit = [allowed] if rows[0].quantity in results.compared else []
    return zoomable([*limit, measured], height=320) | {"params": [{"name": "hidden", "value": []}]}


def _table(rows: Sequence[EstimateRow]) -> Table:
    """Return the table of rows."""
    return Table(
        columns=(
            *("Integrator", "Time step, s", "Quantity", "Estimate", "Low", "High", "Order"),
            *("Until, s", "Cost, s", "Verdict", "Reason"),
        ),
        numeric=(False, True, False, True, True, True, True, True, True, False, False),
        rows=tuple(
            (
                *(Entry(row.integrator), Entry(exactly(row.timestep), row.timestep), Entry(row.quantity)),
                *(Entry(number(value, 3), value) for value in (row.estimate, row.low, row.high, row.order)),
                *(Entry(number(value, 3), value) for value in (row.horizon, row.cost)),
                *(Entry(row.verdict), Entry(row.reason)),
            )
            for row in rows
        ),
        failed=tuple(row.verdict != ESTIMATE for row in rows),
        notes=("Coloured rows have no estimate over the whole time.",),
    )
