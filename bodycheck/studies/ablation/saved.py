"""Reading of a saved ablation."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from bodycheck.adapters.method import current
from bodycheck.figures.columns import COLUMNS
from bodycheck.reports.study import StudyReport
from bodycheck.results import csv_tables
from bodycheck.results.key import RunKey
from bodycheck.results.store import Results
from bodycheck.studies import reading
from bodycheck.studies.ablation import page as ablation
from bodycheck.studies.ablation.rows import Change, ModelRow


def read(results: Results) -> StudyReport:
    """Return the report of an ablation, whose table is beside its runs. Raises `BadFolder` and errors of damaged files."""
    rows = reading.rows(results.folder / "ablation.csv", csv_tables.parsers_of(ModelRow))
    made = {RunKey.of_row(run) for run in reading.runs(results)}
    told = {RunKey.of_row(row | {"integrator": _spelled(row["integrator"], row["model"])}) for row in rows}
    reading.check_runs(results, "ablation.csv", told, told & made)
    found = list(map(_model_row, rows))
    report = ablation.present(results.header, results.cases, found)
    return reading.dated(report, results.header, {name for row in found for name in row.errors})


def _model_row(row: Mapping[str, Any]) -> ModelRow:
    names = [field.name for field in fields(ModelRow) if field.name not in ("changes", "errors")]
    changes = {
        quantity: Change(*(row[f"{quantity}_{part}"] for part in ("change", "rounding", "time_step")))
        for quantity in ("position", "attitude")
        if row[f"{quantity}_change"] is not None
    }
    errors = {name: row[name] for name in COLUMNS if name not in names and row.get(name) is not None}
    return ModelRow(**{name: row[name] for name in names}, changes=changes, errors=errors)


def _spelled(integrator: str, model: str) -> str:
    """Return the present spelling of the method that selects a model."""
    return current(f"{integrator}{',' if ':' in integrator else ':'}model={model}")
