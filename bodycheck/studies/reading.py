"""Functions and checks that all readers of saved studies share.

A folder may come from an unknown source. Therefore its tables are compared with the records in it; nothing is simulated.
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
    """Return the contents of the journal of a finished study, and its header.

    Raises `BadFolder` if the study was interrupted, and `ValueError` if the header lacks an entry that every report contains.
    """
    contents = journal.read(path)
    records.typed(records.HeaderRecord, contents.header)
    if not contents.complete:
        raise BadFolder(f"{path.parent}: the study {INTERRUPTED}")
    return contents, cast(Header, contents.header)


def finished_runs(folder: Path) -> Results:
    """Return the runs that are recorded in the folder of a finished study. Raises `BadFolder` if it was interrupted."""
    results = store.read(folder)
    if not results.complete:
        raise BadFolder(f"{folder}: the study {INTERRUPTED}")
    return results


def check_runs(results: Results, table: str, tabled: set[Any], recorded: set[Any]) -> None:
    """Raise `BadFolder` if a table is empty or does not list the same runs as the records in its folder.

    table: the file name of the table. tabled, recorded: the keys of the runs in the table and in the records.
    """
    if not tabled or tabled != recorded:
        raise BadFolder(
            f"{results.folder}: {table} does not list the same runs as {store.RECORDS}: it is damaged, or it belongs to other "
            "results and must be removed"
        )


def dated(report: StudyReport, header: Mapping[str, Any], figures: Collection[str]) -> StudyReport:
    """Return a report with a notice for each figure that was measured with a definition that has changed since.

    header: the header of the records. figures: the names of the figures in the report.
    """
    stored = records.typed(records.RevisionsRecord, header).revisions
    return replace(report, notices=(*report.notices, *(f"{text}." for text in revisions.notices(stored, figures))))


def rows(folder: Path, table: Table[Row]) -> list[Row]:
    """Return the rows of a table in a folder, with the present spelling of methods whose spelling has changed.

    Raises `ValueError` for a row that does not match the description of the table.
    """
    return [row(table, record) for record in csv_tables.read(folder, table)]


def row(table: Table[Row], record: Mapping[str, Any]) -> Row:
    """Return the row of a table that a record, a mapping from column to value, contains; see `rows`."""
    present = table.values(record) | {"integrator": current(record["integrator"])}
    return cast(Row, present) if table.row is None else records.typed(table.row, present)


def runs(results: Results) -> Iterator[dict[str, Any]]:
    """Return those records of some results that are records of runs."""
    return (record for record in results.records if record["record"] == "run")
