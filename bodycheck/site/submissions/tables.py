"""The tables that a submission may have: their columns, and the entries that each column may have.

Submissions come from strangers. A table has the columns that bodycheck writes and no others, names are names, numbers are
finite, and texts can be printed and load nothing.
"""

import csv
import io
import math
import re
from collections.abc import Callable
from functools import lru_cache
from typing import Any, Literal

from pydantic import TypeAdapter, ValidationError

from bodycheck.adapters.engine_name import EngineName
from bodycheck.adapters.method import Method, current
from bodycheck.casefile.values import Name
from bodycheck.errors import BadInput
from bodycheck.figures.column import Column
from bodycheck.figures.column import Kind as ColumnKind
from bodycheck.judging.attribution import PARTS
from bodycheck.results.csv_tables import FORMULA
from bodycheck.results.tables import RESULTS, Table
from bodycheck.site.submissions.submission import Row
from bodycheck.site.submissions.texts import text
from bodycheck.studies.audit.rows import ROWS as AUDIT
from bodycheck.studies.contact.rows import MEASURED, SETTINGS, SHEET
from bodycheck.studies.ensemble.rows import ROWS as ENSEMBLE
from bodycheck.studies.orders import ORDERS
from bodycheck.studies.parity.rows import READINGS
from bodycheck.studies.releases.rows import CHANGES, RELEASES
from bodycheck.studies.tradeoff.rows import RUNS

#: The kinds of entries in a column. "case": the name of a case. "method": an integrator with its options as text.
Kind = Literal["case", "engine", "version", "method", "text", "number", "integer", "boolean", "number or text"]

#: The most rows of a table. The table of robot models has a row for each part of each model in each engine.
MOST_ROWS, MOST_ROWS_OF = 30_000, {"parity.csv": 200_000}

#: The most bytes of a line, and the most characters of a method.
LONGEST_LINE, LONGEST_METHOD = 100_000, 300

#: How many parsed entries of each kind are cached, since tables repeat the same entries in many rows.
CACHED = 4096

#: A decimal number as Python writes it.
NUMBER = re.compile(r"-?[0-9]{1,25}(?:\.[0-9]{1,25})?(?:e[+-]?[0-9]{1,3})?")

_NAMES = TypeAdapter(Name)


#: The kinds of columns that have these names in any table.
NAMED: dict[str, Kind] = {
    "case": "case",
    "scene": "case",
    "engine": "engine",
    "version": "version",
    "integrator": "method",
    "from_version": "version",
    "to_version": "version",
    "before": "number or text",
    "after": "number or text",
}

#: The tables that the site has pages for, by the names of their files.
TABLES: dict[str, Table[Any]] = {
    table.file: table
    for table in (RESULTS, PARTS, RUNS, ORDERS, RELEASES, CHANGES, SHEET, SETTINGS, MEASURED, READINGS, AUDIT, ENSEMBLE)
}

#: The columns that every table of runs must have. Any other table must have all its columns, except its `later` columns.
RUN = ("case", "engine", "version", "integrator", "timestep", "status")


def kind(column: Column) -> Kind:
    """Return the kind of entries in a column."""
    plain: dict[ColumnKind, Kind] = {"string": "text", "number": "number", "integer": "integer", "boolean": "boolean"}
    return NAMED.get(column.name) or plain[column.kind]


def read(name: str, content: bytes) -> tuple[Row, ...]:
    """Return the rows of a table.

    Parameters
    ----------
    name
        The file name of the table, a key of `TABLES`.
    content
        The content of the file.

    Raises
    ------
    BadInput
        The table is not as bodycheck writes it; the message says where and why.
    """
    if max(map(len, content.split(b"\n"))) > LONGEST_LINE:
        raise BadInput(f"{name}: has a line of more than {LONGEST_LINE} bytes, which is the most that is allowed")
    try:
        reader = csv.reader(io.StringIO(content.decode("utf-8"), newline=""), strict=True)
        columns = next(reader, [])
        _check_columns(name, columns)
        kinds = [(column, PARSERS[kind(TABLES[name].by_name[column])]) for column in columns]
        found: list[Row] = []
        most = MOST_ROWS_OF.get(name, MOST_ROWS)
        for row in reader:
            if len(found) == most:
                raise BadInput(f"{name}: has more than {most} rows, which is the most that is allowed")
            if len(row) != len(columns):
                raise BadInput(f"{name}:{reader.line_num}: has {len(row)} entries where the header has {len(columns)}")
            values: dict[str, Any] = {}
            for (column, parser), entry in zip(kinds, row, strict=True):
                try:
                    values[column] = parser(plain(entry)) if entry else None
                except (ValueError, BadInput) as error:
                    raise _fault(name, reader.line_num, column, entry, str(error)) from error
            found.append(values)
    except (UnicodeDecodeError, csv.Error) as error:
        raise BadInput(f"{name}: is not a CSV table in UTF-8: {str(error)[:200]}") from error
    return tuple(found)


