"""The content of the page of an engine apart from scenes: methods, contact sheet, audit, ensembles, robots and issues."""

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, get_args

from bodycheck.adapters.engine_name import adapter_of
from bodycheck.results.tables import Table
from bodycheck.site import known
from bodycheck.site.catalogue import Catalogue, Entry, version_key
from bodycheck.site.cells import verdict
from bodycheck.site.known import Evidence, Issue
from bodycheck.site.releases import Release
from bodycheck.site.submissions.submission import Submission
from bodycheck.studies.audit.rows import FINDINGS
from bodycheck.studies.contact.rows import MEASURED, SHEET, ContactRow, Line, PropertyRow, Setting, lines


@dataclass(frozen=True, eq=False)
class MethodFacts:
    """The facts about an integrator of a release.

    Parameters
    ----------
    name
        The integrator with its options.
    counts
        The number of its runs with each outcome: ran, failed, refused or unsupported.
    orders
        The rows of orders.csv about it, for the newest release that has rows in orders.csv.
    """

    name: str
    counts: Mapping[str, int]
    orders: tuple[Entry, ...]

    @property
    def claimed(self) -> int | None:
        """Return the order that the adapter claims; None if it is not known."""
        return next((entry.get("claimed") for entry in self.orders if entry.get("claimed") is not None), None)

    @property
    def by_case(self) -> Mapping[str, tuple[Entry, ...]]:
        """Return the rows of orders.csv by case."""
        cases = dict.fromkeys(entry.row["case"] for entry in self.orders)
        return {case: tuple(entry for entry in self.orders if entry.row["case"] == case) for case in cases}

    @property
    def schemes(self) -> tuple[str, ...]:
        """Return the textbook schemes with which the integrator agrees, and as "near …" the schemes to which it is close."""
        told = (entry.get("scheme") or _near(entry.get("nearest_scheme")) for entry in self.orders)
        return tuple(dict.fromkeys(filter(None, told)))


def methods(release: Release) -> tuple[MethodFacts, ...]:
    """Return the facts about each integrator that has runs in a release, or whose order was observed."""
    counts: dict[str, Counter[str]] = defaultdict(Counter)
    for name, runs in release.runs.items():
        scene = release.catalogue.scenes[name]
        for run in runs:
            found = verdict(run, scene)
            counts[run.row["integrator"]][found if found in ("failed", "refused", "unsupported") else "ran"] += 1
    orders: dict[str, list[Entry]] = defaultdict(list)
    for entry in newest(release.catalogue, "orders.csv", release.engine):
        orders[entry.row["integrator"]].append(entry)
    return tuple(MethodFacts(name, counts[name], tuple(orders[name])) for name in dict.fromkeys((*counts, *orders)))


def newest(catalogue: Catalogue, table: str, engine: str) -> tuple[Entry, ...]:
    """Return the rows of a table about the newest version of an engine, from the newest submission that has such rows."""
    entries = [entry for entry in catalogue.entries(table) if entry.engine == engine and entry.get("version")]
    if not entries:
        return ()
    last = max(entries, key=lambda entry: entry.order)
    return tuple(entry for entry in entries if (entry.version, entry.source) == (last.version, last.source))


def defaults(catalogue: Catalogue, engine: str) -> tuple[Mapping[str, str], Submission | None]:
    """Return the default settings of the newest version of an engine, and the newest submission that lists them."""
    found: tuple[Mapping[str, str], Submission | None] = ({}, None)
    latest = version_key("0")
    for source in catalogue.submissions:
        for name, told in source.header.defaults.items():
            version = version_key(source.header.engines.get(name, "0"))
            if adapter_of(name) == engine and told and version >= latest:
                found, latest = (told, source), version
    return found


@dataclass(frozen=True, eq=False)
class ContactFacts:
    """A line of the contact sheet, and its rows by setting, without the settings that have none."""

    line: Line[ContactRow]
    entries: Mapping[Setting, Entry]


def contact_sheet(catalogue: Catalogue, engine: str) -> tuple[ContactFacts, ...]:
    """Return the contact sheet of an engine."""
    entries = {_contact_row(entry): entry for entry in newest(catalogue, "contact.csv", engine)}
    return tuple(
        ContactFacts(line, {setting: entries[row] for setting, row in line.rows.items()}) for line in lines(list(entries))
    )


def contact_settings(sheet: Sequence[ContactFacts]) -> tuple[Setting, ...]:
    """Return the settings that lines of the contact sheet have, in their order."""
    return tuple(setting for setting in get_args(Setting) if any(setting in one.entries for one in sheet))


def _contact_row(entry: Entry) -> ContactRow:
    """Return a row of contact.csv as a `ContactRow`, with the name of the engine without its version."""
    return ContactRow(**_values(entry, SHEET))


def properties(catalogue: Catalogue, engine: str) -> Mapping[Setting, tuple[tuple[PropertyRow, Entry], ...]]:
    """Return the properties of the contacts of an engine by setting, each as a row of the study and with its entry."""
    rows: dict[Setting, list[tuple[PropertyRow, Entry]]] = {}
    for entry in newest(catalogue, "contact_properties.csv", engine):
        row = PropertyRow(**_values(entry, MEASURED))
        rows.setdefault(row.setting, []).append((row, entry))
    return {setting: tuple(rows[setting]) for setting in get_args(Setting) if setting in rows}


def _values(entry: Entry, table: Table[Any]) -> dict[str, Any]:
    """Return the values of a row by column, with "" for empty texts, and the name of the engine without its version."""
    texts = {column.name for column in table.columns if column.kind == "string"}
    return {name: entry.get(name) or "" if name in texts else entry.get(name) for name in table.by_name} | {
        "engine": entry.engine
    }


@dataclass(frozen=True, eq=False)
class RobotFacts:
    """The comparison of an engine's reading of a robot model with the file.

    Parameters
    ----------
    model, version
        The model, and the newest version of the engine that was compared on it.
    counts
        The number of compared quantities by status.
    causes
        The causes of the differences.
    source
        The submission in words, if others say something else of this version; otherwise empty.
    """

    model: str
    version: str
    counts: Mapping[str, int]
    causes: tuple[str, ...]
    source: str = ""


def robots(catalogue: Catalogue, engine: str) -> Iterator[RobotFacts]:
    """Yield the facts about an engine on each robot model, from the newest version that was compared on the model.

    Submissions that say different things of this version have facts each.
    """
    for model, entries in catalogue.robots.items():
        own = [entry for entry in entries if entry.engine == engine]
        if own:
            version = max((entry.version for entry in own), key=version_key)
            by_source: dict[Submission, list[Entry]] = defaultdict(list)
            for entry in own:
                if entry.version == version:
                    by_source[entry.source].append(entry)
            for source, rows in by_source.items():
                causes = sorted({str(entry.get("cause")) for entry in rows if entry.get("cause")})
                counts = Counter(str(entry.get("status")) for entry in rows)
                yield RobotFacts(model, version, counts, tuple(causes), source.named if len(by_source) > 1 else "")


def issues(catalogue: Catalogue, engine: str) -> Iterator[tuple[Issue, tuple[Evidence, ...]]]:
    """Yield the known issues of an engine, with the numbers that show them."""
    for issue in known.issues():
        if issue.engine == engine:
            yield issue, known.evidence(catalogue, issue)


def findings(rows: Sequence[Entry]) -> tuple[Entry, ...]:
    """Return the rows of the audit with a status that counts as a finding."""
    return tuple(entry for entry in rows if entry.get("status") in FINDINGS)


def _near(scheme: str | None) -> str:
    return f"near {scheme}" if scheme else ""
