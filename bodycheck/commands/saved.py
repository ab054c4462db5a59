"""Read a folder of saved results, which contains runs or a study.

The files in the folder tell which of the two it is. Nothing is simulated, and no engine needs to be installed.
"""

from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import fields, replace
from pathlib import Path
from typing import Any, cast

from bodycheck.adapters.method import current
from bodycheck.casefile.case import CaseFaults
from bodycheck.errors import BadFolder
from bodycheck.figures import revisions
from bodycheck.figures.columns import COLUMNS
from bodycheck.files import reading
from bodycheck.judging.run_classes import classes_of
from bodycheck.reports.study import StudyReport
from bodycheck.running import csv_tables, journal, records, store
from bodycheck.running.header import Header
from bodycheck.running.key import RunKey
from bodycheck.running.store import Results
from bodycheck.studies.ablation import page as ablation
from bodycheck.studies.ablation.rows import Change, ModelRow
from bodycheck.studies.audit import page as audit
from bodycheck.studies.audit.rows import Facts, Fault, read_classes
from bodycheck.studies.audit.rows import Row as AuditRow
from bodycheck.studies.ensemble.header import FILE as ENSEMBLE
from bodycheck.studies.ensemble.report import reporting as ensemble
from bodycheck.studies.extremes import page as extremes
from bodycheck.studies.extremes.rows import Limit, Row
from bodycheck.studies.orders import Order
from bodycheck.studies.recommend import page as recommend
from bodycheck.studies.recommend.rows import Answer, Asked, Probe, Recommendation
from bodycheck.studies.tradeoff import page as tradeoff

#: The file with the records of a study of extremes.
EXTREMES = "extremes.jsonl"

#: The file with the records of a search for time steps.
RECOMMEND = "recommend.jsonl"

#: The file with the records of an audit.
AUDIT = "audit.jsonl"

#: How to read a column of results by its kind in `bodycheck.columns`.
PARSERS: dict[str, csv_tables.Parser] = {"string": str, "boolean": csv_tables.truth_value, "integer": int, "number": float}

#: How to read the columns that tradeoff.csv has besides those of results and that do not hold decimal numbers.
TRADEOFF_PARSERS: dict[str, csv_tables.Parser] = {
    **dict.fromkeys(("evaluations", "failed_scenes", "batch"), int),
    **dict.fromkeys(("device", "precision"), str),
}

#: How to read the columns of audit.csv whose texts are of a closed set.
AUDIT_PARSERS: dict[str, csv_tables.Parser] = {"property": str, "status": str}

#: What reading and judging damaged files may raise, beside `BadInput`.
DAMAGE = (
    *(OSError, ArithmeticError, LookupError, TypeError, ValueError),
    *(AttributeError, AssertionError, RecursionError, MemoryError),
)

#: The predicate of messages about an interrupted study.
INTERRUPTED = "was interrupted before its report was written; run it again with the same --out to resume it"


def read(folder: Path) -> Results | StudyReport:
    """Return the results of the runs in a folder, or the report of the study in it.

    Results of interrupted runs are returned with `complete` false. Raises `BadFolder` for a folder that contains neither runs
    nor a study, or both, for an interrupted study, and for damaged files.
    """
    if not folder.is_dir():
        raise BadFolder(f"{folder}: there is no such folder" if not folder.exists() else f"{folder}: is not a folder")
    reading.refuse_links(folder)
    files = (store.RECORDS, EXTREMES, RECOMMEND, AUDIT, ENSEMBLE)
    there = [name for name in files if (folder / name).is_file()]
    if len(there) != 1:
        found = " and ".join(there) or f"neither {', '.join(files[:-1])} nor {files[-1]}"
        raise BadFolder(
            f"{folder}: not a folder of results: it contains {found}; bodycheck writes exactly one of them into each folder"
        )
    with undamaged(folder):
        if there == [EXTREMES]:
            return _extremes(folder)
        if there == [RECOMMEND]:
            return _recommend(folder)
        if there == [AUDIT]:
            return _audit(folder)
        if there == [ENSEMBLE]:
            return ensemble.again(folder)
        results = store.read(folder)
        return _study(results) or results


