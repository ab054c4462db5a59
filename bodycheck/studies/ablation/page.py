"""The report of the ablation: what a scene does not require costs and changes, model by model."""

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from itertools import groupby

from bodycheck.casefile.case import Case
from bodycheck.reference.requirements import Requirements, requirements
from bodycheck.reports.charts import INK, Spec, framed
from bodycheck.reports.finding import Finding
from bodycheck.reports.lines import assign
from bodycheck.reports.quantities import QUANTITIES, count, listing, milliseconds, number
from bodycheck.reports.study import Chart, Part, StudyReport
from bodycheck.reports.tables import Entry, Table
from bodycheck.running.header import Header
from bodycheck.running.key import RunKey
from bodycheck.studies.ablation.rows import Change, ModelRow

#: Lengths below this (m) are told in mm.
NEAR = 0.1

#: An error that a model changes by less, relatively or in its unit, is the same.
ALIKE, ROUNDING = 1e-6, 1e-12

#: Height of a bar in a chart, in pixels.
BAR = 34

UNITS = {"position": "m", "attitude": "rad"}

READING = (
    "Each model has all that the one above it has, and what it adds; the first is the smallest that is exact for the scene but "
    "for the steps. Costs are of a step, relative to the smallest model's, timed side by side in turn: the median of the "
    "rounds, with the least and the most.",
    "A change is the largest distance between the motions on a model and on the smallest one, at the same step. It is held "
    "against the time-step errors of both together, each twice what the motion changes by when the step is halved: farther "
    "apart than that, the two models are not one physics. Below the rounding of all steps, a model changes nothing.",
)


def present(header: Header, cases: Mapping[str, Case], rows: Sequence[ModelRow]) -> StudyReport:
    """What the study's report says.

    header: as that of results. cases: by name. rows: of the study, those of one case, engine, integrator and step together.
    """
    compared = groups(rows)
    by_case: dict[str, list[list[ModelRow]]] = defaultdict(list)
    for own in compared:
        by_case[own[0].case].append(own)
    missing = [f"Without the engine {engine}: {reason}." for engine, reason in header["missing"].items()]
    failures = Counter((row.status, row.reason) for row in rows if row.reason)
    return StudyReport(
        title="What is not needed",
        headline=f"{count(len(rows), 'model')} in {count(len(compared), 'comparison')}",
        header=header,
        notices=(*missing, *(f"{count(amount, 'model')} {status}: {reason}." for (status, reason), amount in failures.items())),
        findings=tuple(finding for own in compared for finding in findings(own)),
        parts=tuple(part(case, by_case[name]) for name, case in cases.items() if name in by_case),
        reading=READING,
    )


def groups(rows: Sequence[ModelRow]) -> list[list[ModelRow]]:
    """The models of each case, engine, integrator and time step, the smallest first."""
    return [list(own) for _, own in groupby(rows, key=lambda row: (row.case, row.engine, row.integrator, row.timestep))]


def findings(rows: Sequence[ModelRow]) -> list[Finding]:
    """What the largest model that ran costs and changes, and the first model that is another physics than the smallest."""
    smallest, *larger = rows
    method = f"{named(smallest)} on "
    ran = [row for row in larger if row.relative_cost is not None and row.changes]
    found = []
    if ran:
        low, most, high = (
            number(value, 3) for value in (ran[-1].relative_cost_low, ran[-1].relative_cost, ran[-1].relative_cost_high)
        )
        costs = f"{ran[-1].model} costs {most} times as much ({low} to {high}) as {smallest.model}"
        found.append(Finding("What is not needed", method, smallest.case, f": {costs}, and {effect(ran[-1].changes)}."))
    for row in ran:
        apart = [name for name, change in row.changes.items() if not change.agrees]
        if apart:
            told = listing([f"{with_unit(row.changes[name].size, name)} in {name}" for name in apart])
            limit = listing([with_unit(row.changes[name].time_step, name) for name in apart])
            differs = f"{row.model} differs from {smallest.model} by {told}"
            after = f": {differs}, more than the time-step errors of both ({limit})."
            found.append(Finding("Not one physics", method, row.case, after))
            break
    return found


def named(row: ModelRow) -> str:
    return f"{row.engine} {row.integrator} at {milliseconds(row.timestep, 4)}"


def effect(changes: Mapping[str, Change]) -> str:
    """What a model changes, in words."""
    changed = {name: change for name, change in changes.items() if not change.is_rounding}
    if not changed:
        return "changes nothing"
    told = listing([f"the {name} by {with_unit(change.size, name)}" for name, change in changed.items()])
    within = "within" if all(change.agrees for change in changed.values()) else "beyond"
    return f"changes {told}, {within} the time-step errors"


def with_unit(value: float, quantity: str) -> str:
    if quantity == "position" and 0 < value < NEAR:
        return f"{number(1e3 * value, 3)} mm"
    return f"{number(value, 3)} {UNITS[quantity]}"


def part(case: Case, compared: Sequence[Sequence[ModelRow]]) -> Part:
    """One case: its charts, and two tables a comparison."""
    tables = []
    for rows in compared:
        tables.append((f"{named(rows[0])}: cost and motion", costs(rows)))
        tables.append((f"{named(rows[0])}: errors, and how they change", errors(rows)))
    return Part(
        name=case.name,
        title=case.name,
        texts=(f"{case.title}. {required(requirements(case.scene))}",),
        charts=tuple(chart(rows) for rows in compared if any(row.relative_cost is not None for row in rows)),
        tables=tuple(tables),
    )


