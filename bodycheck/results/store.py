"""A results folder: the raw results of runs, from which all figures and reports are computed without new simulations.

`run.jsonl` is a journal with a record of each truth, each run and each stop under a law of friction, written as they finish.
If it has no footer, the work was interrupted. `trajectories/` contains the states. The header contains the texts of the case
files.
"""

from bisect import bisect_left
from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, cast

from bodycheck.casefile.case import Case, parse_stored
from bodycheck.errors import BadFolder
from bodycheck.figures.definition import Load
from bodycheck.figures.revisions import REVISIONS
from bodycheck.files import reading
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.bounds import NAMES
from bodycheck.reference.mechanisms.kinematics import joints
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.planar import Stop
from bodycheck.reference.scene import Plane
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.results import journal, records, sensor_files, trajectory_files, truth_records
from bodycheck.results.header import LATER, Header, StoredHeader, stored_case
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import NO_STEP, Completed, Diverged, Run, Unsupported
from bodycheck.results.sensor_files import StoredSensed, of_steps
from bodycheck.results.trajectory_files import StoredTrajectory, run_path, truth_path
from bodycheck.results.unchecked import Unchecked

#: Version of the format of results folders.
FORMAT = 1
#: The file with the records.
RECORDS = "run.jsonl"
#: The files of the cases if all cases are shipped.
NO_FILES: Mapping[str, Path] = {}


class Writer:
    """Writer of a results folder. It is a context manager, which writes the footer at a regular end of the context.

    If the same work was interrupted in the folder, as shown by the `identity` in the header, it is continued. What crashed or
    exceeded a limit is repeated. Any other results are replaced.
    """

    def __init__(
        self,
        folder: Path,
        header: Header,
        identity: str,
        cases: tuple[Case, ...],
        unchecked: Sequence[Unchecked] = (),
        files: Mapping[str, Path] = NO_FILES,
    ) -> None:
        _refuse_other_things(folder)
        texts = [stored_case(case, files.get(case.name)) for case in cases]
        contents = {"cases": texts, "unchecked": [asdict(one) for one in unchecked], "revisions": REVISIONS}
        self.folder = folder
        self.journal = journal.resume(
            folder / RECORDS,
            {"format": FORMAT, **header, "identity": identity, **contents},
            renewed=("unchecked",),
            lost=records.is_lost,
        )
        there = self.journal.records
        self.stops = {_law_of(record) for record in there if record["record"] == "stop"}
        by_name = {case.name: case for case in cases}
        self.done = {_path_of(record) for record in there if record["record"] != "stop" and _is_stored(folder, record, by_name)}
        trajectory_files.remove_all_but({*self.done, *map(of_steps, self.done)}, folder)

    def __enter__(self) -> "Writer":
        self.journal.__enter__()
        return self

    def __exit__(self, *exit: Any) -> None:
        self.journal.__exit__(*exit)

    def has_truth(self, case: str, timestep: float) -> bool:
        """Return whether the folder already had the truth of a case for a time step (s), or that the reference has none."""
        return truth_path(case, timestep) in self.done

    @property
    def resumed(self) -> bool:
        """True if the folder already had results of the same work."""
        return bool(self.journal.records)

    def has_run(self, key: RunKey) -> bool:
        """Return whether the folder already had a run that neither crashed nor exceeded a limit."""
        return run_path(key.case, key.engine, key.method.name, key.method.timestep) in self.done

    def has_stop(self, case: str, law: Plane) -> bool:
        """Return whether the folder already had a record of the stop of a case under a law of friction."""
        return (case, law) in self.stops

    def add_truth(self, case: Case, timestep: float, truth: Truth) -> None:
        """Write the truth for the runs of a case with a time step (s)."""
        bounds = {
            column: getattr(truth.bounds, name) for column, name in zip(trajectory_files.BOUND_COLUMNS, NAMES, strict=True)
        }
        if truth.growth is not None:
            bounds[trajectory_files.GROWTH_COLUMN] = truth.growth
        trajectory_files.write(self.folder, truth_path(case.name, timestep), truth.trajectory, bounds, _bodies(truth.scene))
        self.journal.add({"record": "truth", "case": case.name, "timestep": timestep, **truth_records.told(truth)})

    def add_missing_truth(self, case: Case, timestep: float, missing: NoTruth) -> None:
        """Record the reason why there is no truth for the runs of a case with a time step (s)."""
        self.journal.add({"record": "truth", "case": case.name, "timestep": timestep, **asdict(missing)})

    def add_run(self, run: Run, place: int) -> None:
        """Write a run. `place` is its position in the plan, which determines the order of all tables."""
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
            "role": run.role,
        }
        match run.outcome:
            case Completed() as done:
                record |= _write(self.folder, _path_of(record), run, done)
                load = asdict(done.load) if done.load is not None else None
                record |= {"steps": done.steps, "wall_time": done.wall_time, "load": load}
                record |= {name: getattr(done, name) for name in ("quaternion_norm_error", "rejected", "evaluations")}
                record |= {name: text for name in ("efforts", "contact_terms") if (text := getattr(done, name))}
                if done.interfaces is not None:
                    record |= {"interfaces": [asdict(one) for one in done.interfaces]}
            case TimedOut(limit):
                record |= {"limit": limit}
            case outcome:
                record |= {"reason": outcome.reason}
        self.journal.add(record)

    def add_stop(self, case: str, law: Plane, stop: Stop | None, reason: str = "") -> None:
        """Record the stop of a case's body under a law of friction on its plane.

        Parameters
        ----------
        case
            Name of the case.
        law
            The plane with the law of friction.
        stop
            Where and when the body stops; None if it does not stop, or if the reference has no truth under this law.
        reason
            The reason why there is no stop, if the computation failed.
        """
        record = {"record": "stop", "case": case, "law": asdict(law), "stop": None if stop is None else asdict(stop)}
        self.journal.add(record | ({"reason": reason} if reason else {}))


