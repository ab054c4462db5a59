"""The trajectory files of a results folder: one Parquet file for each truth and for each completed run.

The file of a run of a case with sensors also has their readings. A second file has the states and the readings after each of
the first steps of the run.
"""

import contextlib
import os
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

import numpy as np

from bodycheck.casefile.values import MAX_SAMPLES
from bodycheck.errors import BadFolder
from bodycheck.files import columns, reading, writing
from bodycheck.reference.bounds import NAMES, Bounds
from bodycheck.reference.trajectory import Array, Trajectory

#: Name of the folder of all trajectory files, inside a results folder.
TRAJECTORIES = "trajectories"

#: The largest number of bodies of a mechanism.
MAX_BODIES = 200

#: The largest size of a trajectory file in bytes, which leaves room for the bounds of later versions.
MAX_BYTES = 64 * 8 * MAX_SAMPLES * MAX_BODIES

#: The column with the growth of an error, in truths of mechanisms.
GROWTH_COLUMN = "truth_growth"

#: Columns of a state: position (m), quaternion w x y z (body to world), velocity (m/s), angular velocity, body frame (rad/s).
STATE_COLUMNS = ("x", "y", "z", "qw", "qx", "qy", "qz", "vx", "vy", "vz", "wx", "wy", "wz")

#: The separator between the name of a body of a mechanism and the name of a column of its states, as in "pole.x".
OF_BODY = "."

#: Columns of the bounds of a truth's own errors, in the order and the units of `Bounds`.
BOUND_COLUMNS = tuple(f"truth_{name}" for name in NAMES)


@dataclass(frozen=True)
class StoredTrajectory:
    """The trajectory in a file, which is read each time it is needed and is not kept in memory.

    bodies: the names of the bodies if the trajectory is of a mechanism.
    """

    file: Path
    bodies: tuple[str, ...] = ()

    def read(self) -> Trajectory:
        """Return the trajectory in the file. Raises `BadFolder` if the file is missing or damaged."""
        return read(self.file, self.bodies)


def run_path(case: str, engine: str, spelling: str, timestep: float) -> Path:
    """Return the path of a run's trajectory relative to its results folder.

    Parameters
    ----------
    case, engine
        Names of the case and of the engine.
    spelling
        Spelling of the method when the run was made.
    timestep
        Time step (s).
    """
    # The spelling may come from a case file of unknown origin. It is quoted, so that the path cannot lead out of the folder.
    return _path(case, "-".join(filter(None, (engine, spelling, f"{timestep!r}s"))))


def truth_path(case: str, timestep: float) -> Path:
    """Return the path of the truth of a case for runs with a time step (s), relative to its results folder."""
    return _path(case, f"truth-{timestep!r}s")


def write(folder: Path, path: Path, trajectory: Trajectory, more: Mapping[str, Array], bodies: Sequence[str] = ()) -> None:
    """Write a trajectory into a file, completely or not at all.

    Parameters
    ----------
    folder
        The results folder.
    path
        Path of the file, relative to the folder.
    trajectory
        A trajectory of n instants.
    more
        Further columns (n,) by their names.
    bodies
        The names of the bodies if the trajectory is of a mechanism; each name is a prefix of the columns of the body's state.

    Raises
    ------
    NotWritten
        The file cannot be written.
    """
    import pyarrow as pa  # it is large, and a command that has only been imported has no files
    import pyarrow.parquet as pq

    parts = (trajectory.position, trajectory.quaternion, trajectory.velocity, trajectory.angular_velocity)
    states = np.moveaxis(np.concatenate(parts, axis=-1), -1, -2).reshape(-1, len(trajectory))
    named = {"t": trajectory.t, **dict(zip(_columns_of(bodies), states, strict=True)), **more}
    table = pa.table({name: columns.of_numbers(values) for name, values in named.items()})
    content = pa.BufferOutputStream()
    # LZ4 takes half the time of zstd, and its files are a few per cent larger.
    pq.write_table(table, content, compression="lz4", use_dictionary=False, use_byte_stream_split=True)
    writing.write(folder / path, content.getvalue().to_pybytes(), folder)


def read(file: Path, bodies: Sequence[str] = ()) -> Trajectory:
    """Return the trajectory in a file, of a single body, or of a mechanism whose bodies have these names.

    Raises `BadFolder` if the file is missing or damaged.
    """
    return _trajectory(_columns(file, bodies, ()), bodies)


