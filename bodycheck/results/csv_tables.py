"""Tables as CSV files: how all of them are written and read.

A file is UTF-8 text with a header line. Lines end in a line feed, decimal numbers have all the digits that identify them, truth
values are `True` and `False`, and an entry without a value (None or NaN) is empty. A text that a spreadsheet would take for a
formula has an apostrophe before it, which `read` removes.
"""

import csv
import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from types import UnionType
from typing import Any, get_args

from bodycheck.files import reading, writing
from bodycheck.results.origin import BESIDE, Origins, beside

#: What a text begins with that spreadsheets take for a formula.
FORMULA = ("=", "+", "-", "@", "\t", "\r")

Parser = Callable[[str], Any]

#: The largest size of a table that is read, in bytes.
MAX_BYTES = 1 << 28


def write(path: Path, columns: Sequence[str], rows: Iterable[Mapping[str, Any]], origins: Origins = ()) -> None:
    """Write a table, and beside it a file with the units of its columns and where its numbers come from; see `origin`.

    Parameters
    ----------
    path
        The file, which is replaced if it exists.
    columns
        The names of the columns, in their order.
    rows
        The values of each row by column; a column that a row lacks is empty in it.
    origins
        Where the numbers come from.

    Raises
    ------
    NotWritten
        The file cannot be written, or it is a symbolic link.
    ValueError
        A row has a value for a column that is not among `columns`.
    """
    stream = io.StringIO()
    writer = csv.DictWriter(stream, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows({name: entry(value) for name, value in row.items()} for row in rows)
    writing.write(path, stream.getvalue().encode("utf-8", "replace"))
    writing.write(path.with_name(path.name + BESIDE), beside(path, columns, origins))


def read(path: Path, parsers: Mapping[str, Parser]) -> list[dict[str, Any]]:
    """Return the rows of a table, each with its values by column.

    Parameters
    ----------
    path
        The file.
    parsers
        How to read the columns that do not hold decimal numbers. An empty entry is None unless the parser is `str`.

    Raises
    ------
    OSError
        The file cannot be read, is too large, or is not a regular file.
    ValueError
        An entry cannot be parsed, a row is too long, or the file is not UTF-8.
    """

    def value(name: str, text: str) -> Any:
        parser = parsers.get(name, float)
        text = text[1:] if text and text.startswith("'") and _is_formula(text[1:]) else text
        return parser(text) if text or parser is str else None

    stream = io.StringIO(reading.content(path, MAX_BYTES).decode("utf-8"), newline="")
    try:
        table = list(csv.DictReader(stream, strict=True))
    except csv.Error as error:
        raise ValueError(str(error)) from error
    if any(None in row or None in row.values() for row in table):
        raise ValueError(f"{path}: a row has more or fewer entries than the header")
    return [{name: value(name, text) for name, text in row.items()} for row in table]


def entry(value: Any) -> Any:
    """Return what a table has for a value: nothing for NaN, and an apostrophe before a text that looks like a formula."""
    if isinstance(value, str):
        return f"'{value}" if _is_formula(value) else value
    return value if value == value else None  # NaN is the only value that differs from itself


def _is_formula(text: str) -> bool:
    """Return whether an apostrophe belongs before a text, which may have some of its own."""
    return text.lstrip("'").startswith(FORMULA)


def parsers_of(rows: type) -> dict[str, Parser]:
    """Return the parsers for the fields of a dataclass of rows that hold text or integers."""
    types = {field.name: get_args(field.type) if isinstance(field.type, UnionType) else (field.type,) for field in fields(rows)}
    return {name: parser for name, allowed in types.items() for parser in (str, int) if parser in allowed}


def truth_value(text: str) -> bool:
    """Return the truth value that `write` writes as this text. Raises `KeyError` for any other text."""
    return {"True": True, "False": False}[text]
