"""The trajectory files of a results folder: one Parquet file for each truth and for each completed run."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from bodycheck.casefile.values import MAX_SAMPLES
from bodycheck.errors import BadFolder
from bodycheck.files import reading, writing
from bodycheck.reference.bounds import NAMES, Bounds
from bodycheck.reference.trajectory import Array, Trajectory

#: Name of the folder of all trajectory files, inside a results folder.
TRAJECTORIES = "trajectories"

#: The largest size of a trajectory file in bytes, which leaves room for the bounds of later versions.
MAX_BYTES = 64 * 8 * MAX_SAMPLES

#: Columns of a state: position (m), quaternion w x y z (body to world), velocity (m/s), angular velocity, body frame (rad/s).
STATE_COLUMNS = ("x", "y", "z", "qw", "qx", "qy", "qz", "vx", "vy", "vz", "wx", "wy", "wz")

#: Columns of the bounds of a truth's own errors, in the order and the units of `Bounds`.
BOUND_COLUMNS = tuple(f"truth_{name}" for name in NAMES)


@dataclass(frozen=True)
class StoredTrajectory:
    """The trajectory in a file, which is read each time that it is needed and not kept."""

    file: Path

    def read(self) -> Trajectory:
        """Return the trajectory in the file. Raises `BadFolder` if the file is missing or damaged."""
        return read(self.file)


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
    # The spelling may come from a case file of unknown origin: quoted, it cannot lead out of the folder.
    return _path(case, "-".join(filter(None, (engine, spelling, f"{timestep!r}s"))))


def truth_path(case: str, timestep: float) -> Path:
    """Return the path of the truth of a case for runs with a time step (s), relative to its results folder."""
    return _path(case, f"truth-{timestep!r}s")


def write(folder: Path, path: Path, trajectory: Trajectory, more: Mapping[str, Array]) -> None:
    """Write a trajectory into a file, which appears whole or not at all.

    Parameters
    ----------
    folder
        The results folder.
    path
        Path of the file relative to it.
    trajectory
        A trajectory of n instants.
    more
        Further columns (n,) by their names.

    Raises
    ------
    NotWritten
        The file cannot be written.
    """
    states = np.hstack([trajectory.position, trajectory.quaternion, trajectory.velocity, trajectory.angular_velocity])
    columns = {"t": trajectory.t, **dict(zip(STATE_COLUMNS, states.T, strict=True)), **more}
    content = pa.BufferOutputStream()
    pq.write_table(pa.table(columns), content, compression="zstd", use_dictionary=False, use_byte_stream_split=True)
    writing.write(folder / path, content.getvalue().to_pybytes(), folder)


def read(file: Path) -> Trajectory:
    """Return the trajectory in a file. Raises `BadFolder` if the file is missing or damaged."""
    return _trajectory(_columns(file, ()))


def read_truth(file: Path) -> tuple[Trajectory, Bounds]:
    """Return the trajectory of a truth at n instants, and the bounds of its errors.

    Bounds that an earlier version of bodycheck did not write are not a number. Raises `BadFolder` if the file is missing or
    damaged.
    """
    columns = _columns(file, BOUND_COLUMNS)
    unknown = np.full(len(columns["t"]), np.nan)
    return _trajectory(columns), Bounds(*(columns.get(name, unknown) for name in BOUND_COLUMNS))


def is_readable(file: Path) -> bool:
    """Return whether a trajectory file exists and is whole."""
    try:
        _columns(file, ())
    except BadFolder:
        return False
    return True


def _path(case: str, name: str) -> Path:
    return Path(TRAJECTORIES, case, f"{quote(name, safe=' =,')}.parquet")


def _columns(file: Path, wanted: tuple[str, ...]) -> dict[str, Array]:
    """Return the columns of a trajectory by their names, and those of the wanted ones that the file has.

    Raises `BadFolder` if the file is missing or damaged.
    """
    try:
        stored = pq.ParquetFile(pa.BufferReader(reading.content(file, MAX_BYTES)))
        if not 1 <= stored.metadata.num_rows <= MAX_SAMPLES:
            raise ValueError(f"it has {stored.metadata.num_rows} instants; allowed: 1 to {MAX_SAMPLES}")
        names, there = ["t", *STATE_COLUMNS], set(stored.schema_arrow.names)
        if absent := [name for name in names if name not in there]:
            raise ValueError(f"it has no column {absent[0]}")
        asked = [*names, *(name for name in wanted if name in there)]
        table = stored.read(columns=asked, use_threads=False)  # threads take longer than columns of this size
        for field in table.schema:
            if field.type != pa.float64() or table[field.name].null_count:
                raise ValueError(f"its column {field.name} does not hold numbers alone")
        found = {name: table[name].to_numpy() for name in table.column_names}
    except (OSError, pa.ArrowException, ValueError, KeyError, OverflowError, MemoryError) as error:
        raise BadFolder(f"{file}: a trajectory that the results tell of cannot be read: {error}") from error
    return found


def _trajectory(columns: Mapping[str, Array]) -> Trajectory:
    states = np.column_stack([columns[name] for name in STATE_COLUMNS])
    return Trajectory(columns["t"], states[:, :3], states[:, 3:7], states[:, 7:10], states[:, 10:])