@dataclass(frozen=True)
class Results:
    """The contents of a results folder.

    Attributes
    ----------
    folder
        The folder.
    header
        Versions, machine and command.
    records
        The records of truths, runs and stops.
    complete
        Whether the work was completed.
    known
        Known cases by name. A case with the same text is taken from here, instead of being read from its text again.
    """

    folder: Path
    header: StoredHeader
    records: tuple[dict[str, Any], ...]
    complete: bool
    known: Mapping[str, Case] = field(default_factory=dict, repr=False, compare=False, kw_only=True)

    @cached_property
    def cases(self) -> dict[str, Case]:
        """The cases that were run, by name. Raises `CaseFaults` or `BadFolder` if their texts are damaged."""
        cases = {entry["name"]: self._case(entry["name"], entry["text"]) for entry in self.header["cases"]}
        for name, case in cases.items():
            if case.name != name:
                raise BadFolder(f"{self.folder}: damaged: the case {name} is called {case.name} in its own text")
        return cases

    def only(self, names: Collection[str]) -> "Results":
        """Return the results restricted to the cases with some names."""
        header = self.header | {
            "cases": [entry for entry in self.header["cases"] if entry["name"] in names],
            "unchecked": [entry for entry in self.header.get("unchecked", ()) if entry["case"] in names],
        }
        kept = tuple(record for record in self.records if record["case"] in names)
        return replace(self, header=header, records=kept)

    @cached_property
    def files(self) -> dict[str, str]:
        """The paths from which cases were read, as they were given, by the name of the case; shipped cases have none."""
        return {entry["name"]: file for entry in self.header["cases"] if (file := entry.get("file", ""))}

    @property
    def packages(self) -> dict[str, tuple[Path, ...]]:
        """The folders of packages in which files of robots were found, by the name of the case, where the user named any."""
        named = {entry["name"]: tuple(map(Path, entry.get("packages", ()))) for entry in self.header["cases"]}
        return {name: packages for name, packages in named.items() if packages}

    @cached_property
    def unchecked(self) -> tuple[Unchecked, ...]:
        """The expectations that no run could check, because their engines cannot be used."""
        return tuple(Unchecked(**entry) for entry in self.header.get("unchecked", ()))

    def runs(self) -> Sequence[Run]:
        """Return all runs in the order of the plan; their trajectories are read from disk whenever they are needed."""
        return self._runs

    def run(self, key: RunKey) -> Run | None:
        """Return the run with a key, or None if there is none; its time step may differ by rounding."""
        steps, runs = self._by_method.get(key.over_steps, ((), ()))
        index = bisect_left(steps, key.method.timestep)
        near = range(max(index - 1, 0), min(index + 1, len(steps)))
        return next((runs[at] for at in near if key.method.is_at(steps[at])), None)

    def truth(self, case: str, timestep: float) -> Truth | NoTruth:
        """Return the truth for the runs of a case with a time step (s), read from disk, or the reason for its absence.

        Raises `BadFolder` if its file is missing or damaged.
        """
        record = self._truths.get((case, timestep))
        if record is None:
            return NoTruth("the reference was interrupted")
        if "reason" in record:
            # Earlier versions recorded only the reason.
            return NoTruth(record["reason"], record.get("limit"), record.get("crashed", False))
        scene = self.cases[case].scene
        trajectory, bounds, growth = trajectory_files.read_truth(self.folder / _path_of(record), _bodies(scene))
        moved = joints(scene, trajectory) if isinstance(scene, Mechanism) else None
        return Truth(scene, trajectory, bounds, **truth_records.ways(record), joints=moved, growth=growth)

    def ways(self, case: str, timestep: float) -> dict[str, Any] | None:
        """Return how the truth for the runs of a case with a time step (s) was found, without reading its trajectory.

        The result contains the attributes of `Truth` other than scene, trajectory and bounds, by name; None if there is no
        truth.
        """
        record = self._truths.get((case, timestep), {"reason": ""})
        return None if "reason" in record else truth_records.ways(record)

    def stop_of(self, case: str) -> Stop | None:
        """Return where and when the body of a case stops, from its truths; None if it still moves at their ends."""
        records = [record for (name, _), record in self._truths.items() if name == case]
        return next((truth_records.stop(record["stop"]) for record in records if record.get("stop") is not None), None)

    @cached_property
    def stops(self) -> dict[tuple[str, Plane], Stop | None]:
        """The stop of the body of a case under a law of friction, by the case's name and the plane with the law.

        An entry is None if the reference finds no stop. Interrupted results lack some entries, and results of earlier versions
        all.
        """
        return {_law_of(record): truth_records.stop(record["stop"]) for record in self.records if record["record"] == "stop"}

    def _case(self, name: str, text: str) -> Case:
        case = self.known.get(name)
        return case if case is not None and case.text == text else parse_stored(text, name)

    @cached_property
    def _truths(self) -> dict[tuple[str, float], dict[str, Any]]:
        """The records of the truths by case and time step (s)."""
        return {(record["case"], record["timestep"]): record for record in self.records if record["record"] == "truth"}

    @cached_property
    def _runs(self) -> tuple[Run, ...]:
        runs = [record for record in self.records if record["record"] == "run"]
        return tuple(self._run_of(record) for record in sorted(runs, key=lambda record: int(record["place"])))

    @cached_property
    def _by_method(self) -> dict[RunKey, tuple[list[float], list[Run]]]:
        """The time steps (s) of each method on each case, in ascending order, with the runs."""
        runs_by_method: dict[RunKey, list[Run]] = defaultdict(list)
        for run in sorted(self._runs, key=lambda run: run.method.timestep):
            runs_by_method[run.key.over_steps].append(run)
        return {key: ([run.method.timestep for run in runs], runs) for key, runs in runs_by_method.items()}

    def _run_of(self, record: dict[str, Any]) -> Run:
        key = RunKey.of_row(record)
        law = record["contact_law"]
        scene = self.cases[key.case].scene
        plane = Plane(**law) if law else None
        run = Run(key.case, key.engine, record["version"], key.method, Unsupported(""), plane, scene, record.get("role"))
        run = replace(run, sensors=self.cases[key.case].sensors)
        match record["status"]:
            case Completed.status if record["steps"] == 0:  # earlier versions called this a completed run
                return replace(run, outcome=NO_STEP)
            case Completed.status:
                states = StoredTrajectory(self.folder / _path_of(record), _bodies(scene))
                load = Load(**record["load"]) if record["load"] else None
                norm_error = record.get("quaternion_norm_error")  # results of earlier versions have none
                loads = truth_records.loads(record)
                done = Completed(states, record["steps"], record["wall_time"], load, norm_error, loads)
                # Results of earlier versions have none of these.
                later = ("rejected", "evaluations", "efforts", "contact_terms")
                work = {name: record[name] for name in later if name in record}
                return replace(run, outcome=replace(done, readings=self._readings_of(record), **work))
            case TimedOut.status:
                return replace(run, outcome=TimedOut(record["limit"]))
            case status:
                kind = {kind.status: kind for kind in (Unsupported, Diverged, Crashed)}[status]
                return replace(run, outcome=kind(record["reason"]))

    def _readings_of(self, record: dict[str, Any]) -> StoredSensed | None:
        """Return the stored readings of a completed run; None if it has none, as in results of earlier versions."""
        lacking, case = record.get("sensors"), self.cases[record["case"]]
        if lacking is None:
            return None
        if len(lacking) != len(case.sensors):
            raise BadFolder(f"{self.folder}: damaged: a run of {case.name} has {len(lacking)} sensors, not {len(case.sensors)}")
        return StoredSensed(self.folder / _path_of(record), _bodies(case.scene), case.sensors, tuple(lacking))


