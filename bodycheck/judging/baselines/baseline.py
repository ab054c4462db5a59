"""Baselines: files with results and the effect of rounding on each figure, with which later results are compared.

The effect is measured by runs that are repeated from nudged initial states. A baseline is checked when it is read, since the
file may come from anyone.
"""

import json
from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from bodycheck.adapters.method import current
from bodycheck.casefile.identity import identity, keys
from bodycheck.casefile.values import EngineName, Name
from bodycheck.errors import BadInput
from bodycheck.figures.columns import FIGURES as ALL_FIGURES
from bodycheck.figures.revisions import REVISIONS
from bodycheck.files import reading, writing
from bodycheck.judging import judgement
from bodycheck.judging.baselines import rounding
from bodycheck.judging.judgement import Verdict
from bodycheck.processes import pool
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.results import records
from bodycheck.results.header import DESCRIPTIONS, LATER
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Run
from bodycheck.results.records import Printable, Spelling, Timestep
from bodycheck.results.store import Results
from bodycheck.running import campaign
from bodycheck.running.engines import home
from bodycheck.running.plan import Task
from bodycheck.running.tasks import group, perform_run

#: Version of the format of baselines.
FORMAT = 1
#: The key of the metadata in a file's schema. The metadata contain versions, machine, and the identities of the cases.
METADATA = b"bodycheck"

#: The parts of the header of results that are kept.
HEADER = tuple(name for name in DESCRIPTIONS if name not in ("command", "missing", *LATER))

#: The compared figures.
FIGURES = tuple(name for name, figure in ALL_FIGURES.items() if not figure.of_truth)

Row = dict[str, Any]

#: The largest size of a baseline in bytes, and the most entries of its table.
MAX_BYTES, MAX_ENTRIES = 1 << 28, 10_000_000

#: Suffix of the column with the allowed difference of a figure if nothing has changed; see `rounding.allowances`.
ALLOWANCE = "_allowance"


@dataclass(frozen=True)
class Baseline:
    """The contents of a file that `save` has written.

    Attributes
    ----------
    header
        Versions and machine.
    cases
        The identities of the cases by name.
    rows
        The rows by the keys of their runs.
    revisions
        The revisions of the figures whose definition has ever changed; a figure that is missing has revision 1.
    keys
        The keys of each case that affect the motion, with their values as text, by the name of the case. Files of earlier
        versions have none.
    """

    header: Mapping[str, Any]
    cases: Mapping[str, str]
    rows: Mapping[RunKey, Row]
    revisions: Mapping[str, int] = field(default_factory=dict)
    keys: Mapping[str, Mapping[str, str]] = field(default_factory=dict)


@dataclass(frozen=True)
class Header:
    """The part of the header of results that a baseline keeps."""

    bodycheck: Printable
    started: Printable
    machine: dict[str, Printable]
    packages: dict[str, Printable]
    engines: dict[str, Printable]


@dataclass(frozen=True)
class Metadata:
    """The contents of a baseline apart from its table.

    The contents are the header, the identities of the cases by name, the revisions of figures, and the keys of each case with
    their values as JSON. Baselines of earlier versions lack the keys and the revisions, which were all 1.
    """

    header: Header
    cases: dict[Name, Printable]
    revisions: dict[Printable, int] = field(default_factory=dict)
    keys: dict[Name, dict[Printable, Printable]] = field(default_factory=dict)


@dataclass(frozen=True)
class Columns:
    """The columns of a row that are no figures. Times per step in baselines of earlier versions are ignored."""

    case: Name
    engine: EngineName
    integrator: Spelling
    timestep: Timestep
    status: Printable


def size(verdicts: Sequence[Verdict]) -> int:
    """Return the number of runs that `save` makes."""
    return rounding.NUDGES * sum(verdict.discrepancy is not None and not verdict.run.is_recorded for verdict in verdicts)


def save(
    path: Path,
    results: Results,
    verdicts: Sequence[Verdict],
    jobs: int,
    progress: Callable[[str], None] = lambda done: None,
) -> None:
    """Write a baseline. Every completed run is repeated several times to measure the effect of rounding.

    A recorded motion cannot be repeated; the allowance for it has the error of the truth and the rounding of its own steps.

    Parameters
    ----------
    path
        The file.
    results
        The results to save.
    verdicts
        The verdicts on their runs.
    jobs
        The number of processes.
    progress
        A function that is called with a text after each repeated run.

    Raises
    ------
    NotWritten
        If the file cannot be written.
    """
    allowed = rows(results, verdicts, jobs, progress)
    names = list(dict.fromkeys(name for row in allowed for name in row))
    table = pa.table({name: [row.get(name) for row in allowed] for name in names})
    metadata = {
        "format": FORMAT,
        "header": {name: value for name, value in results.header.items() if name in HEADER},
        "cases": {name: identity(case) for name, case in results.cases.items()},
        "revisions": REVISIONS,
        "keys": {name: keys(case) for name, case in results.cases.items()},
    }
    content = pa.BufferOutputStream()
    pq.write_table(table.replace_schema_metadata({METADATA: json.dumps(metadata)}), content, compression="zstd")
    writing.write_named(path, content.getvalue().to_pybytes())


