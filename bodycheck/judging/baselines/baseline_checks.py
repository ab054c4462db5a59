"""What a baseline must hold. It is checked when a baseline is read, since the file may come from anyone."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from bodycheck.casefile.values import EngineName, Name
from bodycheck.files import reading
from bodycheck.results import records
from bodycheck.results.records import Printable, Spelling, Timestep

#: The largest size of a baseline in bytes, and the most entries of its table.
MAX_BYTES, MAX_ENTRIES = 1 << 28, 10_000_000


@dataclass(frozen=True)
class Header:
    """What a baseline keeps of the header of results."""

    bodycheck: Printable
    started: Printable
    machine: dict[str, Printable]
    packages: dict[str, Printable]
    engines: dict[str, Printable]


@dataclass(frozen=True)
class Metadata:
    """What a baseline holds beside its table: the header, the identities of the cases by name, the revisions of figures, and
    the keys of each case with their values as JSON.

    Baselines of earlier versions lack the revisions, which were all 1, and the keys.
    """

    header: Header
    cases: dict[Name, Printable]
    revisions: dict[Printable, int] = field(default_factory=dict)
    keys: dict[Name, dict[Printable, Printable]] = field(default_factory=dict)


@dataclass(frozen=True)
class Row:
    """The columns of a row that are no figures. Baselines of earlier versions have times per step too, which nothing reads."""

    case: Name
    engine: EngineName
    integrator: Spelling
    timestep: Timestep
    status: Printable


def read(path: Path) -> pa.Table:
    """Return the table in a file.

    Raises `OSError` if it cannot be read or is no regular file, `pyarrow.ArrowException` if it is no Parquet file, and
    `ValueError` if its table is too large or has a column twice.
    """
    stored = pq.ParquetFile(pa.BufferReader(reading.content(path, MAX_BYTES, follow=True)))
    if (entries := stored.metadata.num_rows * stored.metadata.num_columns) > MAX_ENTRIES:
        raise ValueError(f"it has {entries} entries; allowed: at most {MAX_ENTRIES}")
    names = stored.schema_arrow.names
    if repeated := {name for name in names if names.count(name) > 1}:
        raise ValueError(f"it has the column {min(repeated)!r} more than once")
    return stored.read(use_threads=False)  # threads that end with the process have aborted it


def check(row: dict[str, Any], figures: Iterable[str]) -> dict[str, Any]:
    """Return a row as it is. Raises `ValueError` if a column that is not a figure does not fit, or a figure is not a number."""
    records.typed(Row, row)
    for name in figures:
        if (value := row.get(name)) is not None and not isinstance(value, float):
            raise ValueError(f"{name}: read {value!r:.60}; allowed: a decimal number")
    return row
