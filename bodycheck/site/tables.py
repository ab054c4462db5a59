"""The tables that a submission may have: their columns, and what may stand in each.

Submissions come from strangers. A table has the columns that bodycheck writes and no others, names are names, numbers are
finite, and texts can be printed and load nothing.
"""

import csv
import io
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from types import UnionType
from typing import Any, Literal, get_args

from pydantic import TypeAdapter, ValidationError

from bodycheck.adapters.engine_name import EngineName
from bodycheck.adapters.method import Method, current
from bodycheck.casefile.values import Name
from bodycheck.errors import BadInput
from bodycheck.figures.columns import COLUMNS, FIGURES
from bodycheck.running.csv_tables import FORMULA
from bodycheck.site.submission import Row
from bodycheck.studies.audit.rows import Row as AuditRow
from bodycheck.studies.contact.rows import ContactRow
from bodycheck.studies.ensemble.rows import Row as EnsembleRow
from bodycheck.studies.orders import Order
from bodycheck.studies.parity.rows import ParityRow
from bodycheck.studies.releases.rows import ALLOWANCE_SUFFIX, Change
from bodycheck.studies.tradeoff.columns import BATCH_COLUMNS, COST_COLUMNS

#: What may stand in a column. A "case" is the name of one, a "method" the spelling of an integrator with its options.
Kind = Literal["case", "engine", "version", "method", "text", "number", "integer", "boolean", "number or text"]

#: Most rows of a table, and most characters of a text.
MOST_ROWS, LONGEST = 200_000, 4000

#: What a text must not have, since a browser would load or run it: elements that do so, handlers and script addresses.
LOADING = re.compile(
    r"<\s*/?\s*(script|img|iframe|object|embed|link|meta|style|svg|base|form|video|audio)\b|\bon\w+\s*=|javascript:",
    re.IGNORECASE,
)

_NAMES = TypeAdapter(Name)


@dataclass(frozen=True)
class Table:
    """A table of a results folder.

    Parameters
    ----------
    name
        The name of its file.
    title
        What it is, for readers.
    kinds
        What may stand in each column.
    required
        The columns that it must have.
    """

    name: str
    title: str
    kinds: Mapping[str, Kind]
    required: tuple[str, ...]


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

#: The kinds of columns of results by what `bodycheck.figures.columns` says of them.
PLAIN: dict[str, Kind] = {"string": "text", "number": "number", "integer": "integer", "boolean": "boolean"}

_RESULTS: dict[str, Kind] = {name: NAMED.get(name) or PLAIN[column.kind] for name, column in COLUMNS.items()}
_NUMBERS: dict[str, Kind] = dict.fromkeys(COST_COLUMNS + BATCH_COLUMNS, "number")
_ALLOWANCES: dict[str, Kind] = {f"{name}{ALLOWANCE_SUFFIX}": "number" for name in FIGURES}
_ATTRIBUTION: dict[str, Kind] = {
    "case": "case",
    "engine": "engine",
    "version": "version",
    "integrator": "method",
    "timestep": "number",
    "quantity": "text",
    **dict.fromkeys(("total", "model_form", "constraint", "time_step"), "number"),
}


def _of(rows: type) -> dict[str, Kind]:
    """Return the kinds of the columns of a table whose rows are a dataclass."""
    found: dict[str, Kind] = {}
    for field in fields(rows):
        types = get_args(field.type) if isinstance(field.type, UnionType) else (field.type,)
        plain: Kind = "number" if float in types else "integer" if int in types else "text"
        found[field.name] = NAMED.get(field.name) or plain
    return found


def _table(name: str, title: str, kinds: Mapping[str, Kind], *required: str) -> Table:
    return Table(name, title, kinds, required or tuple(kinds))


#: What every table of runs must have.
_RUN = ("case", "engine", "version", "integrator", "timestep", "status")

#: The tables by the names of their files.
TABLES: dict[str, Table] = {
    table.name: table
    for table in (
        _table("results.csv", "runs", _RESULTS, *_RUN),
        _table("attribution.csv", "parts of errors", _ATTRIBUTION),
        _table(
            "tradeoff.csv",
            "errors and costs over time steps",
            _RESULTS | _NUMBERS | {"device": "text", "precision": "text"},
            *_RUN,
        ),
        _table("orders.csv", "orders of convergence", _of(Order)),
        _table("releases.csv", "runs of releases", _RESULTS | _ALLOWANCES, *_RUN),
        _table("changes.csv", "changes from release to release", _of(Change)),
        _table("contact.csv", "contact sheet", _of(ContactRow)),
        _table("parity.csv", "readings of robot models", _of(ParityRow)),
        _table("audit.csv", "audit", _of(AuditRow)),
        _table("ensemble.csv", "ensembles", _of(EnsembleRow)),
    )
}