def required(needs: Requirements) -> str:
    names = [f"{needs.rotation} rotation" if name == "rotation" else name for name in needs.names()]
    coordinates = count(needs.degrees_of_freedom, "degree") + " of freedom"
    return f"It requires {listing(names)}: {coordinates}." if names else "It requires nothing: it is at rest."


def chart(rows: Sequence[ModelRow]) -> Chart:
    """Bars of the relative costs."""
    (line,) = assign([RunKey.of_method(rows[0].engine, rows[0].integrator)]).values()
    drawn = [row for row in rows if row.relative_cost is not None]
    alt = "; ".join(f"{row.model} {number(row.relative_cost, 3)}" for row in drawn)
    return Chart(
        title=f"Cost of a step, relative to the smallest model: {named(rows[0])}",
        specification=bars(drawn, line.colour),
        alt=f"Relative cost of a step: {alt}.",
    )


def bars(rows: Sequence[ModelRow], colour: str) -> Spec:
    """A bar a model with the spread of its rounds and its figure."""
    values = [
        {
            "model": row.model,
            "cost": row.relative_cost,
            "low": row.relative_cost_low,
            "high": row.relative_cost_high,
            "told": f"{number(row.relative_cost, 3)}×",
            "effect": effect(row.changes),
        }
        for row in rows
    ]
    most = max(row.relative_cost_high or 0.0 for row in rows)
    room = {"domain": [0, 1.15 * most], "nice": False}  # for the figures behind the bars
    x = {"type": "quantitative", "title": "Cost of a step, relative", "scale": room}
    tooltip = [{"field": name} for name in ("model", "told", "low", "high", "effect")]
    layers: list[Spec] = [
        {
            "mark": {"type": "bar", "color": colour, "opacity": 0.75, "height": {"band": 0.6}},
            "encoding": {"x": {**x, "field": "cost"}, "tooltip": tooltip},
        },
        {"mark": {"type": "rule", "color": INK}, "encoding": {"x": {**x, "field": "low"}, "x2": {"field": "high"}}},
        {
            "mark": {"type": "text", "align": "left", "dx": 6, "color": INK, "fontSize": 11},
            "encoding": {"x": {**x, "field": "high"}, "text": {"field": "told"}},
        },
    ]
    y = {"field": "model", "type": "nominal", "sort": None, "title": None, "axis": {"ticks": False, "labelLimit": 240}}
    return framed(layers, BAR * len(rows)) | {"data": {"values": values}, "encoding": {"y": y}}


def costs(rows: Sequence[ModelRow]) -> Table:
    """A row a model: its cost, and how far its motion is from the smallest one's."""
    words = ("Model", "Adds")
    figures = (
        *("Time per step, µs", "Cost, relative", "at least", "at most"),
        *("Position change, m", "Time-step errors, m", "Attitude change, rad", "Time-step errors, rad"),
    )
    disagree = tuple(any(not change.agrees for change in row.changes.values()) for row in rows)
    return Table(
        columns=words + figures,
        numeric=(False,) * len(words) + (True,) * len(figures),
        rows=tuple(
            (
                *(Entry(row.model), Entry(row.adds)),
                figure(None if row.time_per_step is None else 1e6 * row.time_per_step),
                *map(figure, (row.relative_cost, row.relative_cost_low, row.relative_cost_high)),
                *(entry for quantity in UNITS for entry in changed(row.changes.get(quantity) if row is not rows[0] else None)),
            )
            for row in rows
        ),
        failed=disagree,
        notes=("Coloured: farther from the smallest model than both time-step errors together.",) if any(disagree) else (),
    )


def changed(change: Change | None) -> tuple[Entry, Entry]:
    if change is None:
        return Entry("–"), Entry("–")
    size = Entry("none", None, f"{number(change.size, 3)}, rounding") if change.is_rounding else figure(change.size)
    return size, figure(change.time_step)


def errors(rows: Sequence[ModelRow]) -> Table:
    """A row a model: every error of its run, with the difference from the smallest model's."""
    names = [name for name in QUANTITIES if any(name in row.errors for row in rows)]
    return Table(
        columns=("Model", *(QUANTITIES[name].label for name in names)),
        numeric=(False, *(True for _ in names)),
        rows=tuple((Entry(row.model), *(compared(row, rows[0], name) for name in names)) for row in rows),
        failed=(False,) * len(rows),
        notes=("In brackets: the difference from the smallest model's; = where there is none.",),
    )


def compared(row: ModelRow, smallest: ModelRow, name: str) -> Entry:
    value, before = row.errors.get(name), smallest.errors.get(name)
    if value is None or before is None or row is smallest:
        return figure(value)
    same = abs(value - before) <= max(ROUNDING, ALIKE * abs(value), ALIKE * abs(before))
    sign = "+" if value > before else ""
    return Entry(f"{number(value, 3)} ({'=' if same else sign + number(value - before, 2)})", value)


def figure(value: float | None) -> Entry:
    return Entry(number(value, 3), value)
