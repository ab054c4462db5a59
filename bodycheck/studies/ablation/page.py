"""The report of the ablation: the cost of models that are larger than a scene requires, and their effect on the motion."""

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from itertools import groupby

from bodycheck.casefile.content import Case
from bodycheck.reference.requirements import MechanismRequirements, Requirements, needs
from bodycheck.reports.charts import INK, Spec, framed
from bodycheck.reports.finding import Finding
from bodycheck.reports.lines import assign
from bodycheck.reports.notices import of_header
from bodycheck.reports.quantities import QUANTITIES, count, listing, milliseconds, number
from bodycheck.reports.study import Chart, Part, StudyReport
from bodycheck.reports.tables import Entry, Table
from bodycheck.results.header import Header
from bodycheck.results.key import RunKey
from bodycheck.studies.ablation.rows import Change, ModelRow

#: Lengths below this (m) are given in mm.
MILLIMETRES_BELOW_M = 0.1

#: Changes of an error below these limits count as no change: the relative limit, and the limit in the unit of the error.
ALIKE, ROUNDING = 1e-6, 1e-12

#: What changes are compared with, in sentences.
TIME_STEP_ERRORS = "the time-step errors of both models"

#: Height of a bar in a chart, in pixels.
BAR = 34

#: Units of the changes.
UNITS = {"position": "m", "attitude": "rad"}

#: Explanations for readers.
READING = (
    "Each model has everything that the model above it has, and what the column “Adds” names. The first model is the smallest "
    "one that is exact for the scene, except for time-step errors. The relative cost is that of a step, divided by that of the "
    "smallest model. All models are timed in turn; the tables give the median of the rounds, with the smallest and the "
    "largest.",
    "A change is the largest distance between the motions on a model and on the smallest one, at the same time step. It is "
    "compared with the sum of the time-step errors of both models. The time-step error of a model is twice the change of its "
    "motion when the step is halved. If the motions are farther apart than that, the two models do not describe the same "
    "physics. If they are closer than the rounding of all steps, the model does not change the motion.",
)


def present(header: Header, cases: Mapping[str, Case], rows: Sequence[ModelRow]) -> StudyReport:
    """Return the contents of the report.

    Parameters
    ----------
    header
        The header of the results, with versions, machine and command.
    cases
        The cases, by name.
    rows
        The rows of the study. Rows with the same case, engine, integrator and time step must be adjacent.
    """
    compared = groups(rows)
    by_case: dict[str, list[list[ModelRow]]] = defaultdict(list)
    for group in compared:
        by_case[group[0].case].append(group)
    failures = Counter((row.status, row.reason) for row in rows if row.reason)
    failed = (
        f"{count(amount, 'model')} ended with the status {status}: {reason}." for (status, reason), amount in failures.items()
    )
    return StudyReport(
        title="What larger models cost and change",
        headline=f"{count(len(rows), 'model')} in {count(len(compared), 'comparison')}",
        header=header,
        notices=(*of_header(header), *failed),
        findings=tuple(finding for group in compared for finding in findings(group)),
        parts=tuple(part(case, by_case[name]) for name, case in cases.items() if name in by_case),
        reading=READING,
    )


def groups(rows: Sequence[ModelRow]) -> list[list[ModelRow]]:
    """Return a group of rows for each case, engine, integrator and time step, from the smallest model to the largest."""
    return [list(models) for _, models in groupby(rows, key=lambda row: (row.case, row.engine, row.integrator, row.timestep))]


def findings(rows: Sequence[ModelRow]) -> list[Finding]:
    """Return findings about the cost and effect of the largest model that ran, and the first model with different physics.

    Both models are compared with the smallest model. rows: a group that `groups` returns.
    """
    smallest, *larger = rows
    before = f"With {named(smallest)} on "
    ran = [row for row in larger if row.relative_cost is not None and row.changes]
    sentences = []
    if ran:
        low, most, high = (
            number(value, 3) for value in (ran[-1].relative_cost_low, ran[-1].relative_cost, ran[-1].relative_cost_high)
        )
        costs = f"the model {ran[-1].model} costs {most} times as much ({low} to {high}) as {smallest.model}"
        sentences.append(Finding("Larger model", before, smallest.case, f", {costs} and {effect(ran[-1].changes)}."))
    for row in ran:
        apart = [name for name, change in row.changes.items() if not change.agrees]
        if apart:
            sizes = listing([f"{with_unit(row.changes[name].size, name)} in {name}" for name in apart])
            limit = listing([with_unit(row.changes[name].time_step, name) for name in apart])
            differs = f"the model {row.model} differs from {smallest.model} by {sizes}"
            after = f", {differs}, which is more than {TIME_STEP_ERRORS} ({limit})."
            sentences.append(Finding("Different physics", before, row.case, after))
            break
    return sentences


def named(row: ModelRow) -> str:
    """Return the engine, the integrator and the time step of a row in words."""
    return f"{row.engine} {row.integrator} at {milliseconds(row.timestep, 4)}"


def effect(changes: Mapping[str, Change]) -> str:
    """Return the end of a sentence about a model, which says how the model changes the motion."""
    changed = {name: change for name, change in changes.items() if not change.is_rounding}
    if not changed:
        return "does not change the motion"
    sizes = listing([f"the {name} by {with_unit(change.size, name)}" for name, change in changed.items()])
    beyond = [name for name, change in changed.items() if not change.agrees]
    if not beyond:
        return f"changes {sizes}, which is within {TIME_STEP_ERRORS}"
    which = "which" if len(beyond) == len(changed) else f"of which the change of the {listing(beyond)}"
    return f"changes {sizes}, {which} is more than {TIME_STEP_ERRORS}"


