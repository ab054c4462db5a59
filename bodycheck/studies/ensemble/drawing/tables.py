"""Members from a table of the user: Parquet or CSV, with a row for each member and a column for each key path.

The file may come from a stranger: it must be a regular file, the amount that is read at once is limited, and any fault of it
gives one clear message. Every process that needs members reads the file again, and refuses it if it has changed.
"""

import hashlib
import os
import re
import threading
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet as pq

from bodycheck.casefile.values import MAX_MEMBERS, MAX_NAME_LENGTH
from bodycheck.errors import BadInput
from bodycheck.files import reading
from bodycheck.reference.trajectory import Array

#: The columns of stored members that identify the member of a row.
LABELS = ("case", "member")

#: The most bytes of a CSV file, which is held in memory as a whole, and of a Parquet file.
MAX_CSV_BYTES, MAX_PARQUET_BYTES = 1 << 28, 1 << 36

#: The most columns, the most bytes of the description of a Parquet file, and the most rows of one of its groups, which are read
#: at once.
MAX_COLUMNS, MAX_DESCRIPTION, MAX_ROWS = 500, 1 << 24, 1 << 24

#: The line of a CSV file that has the names of its columns, with empty lines before it.
FIRST_LINE = re.compile(rb"[\r\n]*([^\r\n]*)")

#: The ends of the names of Parquet files. Any other file is CSV.
PARQUET = (".parquet", ".pq")

#: The lock that is held while a file is read, because threads share open files.
READING = threading.Lock()


@dataclass(frozen=True)
class Table:
    """A table of members.

    Attributes
    ----------
    path
        The absolute path of the file.
    digest
        The SHA-256 of its content.
    rows
        The number of members.
    columns
        The key paths that are its columns.
    """

    path: str
    digest: str
    rows: int
    columns: tuple[str, ...]


def opened(path: Path) -> Table:
    """Return the table in a file. Raises `BadInput` if it cannot be read or is no table of numbers."""
    absolute = Path(os.path.abspath(path))
    with _faults_of(path):
        stored = _Stored.of(absolute)
        names = stored.schema.names
        columns = tuple(name for name in names if name not in LABELS)
        if not columns:
            raise BadInput(f"{path}: has no column that is a key path, such as initial.velocity.0")
        if len(names) > MAX_COLUMNS:
            raise BadInput(f"{path}: has {len(names)} columns; allowed: at most {MAX_COLUMNS}")
        if twice := sorted(name for name, count in Counter(names).items() if count > 1):
            raise BadInput(f"{path}: has the column {twice[0]!r:.100} more than once")
        for name in columns:
            if not (name.isprintable() and len(name) <= MAX_NAME_LENGTH):
                raise BadInput(f"{path}: read {name!r:.100} as a column; allowed: key paths")
            if not _is_numeric(kind := stored.schema.field(name).type):
                raise BadInput(f"{path}: the column {name} holds values of the type {kind}; allowed: numbers")
        if not 1 <= stored.rows <= MAX_MEMBERS:
            raise BadInput(f"{path}: has {stored.rows} rows; allowed: 1 to {MAX_MEMBERS:,}")
        return Table(str(absolute), stored.digest, stored.rows, columns)


def values(table: Table, first: int, count: int) -> dict[str, Array]:
    """Return the columns (count,) of consecutive rows of a table, from the row `first`, by their names.

    Raises `BadInput` for a value that is no finite number, and if the file has changed since it was opened.
    """
    path = Path(table.path)
    with _faults_of(path):
        stored = _Stored.of(path)
        if (stored.digest, stored.rows) != (table.digest, table.rows):
            raise BadInput(f"{path}: has changed since the members were planned; put the file back, or begin anew")
        with READING:
            read = {name: stored.column(name, first, count) for name in table.columns}
        if any(len(column) != count for column in read.values()):
            raise ValueError("it has fewer values than it claims to have")
        return {name: _numbers(path, name, column, first) for name, column in read.items()}


