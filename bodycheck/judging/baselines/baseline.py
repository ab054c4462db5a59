"""Baselines: files with results and the effect of rounding on each figure, with which later results are compared."""

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, Literal, get_args

import pyarrow as pa
import pyarrow.parquet as pq

from bodycheck.adapters.method import Method, current
from bodycheck.casefile.expectation import unit
from bodycheck.casefile.identity import changed_keys, identity, keys
from bodycheck.errors import BadInput
from bodycheck.figures.columns import FIGURES as ALL_FIGURES
from bodycheck.figures.columns import distance_from_ideal
from bodycheck.figures.revisions import REVISIONS, redefined
from bodycheck.files import writing
from bodycheck.judging import judgement
from bodycheck.judging.baselines import baseline_checks, nudged_runs, rounding
from bodycheck.judging.baselines.nudged_runs import ALLOWANCE
from bodycheck.judging.judgement import Verdict
from bodycheck.results import records
from bodycheck.results.header import DESCRIPTIONS, LATER
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Completed, Unsupported
from bodycheck.results.store import Results

#: Version of the format of baselines.
FORMAT = 1
#: The key of the metadata in a file's schema: versions, machine, and the identities of the cases.
METADATA = b"bodycheck"

#: What is kept of the header of results.
HEADER = tuple(name for name in DESCRIPTIONS if name not in ("command", "missing", *LATER))

#: The compared figures.
FIGURES = tuple(name for name, figure in ALL_FIGURES.items() if not figure.of_truth)

#: The most changed keys of a case that a message names, and the longest text of a value in it.
MOST_KEYS, LONGEST_VALUE = 4, 60

#: Factor between two figures below which their difference is given in relative terms.
NEARLY_EQUAL_FACTOR = 1.01

Direction = Literal["worse", "better", "new"]
DIRECTIONS = get_args(Direction)

Row = dict[str, Any]


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
class Change:
    """A difference between two baselines in one run.

    Attributes
    ----------
    case, engine, integrator, timestep
        The run; the time step is in s.
    what
        The column of a figure, "status", or "run" for a run that only one file contains.
    base, now
        The old and the new value; None if there is none.
    allowance
        The allowed difference of a figure.
    direction
        Whether the run got worse or better, or is new.
    """

    case: str
    engine: str
    integrator: str
    timestep: float
    what: str
    base: float | str | None
    now: float | str | None
    allowance: float | None
    direction: Direction

    @property
    def key(self) -> RunKey:
        """The key of the run."""
        return RunKey(self.case, self.engine, Method.parse(self.integrator, self.timestep))

    @property
    def factor(self) -> float:
        """The ratio of the larger error to the smaller one; infinite if there are no two errors or one is zero."""
        return self._ratio(0.0)

    @property
    def severity(self) -> tuple[int, float]:
        """What orders changes: runs come before statuses, these before figures, and figures by their factors.

        An error counts as no smaller than its allowance, so that a change from nearly nothing to little is not the largest.
        """
        kind = ("status", "run").index(self.what) + 1 if self.allowance is None else 0
        return kind, self._ratio(self.allowance or 0.0)

    def _ratio(self, floor: float) -> float:
        if not (isinstance(self.base, float) and isinstance(self.now, float)):
            return math.inf
        least, most = sorted(max(distance_from_ideal(self.what, value), floor) for value in (self.base, self.now))
        return most / least if least > 0 else math.inf

    @property
    def figures(self) -> tuple[str, str, str]:
        """Base, now and allowance as text, with enough digits to show a difference; empty for missing values."""
        for digits in (3, 6, 9, 12, 17):
            base, now = _figure_text(self.base, digits), _figure_text(self.now, digits)
            if base != now:
                break
        return base, now, _figure_text(self.allowance, 3)

    @property
    def amount(self) -> str:
        """Whether it is better or worse, and by which factor, or by which fraction if the two are nearly equal."""
        if not math.isfinite(self.factor):
            return self.direction
        if self.factor < NEARLY_EQUAL_FACTOR:
            return f"{self.direction} by {self.factor - 1:.1g} of it"
        return f"{self.factor:.3g} times {self.direction}"

    @property
    def text(self) -> str:
        """As one sentence."""
        where = f"{self.engine} {self.integrator} on {self.case}, {self.timestep:g} s"
        if self.what == "run":
            return f"{where}, {'is not run any more' if self.now is None else 'is new'}"
        base, now, _ = self.figures
        return f"{where}: {self.what} {base} → {now}{unit(self.what)}, {self.amount}"


