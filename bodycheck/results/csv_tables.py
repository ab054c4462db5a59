"""Tables as CSV files.

A file is UTF-8 text with a header line. Lines end in a line feed, decimal numbers have all digits that are needed to identify
them, truth values are `True` and `False`, and an entry without a value (None or NaN) is empty. A text that a spreadsheet would
read as a formula is written with an apostrophe before it, which `read` removes.
"""

import csv
import io
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from bodycheck.figures.column import Kind
from bodycheck.files import reading, writing
from bodycheck.results.origin import BESIDE, Origins, beside
from bodycheck.results.tables import Row, Table

#: The signs, which are no formulas by themselves.
SIGNS = ("+", "-")

#: The beginnings of texts that spreadsheets read as formulas.
FORMULA = ("=", "+", "-", "@", "\t", "\r")

#: The largest size of a table that is read, in bytes.
MAX_BYTES = 1 << 28


def write(
    folder: Path, table: Table[Row], rows: Sequence[Row], origins: Origins = (), columns: Sequence[str] | None = None
) -> None:
    """Write a table, and beside it a file with the units of its columns and the origins of its numbers; see `origin`.

    Parameters
    ----------
    folder
        The folder of the file, which is replaced if it exists.
    table
        The description of the table.
    rows
        The rows. An entry is empty if a row has no value for its column.
    origins
        The origins of the numbers.
    columns
        The names of the columns, in their order; if it is None, the columns of the rows, see `Table.names`.

    Raises
    ------
    NotWritten
        The file cannot be written, or it is a symbolic link.
    ValueError
        A row has a value for a column that is not among `columns`.
    """
    names = table.names(rows) if columns is None else columns
    stream = io.StringIO()
    writer = csv.DictWriter(stream, names, lineterminator="\n")
    writer.writeheader()
    writer.writerows({name: entry(value) for name, value in record.items()} for record in table.records(rows))
    path = folder / table.file
    writing.write(path, stream.getvalue().encode("utf-8", "replace"))
    writing.write(path.with_name(path.name + BESIDE), beside(table, names, origins))


def read(folder: Path, table: Table[Row]) -> list[dict[str, Any]]:
    """Return the records of a table, each with its values by column.

    An empty entry is None, except in columns of texts. A column that is not in the description contains numbers.

    Parameters
    ----------
    folder
        The folder of the file.
    table
        The description of the table.

    Raises
    ------
    OSError
        The file cannot be read, is too large, or is not a regular file.
    ValueError
        An entry cannot be parsed, a row is too long, or the file is not UTF-8.
    """
    parsers = {column.name: PARSERS[column.kind] for column in table.columns}

    def value(name: str, text: str) -> Any:
        parser = parsers.get(name, float)
        text = text[1:] if text and text.startswith("'") and _is_formula(text[1:]) else text
        return parser(text) if text or parser is str else None

    path = folder / table.file
    stream = io.StringIO(reading.content(path, MAX_BYTES).decode("utf-8"), newline="")
    try:
        lines = list(csv.DictReader(stream, strict=True))
    except csv.Error as error:
        raise ValueError(str(error)) from error
    if any(None in line or None in line.values() for line in lines):
        raise ValueError(f"{path}: a row has more or fewer entries than the header")
    return [{name: value(name, text) for name, text in line.items()} for line in lines]


def entry(value: Any) -> Any:
    """Return the entry of a table for a value: None for NaN, and an apostrophe before a text that looks like a formula."""
    if isinstance(value, str):
        return f"'{value}" if _is_formula(value) else value
    return value if value == value else None  # NaN is the only value that differs from itself


def _is_formula(text: str) -> bool:
    """Return whether an apostrophe belongs before a text, which may already begin with apostrophes."""
    shown = text.lstrip("'")
    return shown.startswith(FORMULA) and shown not in SIGNS


def _truth_value(text: str) -> bool:
    """Return the truth value that `write` writes as a text. Raises `ValueError` for any other text."""
    if text not in ("True", "False"):
        raise ValueError(f"{text!r:.60} is neither True nor False")
    return text == "True"


#: The functions that read the entries of columns, by the kind of the column.
PARSERS: dict[Kind, Callable[[str], Any]] = {"string": str, "boolean": _truth_value, "integer": int, "number": float}