def with_unit(value: float, quantity: str) -> str:
    """Return a change (m or rad) with its unit as text; small lengths are given in mm."""
    if quantity == "position" and 0 < value < MILLIMETRES_BELOW_M:
        return f"{number(1e3 * value, 3)} mm"
    return f"{number(value, 3)} {UNITS[quantity]}"


def part(case: Case, compared: Sequence[Sequence[ModelRow]]) -> Part:
    """Return the part of one case: its charts, and two tables for each comparison."""
    tables = []
    for rows in compared:
        tables.append((f"{named(rows[0])}: cost and motion", costs(rows)))
        tables.append((f"{named(rows[0])}: errors and their changes", errors(rows)))
    return Part(
        name=case.name,
        title=case.name,
        texts=(f"{case.title}. {required(needs(case.scene))}",),
        charts=tuple(chart(rows) for rows in compared if any(row.relative_cost is not None for row in rows)),
        tables=tuple(tables),
    )


def required(requirements: Requirements | MechanismRequirements) -> str:
    """Return a sentence about the requirements of a scene."""
    names = list(requirements.names())
    if isinstance(requirements, Requirements):
        names = [f"{requirements.rotation} rotation" if name == "rotation" else name for name in names]
    coordinates = count(requirements.degrees_of_freedom, "degree") + " of freedom"
    if not names:
        return "The scene requires nothing, as the body is at rest."
    return f"The scene requires {listing(names)}: {coordinates}."


def chart(rows: Sequence[ModelRow]) -> Chart:
    """Return the chart of the relative costs of a group of models."""
    (line,) = assign([RunKey.of_method(rows[0].engine, rows[0].integrator)]).values()
    drawn = [row for row in rows if row.relative_cost is not None]
    alt = "; ".join(f"{row.model} {number(row.relative_cost, 3)}" for row in drawn)
    return Chart(
        title=f"Cost of a step, relative to the smallest model: {named(rows[0])}",
        specification=bars(drawn, line.colour),
        alt=f"Bars show the relative cost of a step with {named(rows[0])}: {alt}.",
    )


def bars(rows: Sequence[ModelRow], colour: str) -> Spec:
    """Return a chart with a bar for the relative cost of each model, the spread of its rounds, and the cost as a number."""
    values = [
        {
            "model": row.model,
            "cost": row.relative_cost,
            "low": row.relative_cost_low,
            "high": row.relative_cost_high,
            "label": f"{number(row.relative_cost, 3)}×",
            "effect": effect(row.changes),
        }
        for row in rows
    ]
    most = max(row.relative_cost_high or 0.0 for row in rows)
    room = {"domain": [0, 1.15 * most], "nice": False}  # for the numbers behind the bars
    x = {"type": "quantitative", "title": "Relative cost of a step", "scale": room}
    tooltip = [{"field": name} for name in ("model", "label", "low", "high", "effect")]
    layers: list[Spec] = [
        {
            "mark": {"type": "bar", "color": colour, "opacity": 0.75, "height": {"band": 0.6}},
            "encoding": {"x": {**x, "field": "cost"}, "tooltip": tooltip},
        },
        {"mark": {"type": "rule", "color": INK}, "encoding": {"x": {**x, "field": "low"}, "x2": {"field": "high"}}},
        {
            "mark": {"type": "text", "align": "left", "dx": 6, "color": INK, "fontSize": 11},
            "encoding": {"x": {**x, "field": "high"}, "text": {"field": "label"}},
        },
    ]
    y = {"field": "model", "type": "nominal", "sort": None, "title": None, "axis": {"ticks": False, "labelLimit": 240}}
    return framed(layers, BAR * len(rows)) | {"data": {"values": values}, "encoding": {"y": y}}


def costs(rows: Sequence[ModelRow]) -> Table:
    """Return a table with one row for each model: its cost, and the differences of its motion from the smallest model."""
    words = ("Model", "Adds")
    figures = (
        *("Time per step, µs", "Relative cost", "Smallest", "Largest"),
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
        notes=("Coloured rows are farther from the smallest model than both time-step errors together.",)
        if any(disagree)
        else (),
    )


def changed(change: Change | None) -> tuple[Entry, Entry]:
    """Return the two cells of a change: its size, and the sum of the time-step errors."""
    if change is None:
        return Entry("–"), Entry("–")
    size = Entry("none", None, f"{number(change.size, 3)}, which is rounding") if change.is_rounding else figure(change.size)
    return size, figure(change.time_step)


def errors(rows: Sequence[ModelRow]) -> Table:
    """Return a table with one row for each model: the errors of its run, with the differences from the smallest model."""
    names = [name for name in QUANTITIES if any(name in row.errors for row in rows)]
    return Table(
        columns=("Model", *(QUANTITIES[name].label for name in names)),
        numeric=(False, *(True for _ in names)),
        rows=tuple((Entry(row.model), *(compared(row, rows[0], name) for name in names)) for row in rows),
        failed=(False,) * len(rows),
        notes=("The difference from the smallest model is in brackets; = means that it is rounding at most.",),
    )


def compared(row: ModelRow, smallest: ModelRow, name: str) -> Entry:
    """Return the cell of an error, with its difference from the smallest model."""
    value, before = row.errors.get(name), smallest.errors.get(name)
    if value is None or before is None or row is smallest:
        return figure(value)
    same = abs(value - before) <= max(ROUNDING, ALIKE * abs(value), ALIKE * abs(before))
    sign = "+" if value > before else ""
    return Entry(f"{number(value, 3)} ({'=' if same else sign + number(value - before, 2)})", value)


def figure(value: float | None) -> Entry:
    """Return the cell of a number."""
    return Entry(number(value, 3), value)