@dataclass(frozen=True)
class Difference:
    """The differences between two baselines, the worst first.

    Attributes
    ----------
    changes
        The changes of runs.
    versions
        The programs whose version changed, with the old and the new version.
    redefined
        The names of the figures that both have and that are not compared, because their definition changed in between.
    runs
        The number of runs that both have.
    compared
        The names of the figures that were compared in any run.
    """

    changes: tuple[Change, ...]
    versions: tuple[tuple[str, str, str], ...]
    redefined: tuple[str, ...]
    runs: int
    compared: tuple[str, ...]

    @property
    def worse(self) -> tuple[Change, ...]:
        """The changes for the worse."""
        return tuple(change for change in self.changes if change.direction == "worse")

    @property
    def text(self) -> str:
        """What has changed in one sentence, with the worst change; or that nothing has."""
        versions = "".join(f"; {name} {base} → {now}" for name, base, now in self.versions)
        if not self.changes:
            runs = "1 run" if self.runs == 1 else f"{self.runs} runs"
            return f"no change in {runs} beyond rounding and the truth's own error{versions}"
        counts = {
            direction: len({change.key for change in self.changes if change.direction == direction}) for direction in DIRECTIONS
        }
        tally = ", ".join(f"{count} {direction}" for direction, count in counts.items() if count)
        return f"runs: {tally}; {self.changes[0].text}{versions}"


def size(verdicts: Sequence[Verdict]) -> int:
    """Return the number of runs that `save` makes."""
    return rounding.NUDGES * sum(verdict.discrepancy is not None for verdict in verdicts)


