"""What a report says, before it is laid out: the same for every writer."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from bodycheck.attribution import Attribution
from bodycheck.judgement import Verdict
from bodycheck.outcome import Completed
from bodycheck.reference.truth import Truth
from bodycheck.reports import curves
from bodycheck.reports.curves import Curves
from bodycheck.reports.lines import Key, Line, assign
from bodycheck.reports.quantities import PLOTTED, QUANTITIES, TABLED, Quantity, bound, milliseconds, number
from bodycheck.reports.scenes import Fact, describe
from bodycheck.reports.summary import Finding, contact, findings, headline, key_of, measured, notices, tally, within_truth
from bodycheck.reports.tables import Entry, Table, origins_table
from bodycheck.store import Results

MOST_NUMBERS = 300_000
"""Numbers of all curves of a report together, so that a large one still opens: some 4 MB."""

MOST_POINTS = 256
"""Points of one curve."""


@dataclass(frozen=True)
class Cell:
    """One run in the matrix. text: its figure or its status. decade: of the figure (rad), None where there is none."""

    text: str
    meaning: str
    decade: int | None = None
    failed: bool = False


@dataclass(frozen=True)
class Section:
    """One case. origins: where its discrepancies of contact come from; None where there is no contact."""

    name: str
    title: str
    source: str
    tags: tuple[str, ...]
    facts: tuple[Fact, ...]
    table: Table | None
    origins: Table | None
    curves: Curves


@dataclass(frozen=True)
class Failure:
    """A run that failed, and why."""

    case: str
    method: str
    status: str
    reason: str


@dataclass(frozen=True)
class Contents:
    """A whole report. matrix: by case and method, None where there is no such run. plotted: what any section draws."""

    header: Mapping[str, Any]
    headline: str
    tally: tuple[tuple[str, int], ...]
    notices: tuple[str, ...]
    findings: tuple[Finding, ...]
    failures: tuple[Failure, ...]
    lines: tuple[Line, ...]
    matrix: tuple[tuple[str, tuple[Cell | None, ...]], ...]
    sections: tuple[Section, ...]
    plotted: tuple[Quantity, ...]

    @property
    def timesteps(self) -> tuple[float, ...]:
        """All time steps (s), the largest first."""
        return tuple(sorted({line.timestep for line in self.lines}, reverse=True))


def gather(results: Results, verdicts: Sequence[Verdict], parts: Sequence[Attribution] = ()) -> Contents:
    """What is to be said of results, the verdicts on their runs, and the parts of their discrepancies of contact."""
    lines = assign(map(key_of, verdicts))
    points = max(2, min(MOST_POINTS, MOST_NUMBERS // max(1, 4 * len(verdicts))))
    by_case: dict[str, list[Verdict]] = {name: [] for name in results.cases}
    for verdict in verdicts:
        by_case[verdict.run.case].append(verdict)
    origins: dict[str, list[Attribution]] = {name: [] for name in results.cases}
    for part in parts:
        origins[part.case].append(part)
    sections = tuple(_section(results, name, own, origins[name], lines, points) for name, own in by_case.items())
    return Contents(
        header=results.header,
        headline=headline(results, verdicts),
        tally=tally(verdicts),
        notices=notices(results, verdicts),
        findings=(*findings(measured(verdicts, lines)), *contact(parts, lines)),
        failures=tuple(_failure(verdict, lines) for verdict in verdicts if verdict.passed is False),
        lines=tuple(lines.values()),
        matrix=tuple((name, _matrix_row(own, lines)) for name, own in by_case.items()),
        sections=sections,
        plotted=tuple(QUANTITIES[name] for name in PLOTTED if any(name in section.curves.drawn for section in sections)),
    )


def _failure(verdict: Verdict, lines: Mapping[Key, Line]) -> Failure:
    return Failure(verdict.run.case, lines[key_of(verdict)].label, _result(verdict), verdict.reason)


def _matrix_row(verdicts: Sequence[Verdict], lines: Mapping[Key, Line]) -> tuple[Cell | None, ...]:
    cells = {lines[key_of(verdict)]: _cell(verdict) for verdict in verdicts}
    return tuple(cells.get(line) for line in lines.values())


def _cell(verdict: Verdict) -> Cell:
    failed = verdict.passed is False
    if verdict.discrepancy is None:
        return Cell(verdict.outcome.status, verdict.reason, None, failed)
    maxima = verdict.discrepancy.maxima()
    if within_truth(maxima):
        return Cell(f"≤ {bound(maxima['truth_error'], 2)}", _within(maxima["truth_error"]), None, failed)
    error = maxima["attitude_error"]
    return Cell(number(error, 2), f"{number(error)} rad", _decade(error), failed)


def _decade(error: float) -> int:
    """The exponent of an error (rad), from -12 for all that is smaller to 0 for all that is larger."""
    return max(-12, min(0, int(f"{error:e}".partition("e")[2])))


def _section(
    results: Results,
    name: str,
    verdicts: Sequence[Verdict],
    parts: Sequence[Attribution],
    lines: Mapping[Key, Line],
    points: int,
) -> Section:
    case = results.cases[name]
    timesteps = dict.fromkeys(verdict.run.method.timestep for verdict in verdicts)
    truths = {timestep: results.truth(name, timestep) for timestep in timesteps}
    known = {timestep: truth for timestep, truth in truths.items() if isinstance(truth, Truth)}
    return Section(
        name=name,
        title=case.title,
        source=case.source,
        tags=case.tags,
        facts=describe(case, tuple(truths.values())),
        table=_table(verdicts) if verdicts else None,
        origins=origins_table(parts) if parts else None,
        curves=curves.draw({lines[key_of(v)].label: v for v in verdicts if v.discrepancy is not None}, known, points),
    )


def _table(verdicts: Sequence[Verdict]) -> Table:
    rows = [verdict.row() for verdict in verdicts]
    quantities = [QUANTITIES[name] for name in TABLED if any(name in row for row in rows)]
    reasons = any(row["reason"] for row in rows)
    words = ("Engine", "Integrator", "Time step", "Status", "Expectation")
    figures = (*(quantity.label for quantity in quantities), "Time per step, µs")
    bounded = any("attitude_error" in row and within_truth(row) for row in rows)
    return Table(
        columns=words + figures + (("Reason",) if reasons else ()),
        numeric=(False,) * len(words) + (True,) * len(figures) + (False,) * reasons,
        rows=tuple(_entries(verdict, row, quantities, reasons) for verdict, row in zip(verdicts, rows, strict=True)),
        failed=tuple(verdict.passed is False for verdict in verdicts),
        notes=("≤: within the truth's own error, which is the figure given.",) if bounded else (),
    )


def _entries(verdict: Verdict, row: Mapping[str, Any], quantities: Sequence[Quantity], reasons: bool) -> tuple[Entry, ...]:
    words = (
        Entry(f"{row['engine']} {row['version']}".rstrip()),
        Entry(row["integrator"]),
        Entry(milliseconds(row["timestep"])),
        Entry(row["status"]),
        Entry({True: "held", False: "failed", None: "–"}[row["passed"]]),
    )
    figures = tuple(_figure(row, quantity) for quantity in quantities)
    time_per_step = row.get("time_per_step")
    cost = Entry("–") if time_per_step is None else Entry(number(1e6 * time_per_step, 3), 1e6 * time_per_step)
    return (*words, *figures, cost, *((Entry(row["reason"]),) if reasons else ()))


def _figure(row: Mapping[str, Any], quantity: Quantity) -> Entry:
    value = row.get(quantity.name)
    if value is None:
        return Entry("–")
    if quantity.name == "attitude_error" and within_truth(row):
        return Entry(f"≤ {bound(row['truth_error'])}", None, _within(row["truth_error"]))
    return Entry(number(value), value)


def _within(truth_error: float) -> str:
    return f"within the truth's own error ({bound(truth_error)} rad)"


def _result(verdict: Verdict) -> str:
    return "expectation broken" if isinstance(verdict.outcome, Completed) else verdict.outcome.status
