"""The table of the runs of one case."""

import math
from collections.abc import Collection, Mapping, Sequence
from typing import Any

from bodycheck.figures.columns import BEFORE_DEPARTURE, DEPARTURE
from bodycheck.judging.judgement import Verdict
from bodycheck.judging.margins import Margin
from bodycheck.reports.quantities import QUANTITIES, TABLED, Quantity, milliseconds, number, within
from bodycheck.reports.runs.commands import curve_anchor
from bodycheck.reports.runs.kinds import KINDS
from bodycheck.reports.runs.summary import expectation_status
from bodycheck.reports.tables import Entry, Table
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Completed
from bodycheck.results.verdicts import WITHIN

#: The heading of the column with the computing time.
COST = "Time per step, µs"

#: The note below tables with margins.
MARGINS = (
    "The margin is the limit divided by the measured value, for the figure that is nearest to its limit; below 1 it is broken."
)

#: The note below tables in which an error or a drift is within the truth's own error.
WITHIN_TRUTH = f"{WITHIN} marks an error within the truth's own error, which is the number shown."


def run_table(
    verdicts: Sequence[Verdict],
    anchors: Mapping[RunKey, str],
    drawn: Collection[str],
    demonstrations: Mapping[RunKey, str],
) -> Table:
    """Return the table of the runs of one case: a row for each run, with its figures.

    The error that shows the discrepancies of the kind of scene best comes first. Columns without information are left out: the
    status if all runs completed, the expectation if no run has expectations, and empty columns of margins and reasons. Notes
    give the versions of engines that have only one; the rows give those of others.

    Parameters
    ----------
    verdicts
        The verdicts on the runs.
    anchors
        The anchors of the commands that reproduce the runs.
    drawn
        The names of the quantities that have curves.
    demonstrations
        The purposes of methods that are demonstrations.
    """
    rows = [verdict.row() for verdict in verdicts]
    first = next((kind.quantity for kind in KINDS if kind.name == verdicts[0].kind), None)
    ordered = sorted(TABLED, key=lambda name: name != first)
    quantities = [QUANTITIES[name] for name in ordered if any(name in row for row in rows)]
    keys = ("Engine", "Integrator", *_labelled(verdicts, "Set"), "Time step")
    labels = tuple(quantity.label for quantity in quantities)
    told = {
        "Status": any(row["status"] != Completed.status for row in rows),
        "Expectation": any(verdict.passed is not None for verdict in verdicts),
        "Margin": any(verdict.margins for verdict in verdicts),
        "Reason": any(row["reason"] for row in rows),
    }
    before = _before_departure(rows)
    every = (*keys, *labels, *before.values(), COST, "Status", "Expectation", "Margin", "Reason")
    columns = tuple(name for name in every if told.get(name, True))
    bounded = any(quantity.within_truth(row) is not None for quantity in quantities for row in rows)
    notes = (
        *((WITHIN_TRUTH,) if bounded else ()),
        *((MARGINS,) if told["Margin"] else ()),
        *_demonstration_notes(verdicts, demonstrations),
        *_version_notes(verdicts),
    )
    versions = _versions(verdicts)
    cells = [
        _entries(verdict, row, quantities, drawn, len(versions[verdict.run.engine]) > 1)
        | {"Integrator": _integrator(verdict, anchors[verdict.key], demonstrations)}
        | {label: _number(row.get(name)) for name, label in before.items()}
        for verdict, row in zip(verdicts, rows, strict=True)
    ]
    own = _own_errors(rows, quantities)
    return Table(
        columns=columns,
        numeric=tuple(name in {"Margin", COST, *labels, *before.values()} for name in columns),
        rows=tuple(tuple(row[name] for name in columns) for row in cells),
        failed=tuple(verdict.passed is False for verdict in verdicts),
        notes=notes,
        footer=tuple(own.get(name, Entry("")) for name in columns) if own else (),
        keys=len(keys),
        runs=tuple(anchors[verdict.key] for verdict in verdicts),
    )


def _before_departure(rows: Sequence[Mapping[str, Any]]) -> dict[str, str]:
    """Return the titles of the columns of errors up to the departure of a robot, by the names of their columns in `rows`."""
    departures = [row[DEPARTURE] for row in rows if DEPARTURE in row]
    known = {column for row in rows for column in row}
    quantities = [QUANTITIES[name] for name, column in BEFORE_DEPARTURE.items() if column in known]
    return {BEFORE_DEPARTURE[one.name]: f"{one.title} up to {departures[0]:.3g} s, {one.unit}" for one in quantities}


