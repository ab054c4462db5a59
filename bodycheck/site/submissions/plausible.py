"""Checks that bodycheck can have measured the rows of a table: known words, numbers within bounds, and each run once."""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from bodycheck.adapters.engine_name import adapter_of
from bodycheck.casefile.content import Case
from bodycheck.errors import BadInput
from bodycheck.figures.columns import COST_COLUMNS, FIGURES, WORK_COLUMNS, most_possible
from bodycheck.results.outcome import Completed
from bodycheck.results.verdicts import ENDS
from bodycheck.site.submissions.submission import Row
from bodycheck.site.submissions.tables import TABLES
from bodycheck.studies.releases.rows import UNOBTAINABLE

#: The words for the status of a run, by table.
STATUSES: dict[str, frozenset[str]] = {
    **dict.fromkeys(("results.csv", "tradeoff.csv", "contact.csv"), frozenset(ENDS)),
    "releases.csv": frozenset((*ENDS, UNOBTAINABLE)),
}

#: The largest absolute value of a number. Before numbers become larger, a run counts as diverged.
LARGEST = 1e200

#: The factor by which rounding may raise a figure above its largest possible value.
ROUNDING = 1 + 1e-9

#: The tables with a row for each run, and their columns of measured figures and costs.
RUNS = ("results.csv", "tradeoff.csv", "releases.csv")
MEASURED = (*FIGURES, *(column.name for column in (*COST_COLUMNS, *WORK_COLUMNS)))

#: The figures with a largest possible value, such as angles.
LIMITED = tuple(figure for figure in FIGURES if most_possible(figure, 1.0) < math.inf)

#: The tables whose rows all have the engine versions of the header.
OF_ONE_VERSION = (
    *("results.csv", "tradeoff.csv", "orders.csv", "attribution.csv", "audit.csv", "ensemble.csv"),
    *("contact.csv", "contact_settings.csv", "contact_properties.csv"),
)


def check(name: str, rows: Sequence[Row], cases: Mapping[str, Case], engines: Mapping[str, str]) -> None:
    """Raise `BadInput` if bodycheck cannot have measured the rows of a table; the message says which row, and why.

    Parameters
    ----------
    name
        The file name of the table.
    rows
        The rows of the table, whose entries have the kinds of their columns.
    cases
        The cases that rows may name, by name.
    engines
        The versions of the engines by name, as given in the header.
    """
    known = {adapter_of(engine) for engine in engines} | ({"file"} if name == "parity.csv" else set())
    table = TABLES[name]
    words = {column.name: column.words for column in table.columns if column.words}
    words |= {"status": STATUSES[name]} if name in STATUSES else {}
    signed = frozenset(column.name for column in table.columns if column.signed)
    for line, row in enumerate(rows, start=2):
        if empty := next((column for column in table.filled if row.get(column) is None), None):
            raise fault(name, line, empty, "", "an entry in every row")
        _check_words(name, line, row, words)
        _check_numbers(name, line, row, signed)
        if (engine := row.get("engine")) and adapter_of(engine) not in known:
            raise fault(name, line, "engine", engine, f"the engines of the header: {', '.join(sorted(known))}")
        version = engines.get(str(engine))
        if name in OF_ONE_VERSION and version and row.get("version") not in (None, version):
            raise fault(name, line, "version", row["version"], f"{version}, which the header has for {engine}")
        case = row.get("case") or row.get("scene")
        if case is not None and case not in cases:
            raise fault(name, line, "case", case, "the cases that come with bodycheck, and those whose file is with the table")
        if name in RUNS:
            _check_run(name, line, row, cases[str(case)])
    if table.key:
        _check_once(name, rows, table.key)


def fault(name: str, line: int, column: str, read: Any, allowed: str) -> BadInput:
    """Return the error for an entry; it gives the file, line and column, the value that was read, and the allowed values."""
    shown = repr(read)
    return BadInput(f"{name}:{line}: {column}: read {shown if len(shown) <= 80 else shown[:79] + '…'}; allowed: {allowed}")


def _check_words(name: str, line: int, row: Row, words: Mapping[str, frozenset[str]]) -> None:
    for column, allowed in words.items():
        if (word := row.get(column)) is not None and word not in allowed:
            raise fault(name, line, column, word, ", ".join(sorted(allowed - {""})))


def _check_numbers(name: str, line: int, row: Row, signed: frozenset[str]) -> None:
    for column, value in row.items():
        if value.__class__ is float or value.__class__ is int:
            if not -LARGEST <= value <= LARGEST:
                raise fault(name, line, column, value, f"numbers of at most {LARGEST:g}")
            if value < 0 and column not in signed:
                raise fault(name, line, column, value, "numbers that are not negative")


def _check_run(name: str, line: int, row: Row, case: Case) -> None:
    if row.get("timestep") == 0.0 or (row["status"] == Completed.status and row.get("timestep") is None):
        raise fault(name, line, "timestep", row.get("timestep"), "positive numbers, in s")
    if row["status"] != Completed.status:
        found = next((column for column in MEASURED if row.get(column) is not None), None)
        if found is not None:
            raise fault(name, line, found, row[found], f"an empty entry, because the run is {row['status']}")
        if not row.get("reason"):
            raise fault(name, line, "reason", row.get("reason"), f"the reason why the run is {row['status']}")
        return
    if row.get("steps") == 0:
        raise fault(name, line, "steps", 0, f"at least 1 in a run that is {Completed.status}")
    for figure in LIMITED:
        value = row.get(figure)
        if value is not None and value > (most := most_possible(figure, case.duration)) * ROUNDING:
            raise fault(name, line, figure, value, f"at most {most:.12g} in {case.name}")


def _check_once(name: str, rows: Iterable[Row], columns: Sequence[str]) -> None:
    """Raise `BadInput` if two rows are about the same run. columns: the columns that identify a run."""
    lines: dict[tuple[Any, ...], int] = {}
    for line, row in enumerate(rows, start=2):
        key = tuple(row.get(column) for column in columns)
        if (first := lines.setdefault(key, line)) != line:
            told = ", ".join(str(value) for value in key if value is not None)
            raise BadInput(f"{name}:{line}: is of the same run as line {first}: {told[:200]}; allowed: each run once")
