"""The trajectory files of a results folder: one Parquet file for each truth and for each completed run."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from bodycheck.errors import BadFolder
from bodycheck.reference.bounds import NAMES, Bounds
from bodycheck.reference.trajectory import Array, Trajectory

#: Name of the folder of all trajectory files, inside a results folder.
TRAJECTORIES = "trajectories"

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


def write(file: Path, trajectory: Trajectory, more: Mapping[str, Array]) -> None:
    """Write a trajectory of n instants into a file, and further columns (n,) by their names.

    The file appears whole or not at all.
    """
    states = np.hstack([trajectory.position, trajectory.quaternion, trajectory.velocity, trajectory.angular_velocity])
    columns = {"t": trajectory.t, **dict(zip(STATE_COLUMNS, states.T, strict=True)), **more}
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_suffix(".part")
    pq.write_table(pa.table(columns), part, compression="zstd", use_dictionary=False, use_byte_stream_split=True)
    os.replace(part, file)


def read(file: Path) -> Trajectory:
    """Return the trajectory in a file. Raises `BadFolder` if the file is missing or damaged."""
    return _trajectory(_table(file, ()))


def read_truth(file: Path) -> tuple[Trajectory, Bounds]:
    """Return the trajectory of a truth at n instants, and the bounds of its errors.

    Bounds that an earlier version of bodycheck did not write are not a number. Raises `BadFolder` if the file is missing or
    damaged.
    """
    table = _table(file, _columns_of(file, BOUND_COLUMNS))
    unknown = np.full(len(table), np.nan)
    bounds = (table[name].to_numpy() if name in table.column_names else unknown for name in BOUND_COLUMNS)
    return _trajectory(table), Bounds(*bounds)


def is_readable(file: Path) -> bool:
    """Return whether a trajectory file exists and is whole."""
    try:
        pq.read_table(file)
    except (OSError, pa.ArrowException):
        return False
    return True


def _path(case: str, name: str) -> Path:
    return Path(TRAJECTORIES, case, f"{quote(name, safe=' =,')}.parquet")


def _columns_of(file: Path, wanted: tuple[str, ...]) -> tuple[str, ...]:
    """Return those of the wanted columns that a file has."""
    try:
        names = pq.read_schema(file).names
    except (OSError, pa.ArrowException) as error:
        raise _unreadable(file, error) from error
    return tuple(name for name in wanted if name in names)


def _unreadable(file: Path, error: Exception) -> BadFolder:
    return BadFolder(f"{file}: a trajectory that the results tell of cannot be read: {error}")


def _table(file: Path, more: tuple[str, ...]) -> pa.Table:
    try:
        return pq.read_table(file, columns=["t", *STATE_COLUMNS, *more])
    except (OSError, pa.ArrowException) as error:
        raise _unreadable(file, error) from error


def _trajectory(table: pa.Table) -> Trajectory:
    states = np.column_stack([table[name].to_numpy() for name in STATE_COLUMNS])
    return Trajectory(table["t"].to_numpy(), states[:, :3], states[:, 3:7], states[:, 7:10], states[:, 10:])
