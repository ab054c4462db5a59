"""Reading of a saved trade-off."""

from bodycheck.figures.columns import COLUMNS
from bodycheck.judging.schemes.run_classes import classes_of
from bodycheck.reports.study import StudyReport
from bodycheck.results import csv_tables, records
from bodycheck.results.key import RunKey
from bodycheck.results.store import Results
from bodycheck.studies import reading
from bodycheck.studies.orders import Order
from bodycheck.studies.tradeoff import page as tradeoff

#: How to read the columns that tradeoff.csv has besides those of results and that do not hold decimal numbers.
COST_PARSERS: dict[str, csv_tables.Parser] = {
    **dict.fromkeys(("evaluations", "failed_scenes", "batch"), int),
    **dict.fromkeys(("device", "precision"), str),
}


def read(results: Results) -> StudyReport:
    """Return the report of a trade-off, whose tables are beside its runs. Raises `BadFolder` and errors of damaged files."""
    parsers = {name: reading.PARSERS[column.kind] for name, column in COLUMNS.items()}
    rows = reading.rows(results.folder / "tradeoff.csv", parsers | COST_PARSERS)
    reading.check_runs(
        results, "tradeoff.csv", {RunKey.of_row(row) for row in rows}, {RunKey.of_row(run) for run in reading.runs(results)}
    )
    orders = reading.rows(results.folder / "orders.csv", csv_tables.parsers_of(Order))
    classes = classes_of(results, results.runs())
    report = tradeoff.present(results.header, rows, [records.typed(Order, order) for order in orders], classes)
    return reading.dated(report, results.header, {name for row in rows for name, value in row.items() if value is not None})