def save(
    path: Path,
    results: Results,
    verdicts: Sequence[Verdict],
    jobs: int,
    progress: Callable[[str], None] = lambda done: None,
) -> None:
    """Write a baseline. Every completed run is repeated some times to measure the effect of rounding.

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
    told = {
        "format": FORMAT,
        "header": {name: value for name, value in results.header.items() if name in HEADER},
        "cases": {name: identity(case) for name, case in results.cases.items()},
        "revisions": REVISIONS,
        "keys": {name: keys(case) for name, case in results.cases.items()},
    }
    content = pa.BufferOutputStream()
    pq.write_table(table.replace_schema_metadata({METADATA: json.dumps(told)}), content, compression="zstd")
    writing.write_named(path, content.getvalue().to_pybytes())


def read(path: Path) -> Baseline:
    """Read the baseline in a file. Raises `BadInput` if the file cannot be read or is not a baseline."""
    figures = [column for name in FIGURES for column in (name, name + ALLOWANCE)]
    try:
        table = baseline_checks.read(path)
        told = json.loads((table.schema.metadata or {})[METADATA])
        if told["format"] != FORMAT:
            raise ValueError(f"its format is {told['format']}, not {FORMAT}")
        metadata = records.typed(baseline_checks.Metadata, told)
        rows = {RunKey.of_row(row): _present(row) for row in (baseline_checks.check(row, figures) for row in table.to_pylist())}
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


def diff(base: Baseline, now: Baseline) -> Difference:
    """Return the changes that exceed the effect of rounding and the errors of the truths.

    Figures whose definition changed between the two are not compared.

    Raises `BadInput` if the physics of a case has changed, because its runs cannot be compared then.
    """
    if other := sorted(name for name, told in base.cases.items() if now.cases.get(name, told) != told):
        edited = (_edited(name, base.keys.get(name, {}), now.keys.get(name, {})) for name in other)
        raise BadInput(f"the case itself has changed, save a new baseline: {'; '.join(edited)}")
    apart = redefined(base.revisions, now.revisions)
    found = [
        change
        for key in {**base.rows, **now.rows}
        for change in changes(key, base.rows.get(key), now.rows.get(key))
        if change.what not in apart
    ]
    shared = [(base.rows[key], now.rows[key]) for key in base.rows.keys() & now.rows.keys()]
    lost = tuple(name for name in apart if any(_entries_of_both(*rows, name) for rows in shared))
    compared = tuple(name for name in FIGURES if name not in lost and any(_entries_of_both(*rows, name) for rows in shared))
    found.sort(key=lambda change: change.severity, reverse=True)
    found.sort(key=lambda change: DIRECTIONS.index(change.direction))
    return Difference(tuple(found), tuple(_versions(base, now)), lost, len(shared), compared)


def as_json(found: Difference) -> dict[str, Any]:
    """Return the JSON object of `bodycheck diff --json`."""
    changes = [{**asdict(change), "text": change.text} for change in found.changes]
    versions = {name: {"base": base, "now": now} for name, base, now in found.versions}
    told = {"worse": len(found.worse), "changes": changes, "versions": versions, "redefined": list(found.redefined)}
    return told | {"runs": found.runs, "compared": list(found.compared), "text": found.text}


def rows(
    results: Results, verdicts: Sequence[Verdict], jobs: int, progress: Callable[[str], None] = lambda done: None
) -> list[Row]:
    """Return the rows of results with the allowance of every figure.

    Every completed run is repeated `rounding.NUDGES` times. Parameters are those of `save`.
    """
    measured = nudged_runs.measured(results, verdicts, jobs, progress)
    return [row | measured.get(RunKey.of_row(row), {}) for row in judgement.records(verdicts)]


def changes(key: RunKey, base: Row | None, now: Row | None) -> Iterator[Change]:
    """Yield the changes of one run: its existence, its status, or figures that differ by more than both allowances.

    Parameters
    ----------
    key
        The key of the run.
    base, now
        The old and the new row; None if the run does not exist there.
    """
    change = partial(Change, key.case, key.engine, key.method.name, key.method.timestep)
    if base is None or now is None:
        there = [None if row is None else str(row["status"]) for row in (base, now)]
        direction: Direction = "new" if base is None else "worse"
        yield change(what="run", base=there[0], now=there[1], allowance=None, direction=direction)
        return
    if (was := base["status"]) != (is_now := now["status"]):
        direction = "better" if _rank(is_now) < _rank(was) else "worse"
        yield change(what="status", base=was, now=is_now, allowance=None, direction=direction)
        return
    for name in FIGURES:
        figures, allowances = _entries_of_both(base, now, name), _entries_of_both(base, now, name + ALLOWANCE)
        if figures is None or allowances is None or abs(figures[1] - figures[0]) <= sum(allowances):
            continue
        direction = "better" if distance_from_ideal(name, figures[1]) < distance_from_ideal(name, figures[0]) else "worse"
        yield change(what=name, base=figures[0], now=figures[1], allowance=sum(allowances), direction=direction)


def _entries_of_both(base: Row, now: Row, name: str) -> tuple[float, float] | None:
    """Return an entry of two rows; None unless both have it."""
    one, other = base.get(name), now.get(name)
    return None if one is None or other is None else (float(one), float(other))


def _edited(name: str, base: Mapping[str, str], now: Mapping[str, str]) -> str:
    """Return the name of a case with the keys that have changed, if they are known."""
    apart = changed_keys(base, now) if base and now else []
    told = [f"{key} {_shortened(one)} → {_shortened(other)}" for key, one, other in apart[:MOST_KEYS]]
    more = [f"{len(apart) - MOST_KEYS} more"] if len(apart) > MOST_KEYS else []
    return f"{name} ({', '.join(told + more)})" if apart else name


def _shortened(value: str | None) -> str:
    """Return a value as text; None stands for a key that is not there."""
    return "none" if value is None else value if len(value) <= LONGEST_VALUE else f"{value[:LONGEST_VALUE]}…"


def _rank(status: str) -> int:
    return (Completed.status, Unsupported.status).index(status) if status in (Completed.status, Unsupported.status) else 2


def _figure_text(value: float | str | None, digits: int) -> str:
    return f"{value:.{digits}g}" if isinstance(value, float) else value or ""


def _versions(base: Baseline, now: Baseline) -> Iterator[tuple[str, str, str]]:
    before, after = ({"bodycheck": one.header["bodycheck"], **one.header["engines"]} for one in (base, now))
    for name in before.keys() & after.keys():
        if before[name] != after[name]:
            yield name, before[name], after[name]


def _present(row: Row) -> Row:
    """Return a row of a baseline with the present spelling of its method."""
    return row | {"status": str(row["status"]), "integrator": current(row["integrator"])}
