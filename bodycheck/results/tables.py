"""Descriptions of tables: their files, columns and rows, each described once together with the type of the rows.

All code that writes, reads, prints, checks, publishes or documents a table takes names, types, units and meanings from its
description. A field of a row is described by a `Meaning` in its type, or by the column of results that has its name.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from functools import cached_property
from types import UnionType
from typing import Any, Generic, Literal, TypeVar, Union, cast, get_args, get_origin

from bodycheck.figures.column import Column, Kind
from bodycheck.figures.columns import COLUMNS

Row = TypeVar("Row")


@dataclass(frozen=True)
class Meaning:
    """The meaning of a field of a row, which is part of the type of the field: `Annotated[float, Meaning(...)]`.

    Attributes
    ----------
    title, meaning, unit, counts, signed
        See `Column`.
    words
        The texts that the field may have; if empty, the texts of its type, or any text.
    column
        The name of the column; if it is empty, the name of the field.
    """

    title: str
    meaning: str
    unit: str = ""
    counts: str = ""
    signed: bool = False
    words: frozenset[str] = frozenset()
    column: str = ""


@dataclass(frozen=True)
class Table(Generic[Row]):
    """The description of a table.

    Attributes
    ----------
    name
        The name of its file without ".csv".
    title
        The contents of the table, as a phrase for readers.
    row
        The dataclass of its rows, whose fields are the columns; None if rows are mappings from column to value.
    columns
        All columns that it may have, in their order. A row that is a mapping may lack some.
    key
        The columns that together identify a row; empty if two rows may be alike.
    filled
        The columns that have an entry in every row.
    shown
        The columns that a notebook shows; if it is empty, all columns.
    later
        The columns that tables of earlier versions lack.
    """

    name: str
    title: str
    row: type[Row] | None
    columns: tuple[Column, ...]
    key: tuple[str, ...] = ()
    filled: tuple[str, ...] = ()
    shown: tuple[str, ...] = ()
    later: tuple[str, ...] = ()

    @property
    def file(self) -> str:
        """The name of its file."""
        return f"{self.name}.csv"

    @cached_property
    def by_name(self) -> dict[str, Column]:
        """The columns by name."""
        return {column.name: column for column in self.columns}

    def names(self, rows: Sequence[Row]) -> list[str]:
        """Return the names of the columns of rows.

        For mappings, these are the keys of the first row, or the names of all columns if there is no row.
        """
        return list(cast(Mapping[str, Any], rows[0])) if self.row is None and rows else list(self.by_name)

    def records(self, rows: Sequence[Row]) -> list[dict[str, Any]]:
        """Return rows as mappings from column to value."""
        if self.row is None:
            return [dict(cast(Mapping[str, Any], row)) for row in rows]
        renamed = self._renamed
        return [{renamed.get(name, name): value for name, value in asdict(cast(Any, row)).items()} for row in rows]

    def values(self, record: Mapping[str, Any]) -> dict[str, Any]:
        """Return the values of the fields of a row, by field, from its record."""
        fields_by_column = {} if self.row is None else {column: field for field, column in self._renamed.items()}
        return {fields_by_column.get(name, name): value for name, value in record.items()}

    @cached_property
    def _renamed(self) -> dict[str, str]:
        """The names of the columns, by field, for fields whose column has a different name."""
        named = zip(fields(cast(Any, self.row)), self.columns, strict=True)
        return {field.name: column.name for field, column in named if field.name != column.name}


def table_of(
    row: type[Row],
    name: str,
    title: str,
    *,
    key: Sequence[str] = (),
    filled: Sequence[str] = (),
    shown: Sequence[str] = (),
    later: Sequence[str] = (),
) -> Table[Row]:
    """Return the description of a table whose rows are a dataclass. For the other parameters see `Table`.

    Raises `KeyError` for a field that has no `Meaning` and is not the name of a column of results.
    """
    return Table(name, title, row, tuple(_columns(row)), tuple(key), tuple(filled), tuple(shown), tuple(later))


def _columns(row: type) -> Iterator[Column]:
    """Yield the columns of a dataclass of rows."""
    for field in fields(row):
        hint, *notes = get_args(field.type) if hasattr(field.type, "__metadata__") else (field.type,)
        meaning = next((note for note in notes if isinstance(note, Meaning)), None)
        if meaning is None:
            yield COLUMNS[field.name]
        else:
            words = meaning.words or frozenset(word for word in _words(hint) if word)
            described = (meaning.title, meaning.meaning, meaning.unit, meaning.counts)
            yield Column(meaning.column or field.name, _kind(hint), *described, words=words, signed=meaning.signed)


def _alternatives(hint: Any) -> tuple[Any, ...]:
    """Return the types of a union; for any other type, the type itself."""
    return get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)


def _words(hint: Any) -> Iterator[str]:
    """Yield the texts of the literal types in a type."""
    for part in _alternatives(hint):
        if get_origin(part) is Literal:
            yield from get_args(part)


#: The kinds of values. The kind of a column is the first of these kinds that its values may have.
KINDS: tuple[Kind, ...] = ("string", "number", "integer", "boolean")


def _kind(hint: Any) -> Kind:
    """Return the kind of the values of a type. A column of numbers and texts is a column of texts."""
    kinds: dict[Any, Kind] = {str: "string", bool: "boolean", int: "integer", float: "number"}
    parts = ["string" if get_origin(part) is Literal else kinds.get(part) for part in _alternatives(hint)]
    return next(kind for kind in KINDS if kind in parts)


#: The columns that every run has, and that identify a run in a table of several cases and engines.
RUN = ("case", "engine", "integrator", "timestep")
RUN_FILLED = ("case", "engine", "version", "integrator", "timestep", "status")

#: The table of runs, with all columns that it may have.
RESULTS: Table[Mapping[str, Any]] = Table(
    "results",
    "runs",
    None,
    tuple(COLUMNS.values()),
    key=RUN,
    filled=RUN_FILLED,
    shown=(
        *("case", "engine", "integrator", "timestep", "status", "passed"),
        *("attitude_error", "position_error", "energy_drift", "energy_error", "reason"),
    ),
)
