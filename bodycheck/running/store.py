"""A results folder: what was run, raw, so that every figure and report is computed from it without simulating again.

`run.jsonl` is a journal with a record of each truth and each run as they finish; without its footer it tells of an interrupted
run. `trajectories/` holds the states. The case files are in the header as they were read.
"""

import os
import shutil
from collections.abc import Collection, Iterator
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from bodycheck.casefile.case import Case, parse_stored
from bodycheck.errors import BadInput
from bodycheck.figures.definition import Load
from bodycheck.reference.planar import Stop
from bodycheck.reference.scene import Plane
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import Truth
from bodycheck.running import journal
from bodycheck.running.key import RunKey
from bodycheck.running.outcome import Completed, Crashed, Diverged, Run, TimedOut, Unsupported

FORMAT = 1
RECORDS = "run.jsonl"
TRAJECTORIES = "trajectories"
TRUTH = "truth"
STATE_COLUMNS = ("x", "y", "z", "qw", "qx", "qy", "qz", "vx", "vy", "vz", "wx", "wy", "wz")


class BadFolder(BadInput):
    """A folder is not what it should be; the text says why."""


class Writer:
    """Writes a results folder; use as a context, whose regular end writes the footer.

    Goes on with a folder in which the same work was interrupted, as the `identity` in the header tells; any other results are
    replaced.
    """

    def __init__(self, folder: Path, header: dict[str, Any], cases: tuple[Case, ...]) -> None:
        _refuse_other_things(folder)
        texts = [{"name": case.name, "text": case.text} for case in cases]
        self.folder = folder
        self.journal = journal.resume(folder / RECORDS, {"format": FORMAT, **header, "cases": texts})
        self.done = {_path_of(record) for record in self.journal.records if _is_stored(folder, record)}
        _remove_all_but(self.done, folder)

    def __enter__(self) -> "Writer":
        self.journal.__enter__()
        return self

    def __exit__(self, *exit: Any) -> None:
        self.journal.__exit__(*exit)

    def has_truth(self, case: str, timestep: float) -> bool:
        """Whether that of a case for a time step (s) was there already, or the reason why there is none."""
        return _trajectory_path(case, TRUTH, "", timestep) in self.done

    def has_run(self, key: RunKey) -> bool:
        """Whether a run was there already, however it ended."""
        return _trajectory_path(key.case, key.engine, key.method.name, key.method.timestep) in self.done

    def add_truth(self, case: Case, timestep: float, truth: Truth) -> None:
        path = _trajectory_path(case.name, TRUTH, "", timestep)
        self._save(path, truth.trajectory, {"truth_error": truth.error, "truth_position_error": truth.position_error})
        record: dict[str, Any] = {"case": case.name, "timestep": timestep, "model": truth.model, "why": truth.reason}
        record |= {"backend": truth.backend, "witnesses": truth.witnesses}
        if truth.stop is not None:
            record["stop"] = asdict(truth.stop)
        self.journal.add({"record": "truth", **record})

    def add_missing_truth(self, case: Case, timestep: float, reason: str) -> None:
        self.journal.add({"record": "truth", "case": case.name, "timestep": timestep, "reason": reason})

    def add_run(self, run: Run, place: int) -> None:
        """place: where the run stood in the plan, which is the order of every table."""
        record: dict[str, Any] = {
            "record": "run",
            "place": place,
            "case": run.case,
            "engine": run.engine,
            "version": run.version,
            "integrator": run.method.name,
            "timestep": run.method.timestep,
            "status": run.outcome.status,
            "contact_law": asdict(run.contact_law) if run.contact_law is not None else None,
        }
        match run.outcome:
            case Completed(trajectory, steps, wall_time, load):
                self._save(_path_of(record), trajectory, {})
                record |= {"steps": steps, "wall_time": wall_time, "load": asdict(load) if load is not None else None}
            case TimedOut(limit):
                record |= {"limit": limit}
            case outcome:
                record |= {"reason": outcome.reason}
        self.journal.add(record)

    def _save(self, path: Path, trajectory: Trajectory, more: dict[str, Array]) -> None:
        states = np.hstack([trajectory.position, trajectory.quaternion, trajectory.velocity, trajectory.angular_velocity])
        columns = {"t": trajectory.t, **dict(zip(STATE_COLUMNS, states.T, strict=True)), **more}
        file = self.folder / path
        file.parent.mkdir(parents=True, exist_ok=True)
        part = file.with_suffix(".part")
        pq.write_table(pa.table(columns), part, compression="zstd", use_dictionary=False, use_byte_stream_split=True)
        os.replace(part, file)  # whole or not at all, and there before its record is


