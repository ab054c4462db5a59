"""Tables as every writer lays them out."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Entry:
    """One field of a table. value: the number as it was measured, or that bounds it; meaning: then says which bound it is."""

    text: str
    value: float | None = None
    meaning: str = ""


@dataclass(frozen=True)
class Table:
    """Runs of one case: a title a column, a row a run, the line of each run's method."""

    columns: tuple[str, ...]
    numeric: tuple[bool, ...]
    rows: tuple[tuple[Entry, ...], ...]
    failed: tuple[bool, ...]
    notes: tuple[str, ...]