def read_with(file: Path, bodies: Sequence[str], more: Sequence[str]) -> tuple[Trajectory, dict[str, Array]]:
    """Return the trajectory in a file, and its columns (n,) with further names. Raises `BadFolder` as `read` does."""
    columns = _columns(file, bodies, (), more)
    return _trajectory(columns, bodies), {name: columns[name] for name in more}


def read_truth(file: Path, bodies: Sequence[str] = ()) -> tuple[Trajectory, Bounds, Array | None]:
    """Return the trajectory of a truth at n instants, the bounds of its errors, and the growth (n,) of an error or None.

    Bounds that an earlier version of bodycheck did not write are NaN. Raises `BadFolder` if the file is missing or damaged.
    """
    columns = _columns(file, bodies, (*BOUND_COLUMNS, GROWTH_COLUMN))
    unknown = np.full(len(columns["t"]), np.nan)
    bounds = Bounds(*(columns.get(name, unknown) for name in BOUND_COLUMNS))
    return _trajectory(columns, bodies), bounds, columns.get(GROWTH_COLUMN)


def is_readable(file: Path, bodies: Sequence[str] = (), more: Sequence[str] = ()) -> bool:
    """Return whether a trajectory file exists and is complete, with further columns of these names."""
    try:
        _columns(file, bodies, (), more)
    except BadFolder:
        return False
    return True


def remove_all_but(kept: Collection[Path], folder: Path) -> None:
    """Delete trajectory files that no journal record refers to, and unfinished files of killed processes.

    The folder must not contain any symbolic link.
    """
    with writing.failing(folder):
        for path in folder.rglob("*"):
            if writing.is_part(path):
                path.unlink()
        for subfolder, _, names in os.walk(folder / TRAJECTORIES, topdown=False):
            for path in (Path(subfolder, name) for name in names):
                if path.relative_to(folder) not in kept:
                    path.unlink()
            with contextlib.suppress(OSError):  # the folder is not empty
                os.rmdir(subfolder)


def _path(case: str, name: str) -> Path:
    return Path(TRAJECTORIES, case, f"{quote(name, safe=' =,')}.parquet")


def _columns(file: Path, bodies: Sequence[str], wanted: Sequence[str], more: Sequence[str] = ()) -> dict[str, Array]:
    """Return the columns of a trajectory, those with further names, and the `wanted` columns that the file has, by their names.

    Raises `BadFolder` if the file is missing or damaged.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        stored = pq.ParquetFile(pa.BufferReader(reading.content(file, MAX_BYTES)))
        if not 1 <= stored.metadata.num_rows <= MAX_SAMPLES:
            raise ValueError(f"it has {stored.metadata.num_rows} instants; allowed: 1 to {MAX_SAMPLES}")
        names, there = ["t", *_columns_of(bodies), *more], set(stored.schema_arrow.names)
        if absent := [name for name in names if name not in there]:
            raise ValueError(f"it has no column {absent[0]}")
        asked = [*names, *(name for name in wanted if name in there)]
        table = stored.read(columns=asked, use_threads=False)  # threads take longer than columns of this size
        for field in table.schema:
            if field.type != pa.float64() or table[field.name].null_count:
                raise ValueError(f"its column {field.name} does not hold numbers alone")
        numbers = {name: columns.numbers_of(table[name]) for name in table.column_names}
    except (OSError, pa.ArrowException, ValueError, KeyError, OverflowError, MemoryError) as error:
        raise BadFolder(f"{file}: a trajectory that the results tell of cannot be read: {error}") from error
    return numbers


def _columns_of(bodies: Sequence[str]) -> tuple[str, ...]:
    """Return the columns of the states of the bodies of a mechanism, or of a single body if there are no names."""
    return tuple(body + OF_BODY + name for body in bodies for name in STATE_COLUMNS) if bodies else STATE_COLUMNS


def _trajectory(columns: Mapping[str, Array], bodies: Sequence[str]) -> Trajectory:
    states = np.column_stack([columns[name] for name in _columns_of(bodies)])
    if bodies:
        states = states.reshape(len(states), len(bodies), len(STATE_COLUMNS)).swapaxes(0, 1)
    return Trajectory(columns["t"], states[..., :3], states[..., 3:7], states[..., 7:10], states[..., 10:])
