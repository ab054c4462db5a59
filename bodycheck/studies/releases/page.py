"""The report of the study of releases: what each upgrade changed, and every figure by release, case by case."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace

from packaging.version import Version

from bodycheck.reports.charts import ZOOMING
from bodycheck.reports.lines import HUES, Line, assign, paled
from bodycheck.reports.quantities import QUANTITIES, Quantity, count, listing, milliseconds, number
from bodycheck.reports.study import Chart, Part, StudyReport
from bodycheck.reports.tables import Entry, Table
from bodycheck.running.key import RunKey
from bodycheck.running.outcome import Completed
from bodycheck.studies.releases.chart import Point, release_chart
from bodycheck.studies.releases.findings import findings, named, orders
from bodycheck.studies.releases.rows import STATUS, Change, Found, Row, made, merged_header

#: The figure that is drawn and tabled whether it changed or not.
PRIMARY = "attitude_error"

READING = (
    "Every release runs in an environment of its own, and the same bodycheck runs all of them. A change is named where two "
    "releases that follow one another differ by more than the bound of the truth's own error, rounding, and what runs from "
    "nudged initial states differ by among themselves; where nothing is named they agree to that. A release that could not be "
    "measured is stepped over.",
    "In each chart a line is a method, and a ring is around the first release that gives something else. A gap is a release "
    "that could not be had, lacks the method, or has no figure; an error of zero has no place on a log scale either. "
    f"{ZOOMING} The legend switches methods on and off in all charts.",
    "Orders and schemes are observed where a figure changed, in both releases: an order p says that an error shrinks like the "
    "p-th power of the time step, a scheme is named where the engine's trajectory is that of the textbook scheme. "
    "releases.csv has all figures, changes.csv all changes.",
)


@dataclass(frozen=True)
class _Told:
    """What is to be drawn: rows and changes with the line of their method."""

    rows: Sequence[tuple[Line, Row]]
    changes: Sequence[tuple[Line, Change]]
    versions: Sequence[str]


def present(found: Mapping[str, Found]) -> StudyReport:
    """What the study's report says. found: by a label, such as `release_rows.labels` gives; an empty one of a single study."""
    rows = [(_key(label, row), row) for label, one in found.items() for row in one.rows if row["integrator"]]
    changes = [(_key(label, asdict(change)), change) for label, one in found.items() for change in one.changes]
    lines = _hued(assign(key for key, _ in (*rows, *changes)))
    told = _Told(
        [(lines[key], row) for key, row in rows],
        [(lines[key], change) for key, change in changes],
        sorted({version for one in found.values() for version in one.header["versions"]}, key=Version),
    )
    return StudyReport(
        title="What upgrades changed",
        headline=_headline(told),
        header=merged_header(found),
        notices=tuple(f"{label}: {text}" if label else text for label, one in found.items() for text in _notices(one)),
        findings=findings(told.changes, [row for _, row in told.rows]),
        parts=tuple(_part(case, told) for case in dict.fromkeys(row["case"] for _, row in told.rows)),
        reading=READING,
    )


def _hued(lines: Mapping[RunKey, Line]) -> dict[RunKey, Line]:
    """The same lines with a hue an integrator: there is one engine."""
    integrators = list(dict.fromkeys(line.integrator for line in lines.values()))
    sets = list(dict.fromkeys(line.results for line in lines.values()))
    found = {}
    for key, line in lines.items():
        hue, _ = HUES[integrators.index(line.integrator) % len(HUES)]
        found[key] = replace(line, colour=paled(hue, len(sets) - 1 - sets.index(line.results)))
    return found


def _key(label: str, row: Row) -> RunKey:
    return RunKey.of_row(row, label).over_cases


def _headline(told: _Told) -> str:
    changed = {change.integrator for _, change in told.changes}
    upgrades = {(change.from_version, change.to_version) for _, change in told.changes}
    ran = made(row for _, row in told.rows)
    runs = f"{count(len(ran), 'run')} of {count(len({row['version'] for row in ran}), 'release')}"
    if changed:
        return f"{count(len(changed), 'integrator')} changed at {count(len(upgrades), 'upgrade')}, in {runs}"
    return f"No change in {runs}" if ran else "No release could be measured"


