"""The rows of the study of releases: what each version of an engine gives, and what changed from one to the next.

A folder keeps them as `releases.csv` and `changes.csv` for people and tables, and as `releases.jsonl`, a journal whose header
tells of the machine, for `read`.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, cast, get_type_hints

from bodycheck.adapters.method import current
from bodycheck.errors import BadInput
from bodycheck.judging.judgement import COLUMNS
from bodycheck.running import csv_tables, journal
from bodycheck.running.header import Header
from bodycheck.running.outcome import Unsupported

RECORDS = "releases.jsonl"

#: Status of a row of a version that cannot be had here: it tells of no method.
UNOBTAINABLE = "unobtainable"

#: Behind the name of a figure: by how much it may differ where nothing has changed; see `bodycheck.judging.baseline`.
ALLOWANCE = "_allowance"

#: The quantity of a change that is of the status.
STATUS = "status"

#: A version x method x case: the columns of results, and the allowance of each figure.
Row = Mapping[str, Any]


@dataclass(frozen=True)
class Change:
    """What a method gives in one version and not in the next one that could be measured.

    quantity: a figure's column, or `STATUS`. before, after: the figures, or the statuses. factor: how many times farther from
    what is right the larger figure is; None of statuses and beside a zero. order_before, order_after: the observed orders in
    that quantity; None where it has none, or none was seen. scheme_before, scheme_after: the textbook schemes, empty where
    none is named. timestep: s. allowance: of the difference, by which it may differ where nothing has changed.
    """

    engine: str
    case: str
    integrator: str
    quantity: str
    from_version: str
    to_version: str
    before: float | str
    after: float | str
    factor: float | None
    order_before: float | None
    order_after: float | None
    scheme_before: str
    scheme_after: str
    timestep: float
    allowance: float | None


class ReleasesHeader(Header):
    """The header of a study of releases, which spans several versions of one engine.

    versions: the releases in their order. cases: the identities of the cases by name. unmeasured: why a release could not be
    measured, by version. notices: what limits what the study says.
    """

    versions: list[str]
    cases: dict[str, str]
    unmeasured: dict[str, str]
    notices: list[str]


@dataclass(frozen=True)
class Found:
    """What a study of releases found.

    header: as that of results, with `versions` in their order, `cases`, identities by name, `unmeasured`, why nothing is known
    of some versions, by version, and `notices`.
    """

    header: ReleasesHeader
    rows: tuple[Row, ...]
    changes: tuple[Change, ...]


def made(rows: Iterable[Row]) -> list[Row]:
    """The rows of runs that were made, however they ended: of releases that can be had, of methods that they have."""
    return [row for row in rows if row["status"] not in (UNOBTAINABLE, Unsupported.status)]


def labels(found: Sequence[Found]) -> list[str]:
    """What tells studies apart: what of their machines differs; of a single study nothing, of equal machines the place."""
    machines = [one.header["machine"] for one in found]
    for field in ("processor", "system", "python"):
        told = [str(machine.get(field, "")) for machine in machines]
        if len(set(told)) == len(found) > 1:
            return told
    return [""] if len(found) == 1 else [f"machine {place}" for place in range(1, len(found) + 1)]


def merged_header(found: Mapping[str, Found]) -> ReleasesHeader:
    """The header of several studies by their labels: that of the first, with the machines of all.

    Raises `BadInput` where they are not of one engine, or a case is not the same one in all of them.
    """
    first, *others = found.values()
    if any(other.header["engines"].keys() != first.header["engines"].keys() for other in others):
        raise BadInput("these studies are of different engines")
    for name, identity in first.header["cases"].items():
        if any(other.header["cases"].get(name, identity) != identity for other in others):
            raise BadInput(f"{name}: is not the same case in all of these studies")
    if len(found) == 1:
        return first.header
    machines = {f"{name} of {label}": value for label, one in found.items() for name, value in one.header["machine"].items()}
    return {**first.header, "machine": machines}


def write(found: Found, folder: Path) -> None:
    """releases.csv, changes.csv and releases.jsonl in a folder, which is made. Raises `BadInput` where they cannot be."""
    try:
        with journal.begin(folder / RECORDS, dict(found.header)) as log:
            for row in found.rows:
                log.add({"record": "row", "row": dict(row)})
            for change in found.changes:
                log.add({"record": "change", "change": asdict(change)})
            further = dict.fromkeys(name for row in found.rows for name in row if name not in COLUMNS)
            names = sorted(further, key=lambda name: name.endswith(ALLOWANCE))
            csv_tables.write(folder / "releases.csv", (*COLUMNS, *names), found.rows)
            csv_tables.write(folder / "changes.csv", [field.name for field in fields(Change)], map(asdict, found.changes))
    except OSError as error:
        raise BadInput(f"{folder}: cannot be written: {error}") from error


def read(folder: Path) -> Found:
    """What `write` has written. Raises `BadInput`."""
    contents = journal.read(folder / RECORDS)
    if not contents.complete:
        raise BadInput(f"{folder / RECORDS}: was interrupted while it was written; make it again")
    try:
        return Found(
            cast(ReleasesHeader, {name: contents.header[name] for name in get_type_hints(ReleasesHeader)}),
            tuple(_present(record["row"]) for record in contents.records if record["record"] == "row"),
            tuple(Change(**_present(record["change"])) for record in contents.records if record["record"] == "change"),
        )
    except (KeyError, TypeError) as error:
        raise BadInput(f"{folder / RECORDS}: no records of a study of releases: {error}") from error


def _present(row: Row) -> dict[str, Any]:
    """A row with the present spelling of its method, which earlier versions of bodycheck spelled otherwise."""
    return {**row, "integrator": current(row["integrator"])}
