"""The report of the study of releases: the changes at each upgrade, and for each case the numbers of every release."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from packaging.version import Version

from bodycheck.figures import revisions
from bodycheck.reports.charts import ZOOMING, Spec, framed, log_axis, method_scale
from bodycheck.reports.lines import FURTHER_HUES, HUES, Line, assign, paled
from bodycheck.reports.quantities import QUANTITIES, Quantity, count, listing, milliseconds, number, verb
from bodycheck.reports.series import rounded
from bodycheck.reports.study import Chart, Part, StudyReport
from bodycheck.reports.tables import Entry, Table
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Completed
from bodycheck.studies.releases.findings import findings, named, orders
from bodycheck.studies.releases.rows import STATUS, Change, Found, Row, made, merged_header

#: The line of a method, a version, the number of the method in this version or None, and as text the number from which it
#: changed at this version; the text is empty if it did not change.
Point = tuple[Line, str, float | None, str]

#: Area of the ring that marks a change (square pixels).
RING = 150


def release_chart(quantity: Quantity, versions: Sequence[str], points: Sequence[Point]) -> Spec:
    """Return a complete chart of a quantity over the given versions, in their order.

    Zeros, which a log scale cannot show, and missing numbers leave gaps. The parameter `hidden` of the chart holds the labels
    of methods that are switched off.
    """
    lines = list(dict.fromkeys(line for line, *_ in points))
    label = {"labelAngle": -60, "labelFontSize": 10, "labelOverlap": False, "grid": False}
    x = {"field": "version", "type": "ordinal", "sort": list(versions), "title": "Release", "axis": label}
    y = {
        "field": "value",
        "type": "quantitative",
        "title": quantity.label,
        "scale": {"type": "log", "nice": False, "padding": 12},
        "axis": log_axis("y"),
    }
    tooltip = [
        {"field": "method", "type": "nominal"},
        {"field": "version", "type": "nominal", "title": "release"},
        {"field": "label", "type": "nominal", "title": quantity.title.lower()},
    ]
    scales = {channel: method_scale(channel, lines) for channel in ("strokeDash", "strokeWidth")}
    # Only the vertical axis zooms, because releases are not numbers.
    zoom = {"type": "interval", "encodings": ["y"], "zoom": "wheel![event.ctrlKey || event.metaKey]"}
    ring = {"type": "point", "clip": True, "aria": False, "filled": False, "size": RING, "strokeWidth": 1.6, "opacity": 0.9}
    layers: list[Spec] = [
        {
            "data": {"values": [_values(point, quantity) for point in points]},
            "transform": [{"filter": "indexof(hidden, datum.method) < 0"}],
            "encoding": {"x": x, "y": y, "color": method_scale("color", lines)},
            "layer": [
                {
                    "params": [{"name": "window", "select": zoom, "bind": "scales"}],
                    "mark": {"type": "line", "clip": True, "aria": False, "opacity": 0.8},
                    "encoding": scales,
                },
                {
                    "transform": [{"filter": "isValid(datum.value)"}],
                    "mark": {"type": "point", "clip": True, "filled": True, "size": 26, "opacity": 1, "aria": False},
                    "encoding": {"tooltip": tooltip},
                },
                {"transform": [{"filter": "datum.changed"}], "mark": ring, "encoding": {"tooltip": tooltip}},
            ],
        }
    ]
    return framed(layers, height=300) | {"params": [{"name": "hidden", "value": []}]}


def _values(point: Point, quantity: Quantity) -> Mapping[str, Any]:
    line, version, value, before = point
    drawn = rounded([value])[0] if value else None
    shown = number(value) if not before else f"{before} → {number(value)}"
    label = f"{shown} {quantity.unit}".rstrip()
    return {"method": line.label, "version": version, "value": drawn, "label": label, "changed": bool(before and drawn)}


#: The quantity that is always drawn and tabulated, even if it did not change.
PRIMARY = "attitude_error"

#: Explanations for readers.
READING = (
    "Every release runs in an environment of its own, and the same bodycheck runs all of them. A change is reported if two "
    "successive releases differ by more than the truth's own error, rounding, and the spread of runs from nudged initial "
    "states explain. Otherwise they agree within these limits. A release that could not be measured is skipped.",
    "In each chart a line is a method, and a ring marks the first release with another value. A gap means that the release was "
    "not available, lacks the method or has no number, or that the number is zero, which a log scale cannot show. "
    f"{ZOOMING} The legend switches methods on and off in all charts.",
    "Orders and schemes are observed in both releases where a number changed. An order p means that the error decreases like "
    "the p-th power of the time step. A scheme is named if the engine's trajectory is that of the textbook scheme. "
    "releases.csv has all numbers, and changes.csv has all changes.",
)


@dataclass(frozen=True)
class _Labelled:
    """Rows and changes with the lines of their methods, and all versions in order."""

    rows: Sequence[tuple[Line, Row]]
    changes: Sequence[tuple[Line, Change]]
    versions: Sequence[str]


def present(studies: Mapping[str, Found]) -> StudyReport:
    """Return the contents of the report of studies, which are given by label (see `rows.labels`).

    The label of a single study is empty. Raises `BadInput` if the studies cannot be combined; see `rows.merged_header`.
    """
    rows = [(_key(label, row), row) for label, one in studies.items() for row in one.rows if row["integrator"]]
    changes = [(_key(label, asdict(change)), change) for label, one in studies.items() for change in one.changes]
    lines = _hued(assign(key for key, _ in (*rows, *changes)))
    labelled = _Labelled(
        [(lines[key], row) for key, row in rows],
        [(lines[key], change) for key, change in changes],
        sorted({version for one in studies.values() for version in one.header["versions"]}, key=Version),
    )
    return StudyReport(
        title="What upgrades changed",
        headline=_headline(labelled),
        header=merged_header(studies),
        notices=tuple(f"{label}: {text}" if label else text for label, one in studies.items() for text in _notices(one)),
        findings=findings(labelled.changes, [row for _, row in labelled.rows]),
        parts=tuple(_part(case, labelled) for case in dict.fromkeys(row["case"] for _, row in labelled.rows)),
        reading=READING,
    )


def _hued(lines: Mapping[RunKey, Line]) -> dict[RunKey, Line]:
    """Return the same lines with a hue for each integrator instead of each engine, because there is only one engine."""
    integrators = list(dict.fromkeys(line.integrator for line in lines.values()))
    sets = list(dict.fromkeys(line.results for line in lines.values()))
    hues = (*HUES.values(), *FURTHER_HUES)
    coloured = {}
    for key, line in lines.items():
        hue, _ = hues[integrators.index(line.integrator) % len(hues)]
        coloured[key] = replace(line, colour=paled(hue, len(sets) - 1 - sets.index(line.results)))
    return coloured


def _key(label: str, row: Row) -> RunKey:
    return RunKey.of_row(row, label).over_cases


def _headline(labelled: _Labelled) -> str:
    changed = {change.integrator for _, change in labelled.changes}
    upgrades = {(change.from_version, change.to_version) for _, change in labelled.changes}
    ran = made(row for _, row in labelled.rows)
    runs = f"{count(len(ran), 'run')} of {count(len({row['version'] for row in ran}), 'release')}"
    if changed:
        compared = f"{runs} {verb(len(ran), 'was', 'were')} compared"
        return f"{count(len(changed), 'integrator')} changed at {count(len(upgrades), 'upgrade')}; {compared}"
    return f"No change in {runs}" if ran else "No release could be measured"


def _notices(results: Found) -> list[str]:
    unmeasured = [f"{version} was not measured: {reason}." for version, reason in results.header["unmeasured"].items()]
    columns = {name for row in results.rows for name, value in row.items() if value is not None}
    other = revisions.notices(results.header["revisions"], columns)
    return [*(f"{notice}." for notice in (*results.header["notices"], *other)), *unmeasured]


def _part(case: str, labelled: _Labelled) -> Part:
    rows = [(line, row) for line, row in labelled.rows if row["case"] == case]
    changes = [(line, change) for line, change in labelled.changes if change.case == case]
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
        texts=() if changes else ("All releases that were measured agree to within rounding.",),
        charts=tuple(_chart(quantity, rows, changes, labelled.versions) for quantity in drawn),
        tables=(*tables, (QUANTITIES[PRIMARY].label, _by_release(rows, labelled.versions))),
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
    happened = [
        f"{line.label} from {number(change.before)} to {number(change.after)} at {change.to_version}"
        for line, change in changes
        if change.quantity == quantity.name and isinstance(change.before, float) and isinstance(change.after, float)
    ]
    changed = f"The changes are {listing(happened, 6, 'change')}." if happened else "There is no change."
    alt = f"{quantity.title} by release on a log scale, for {count(len({line for line, _ in rows}), 'method')}. {changed}"
    zero = listing(list(dict.fromkeys(line.label for line, _, value, _ in points if value == 0)))
    notes = (f"Values of zero, which are not drawn, occur with {zero}.",) if zero else ()
    return Chart(quantity.title, release_chart(quantity, versions, points), alt, notes)


def _changes(changes: Sequence[tuple[Line, Change]]) -> Table:
    words = ("Integrator", "Between", "Time step", "Quantity", "Order", "Scheme")
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
        notes=("The factor says how many times farther from the exact value the larger of the two numbers is.",),
    )


def _figure(name: str) -> str:
    return "Status" if name == STATUS else QUANTITIES[name].label


def _by_release(rows: Sequence[tuple[Line, Row]], versions: Sequence[str]) -> Table:
    """Return a table with one row for each release and one column for each method."""
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
