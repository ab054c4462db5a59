"""Tables in reports, independent of the layout, and their division into tables that are narrow enough for a page."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace

#: The number of characters that fit beside the index in a window of 1280 pixels, in a font with broad digits.
ROOM = 129.0

#: The space between two columns, in characters.
GAP = 1.6

#: The widths, in characters, of a column of words, which break into lines, and of a column of sentences.
WORDS, SENTENCES = 11, 30


@dataclass(frozen=True)
class Entry:
    """One cell of a table.

    Parameters
    ----------
    text
        The text of the cell.
    value
        The number by which the column is sorted: the measured number, or its bound.
    meaning
        Explanation that appears at the pointer; empty if there is none.
    link
        The anchor in the page to which the cell links; empty if the cell is no link.
    """

    text: str
    value: float | None = None
    meaning: str = ""
    link: str = ""


@dataclass(frozen=True)
class Table:
    """A table.

    Parameters
    ----------
    columns
        Title of each column.
    numeric
        Whether each column holds numbers.
    rows
        The cells of each row.
    failed
        Whether each row is marked as failed.
    notes
        Sentences below the table.
    footer
        The cells of a row that stays below all others; empty if there is none.
    keys
        The number of columns, from the first, that identify a row.
    runs
        The anchor of the command that reproduces the run of each row; empty in a table without commands.
    """

    columns: tuple[str, ...]
    numeric: tuple[bool, ...]
    rows: tuple[tuple[Entry, ...], ...]
    failed: tuple[bool, ...]
    notes: tuple[str, ...]
    footer: tuple[Entry, ...] = ()
    keys: int = 2
    runs: tuple[str, ...] = ()


def pieces(table: Table) -> Iterator[Table]:
    """Yield a table in parts that fit a page, each with all rows and with the columns that identify them.

    Only the last part has notes. A table that fits is yielded as one part.
    """
    keys, columns = list(range(table.keys)), range(table.keys, len(table.columns))
    begun = sum(_width(table, column) for column in keys)
    parts: list[list[int]] = [[]]
    used = begun
    for column in columns:
        width = _width(table, column)
        if parts[-1] and used + width > ROOM:
            parts.append([])
            used = begun
        parts[-1].append(column)
        used += width
    for part in parts:
        yield _selected(table, [*keys, *part], table.notes if part is parts[-1] else ())


def _selected(table: Table, columns: list[int], notes: tuple[str, ...]) -> Table:
    return replace(
        table,
        columns=tuple(table.columns[column] for column in columns),
        numeric=tuple(table.numeric[column] for column in columns),
        rows=tuple(tuple(row[column] for column in columns) for row in table.rows),
        footer=tuple(table.footer[column] for column in columns) if table.footer else (),
        notes=notes,
    )


def _width(table: Table, column: int) -> float:
    """Return the width of a column in characters. Numbers stay on one line; headings and words may break into lines."""
    texts = [row[column].text for row in (*table.rows, *((table.footer,) if table.footer else ()))]
    longest = max(map(len, texts), default=0)
    heading = max(map(len, re.split(r"[\s-]", table.columns[column])), default=0)
    if not table.numeric[column]:
        longest = min(longest, SENTENCES if table.columns[column] == "Reason" else WORDS)
    return max(longest, min(heading, WORDS)) + GAP