def _number(value: float | None) -> Entry:
    return Entry("–") if value is None else Entry(number(value), value)


def _own_errors(rows: Sequence[Mapping[str, Any]], quantities: Sequence[Quantity]) -> dict[str, Entry]:
    """Return the cells of the row with the error bounds of the truth, by column; empty if no bound is known."""
    known = {
        quantity: [row[quantity.bound_name] for row in rows if row.get(quantity.bound_name) is not None]
        for quantity in quantities
    }
    found = {
        quantity.label: Entry(within(max(own), 2), max(own), f"bound of the truth's own {quantity.title.lower()}")
        for quantity, own in known.items()
        if own
    }
    return {"Engine": Entry("Truth's own error"), **found} if found else {}


def _labelled(verdicts: Sequence[Verdict], text: str) -> tuple[str, ...]:
    """Return the tuple `(text,)` if there are several sets of results; otherwise an empty tuple."""
    return (text,) if any(verdict.label for verdict in verdicts) else ()


def _entries(
    verdict: Verdict,
    row: Mapping[str, Any],
    quantities: Sequence[Quantity],
    drawn: Collection[str],
    several_versions: bool,
) -> dict[str, Entry]:
    """Return the cells of a run by column. A figure links to its curve, if it has one."""
    time_per_step = row.get("time_per_step")
    leads = {one.name: curve_anchor(verdict.run.case, one.name) if one.name in drawn else "" for one in quantities}
    return {
        "Engine": Entry(f"{row['engine']}\u00a0{row['version']}" if several_versions else row["engine"]),
        "Set": Entry(verdict.label),
        "Time step": Entry(milliseconds(row["timestep"])),
        "Status": Entry(row["status"]),
        "Expectation": Entry(expectation_status(verdict)),
        "Margin": _margin(verdict.margins),
        **{quantity.label: _figure(row, quantity, leads[quantity.name]) for quantity in quantities},
        COST: Entry("–") if time_per_step is None else Entry(number(1e6 * time_per_step, 3), 1e6 * time_per_step),
        "Reason": Entry(row["reason"]),
    }


def _integrator(verdict: Verdict, anchor: str, demonstrations: Mapping[RunKey, str]) -> Entry:
    marked = " (demonstration)" if verdict.key.over_cases in demonstrations else ""
    return Entry(f"{verdict.run.method.name}{marked}", link=anchor)


def _versions(verdicts: Sequence[Verdict]) -> dict[str, set[str]]:
    """Return the versions of each engine; a name such as mujoco@3.1.0 has its version in itself."""
    versions: dict[str, set[str]] = {}
    for verdict in verdicts:
        engine, version = verdict.run.engine, verdict.run.version
        versions.setdefault(engine, set()).update({version} if version and "@" not in engine else ())
    return versions


def _version_notes(verdicts: Sequence[Verdict]) -> tuple[str, ...]:
    only = [f"{engine} {version}" for engine, those in _versions(verdicts).items() if len(those) == 1 for version in those]
    return (f"Versions: {', '.join(only)}.",) if only else ()


def _demonstration_notes(verdicts: Sequence[Verdict], demonstrations: Mapping[RunKey, str]) -> tuple[str, ...]:
    """Return a sentence about each integrator that is a demonstration."""
    told = {
        f"{verdict.run.engine} {verdict.run.method.integrator} is there to demonstrate {demonstrations[key]}."
        for verdict in verdicts
        if (key := verdict.key.over_cases) in demonstrations
    }
    return tuple(sorted(told))


def _margin(margins: Sequence[Margin]) -> Entry:
    """Return the cell with the narrowest margin of a run. The explanation at the pointer has all margins with their limits."""
    if not margins:
        return Entry("–")
    narrowest = min(margins, key=lambda margin: margin.room)
    told = "; ".join(f"{margin.name} {margin.range.text}, measured {number(margin.measured)}" for margin in margins)
    if not math.isfinite(narrowest.room):
        return Entry("∞", None, told)
    return Entry(number(narrowest.room, 3), narrowest.room, told)


def _figure(row: Mapping[str, Any], quantity: Quantity, link: str) -> Entry:
    value = row.get(quantity.name)
    if value is None:
        return Entry("–")
    if (own := quantity.within_truth(row)) is not None:
        return Entry(within(own), own, quantity.told_within(own), link)
    return Entry(number(value), value, link=link)
