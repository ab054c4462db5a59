"""The rows of the study of releases: the results of each version of an engine, and the changes from version to version.

A folder contains the rows as `releases.csv` and `changes.csv` for users. It also contains them as `releases.jsonl`, a journal
that `read` reads and whose header describes the machine.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Annotated, Any, cast, get_type_hints

from bodycheck.adapters.method import current
from bodycheck.errors import BadInput
from bodycheck.figures.column import Column
from bodycheck.figures.columns import FIGURES
from bodycheck.figures.revisions import redefined
from bodycheck.judging.judgement import COLUMNS
from bodycheck.results import csv_tables, journal, records
from bodycheck.results.header import DESCRIPTIONS, LATER, Header
from bodycheck.results.outcome import Unsupported
from bodycheck.results.tables import RESULTS, Meaning, Table, table_of

#: The file with the records of the study.
RECORDS = "releases.jsonl"

#: Status of a row for a version that cannot be installed. Such a row says nothing about a method.
UNOBTAINABLE = "unobtainable"

#: Suffix of the column with the difference of a figure that is allowed if nothing has changed; see
#: `judging.baselines.baseline`.
ALLOWANCE_SUFFIX = "_allowance"

#: The name of the quantity in a change of the status.
STATUS = "status"

#: Beginning of the notice about a figure that is left out.
NOT_COMPARED = "Left out, since its definition differs between these studies"

#: The row of a version, method and case: the columns of results, and the allowance of each figure.
Row = Mapping[str, Any]


@dataclass(frozen=True)
class Change:
    """A difference between a method's results in a version and its results in the next version that could be measured."""

    engine: str
    case: str
    integrator: str
    quantity: Annotated[
        str, Meaning("Quantity", "what the numbers of the row are of", words=frozenset((*RESULTS.by_name, STATUS)))
    ]
    from_version: Annotated[str, Meaning("From", "earlier version")]
    to_version: Annotated[str, Meaning("To", "next version that could be measured")]
    before: Annotated[float | str, Meaning("Before", "value or status in the earlier version, in the unit of the quantity")]
    after: Annotated[float | str, Meaning("After", "value or status in the later version, in the unit of the quantity")]
    factor: Annotated[
        float | None,
        Meaning(
            "Factor",
            "ratio of the larger error to the smaller one; empty for a status, and if the smaller one is zero",
            counts="times",
        ),
    ]
    order_before: Annotated[
        float | None, Meaning("Order before", "observed order of convergence in the earlier version", signed=True)
    ]
    order_after: Annotated[
        float | None, Meaning("Order after", "observed order of convergence in the later version", signed=True)
    ]
    scheme_before: Annotated[str, Meaning("Scheme before", "textbook scheme of the earlier version; empty if none is named")]
    scheme_after: Annotated[str, Meaning("Scheme after", "textbook scheme of the later version; empty if none is named")]
    timestep: float
    allowance: Annotated[
        float | None,
        Meaning("Allowance", "difference that is allowed if nothing has changed, in the unit of the quantity"),
    ]


#: The columns with the allowed difference of a figure from release to release.
ALLOWANCES = tuple(
    Column(
        *(f"{name}{ALLOWANCE_SUFFIX}", "number", f"{figure.title}, allowance"),
        *(f"difference of {name} that is allowed if nothing has changed", figure.unit, figure.counts),
    )
    for name, figure in FIGURES.items()
)

#: The table of the runs of all releases. A row of a release that could not be obtained has no figures.
RELEASES: Table[Row] = Table(
    "releases",
    "runs of releases",
    None,
    (*RESULTS.columns, *ALLOWANCES),
    key=("case", "version", "integrator", "timestep"),
    filled=("case", "engine", "version", "status"),
)
CHANGES = table_of(
    Change,
    "changes",
    "changes from release to release",
    filled=("case", "engine", "integrator", "timestep", "quantity", "from_version", "to_version"),
)

#: The tables of the study, the main one first.
TABLES = (RELEASES, CHANGES)


class ReleasesHeader(Header):
    """The header of a study of releases, which spans several versions of one engine.

    Attributes
    ----------
    versions
        The releases in ascending order.
    cases
        The identities of the cases by name.
    unmeasured
        The reasons why releases could not be measured, by version.
    notices
        Notices about limits of the study.
    revisions
        The revisions of the definitions of figures that have ever changed. Headers by earlier versions of bodycheck have none.
    """

    versions: list[str]
    cases: dict[str, str]
    unmeasured: dict[str, str]
    notices: list[str]
    revisions: dict[str, int]