def read(path: Path) -> Baseline:
    """Read the baseline in a file. Raises `BadInput` if the file cannot be read or is not a baseline."""
    figures = [column for name in FIGURES for column in (name, name + ALLOWANCE)]
    try:
        table = _table(path)
        stored = json.loads((table.schema.metadata or {})[METADATA])
        if stored["format"] != FORMAT:
            raise ValueError(f"its format is {stored['format']}, not {FORMAT}")
        metadata = records.typed(Metadata, stored)
        rows = by_key(table.to_pylist(), figures)
        return Baseline(asdict(metadata.header), metadata.cases, rows, metadata.revisions, metadata.keys)
    except (
        OSError,
        ValueError,
        LookupError,
        TypeError,
        BadInput,
        RecursionError,
        MemoryError,
        pa.ArrowException,
    ) as error:
        raise BadInput(f"{path}: not a baseline of `bodycheck run --save`: {error}") from error


def rows(
    results: Results, verdicts: Sequence[Verdict], jobs: int, progress: Callable[[str], None] = lambda done: None
) -> list[Row]:
    """Return the rows of results with the allowance of every figure.

    Every completed run is repeated `rounding.NUDGES` times. For the parameters see `save`.
    """
    measured = allowances(results, verdicts, jobs, progress)
    return [row | measured.get(RunKey.of_row(row), {}) for row in judgement.records(verdicts)]


def by_key(rows: Iterable[Row], figures: Collection[str] = FIGURES) -> dict[RunKey, Row]:
    """Return rows of runs by the keys of the runs, with the present spellings of methods.

    figures: the columns that must be numbers where they are not empty. Raises `ValueError`, `TypeError`, `LookupError` or
    `BadInput` for a row with invalid values.
    """
    return {RunKey.of_row(row): _present(row) for row in (_checked(row, figures) for row in rows)}


def _present(row: Row) -> Row:
    """Return a row of a baseline with the present spelling of its method."""
    return row | {"status": str(row["status"]), "integrator": current(row["integrator"])}


def _table(path: Path) -> pa.Table:
    """Return the table in a file.

    Raises `OSError` if the file cannot be read or is no regular file, `pyarrow.ArrowException` if it is no Parquet file, and
    `ValueError` if its table is too large or has a repeated column.
    """
    stored = pq.ParquetFile(pa.BufferReader(reading.content(path, MAX_BYTES, follow=True)))
    if (entries := stored.metadata.num_rows * stored.metadata.num_columns) > MAX_ENTRIES:
        raise ValueError(f"it has {entries} entries; allowed: at most {MAX_ENTRIES}")
    names = stored.schema_arrow.names
    if repeated := {name for name in names if names.count(name) > 1}:
        raise ValueError(f"it has the column {min(repeated)!r} more than once")
    return stored.read(use_threads=False)  # with threads, a process has been seen to abort at its end


def _checked(row: dict[str, Any], figures: Iterable[str]) -> dict[str, Any]:
    """Return a row unchanged. Raises `ValueError` if a figure is not a number, or another column has an invalid value."""
    records.typed(Columns, row)
    for name in figures:
        if (value := row.get(name)) is not None and not isinstance(value, float):
            raise ValueError(f"{name}: read {value!r:.60}; allowed: a decimal number")
    return row


def allowances(
    results: Results, verdicts: Sequence[Verdict], jobs: int, progress: Callable[[str], None]
) -> dict[RunKey, dict[str, float]]:
    """Repeat the completed runs with nudged initial states, and return the allowances of figures by the key of the run."""
    truths = lru_cache(1)(results.truth)
    completed = [verdict.run for verdict in verdicts if verdict.discrepancy is not None]
    waiting = {run.key: run for run in completed if not run.is_recorded}
    tasks = [
        Task(rounding.nudged(results.cases[run.case], run, seed), run.engine, run.method)
        for run in waiting.values()
        for seed in range(rounding.NUDGES)
    ]
    answers: dict[RunKey, list[Run]] = defaultdict(list)
    measured = {run.key: _row_of(truths(run.case, run.method.sampling), run, [run]) for run in completed if run.is_recorded}
    with pool.Workers(perform_run, jobs, campaign.TIME_LIMIT_S, group=group, home=home) as workers:
        for task, answer in workers.map(tasks):
            progress(f"{task.case.name} · {task.engine} {task.method}, nudged")
            key = task.key
            answers[key].append(answer if isinstance(answer, Run) else replace(waiting[key], outcome=answer))
            if len(answers[key]) == rounding.NUDGES:
                run = waiting.pop(key)
                measured[key] = _row_of(truths(run.case, run.method.sampling), run, answers.pop(key))
    return measured


def _row_of(truth: Truth | NoTruth, run: Run, others: Sequence[Run]) -> dict[str, float]:
    assert isinstance(truth, Truth)  # a run with a discrepancy has a truth
    return {f"{name}{ALLOWANCE}": value for name, value in rounding.allowances(truth, run, others).items()}