def plain(entry: str) -> str:
    """Return an entry without the apostrophe that keeps spreadsheets from reading it as a formula, if it has one."""
    return entry[1:] if entry[0] == "'" and entry[1:].lstrip("'").startswith(FORMULA) else entry


def _check_columns(name: str, columns: list[str]) -> None:
    """Raise `BadInput` if a table lacks a required column, has an unknown column, or has a column twice."""
    table = TABLES[name]
    if not columns:
        raise BadInput(f"{name}: is empty")
    if unknown := [column for column in columns if column not in table.by_name]:
        raise BadInput(f"{name}:1: has a column {unknown[0][:60]!r}; allowed: {', '.join(table.by_name)}"[:500])
    required = RUN if table.row is None else tuple(name for name in table.by_name if name not in table.later)
    if missing := [column for column in required if column not in columns]:
        raise BadInput(f"{name}:1: has no column {missing[0]}")
    if len(set(columns)) < len(columns):
        raise BadInput(f"{name}:1: has the column {max(columns, key=columns.count)} twice")


def _fault(name: str, line: int, column: str, entry: str, why: str) -> BadInput:
    shown = entry if len(entry) <= 60 else f"{entry[:60]}…"
    return BadInput(f"{name}:{line}: {column}: {shown!r} {why}")


@lru_cache(maxsize=CACHED)
def _case(entry: str) -> str:
    try:
        return str(_NAMES.validate_python(entry))
    except ValidationError as error:
        raise ValueError("is not the name of a case: small letters, digits and hyphens") from error


@lru_cache(maxsize=CACHED)
def engine(entry: str) -> str:
    """Return the name of an engine, which may have a version. Raises `ValueError` or `BadInput` for any other text."""
    if len(entry) > 60 or not re.fullmatch(r"[a-z0-9_]+(@[0-9A-Za-z.!+]+)?", entry):
        raise ValueError("is not the name of an engine: small letters, digits and _, maybe with @VERSION")
    if entry != "file":
        EngineName.parse(entry)
    return entry


@lru_cache(maxsize=CACHED)
def version(entry: str) -> str:
    """Return a version. Raises `ValueError` for any other text."""
    if not re.fullmatch(r"[0-9A-Za-z][0-9A-Za-z.!+_-]{0,39}", entry):
        raise ValueError("is not a version: at most 40 letters, digits and . ! + _ -")
    return entry


@lru_cache(maxsize=CACHED)
def _method(entry: str) -> str:
    try:
        Method.parse(current(entry), 0.0)
    except BadInput as error:
        raise ValueError("is not the spelling of a method, such as Euler:cone=elliptic") from error
    return text(current(entry), LONGEST_METHOD)


@lru_cache(maxsize=CACHED)
def _text(entry: str) -> str:
    return text(entry)


def _number(entry: str) -> float:
    if not NUMBER.fullmatch(entry) or not math.isfinite(value := float(entry)):
        raise ValueError("is not a finite number, such as 1.5e-07")
    return value


def _integer(entry: str) -> int:
    if not re.fullmatch(r"-?[0-9]{1,15}", entry):
        raise ValueError("is not an integer of at most 15 digits")
    return int(entry)


def _boolean(entry: str) -> bool:
    if entry not in ("True", "False"):
        raise ValueError("is neither True nor False")
    return entry == "True"


def _number_or_text(entry: str) -> float | str:
    try:
        return _number(entry)
    except ValueError:
        return _text(entry)


#: The functions that parse the entries of each kind.
PARSERS: dict[Kind, Callable[[str], Any]] = {
    "case": _case,
    "engine": engine,
    "version": version,
    "method": _method,
    "text": _text,
    "number": _number,
    "integer": _integer,
    "boolean": _boolean,
    "number or text": _number_or_text,
}
