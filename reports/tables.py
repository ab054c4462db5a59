"""Tables, which every writer lays out in its own way."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Entry:
    """One cell of a table.

    Parameters
    ----------
    text
        The text of the cell.
    value
        The number by which the column is sorted: the measured one, or its bound.
    meaning
        Explanation that appears at the pointer; empty if there is none.
    """

    text: str
    value: float | None = None
    meaning: str = ""


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
    """

    columns: tuple[str, ...]
    numeric: tuple[bool, ...]
    rows: tuple[tuple[Entry, ...], ...]
    failed: tuple[bool, ...]
    notes: tuple[str, ...]
    footer: tuple[Entry, ...] = ()