@contextmanager
def undamaged(*folders: Path) -> Iterator[None]:
    """Turn errors of reading folders within the context into `BadFolder`: the files are not as bodycheck wrote them."""
    try:
        yield
    except CaseFaults as error:
        raise BadFolder(f"{_names(folders)}: damaged: {error}") from error
    except DAMAGE as error:
        raise BadFolder(f"{_names(folders)}: damaged: {type(error).__name__}: {error}") from error


def _names(folders: tuple[Path, ...]) -> str:
    return " or ".join(map(str, folders))


def _checked(header: Mapping[str, Any]) -> Header:
    """Return a header. Raises `ValueError` if it lacks an entry that every report contains."""
    records.typed(records.HeaderRecord, header)
    return cast(Header, header)


def _study(results: Results) -> StudyReport | None:
    """Return the report of the study whose table is beside the runs; None if there is no such table."""
    tables = [name for name in ("tradeoff.csv", "ablation.csv") if (results.folder / name).is_file()]
    if not tables:
        return None
    if len(tables) > 1:
        raise BadFolder(
            f"{results.folder}: contains {' and '.join(tables)}, but only one can belong to these results; remove the other"
        )
    if not results.complete:
        raise BadFolder(f"{results.folder}: the study {INTERRUPTED}")
    return _tradeoff(results) if tables == ["tradeoff.csv"] else _ablation(results)


def _tradeoff(results: Results) -> StudyReport:
    parsers = {name: PARSERS[column.kind] for name, column in COLUMNS.items()}
    rows = _rows(results.folder / "tradeoff.csv", parsers | TRADEOFF_PARSERS)
    _check(results, "tradeoff.csv", {RunKey.of_row(row) for row in rows}, {RunKey.of_row(run) for run in _runs(results)})
    orders = _rows(results.folder / "orders.csv", csv_tables.parsers_of(Order))
    classes = classes_of(results, results.runs())
    report = tradeoff.present(results.header, rows, [records.typed(Order, order) for order in orders], classes)
    return _dated(report, results.header, {name for row in rows for name, value in row.items() if value is not None})


def _ablation(results: Results) -> StudyReport:
    rows = _rows(results.folder / "ablation.csv", csv_tables.parsers_of(ModelRow))
    made = {RunKey.of_row(run) for run in _runs(results)}
    told = {RunKey.of_row(row | {"integrator": _spelled(row["integrator"], row["model"])}) for row in rows}
    _check(results, "ablation.csv", told, told & made)
    found = list(map(_model_row, rows))
    report = ablation.present(results.header, results.cases, found)
    return _dated(report, results.header, {name for row in found for name in row.errors})


def _extremes(folder: Path) -> StudyReport:
    contents = journal.read(folder / EXTREMES)
    header = _checked(contents.header)
    if not contents.complete:
        raise BadFolder(f"{folder}: the study {INTERRUPTED}")
    rows = [records.typed(Row, row) for row in _rows(folder / "extremes.csv", csv_tables.parsers_of(Row))]
    limits = [records.typed(Limit, limit) for limit in _rows(folder / "limits.csv", csv_tables.parsers_of(Limit))]
    runs = [record["row"] for record in contents.records if record["record"] == "run"]
    made = [records.typed(Row, row | {"integrator": current(row["integrator"])}) for row in runs]
    if set(rows) != set(made):
        raise BadFolder(f"{folder}: damaged: extremes.csv does not list the same runs as {EXTREMES}")
    return extremes.present(header, rows, limits)


