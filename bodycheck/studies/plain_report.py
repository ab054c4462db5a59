"""The report of a study whose folder has only the modules `rows` and `study` (see `plain`), also from its saved results.

This module makes no study, so that `bodycheck report` needs no engine and starts no process.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from bodycheck.errors import BadFolder
from bodycheck.reports.notices import of_header
from bodycheck.reports.quantities import count, number
from bodycheck.reports.study import Part, StudyReport
from bodycheck.reports.tables import Entry
from bodycheck.reports.tables import Table as PageTable
from bodycheck.results.header import Header
from bodycheck.results.tables import Table
from bodycheck.studies import reading, registry


def present(name: str, header: Header, rows: Sequence[Sequence[Any]]) -> StudyReport:
    """Return the contents of the report of a study: by its module `page`, or with all its tables if it has no such module.

    rows: the rows of each table, in the order of `TABLES`.
    """
    if (page := registry.part(name, "page")) is not None:
        report: StudyReport = page.present(header, *rows)
        return report
    tables: Sequence[Table[Any]] = registry.required(name, "rows").TABLES
    return StudyReport(
        title=tables[0].title.capitalize(),
        headline=f"{count(len(rows[0]), 'row')} of {tables[0].title}",
        header=header,
        notices=tuple(of_header(header)),
        findings=(),
        parts=tuple(_page_part(table, table_rows) for table, table_rows in zip(tables, rows, strict=True)),
    )


def journal(name: str) -> str:
    """Return the file name of a study's journal."""
    return str(registry.required(name, "rows").RECORDS)


def read(name: str, folder: Path) -> StudyReport:
    """Return the report of a finished study that is saved in a folder.

    Raises `BadFolder` if the study was interrupted, or if the rows of its main table differ from those in its journal, and
    the errors of damaged files.
    """
    rows = registry.required(name, "rows")
    contents, header = reading.finished(folder / rows.RECORDS)
    tables: Sequence[Table[Any]] = rows.TABLES
    rows_by_table = [reading.rows(folder, table) for table in tables]
    recorded = {reading.row(tables[0], record["row"]) for record in contents.records if "row" in record}
    if set(rows_by_table[0]) != recorded:
        raise BadFolder(f"{folder}: damaged: {tables[0].file} does not list the same runs as {rows.RECORDS}")
    return present(name, header, rows_by_table)


def _page_part(table: Table[Any], rows: Sequence[Any]) -> Part:
    """Return the part of a page with all rows of a table."""
    columns = [table.by_name[name] for name in table.names(rows)]
    cells = PageTable(
        columns=tuple(f"{column.title}, {column.unit}" if column.unit else column.title for column in columns),
        numeric=tuple(column.kind in ("number", "integer") for column in columns),
        rows=tuple(tuple(_cell(record[column.name]) for column in columns) for record in table.records(rows)),
        failed=(False,) * len(rows),
        notes=(),
    )
    return Part(
        table.name, table.title.capitalize(), (f"The table is {table.file}.",), (), ((table.title.capitalize(), cells),)
    )


def _cell(value: Any) -> Entry:
    """Return the cell of a value."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return Entry(number(value), float(value))
    return Entry("" if value is None else str(value))