def read(name: str, content: bytes) -> tuple[Row, ...]:
    """Return the rows of a table.

    Parameters
    ----------
    name
        The name of its file, one of `TABLES`.
    content
        The content of the file.

    Raises
    ------
    BadInput
        The table is not as bodycheck writes it; the text says where and why.
    """
    table = TABLES[name]
    try:
        lines = list(csv.reader(io.StringIO(content.decode("utf-8"), newline=""), strict=True))
    except (UnicodeDecodeError, csv.Error) as error:
        raise BadInput(f"{name}: {error}") from error
    if not lines:
        raise BadInput(f"{name}: is empty")
    columns, *rows = lines
    if len(rows) > MOST_ROWS:
        raise BadInput(f"{name}: has {len(rows)} rows; at most {MOST_ROWS} are allowed")
    if unknown := [column for column in columns if column not in table.kinds]:
        raise BadInput(f"{name}: has a column {unknown[0][:60]!r}, which bodycheck does not write")
    if missing := [column for column in table.required if column not in columns]:
        raise BadInput(f"{name}: has no column {missing[0]}")
    if len(set(columns)) < len(columns):
        raise BadInput(f"{name}: has a column twice")
    found = []
    for line, row in enumerate(rows, start=2):
        if len(row) != len(columns):
            raise BadInput(f"{name}:{line}: has {len(row)} entries where the header has {len(columns)}")
        found.append(
            {column: _value(name, line, column, table.kinds[column], text) for column, text in zip(columns, row, strict=True)}
        )
    return tuple(found)


def _value(name: str, line: int, column: str, kind: Kind, text: str) -> Any:
    """Return the value of an entry; None if it is empty."""
    plain = text[1:] if text.startswith("'") and text[1:].lstrip("'").startswith(FORMULA) else text
    try:
        return PARSERS[kind](plain) if plain else None
    except (ValueError, BadInput) as error:
        shown = plain if len(plain) <= 60 else f"{plain[:60]}…"
        raise BadInput(f"{name}:{line}: {column}: {shown!r} {error}") from error


def _case(text: str) -> str:
    try:
        return str(_NAMES.validate_python(text))
    except ValidationError as error:
        raise ValueError("is not the name of a case") from error


def _engine(text: str) -> str:
    if text != "file":
        EngineName.parse(text)
    if len(text) > 60 or not re.fullmatch(r"[a-z0-9_]+(@[0-9A-Za-z.!+]+)?", text):
        raise ValueError("is not the name of an engine")
    return text


def _version(text: str) -> str:
    if not re.fullmatch(r"[0-9A-Za-z][0-9A-Za-z.!+_-]{0,39}", text):
        raise ValueError("is not a version")
    return text


def _method(text: str) -> str:
    try:
        Method.parse(current(text), 0.0)
    except BadInput as error:
        raise ValueError("is not the spelling of a method") from error
    return _text(current(text))


def _text(text: str) -> str:
    if len(text) > LONGEST:
        raise ValueError(f"has {len(text)} characters; at most {LONGEST} are allowed")
    if not text.replace("\n", " ").isprintable():
        raise ValueError("has characters that cannot be printed")
    if LOADING.search(text):
        raise ValueError("has markup that a browser would load or run")
    return text


def _number(text: str) -> float:
    value = float(text) if len(text) <= 40 else math.nan
    if not math.isfinite(value):
        raise ValueError("is not a finite number")
    return value


def _integer(text: str) -> int:
    if not re.fullmatch(r"-?\d{1,18}", text):
        raise ValueError("is not an integer")
    return int(text)


def _boolean(text: str) -> bool:
    if text not in ("True", "False"):
        raise ValueError("is neither True nor False")
    return text == "True"


def _number_or_text(text: str) -> float | str:
    try:
        return _number(text)
    except ValueError:
        return _text(text)


#: How entries are read.
PARSERS: dict[Kind, Callable[[str], Any]] = {
    "case": _case,
    "engine": _engine,
    "version": _version,
    "method": _method,
    "text": _text,
    "number": _number,
    "integer": _integer,
    "boolean": _boolean,
    "number or text": _number_or_text,
}