def _notices(found: Found) -> list[str]:
    unmeasured = [f"{version} was not measured: {reason}." for version, reason in found.header["unmeasured"].items()]
    return [*(f"{notice}." for notice in found.header["notices"]), *unmeasured]


def _part(case: str, told: _Told) -> Part:
    rows = [(line, row) for line, row in told.rows if row["case"] == case]
    changes = [(line, change) for line, change in told.changes if change.case == case]
    changed = {change.quantity for _, change in changes}
    drawn = [
        quantity
        for name, quantity in QUANTITIES.items()
        if (name == PRIMARY or name in changed) and any(row.get(name) for _, row in rows)
    ]
    tables = [("Changes", _changes(changes))] if changes else []
    return Part(
        name=case,
        title=case,
        texts=() if changes else ("All releases that were measured agree to rounding.",),
        charts=tuple(_chart(quantity, rows, changes, told.versions) for quantity in drawn),
        tables=(*tables, (QUANTITIES[PRIMARY].label, _by_release(rows, told.versions))),
        lines=tuple(dict.fromkeys(line for line, _ in rows)),
    )


def _chart(
    quantity: Quantity,
    rows: Sequence[tuple[Line, Row]],
    changes: Sequence[tuple[Line, Change]],
    versions: Sequence[str],
) -> Chart:
    before = {(line, change.to_version): change.before for line, change in changes if change.quantity == quantity.name}
    points: list[Point] = []
    for line, row in rows:
        value = before.get((line, row["version"]))
        points.append((line, row["version"], row.get(quantity.name), number(value) if isinstance(value, float) else ""))
    told = [
        f"{line.label} {number(change.before)} → {number(change.after)} at {change.to_version}"
        for line, change in changes
        if change.quantity == quantity.name and isinstance(change.before, float) and isinstance(change.after, float)
    ]
    happened = listing(told, 6, "change") if told else "no change"
    alt = f"{quantity.title} by release on a log scale, {count(len({line for line, _ in rows}), 'method')}: {happened}."
    zero = listing(list(dict.fromkeys(line.label for line, _, value, _ in points if value == 0)))
    notes = (f"With a figure of zero, which is not drawn: {zero}.",) if zero else ()
    return Chart(quantity.title, release_chart(quantity, versions, points), alt, notes)


def _changes(changes: Sequence[tuple[Line, Change]]) -> Table:
    words = ("Integrator", "Between", "Time step", "Figure", "Order", "Scheme")
    figures = ("Before", "After", "Factor")
    rows = []
    for line, change in changes:
        scheme = " → ".join(dict.fromkeys(name or "none" for name in (change.scheme_before, change.scheme_after)))
        texts = (
            named(line),
            f"{change.from_version} and {change.to_version}",
            milliseconds(change.timestep, 4),
            _figure(change.quantity),
            orders(change),
            "–" if scheme == "none" else scheme,
        )
        sides = [Entry(side) if isinstance(side, str) else Entry(number(side), side) for side in (change.before, change.after)]
        rows.append((*map(Entry, texts), *sides, Entry(number(change.factor, 3), change.factor)))
    return Table(
        columns=words + figures,
        numeric=(False,) * len(words) + (True,) * len(figures),
        rows=tuple(rows),
        failed=(False,) * len(rows),
        notes=("Factor: how many times farther from mechanics the larger of the two figures is.",),
    )


def _figure(name: str) -> str:
    return "Status" if name == STATUS else QUANTITIES[name].label


def _by_release(rows: Sequence[tuple[Line, Row]], versions: Sequence[str]) -> Table:
    """A row a release, a column a method."""
    cells: dict[str, dict[Line, Row]] = defaultdict(dict)
    for line, row in rows:
        cells[row["version"]][line] = row
    lines = list(dict.fromkeys(line for line, _ in rows))
    there = [version for version in versions if version in cells]
    return Table(
        columns=("Release", *(line.label for line in lines)),
        numeric=(False, *(True for _ in lines)),
        rows=tuple((Entry(version), *(_cell(cells[version].get(line)) for line in lines)) for version in there),
        failed=(False,) * len(there),
        notes=(),
    )


def _cell(row: Row | None) -> Entry:
    if row is None:
        return Entry("–")
    if row["status"] != Completed.status:
        return Entry(row["status"])
    return Entry(number(row[PRIMARY]), row[PRIMARY])