@dataclass(frozen=True)
class Found:
    """The results of a study of releases.

    Parameters
    ----------
    header
        The header of the results.
    rows
        The rows of all versions, methods and cases.
    changes
        The changes from version to version.
    """

    header: ReleasesHeader
    rows: tuple[Row, ...]
    changes: tuple[Change, ...]


def comparable(studies: Sequence[Found]) -> list[Found]:
    """Return the studies without the figures whose definitions differ between them, which notices in the headers name."""
    first, *others = (one.header["revisions"] for one in studies)
    there = {name for one in studies for row in one.rows for name, value in row.items() if value is not None}
    apart = {name for other in others for name in redefined(first, other)} & there
    columns = apart | {f"{name}{ALLOWANCE_SUFFIX}" for name in apart}
    return [
        replace(
            one,
            header={**one.header, "notices": [*one.header["notices"], *(f"{NOT_COMPARED}: {name}" for name in sorted(apart))]},
            rows=tuple({name: value for name, value in row.items() if name not in columns} for row in one.rows),
            changes=tuple(change for change in one.changes if change.quantity not in apart),
        )
        for one in studies
    ]


def made(rows: Iterable[Row]) -> list[Row]:
    """Return the rows of runs that were made: all rows except those for missing releases and missing methods."""
    return [row for row in rows if row["status"] not in (UNOBTAINABLE, Unsupported.status)]


def labels(studies: Sequence[Found]) -> list[str]:
    """Return labels that distinguish studies: a property in which their machines differ, or numbers; empty for one study."""
    machines = [one.header["machine"] for one in studies]
    for field in ("processor", "system", "python"):
        texts = [str(machine.get(field, "")) for machine in machines]
        if len(set(texts)) == len(studies) > 1:
            return texts
    return [""] if len(studies) == 1 else [f"machine {number}" for number in range(1, len(studies) + 1)]


def merged_header(studies: Mapping[str, Found]) -> ReleasesHeader:
    """Return the common header of studies, which are given by their labels: the first header, with the machines of all studies.

    Raises `BadInput` if the studies are of different engines, or if a case differs between them.
    """
    first, *others = studies.values()
    if any(other.header["engines"].keys() != first.header["engines"].keys() for other in others):
        raise BadInput("these studies are of different engines")
    for name, identity in first.header["cases"].items():
        if any(other.header["cases"].get(name, identity) != identity for other in others):
            raise BadInput(f"{name}: the case differs between these studies")
    if len(studies) == 1:
        return first.header
    machines = {f"{name} of {label}": value for label, one in studies.items() for name, value in one.header["machine"].items()}
    return {**first.header, "machine": machines}


def write(results: Found, folder: Path) -> None:
    """Write releases.csv, changes.csv and releases.jsonl into a folder. Raises `BadInput` if that fails."""
    origins = [{name: results.header.get(name) for name in DESCRIPTIONS} | {"cases_physics_sha256": results.header["cases"]}]
    with journal.begin(folder / RECORDS, dict(results.header)) as log:
        for row in results.rows:
            log.add({"record": "row", "row": dict(row)})
        for change in results.changes:
            log.add({"record": "change", "change": asdict(change)})
        further = dict.fromkeys(name for row in results.rows for name in row if name not in COLUMNS)
        names = sorted(further, key=lambda name: name.endswith(ALLOWANCE_SUFFIX))
        csv_tables.write(folder, RELEASES, results.rows, origins, (*COLUMNS, *names))
        csv_tables.write(folder, CHANGES, results.changes, origins)


def read(folder: Path) -> Found:
    """Return the results that `write` has written into a folder. Raises `BadInput` if they are incomplete or damaged."""
    contents = journal.read(folder / RECORDS)
    if not contents.complete:
        raise BadInput(f"{folder / RECORDS}: was interrupted while it was written; run the study again")
    try:
        revisions = records.typed(records.RevisionsRecord, contents.header).revisions
        header = {"revisions": revisions, **LATER, **contents.header}
        return Found(
            cast(ReleasesHeader, {name: header[name] for name in get_type_hints(ReleasesHeader)}),
            tuple(_present(record["row"]) for record in contents.records if record["record"] == "row"),
            tuple(Change(**_present(record["change"])) for record in contents.records if record["record"] == "change"),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise BadInput(f"{folder / RECORDS}: does not contain records of a study of releases: {error}") from error


def _present(row: Row) -> dict[str, Any]:
    """Return a row with the present spelling of its method; earlier versions of bodycheck spelled some methods differently."""
    return {**row, "integrator": current(row["integrator"])}
