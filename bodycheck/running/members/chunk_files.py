"""The files of chunks in the folder of an ensemble, which are written completely or not at all.

`chunks/ENGINE/FIRST-COUNT.KIND.parquet` contains the table of one kind for some members: the runs and, if the chunk has them,
the members, the truths and the trajectories. The file of the runs is written last, so that a chunk is done if this file exists.
Tables have one row group for each block, and the digest of the work that they belong to, by which files of other work are
recognised. Two workers that carry out the same chunk write the same rows, and the later file replaces the earlier.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from bodycheck.errors import BadFolder
from bodycheck.figures.columns import FIGURES
from bodycheck.files import reading, writing
from bodycheck.results.trajectory_files import STATE_COLUMNS
from bodycheck.running.members.chunks import Chunk

#: The folder of the files of chunks, inside the folder of an ensemble.
CHUNKS = "chunks"

#: The kinds of tables. In the end, each kind has a folder of its name.
RUNS, MEMBERS, TRUTHS, TRAJECTORIES = KINDS = ("runs", "members", "truths", "trajectories")

#: The names of the files of chunks.
NAME = re.compile(rf"(\d{{12}})-(\d{{12}})\.({'|'.join(KINDS)})\.parquet")

#: The key of the digest of the work in the metadata of a file.
IDENTITY = b"bodycheck_identity"

#: The largest size (bytes) of a file of a chunk, because files from strangers are read too.
MAX_BYTES = 1 << 30

#: Columns whose values differ between repetitions of the same run.
MEASURED = ("wall_time",)

_TEXT, _NUMBER, _COUNT = pa.string(), pa.float64(), pa.int64()

#: The columns of runs.
RUN_SCHEMA = pa.schema(
    [
        *((name, _TEXT) for name in ("case", "engine", "version", "integrator")),
        *(("timestep", _NUMBER), ("member", _COUNT), ("status", _TEXT), ("passed", pa.bool_()), ("reason", _TEXT)),
        *((name, _NUMBER) for name in FIGURES),
        *(("steps", _COUNT), ("wall_time", _NUMBER)),
    ]
)

#: The columns of truths with the largest bounds over the instants, in the order and the units of `reference.bounds.Bounds`: in
#: rad, m, m/s, rad/s, J and kg m^2/s.
BOUND_COLUMNS = tuple(
    f"{name}_bound" for name in ("attitude", "position", "velocity", "angular_velocity", "energy", "angular_momentum")
)

#: The columns of truths. The difference is the largest difference (rad) of the attitude from the attitudes of witnesses.
TRUTH_SCHEMA = pa.schema(
    [
        *(("case", _TEXT), ("timestep", _NUMBER), ("member", _COUNT), ("model", _TEXT), ("reason", _TEXT)),
        *((name, _NUMBER) for name in BOUND_COLUMNS),
        *(("witnessed", pa.bool_()), ("witness_difference", _NUMBER)),
    ]
)

#: The columns of trajectories: one row for each instant, and each body of a mechanism, whose name is `body`. `kept` says why
#: the trajectory is kept: its run failed, is the worst, or is a sample.
TRAJECTORY_SCHEMA = pa.schema(
    [
        *((name, _TEXT) for name in ("case", "engine", "integrator")),
        *(("timestep", _NUMBER), ("member", _COUNT), ("kept", _TEXT), ("t", _NUMBER)),
        *((name, _NUMBER) for name in STATE_COLUMNS),
        ("body", _TEXT),
    ]
)


def member_schema(names: Sequence[str]) -> Any:
    """Return the columns of members with numbers of these names."""
    return pa.schema([("case", _TEXT), ("member", _COUNT), *((name, _NUMBER) for name in names)])


def table(columns: Mapping[str, Any], schema: Any) -> Any:
    """Return a table with the columns of a schema. Missing columns are empty, and NaN is a missing value.

    columns: sequences or arrays of equal lengths by name; a single text or number is repeated in all rows.
    """
    count = max(len(values) for values in columns.values() if not isinstance(values, str | float))
    return pa.table([_column(columns.get(field.name), field.type, count) for field in schema], schema=schema)


def _column(values: Any, kind: Any, count: int) -> Any:
    if values is None:
        return pa.nulls(count, kind)
    if isinstance(values, str | float):
        return pa.repeat(pa.scalar(values, kind), count)
    if pa.types.is_floating(kind):
        numbers = np.asarray(values, dtype=np.float64)
        return pa.array(numbers, kind, mask=np.isnan(numbers))
    return pa.array(values, kind)


@dataclass(frozen=True)
class ChunkFile:
    """A file of a chunk. members: the range of its members."""

    path: Path
    engine: str
    kind: str
    members: range


def folder_of(engine: str) -> str:
    """Return the name of the folder of an engine."""
    return quote(engine, safe=" =,@+")


def path_of(chunk: Chunk, kind: str) -> Path:
    """Return the path of a file of a chunk, relative to the folder of the ensemble."""
    return Path(CHUNKS, folder_of(chunk.share.engine), f"{chunk.first:012}-{chunk.count:012}.{kind}.parquet")


def write(folder: Path, chunk: Chunk, kind: str, tables: Sequence[Any]) -> None:
    """Write a file of a chunk, with the table of each block. Raises `NotWritten`."""
    schema = tables[0].schema.with_metadata({IDENTITY: chunk.work.identity.encode()})
    writing.write(folder / path_of(chunk, kind), encoded(schema, tables), folder)


def encoded(schema: Any, tables: Iterable[Any]) -> Any:
    """Return the content of a Parquet file with a row group for each table."""
    content = pa.BufferOutputStream()
    texts = [field.name for field in schema if field.type == _TEXT]
    numbers = [field.name for field in schema if pa.types.is_floating(field.type)]
    options = {"compression": "zstd", "compression_level": 1, "use_dictionary": texts, "use_byte_stream_split": numbers}
    with pq.ParquetWriter(content, schema, **options) as writer:
        for one in tables:
            writer.write_table(one.replace_schema_metadata(schema.metadata), row_group_size=max(1, one.num_rows))
    return content.getvalue()


def digest(tables: Iterable[Any]) -> str:
    """Return a digest of rows without their measured times."""
    checksum = sha256()
    for one in tables:
        kept = one.drop_columns([name for name in MEASURED if name in one.column_names])
        content = pa.BufferOutputStream()
        with pa.ipc.new_stream(content, kept.schema) as stream:
            stream.write_table(kept)
        checksum.update(content.getvalue())
    return checksum.hexdigest()


def found(folder: Path, identity: str) -> list[ChunkFile]:
    """Return the files of the chunks of some work in a folder, in the order of their members, without files of other work.

    Raises `BadFolder` for a folder that cannot be read, and for symbolic links.
    """
    files = []
    for engine_folder in reading.names_in(folder / CHUNKS):
        for name in reading.names_in(folder / CHUNKS / engine_folder):
            if (match := NAME.fullmatch(name)) is not None:
                path = folder / CHUNKS / engine_folder / name
                first, count = int(match[1]), int(match[2])
                if _belongs(path, identity):
                    files.append(ChunkFile(path, engine_folder, match[3], range(first, first + count)))
    return sorted(files, key=lambda file: (file.engine, file.kind, file.members.start, file.members.stop))


def _belongs(path: Path, identity: str) -> bool:
    """Return whether a file is whole and belongs to the work with an identity. Raises `BadFolder` if it cannot be read."""
    try:
        metadata = pq.read_metadata(pa.BufferReader(reading.content(path, MAX_BYTES)))
    except reading.Refused as error:
        raise BadFolder(str(error)) from error
    except (OSError, pa.ArrowException, ValueError):
        return False
    return bool((metadata.metadata or {}).get(IDENTITY) == identity.encode())


def blocks(files: Sequence[ChunkFile], size: int, block: int) -> dict[int, tuple[ChunkFile, int]]:
    """Return the file and the row group of each block of an ensemble, by the first member of the block.

    If several files contain a block, the first counts.

    Parameters
    ----------
    files
        The files of one kind of one engine.
    size, block
        The number of members of the ensemble, and of a block.
    """
    where: dict[int, tuple[ChunkFile, int]] = {}
    for file in files:
        starts = range(file.members.start, file.members.stop, block)
        whole = file.members.start % block == 0 and (file.members.stop % block == 0 or file.members.stop == size)
        if whole and file.members.stop <= size:
            for group, start in enumerate(starts):
                where.setdefault(start, (file, group))
    return dict(sorted(where.items()))


def tables(where: Mapping[int, tuple[ChunkFile, int]], schema: Any, block: int, each: int = 1) -> Iterator[Any]:
    """Yield the tables of blocks, in the order of the members.

    Raises `BadFolder` for a damaged file, and if the members of a table differ from those in the name of its file.

    Parameters
    ----------
    where
        The file and the row group of each block, as `blocks` returns them.
    schema
        The columns that the tables have.
    block, each
        The number of members of a block, and the number of consecutive rows of each member.
    """
    opened: tuple[Path, Any] | None = None
    for first, (file, group) in where.items():
        try:
            if opened is None or opened[0] != file.path:
                opened = file.path, pq.ParquetFile(pa.BufferReader(reading.content(file.path, MAX_BYTES)))
            one = opened[1].read_row_group(group)
            if not one.schema.equals(schema):
                raise ValueError("it has other columns")
            members = np.arange(first, min(first + block, file.members.stop))
            if not np.array_equal(one["member"].to_numpy(), np.repeat(members, each)):
                raise ValueError("it has other members than its name says")
        except (OSError, pa.ArrowException, ValueError, IndexError) as error:
            raise BadFolder(f"{file.path}: damaged: {error}; remove it, and run the same command again") from error
        yield one