@contextmanager
def _faults_of(path: Path) -> Iterator[None]:
    """Raise `BadInput` with one message for any fault of a stranger's file within the context."""
    try:
        yield
    except reading.Refused as error:
        raise BadInput(f"{path}: {error.reason}") from error
    except (OSError, ValueError, MemoryError, pa.ArrowException) as error:
        words = (str(error).splitlines() or [type(error).__name__])[0]
        raise BadInput(f"{path}: cannot be read as a table: {words:.200}") from error


def _is_numeric(kind: pa.DataType) -> bool:
    return bool(pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_null(kind))


def _numbers(path: Path, name: str, column: pa.ChunkedArray, first: int) -> Array:
    """Return a column of numbers as doubles."""
    numbers = np.asarray(column.cast(pa.float64(), safe=False).fill_null(np.nan).to_numpy())
    wrong = np.flatnonzero(~np.isfinite(numbers))
    if wrong.size:
        index = int(wrong[0])
        raise BadInput(f"{path}: member {first + index} has no finite number in the column {name}; allowed: finite numbers")
    return numbers


@dataclass(frozen=True)
class _Stored:
    """An open file: the names and types of its columns, the number of rows, and the columns, some rows at a time."""

    digest: str
    schema: pa.Schema
    rows: int
    csv: pa.Table | None
    parquet: pq.ParquetFile | None
    #: The index of the first row of each row group of a Parquet file, and then the number of all rows.
    starts: tuple[int, ...] = ()

    @staticmethod
    def of(path: Path) -> "_Stored":
        """Return the file at a path, which a process opens only once unless the file changes."""
        reading.check_regular(path)
        state = os.stat(path)
        return _stored(path, state.st_size, state.st_mtime_ns, state.st_ino)

    def column(self, name: str, first: int, count: int) -> pa.ChunkedArray:
        """Return some rows of a column."""
        if self.csv is not None:
            return self.csv.column(name).slice(first, count)
        assert self.parquet is not None
        groups = [
            group
            for group in range(len(self.starts) - 1)
            if self.starts[group] < first + count and first < self.starts[group + 1]
        ]
        read = self.parquet.read_row_groups(groups, columns=[name], use_threads=False)
        return read.column(name).slice(first - self.starts[groups[0]], count)


@lru_cache(maxsize=2)
def _stored(path: Path, size: int, _changed: int, _identity: int) -> _Stored:
    """Return the file at a path of this size. The other parameters are keys of the cache, which distinguish changed files."""
    parquet = path.name.endswith(PARQUET)
    limit = MAX_PARQUET_BYTES if parquet else MAX_CSV_BYTES
    if size > limit:
        advice = "" if parquet else "; a larger table can be given as Parquet"
        raise BadInput(f"{path}: has {size} bytes; allowed: at most {limit}{advice}")
    if not parquet:
        content = reading.content(path, limit, follow=True)
        line = FIRST_LINE.match(content)
        assert line is not None  # it may be empty
        if (columns := line[1].count(b",") + 1) > MAX_COLUMNS:  # PyArrow takes 8 kB for each
            raise BadInput(f"{path}: has {columns} columns; allowed: at most {MAX_COLUMNS}")
        table = pyarrow.csv.read_csv(pa.BufferReader(content), pyarrow.csv.ReadOptions(use_threads=False))
        return _Stored(hashlib.sha256(content).hexdigest(), table.schema, table.num_rows, table, None)
    with path.open("rb") as file:
        digest = hashlib.file_digest(file, "sha256").hexdigest()
    stored = pq.ParquetFile(path, thrift_string_size_limit=MAX_DESCRIPTION, thrift_container_size_limit=MAX_DESCRIPTION)
    sizes = [stored.metadata.row_group(group).num_rows for group in range(stored.metadata.num_row_groups)]
    if max(sizes, default=0) > MAX_ROWS:
        raise BadInput(f"{path}: has {max(sizes)} rows in one group; allowed: at most {MAX_ROWS}")
    starts = tuple(int(start) for start in np.cumsum([0, *sizes]))
    return _Stored(digest, stored.schema_arrow, starts[-1], None, stored, starts)
