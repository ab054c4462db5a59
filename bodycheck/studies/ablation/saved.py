"""Reading of the saved results of an ablation."""

from pathlib import Path

from bodycheck.adapters.method import current
from bodycheck.reports.study import StudyReport
from bodycheck.results.key import RunKey
from bodycheck.studies import reading
from bodycheck.studies.ablation import page as ablation
from bodycheck.studies.ablation.rows import MODELS, row_of

#: The file by which the folder of an ablation is recognised: the table of its models.
FILE = MODELS.file


def read(folder: Path) -> StudyReport:
    """Return the report of a finished ablation in a folder. Raises `BadFolder` and the errors of damaged files."""
    results = reading.finished_runs(folder)
    rows = reading.rows(folder, MODELS)
    recorded = {RunKey.of_row(run) for run in reading.runs(results)}
    tabled = {RunKey.of_row({**row, "integrator": _spelled(row["integrator"], row["model"])}) for row in rows}
    reading.check_runs(results, MODELS.file, tabled, tabled & recorded)
    models = list(map(row_of, rows))
    report = ablation.present(results.header, results.cases, models)
    return reading.dated(report, results.header, {name for row in models for name in row.errors})


def _spelled(integrator: str, model: str) -> str:
    """Return the present spelling of the method that selects a model with an integrator."""
    return current(f"{integrator}{',' if ':' in integrator else ':'}model={model}")