def read(folder: Path) -> Results:
    """Read the results in a folder. Raises `BadFolder` if they are missing or damaged."""
    try:
        contents = journal.read(folder / RECORDS)
        if contents.header.get("format") != FORMAT:
            raise ValueError(f"its format is {contents.header.get('format')!r}, not {FORMAT}")
        _check(contents.header, contents.records)
        # If a run was repeated because its trajectory was lost, its later record is valid.
        latest = {_identity_of(record): record for record in contents.records}
    except (journal.BadJournal, ValueError) as error:
        raise BadFolder(f"{folder}: no readable results: {error}") from error
    return Results(folder, cast(StoredHeader, LATER | contents.header), tuple(latest.values()), contents.complete)


def _check(header: dict[str, Any], entries: Sequence[dict[str, Any]]) -> None:
    """Raise `ValueError` unless the header and the records of a results folder have the required contents."""
    records.typed(records.HeaderRecord, header)
    names = {case.name for case in records.typed(records.CasesRecord, header).cases}
    for record in entries:
        records.check(record)
        if record["case"] not in names:
            raise ValueError(f"a {record['record']} of the case {record['case']!r}, which the header does not contain")


def _identity_of(record: dict[str, Any]) -> Path | tuple[str, Plane]:
    """Return the subject of a record; of two records about the same subject, the later is valid."""
    return _law_of(record) if record["record"] == "stop" else _path_of(record)