@dataclass(frozen=True)
class Results:
    """A results folder, read. header: versions, machine, command. complete: whether the run came to its end."""

    folder: Path
    header: dict[str, Any]
    records: tuple[dict[str, Any], ...]
    complete: bool

    @cached_property
    def cases(self) -> dict[str, Case]:
        """The cases that were run, by name."""
        return {entry["name"]: parse_stored(entry["text"], entry["name"]) for entry in self.header["cases"]}

    def runs(self) -> Iterator[Run]:
        """All runs in the order of the plan, their trajectories read from disk as they come."""
        records = [record for record in self.records if record["record"] == "run"]
        yield from map(self._run, sorted(records, key=lambda record: int(record["place"])))

    def truth(self, case: str, timestep: float) -> Truth | Unsupported:
        """The truth that the runs of a case with one time step are held against, or why there is none."""
        for record in self.records:
            if record["record"] == "truth" and record["case"] == case and record["timestep"] == timestep:
                if "reason" in record:
                    return Unsupported(record["reason"])
                bounds = ("truth_error", "truth_position_error")
                table = _read_columns(self.folder / _path_of(record), bounds)
                error, position_error = (table[bound].to_numpy() for bound in bounds)
                stop = record.get("stop")
                return Truth(
                    self.cases[case].scene,
                    _trajectory(table),
                    error,
                    position_error,
                    model=record["model"],
                    reason=record["why"],
                    backend=record["backend"],
                    witnesses=tuple(record["witnesses"]),
                    stop=Stop(stop["time"], tuple(stop["position"]), stop["yaw"]) if stop else None,
                )
        return Unsupported("the reference was interrupted")

    def _run(self, record: dict[str, Any]) -> Run:
        key = RunKey.of_row(record)
        law = record["contact_law"]
        run = Run(key.case, key.engine, record["version"], key.method, Unsupported(""), Plane(**law) if law else None)
        match record["status"]:
            case Completed.status:
                table = _read_columns(self.folder / _path_of(record))
                load = Load(**record["load"]) if record["load"] else None
                return replace(run, outcome=Completed(_trajectory(table), record["steps"], record["wall_time"], load))
            case TimedOut.status:
                return replace(run, outcome=TimedOut(record["limit"]))
            case status:
                kind = {kind.status: kind for kind in (Unsupported, Diverged, Crashed)}[status]
                return replace(run, outcome=kind(record["reason"]))


def read(folder: Path) -> Results:
    """The results in a folder. Raises `BadFolder`."""
    try:
        contents = journal.read(folder / RECORDS)
        if contents.header["format"] != FORMAT:
            raise ValueError(f"its format is {contents.header['format']!r}, not {FORMAT}")
        # What was done again, because its trajectory was lost, is told of by its later record.
        records = {_path_of(record): record for record in contents.records}
    except (journal.BadJournal, ValueError, KeyError, TypeError) as error:
        raise BadFolder(f"{folder}: no readable results: {error}") from error
    return Results(folder, contents.header, tuple(records.values()), contents.complete)


def _path_of(record: dict[str, Any]) -> Path:
    """The file of the trajectory of a record, named after the method as it was spelled when it was written."""
    if record["record"] == "truth":
        return _trajectory_path(record["case"], TRUTH, "", record["timestep"])
    return _trajectory_path(record["case"], record["engine"], record["integrator"], record["timestep"])


def _is_stored(folder: Path, record: dict[str, Any]) -> bool:
    """Whether the trajectory of which a record tells is there and can be read; also where there is none to be."""
    if "reason" in record or record.get("status", Completed.status) != Completed.status:
        return True
    try:
        pq.read_table(folder / _path_of(record))
    except (OSError, pa.ArrowException):
        return False
    return True


def _trajectory_path(case: str, engine: str, spelling: str, timestep: float) -> Path:
    # The spelling of a method may come from a stranger's case file: quoted, it cannot lead out of the folder.
    name = quote("-".join(filter(None, (engine, spelling, f"{timestep!r}s"))), safe=" =,")
    return Path(TRAJECTORIES, case, f"{name}.parquet")


def _read_columns(path: Path, more: tuple[str, ...] = ()) -> pa.Table:
    """The file of a trajectory. more: columns beside the states. Raises `BadFolder` where it is lost or damaged."""
    try:
        return pq.read_table(path, columns=["t", *STATE_COLUMNS, *more])
    except (OSError, pa.ArrowException) as error:
        raise BadFolder(f"{path}: a trajectory that the results tell of cannot be read: {error}") from error


def _trajectory(table: pa.Table) -> Trajectory:
    states = np.column_stack([table[name].to_numpy() for name in STATE_COLUMNS])
    return Trajectory(table["t"].to_numpy(), states[:, :3], states[:, 3:7], states[:, 7:10], states[:, 10:])


def _refuse_other_things(folder: Path) -> None:
    if folder.exists() and not folder.is_dir():
        raise BadFolder(f"{folder}: is not a folder")
    if folder.exists() and any(folder.iterdir()) and not (folder / RECORDS).is_file():
        raise BadFolder(f"{folder}: has other things in it than results; give an empty or a new folder")


def _remove_all_but(kept: Collection[Path], folder: Path) -> None:
    """Remove the trajectories that are not kept: those of earlier results, and what was written and never told of."""
    if not kept:
        shutil.rmtree(folder / TRAJECTORIES, ignore_errors=True)
    for path in (folder / TRAJECTORIES).rglob("*"):
        if path.is_file() and path.relative_to(folder) not in kept:
            path.unlink()
