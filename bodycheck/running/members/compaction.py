"""Compact the files of chunks into a few files of tens of MB, with the rows in the order of the plan.

The result does not depend on how the ensemble was cut into chunks. At most one row group is in memory at a time.
"""

import shutil
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import pyarrow as pa

from bodycheck.errors import BadFolder
from bodycheck.files import reading, writing
from bodycheck.running.members.chunk_files import encoded

#: The largest number of rows of a row group, and of a file: a row of runs takes some 200 bytes.
GROUP_ROWS, FILE_ROWS = 1 << 16, 1 << 18


def write(tables: Iterable[Any], schema: Any, target: Path, inside: Path) -> int:
    """Write tables as `target/part-00000.parquet` and further files, replacing existing files.

    Returns the number of rows. Raises `NotWritten` if a file cannot be written.

    Parameters
    ----------
    tables
        Tables of PyArrow in the order of their rows.
    schema
        The columns to write. Other columns of the tables are left out.
    target
        The folder of the files.
    inside
        The folder of the ensemble.
    """
    remove(target, inside)
    count = rows = 0
    groups: list[Any] = []
    for group in _groups(tables, schema):
        groups.append(group)
        rows += group.num_rows
        if sum(one.num_rows for one in groups) + GROUP_ROWS > FILE_ROWS:
            _write(groups, schema, target / f"part-{count:05}.parquet", inside)
            count, groups = count + 1, []
    if groups or not count:
        _write(groups, schema, target / f"part-{count:05}.parquet", inside)
    return rows


def remove(target: Path, inside: Path) -> None:
    """Remove a folder inside a results folder. Raises `BadFolder` for a symbolic link in it, and `NotWritten`."""
    if target.is_symlink():
        raise BadFolder(f"{target}: is a symbolic link; a results folder must not contain any, remove it")
    reading.refuse_links(target)
    with writing.failing(target):
        if target.exists():
            shutil.rmtree(target)


def _groups(tables: Iterable[Any], schema: Any) -> Iterator[Any]:
    """Yield the rows of tables, regrouped in tables of `GROUP_ROWS` rows; the last may have fewer."""
    waiting: list[Any] = []
    for table in tables:
        waiting.append(table.select(schema.names))
        while sum(one.num_rows for one in waiting) >= GROUP_ROWS:
            whole = pa.concat_tables(waiting)
            yield whole.slice(0, GROUP_ROWS)
            waiting = [whole.slice(GROUP_ROWS)]
    rest = pa.concat_tables(waiting) if waiting else None
    if rest is not None and rest.num_rows:
        yield rest


def _write(groups: list[Any], schema: Any, path: Path, inside: Path) -> None:
    writing.write(path, encoded(schema, groups), inside)
