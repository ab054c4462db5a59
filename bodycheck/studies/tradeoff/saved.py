"""Reading of a saved trade-off."""

from pathlib import Path

from bodycheck.judging.schemes.run_classes import classes_of
from bodycheck.reports.study import StudyReport
from bodycheck.results.key import RunKey
from bodycheck.studies import reading
from bodycheck.studies.orders import ORDERS
from bodycheck.studies.tradeoff import page as tradeoff
from bodycheck.studies.tradeoff.rows import RUNS

#: The file by which the folder of a trade-off is recognised: the table of its runs.
FILE = RUNS.file


def read(folder: Path) -> StudyReport:
    """Return the report of a finished trade-off in a folder. Raises `BadFolder` and the errors of damaged files."""
    results = reading.finished_runs(folder)
    rows = reading.rows(folder, RUNS)
    reading.check_runs(
        results, RUNS.file, {RunKey.of_row(row) for row in rows}, {RunKey.of_row(run) for run in reading.runs(results)}
    )
    classes = classes_of(results, results.runs())
    report = tradeoff.present(results.header, rows, reading.rows(folder, ORDERS), classes)
    return reading.dated(report, results.header, {name for row in rows for name, value in row.items() if value is not None})
