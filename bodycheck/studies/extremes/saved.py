"""Reading of a saved study of extremes."""

from pathlib import Path

from bodycheck.adapters.method import current
from bodycheck.errors import BadFolder
from bodycheck.reports.study import StudyReport
from bodycheck.results import csv_tables, records
from bodycheck.studies import reading
from bodycheck.studies.extremes import page as extremes
from bodycheck.studies.extremes.rows import RECORDS, Limit, Row


def read(folder: Path) -> StudyReport:
    """Return the report of a finished study of extremes in a folder. Raises `BadFolder` and errors of damaged files."""
    contents, header = reading.finished(folder / RECORDS)
    rows = [records.typed(Row, row) for row in reading.rows(folder / "extremes.csv", csv_tables.parsers_of(Row))]
    limits = [records.typed(Limit, limit) for limit in reading.rows(folder / "limits.csv", csv_tables.parsers_of(Limit))]
    runs = [record["row"] for record in contents.records if record["record"] == "run"]
    made = [records.typed(Row, row | {"integrator": current(row["integrator"])}) for row in runs]
    if set(rows) != set(made):
        raise BadFolder(f"{folder}: damaged: extremes.csv does not list the same runs as {RECORDS}")
    return extremes.present(header, rows, limits)