def _law_of(record: dict[str, Any]) -> tuple[str, Plane]:
    """Return the case and the law of friction in the record of a stop."""
    return record["case"], Plane(**record["law"])


def _bodies(scene: AnyScene | None) -> tuple[str, ...]:
    """Return the names of the bodies of a mechanism; empty for any other scene."""
    return tuple(body.name for body in scene.bodies) if isinstance(scene, Mechanism) else ()


def _path_of(record: dict[str, Any]) -> Path:
    """Return the path of a record's trajectory, whose name contains the spelling of the method at the time of writing."""
    if record["record"] == "truth":
        return truth_path(record["case"], record["timestep"])
    return run_path(record["case"], record["engine"], record["integrator"], record["timestep"])


def _write(folder: Path, path: Path, run: Run, done: Completed) -> dict[str, Any]:
    """Write the states of a completed run and the readings of its sensors, and return the entries of its record on them."""
    bodies, sensed = _bodies(run.scene), done.sensed
    if sensed is None:
        trajectory_files.write(folder, path, done.trajectory, {}, bodies)
        return {}
    sensor_files.write(folder, path, done.trajectory, sensed, run.sensors, bodies)
    return {"sensors": list(sensed.lacking)}


def _is_stored(folder: Path, record: dict[str, Any], cases: Mapping[str, Case]) -> bool:
    """Return whether the trajectory of a record can be read, with its readings; True if the record has none. cases: by name."""
    if "reason" in record or record.get("status", Completed.status) != Completed.status:
        return True
    case, file = cases[record["case"]], folder / _path_of(record)
    if record.get("sensors") is None:
        return trajectory_files.is_readable(file, _bodies(case.scene))
    return sensor_files.is_readable(file, _bodies(case.scene), case.sensors)


def _refuse_other_things(folder: Path) -> None:
    """Raise `BadFolder` for a path that is no folder, and for a folder that contains links or files other than results."""
    if folder.exists() and not folder.is_dir():
        raise BadFolder(f"{folder}: is not a folder")
    if reading.names_in(folder) and not (folder / RECORDS).is_file():
        raise BadFolder(f"{folder}: contains files that are not results; give an empty or a new folder")
    reading.refuse_links(folder)
