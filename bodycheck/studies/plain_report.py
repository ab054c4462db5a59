"""The report of a study whose folder has only `rows` and `study`, and reading its folder again; see `plain`.

Nothing here makes a study, so that `bodycheck report` needs no engine and starts no process.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from bodycheck.errors import BadFolder
from bodycheck.reports.notices import missing_engines
from bodycheck.reports.quantities import count, number
from bodycheck.reports.study import Part, StudyReport
from bodycheck.reports.tables import Entry
from bodycheck.reports.tables import Table as PageTable
from bodycheck.results.header import Header
from bodycheck.results.tables import Table
from bodycheck.studies import reading, registry


def present(name: str, header: Header, rows: Sequence[Sequence[Any]]) -> StudyReport:
    """Return the contents of the report of a study: those of its module `page`, or its tables as they are."""
    if (page := registry.part(name, "page")) is not None:
        report: StudyReport = page.present(header, *rows)
        return report
    tables: Sequence[Table[Any]] = registry.required(name, "rows").TABLES
    return StudyReport(
        title=tables[0].title.capitalize(),
        headline=f"{count(len(rows[0]), 'row')} of {tables[0].title}",
        header=header,
        notices=tuple(missing_engines(header)),
        findings=(),
        parts=tuple(_page_part(table, table_rows) for table, table_rows in zip(tables, rows, strict=True)),
    )


def journal(name: str) -> str:
    """Return the name of the journal in the folder of a study."""
    return str(registry.required(name, "rows").RECORDS)


def read(name: str, folder: Path) -> StudyReport:
    """Return the report of a finished study in a folder.

    Raises `BadFolder` if it was interrupted, or if its main table differs from what its journal records, and errors of damaged
    files.
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
