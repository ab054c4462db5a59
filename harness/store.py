"""A results folder: what was run, raw, so that every figure and report is computed from it without simulating again.

`run.jsonl` is a header, a line a truth and a run as they finish, and a footer; without its footer it tells of an interrupted
run. `trajectories/` holds the states. The case files are in the header as they were read.
"""

import json
import shutil
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, TextIO
from urllib.parse import quote

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from bodycheck.adapters.contract import Method
from bodycheck.case import Case, parse
from bodycheck.errors import BadInput
from bodycheck.outcome import Completed, Crashed, Diverged, Load, Run, TimedOut, Unsupported
from bodycheck.reference.scene import Plane
from bodycheck.reference.sliding import Stop
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import Truth

FORMAT = 1
RECORDS = "run.jsonl"
TRAJECTORIES = "trajectories"
STATE_COLUMNS = ("x", "y", "z", "qw", "qx", "qy", "qz", "vx", "vy", "vz", "wx", "wy", "wz")


class BadFolder(BadInput):
    """A folder is not what it should be; the text says why."""


class Writer:
    """Writes a results folder; use as a context, whose regular end writes the footer."""

    def __init__(self, folder: Path, header: dict[str, Any], cases: tuple[Case, ...]) -> None:
        _make_room(folder)
        self.folder, self.runs = folder, 0
        self.stream: TextIO = (folder / RECORDS).open("x", encoding="utf-8")
        texts = [{"name": case.name, "text": case.text} for case in cases]
        self._write({"record": "header", "format": FORMAT, **header, "cases": texts})

    def __enter__(self) -> "Writer":
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None:
            self._write({"record": "footer", "runs": self.runs})
        self.stream.close()

    def add_truth(self, case: Case, timestep: float, truth: Truth) -> None:
        path = _trajectory_path(case.name, "truth", Method("", timestep))
        self._save(path, truth.trajectory, {"truth_error": truth.error, "truth_position_error": truth.position_error})
        record: dict[str, Any] = {"case": case.name, "timestep": timestep, "model": truth.model, "backend": truth.backend}
        if truth.stop is not None:
            record["stop"] = asdict(truth.stop)
        self._write({"record": "truth", **record})

    def add_missing_truth(self, case: Case, timestep: float, reason: str) -> None:
        self._write({"record": "truth", "case": case.name, "timestep": timestep, "reason": reason})

    def add_run(self, run: Run, place: int) -> None:
        """place: where the run stood in the plan, which is the order of every table."""
        record: dict[str, Any] = {
            "record": "run",
            "place": place,
            "case": run.case,
            "engine": run.engine,
            "version": run.version,
            "integrator": run.method.integrator,
            "timestep": run.method.timestep,
            "status": run.outcome.status,
            "contact_law": asdict(run.contact_law) if run.contact_law is not None else None,
        }
        match run.outcome:
            case Completed(trajectory, steps, wall_time, load):
                self._save(_trajectory_path(run.case, run.engine, run.method), trajectory, {})
                record |= {"steps": steps, "wall_time": wall_time, "load": asdict(load) if load is not None else None}
            case TimedOut(limit):
                record |= {"limit": limit}
            case outcome:
                record |= {"reason": outcome.reason}
        self._write(record)
        self.runs += 1

    def _write(self, record: dict[str, Any]) -> None:
        self.stream.write(json.dumps(record, ensure_ascii=False) + "\n")
        self.stream.flush()

    def _save(self, path: Path, trajectory: Trajectory, more: dict[str, Array]) -> None:
        states = np.hstack([trajectory.position, trajectory.quaternion, trajectory.velocity, trajectory.angular_velocity])
        columns = {"t": trajectory.t, **dict(zip(STATE_COLUMNS, states.T, strict=True)), **more}
        (self.folder / path).parent.mkdir(parents=True, exist_ok=True)
        pq.write_table(
            pa.table(columns), self.folder / path, compression="zstd", use_dictionary=False, use_byte_stream_split=True
        )


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
        return {entry["name"]: parse(entry["text"], entry["name"]) for entry in self.header["cases"]}

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
                table = pq.read_table(self.folder / _trajectory_path(case, "truth", Method("", timestep)))
                errors = table["truth_error"].to_numpy(), table["truth_position_error"].to_numpy()
                stop = record.get("stop")
                return Truth(
                    self.cases[case].scene,
                    _trajectory(table),
                    *errors,
                    model=record["model"],
                    backend=record["backend"],
                    stop=Stop(stop["time"], tuple(stop["position"]), stop["yaw"]) if stop else None,
                )
        return Unsupported("the reference was interrupted")

    def _run(self, record: dict[str, Any]) -> Run:
        method = Method(record["integrator"], record["timestep"])
        law = record["contact_law"]
        run = Run(record["case"], record["engine"], record["version"], method, Unsupported(""), Plane(**law) if law else None)
        match record["status"]:
            case Completed.status:
                table = pq.read_table(self.folder / _trajectory_path(run.case, run.engine, method))
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
        # Whoever was killed may have left half a line: what follows the last line end is no record.
        lines = (folder / RECORDS).read_text("utf-8").split("\n")[:-1]
        header, *records = [json.loads(line) for line in lines]
        if header["record"] != "header" or header["format"] != FORMAT:
            raise ValueError("its first line is no header of this format")
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise BadFolder(f"{folder}: no readable results: {error}") from error
    complete = bool(records) and records[-1]["record"] == "footer"
    return Results(folder, header, tuple(records), complete)


def _trajectory_path(case: str, engine: str, method: Method) -> Path:
    # The name of a method may come from a stranger's case file: quoted, it cannot lead out of the folder.
    name = quote("-".join(filter(None, (engine, method.integrator, f"{method.timestep!r}s"))), safe=" =,")
    return Path(TRAJECTORIES, case, f"{name}.parquet")


def _trajectory(table: pa.Table) -> Trajectory:
    states = np.column_stack([table[name].to_numpy() for name in STATE_COLUMNS])
    return Trajectory(table["t"].to_numpy(), states[:, :3], states[:, 3:7], states[:, 7:10], states[:, 10:])


def _make_room(folder: Path) -> None:
    """An empty place for results: earlier results are replaced, anything else is left alone."""
    if folder.exists() and not folder.is_dir():
        raise BadFolder(f"{folder}: is not a folder")
    if folder.exists() and any(folder.iterdir()) and not (folder / RECORDS).is_file():
        raise BadFolder(f"{folder}: has other things in it than results; give an empty or a new folder")
    shutil.rmtree(folder / TRAJECTORIES, ignore_errors=True)
    (folder / RECORDS).unlink(missing_ok=True)
    folder.mkdir(parents=True, exist_ok=True)