def _recommend(folder: Path) -> StudyReport:
    contents = journal.read(folder / RECOMMEND)
    header, asked = _checked(contents.header), records.typed(Asked, contents.header["asked"])
    if not contents.complete:
        raise BadFolder(f"{folder}: the study {INTERRUPTED}")
    parsers = csv_tables.parsers_of(Answer) | {"reached": csv_tables.truth_value}
    answers = [records.typed(Answer, answer) for answer in _rows(folder / "recommend.csv", parsers)]
    probes = [records.typed(Probe, probe) for probe in _rows(folder / "steps.csv", csv_tables.parsers_of(Probe))]
    if {probe.method for probe in probes} - {answer.method for answer in answers}:
        raise BadFolder(f"{folder}: damaged: recommend.csv does not list the same methods as steps.csv")
    report = recommend.present(header, Recommendation(asked, tuple(answers), tuple(probes)))
    return _dated(report, contents.header, {asked.figure})


def _audit(folder: Path) -> StudyReport:
    contents = journal.read(folder / AUDIT)
    header = _checked(contents.header)
    if not contents.complete:
        raise BadFolder(f"{folder}: the study {INTERRUPTED}")
    facts = {name: records.typed(Facts, own) for name, own in contents.header["facts"].items()}
    rows = [
        records.typed(AuditRow, row) for row in _rows(folder / "audit.csv", csv_tables.parsers_of(AuditRow) | AUDIT_PARSERS)
    ]
    made = [record for record in contents.records if record["record"] == "probe"]
    if {(row.engine, row.integrator) for row in rows} != {(one["engine"], one["integrator"]) for one in made}:
        raise BadFolder(f"{folder}: damaged: audit.csv does not list the same methods as {AUDIT}")
    names = ("engine", "integrator", "probe")
    silent = [record for record in contents.records if "fault" in record]
    faults = [records.typed(Fault, {name: one[name] for name in names} | {"reason": one["fault"]}) for one in silent]
    (classed,) = (read_classes(record) for record in contents.records if record["record"] == "classes")
    return audit.present(header, facts, rows, faults, classed)


def _dated(report: StudyReport, header: Mapping[str, Any], figures: Collection[str]) -> StudyReport:
    """Return a report that says which of its figures were measured with another definition. figures: those that it has."""
    stored = records.typed(records.RevisionsRecord, header).revisions
    return replace(report, notices=(*report.notices, *(f"{text}." for text in revisions.notices(stored, figures))))


def _check(results: Results, table: str, told: set[Any], made: set[Any]) -> None:
    """Raise `BadFolder` if a table does not list the same runs as the records in its folder."""
    if not told or told != made:
        raise BadFolder(
            f"{results.folder}: {table} does not list the same runs as {store.RECORDS}: it is damaged, or it belongs to other "
            "results and must be removed"
        )


def _model_row(row: Mapping[str, Any]) -> ModelRow:
    names = [field.name for field in fields(ModelRow) if field.name not in ("changes", "errors")]
    changes = {
        quantity: Change(*(row[f"{quantity}_{part}"] for part in ("change", "rounding", "time_step")))
        for quantity in ("position", "attitude")
        if row[f"{quantity}_change"] is not None
    }
    errors = {name: row[name] for name in COLUMNS if name not in names and row.get(name) is not None}
    return ModelRow(**{name: row[name] for name in names}, changes=changes, errors=errors)


def _runs(results: Results) -> Iterator[dict[str, Any]]:
    return (record for record in results.records if record["record"] == "run")


def _spelled(integrator: str, model: str) -> str:
    """Return the present spelling of the method that selects a model."""
    return current(f"{integrator}{',' if ':' in integrator else ':'}model={model}")


def _rows(path: Path, parsers: Mapping[str, csv_tables.Parser]) -> list[dict[str, Any]]:
    """Return the rows of a table, with the present spelling of methods that earlier versions of bodycheck spelled otherwise."""
    return [row | {"integrator": current(row["integrator"])} for row in csv_tables.read(path, parsers)]
