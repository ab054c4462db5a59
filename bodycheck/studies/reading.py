"""Reading of saved studies: the checks that all of them share.

A folder comes from anyone. What a table says is compared with the records beside it, and nothing is simulated.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

from bodycheck.adapters.method import current
from bodycheck.errors import BadFolder
from bodycheck.figures import revisions
from bodycheck.reports.study import StudyReport
from bodycheck.results import csv_tables, journal, records, store
from bodycheck.results.header import Header
from bodycheck.results.journal import Contents
from bodycheck.results.store import Results
from bodycheck.results.tables import Row, Table

#: The predicate of messages about an interrupted study.
INTERRUPTED = "was interrupted before its report was written; run it again with the same --out to resume it"


def finished(path: Path) -> tuple[Contents, Header]:
    """Return the records of a finished study, and their header.

    Raises `BadFolder` if the study was interrupted, and `ValueError` if the header lacks an entry that every report contains.
    """
    contents = journal.read(path)
    records.typed(records.HeaderRecord, contents.header)
    if not contents.complete:
        raise BadFolder(f"{path.parent}: the study {INTERRUPTED}")
    return contents, cast(Header, contents.header)


def finished_runs(folder: Path) -> Results:
    """Return the runs of a finished study, whose table is beside their records. Raises `BadFolder` if it was interrupted."""
    results = store.read(folder)
    if not results.complete:
        raise BadFolder(f"{folder}: the study {INTERRUPTED}")
    return results


def check_runs(results: Results, table: str, tabled: set[Any], recorded: set[Any]) -> None:
    """Raise `BadFolder` if a table does not list the same runs as the records in its folder."""
    if not tabled or tabled != recorded:
        raise BadFolder(
            f"{results.folder}: {table} does not list the same runs as {store.RECORDS}: it is damaged, or it belongs to other "
            "results and must be removed"
        )


def dated(report: StudyReport, header: Mapping[str, Any], figures: Collection[str]) -> StudyReport:
    """Return a report that says which of its figures were measured with another definition. figures: those that it has."""
    stored = records.typed(records.RevisionsRecord, header).revisions
    return replace(report, notices=(*report.notices, *(f"{text}." for text in revisions.notices(stored, figures))))


def rows(folder: Path, table: Table[Row]) -> list[Row]:
    """Return the rows of a table, with the present spelling of methods that earlier versions of bodycheck spelled otherwise.

    Raises `ValueError` for a row that is not as the description of the table says.
    """
    return [row(table, record) for record in csv_tables.read(folder, table)]


def row(table: Table[Row], record: Mapping[str, Any]) -> Row:
    """Return the row of a record of a table; see `rows`."""
    present = table.values(record) | {"integrator": current(record["integrator"])}
    return cast(Row, present) if table.row is None else records.typed(table.row, present)


def runs(results: Results) -> Iterator[dict[str, Any]]:
    """Return the records of the runs among those of some results."""
    return (record for record in results.records if record["record"] == "run")
