"""Logs: motions of a case that somebody recorded, such as in another simulator or on a real robot, as CSV files.

`read` returns the motion in a log as a run, and `results` compares it with the truth. The first line of a log names the
columns, and each other line has the state at one instant. The file may come from a stranger: it is data, and its size is
bounded.
"""

import csv
import io
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from bodycheck.adapters.contract import Method
from bodycheck.casefile.case import MAX_FAULTS
from bodycheck.casefile.content import Case
from bodycheck.errors import BadInput
from bodycheck.files import reading
from bodycheck.files.temporary import temporary_folder
from bodycheck.processes import pool
from bodycheck.reference.certified import Certificate
from bodycheck.reference.kinematics import normalise
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.coordinates import COORDINATES, JointMotion
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array, Trajectory, stacked
from bodycheck.reference.truths import Truth
from bodycheck.results import resumption, store
from bodycheck.results.outcome import RECORDED, Completed, Run
from bodycheck.results.store import Results, Writer
from bodycheck.results.trajectory_files import OF_BODY
from bodycheck.running import campaign, engines, tasks
from bodycheck.running.truths import MAX_INSTANTS
from bodycheck.suggestion import first_names

#: The columns of a pose: position of the centre of mass (m, world), and quaternion w x y z from body to world.
POSE = ("px", "py", "pz", "qw", "qx", "qy", "qz")

#: The columns of a velocity (m/s, world), and of an angular velocity (rad/s, along the axes of the body).
VELOCITY, ANGULAR_VELOCITY = ("vx", "vy", "vz"), ("wx", "wy", "wz")

#: The column of the instants (s).
TIME = "t"

#: The column with the names of bodies in a file with a line for each body at each instant, and the names of columns there that
#: differ: those that scripts of `bodycheck export` print.
BODY, OF_SCRIPTS = "body", {"x": "px", "y": "py", "z": "pz"}

#: The largest size of a file in bytes. Its largest number of instants is that of a truth.
MAX_BYTES = 1 << 28

#: The largest deviation of the length of a quaternion from 1.
NORM = 0.01

#: The largest deviation of an instant from the end of the case (relative), by the rounding of a log.
ROUNDED = 1e-9


@dataclass(frozen=True, eq=False)
class Recording:
    """A recorded motion of a case.

    Attributes
    ----------
    run
        The motion as a completed run. Velocities that the file lacks are NaN.
    notes
        Sentences about what of the file was not used, and about its end.
    """

    run: Run
    notes: tuple[str, ...]


def read(path: Path, case: Case, engine: str, version: str) -> Recording:
    """Return the motion of a case in a CSV file.

    Parameters
    ----------
    path
        The file, with the column `t` and, for a body, the columns of `POSE`, and, if they are known, of `VELOCITY` and
        `ANGULAR_VELOCITY`. For bodies of a mechanism, the name of the body and a point precede each name, or the column `body`
        names the body, with a line for each at each instant, as scripts of `bodycheck export` print it. Joints with one
        coordinate may have `JOINT.position` and `JOINT.velocity` instead (rad and rad/s, or m and m/s).
    case
        The case.
    engine, version
        What recorded the motion.

    Raises
    ------
    BadInput
        If the file cannot be read, lacks a column, or has a value that is not allowed. The text gives the line and the column.
    """
    columns = columns_of(path)
    t, columns, notes = within(path, columns, case.duration)
    used, trajectory = _trajectory(path, columns, t, case)
    if unused := sorted(columns.keys() - used - {TIME}):
        notes = (f"{path}: columns that are not used: {_listed(unused)}", *notes)
    lengths = np.linalg.norm(trajectory.quaternion, axis=-1)
    norm_error = float(np.abs(lengths - 1).max())
    trajectory = replace(trajectory, quaternion=normalise(trajectory.quaternion))
    timestep = float(f"{(t[-1] - t[0]) / (len(t) - 1):.9g}")
    outcome = Completed(trajectory, len(t) - 1, 0.0, quaternion_norm_error=norm_error)
    return Recording(Run(case.name, engine, version, Method(RECORDED, timestep), outcome, scene=case.scene), notes)


@contextmanager
def results(run: Run, case: Case, folder: Path | None, command: Sequence[str], files: Mapping[str, Path]) -> Iterator[Results]:
    """Compute the truth of a case at the instants of a recorded run, store both as results, and provide these.

    Parameters
    ----------
    run
        The recorded run.
    case
        The case.
    folder
        The folder for the results; None for a temporary folder.
    command
        The words of the command, for the header.
    files
        The file of the case by its name, unless the case is shipped.

    Raises
    ------
    BadFolder
        If the folder contains other files.
    """
    assert isinstance(run.outcome, Completed)  # as `read` returns it
    head = campaign.header(command, {}, {}) | {"engines": {run.engine: run.version}, "precisions": {run.engine: "float64"}}
    t = run.outcome.trajectory.t
    with ExitStack() as stack:
        results_folder = folder or stack.enter_context(temporary_folder())
        identity = resumption.identity(case.text, run.key, run.version, t.tobytes(), datetime.now(UTC))
        with Writer(results_folder, head, identity, (case,), files=files) as writer:
            with pool.Workers(tasks.answer, 1, campaign.TIME_LIMIT_S, home=engines.home) as workers:
                truth = workers.call(tasks.Question(case, tuple(t.tolist()), certified=False))
            assert not isinstance(truth, Certificate)  # the question does not ask for one
            timestep = run.method.timestep
            if isinstance(truth, Truth):
                writer.add_truth(case, timestep, truth)
            else:
                writer.add_missing_truth(case, timestep, campaign.no_truth(truth))
            writer.add_run(run, 0)
        yield replace(store.read(results_folder), complete=True, known={case.name: case})


def no_faults(names: Sequence[str]) -> list[str]:
    """Return no fault of the names of columns."""
    return []


def columns_of(path: Path, faults_of: Callable[[Sequence[str]], list[str]] = no_faults, fewest: int = 2) -> dict[str, Array]:
    """Return the columns of a file by their names; all numbers are finite. Raises `BadInput` with all faults of the file.

    faults_of: returns the faults of the names of the columns, which are reported together with those of the numbers. fewest:
    the fewest instants.
    """
    try:
        text = reading.content(path, MAX_BYTES, follow=True).decode("utf-8-sig")
    except reading.Refused as error:
        raise BadInput(f"{path}: {error.reason}") from error
    except UnicodeDecodeError as error:
        raise BadInput(f"{path}: is not UTF-8: {error.reason}") from error
    except OSError as error:
        raise BadInput(f"{path}: cannot be read: {error.strerror}") from error
    rows = csv.reader(io.StringIO(text))
    try:
        names = [name.strip() for name in next(rows, [])]
        names = names if "px" in names else [OF_SCRIPTS.get(name, name) for name in names]
        if len(set(names)) != len(names) or TIME not in names:
            raise BadInput(f"{path}:1: read {', '.join(names)[:200]!r}; allowed: different names of columns, among them t")
        of_body = names.index(BODY) if BODY in names else None
        bodies, values, faults = list[str](), list[list[float]](), [f"1: {fault}" for fault in faults_of(names)]
        for row in filter(None, rows):
            numbers, wrong = _numbers(rows.line_num, names, row)
            values.append(numbers)
            faults += wrong
            bodies += [] if of_body is None or wrong else [row[of_body]]
            if len(faults) > MAX_FAULTS:
                break
    except csv.Error as error:
        raise BadInput(f"{path}:{rows.line_num}: is no CSV: {error}") from error
    _refuse(path, faults)
    instants = len(values) // max(1, len(set(bodies)))
    if not fewest <= instants <= MAX_INSTANTS:
        raise BadInput(f"{path}: has {instants} instants; allowed: {fewest} to {MAX_INSTANTS}")
    columns = dict(zip((name for name in names if name != BODY), np.array(values).T, strict=True))
    return columns if of_body is None else _of_bodies(path, columns, bodies, instants)


def _of_bodies(path: Path, columns: Mapping[str, Array], bodies: Sequence[str], instants: int) -> dict[str, Array]:
    """Return columns with one line for each instant, of a file with a line for each body at each instant. Raises `BadInput`."""
    names = bodies[: len(bodies) // instants]
    tables = {name: values.reshape(-1, len(names)) for name, values in columns.items() if len(values) == instants * len(names)}
    if len(set(names)) != len(names) or list(bodies) != [*names] * instants or TIME not in tables:
        raise BadInput(f"{path}: its bodies differ from instant to instant; allowed: a line for each body, in the same order")
    if (tables[TIME] != tables[TIME][:, :1]).any():
        raise BadInput(f"{path}: t differs among bodies; allowed: a line for each body at each instant")
    of_bodies = {
        f"{body}{OF_BODY}{name}": table[:, index]
        for name, table in tables.items()
        for index, body in enumerate(names)
        if name != TIME
    }
    return {TIME: tables[TIME][:, 0], **of_bodies}


def _numbers(line: int, names: Sequence[str], row: Sequence[str]) -> tuple[list[float], list[str]]:
    """Return the numbers of a line, and its faults."""
    if len(row) != len(names):
        return [], [f"{line}: has {len(row)} values; allowed: {len(names)}, as many as the first line has names"]
    numbers, faults = [], []
    for name, entry in zip(names, row, strict=True):
        if name == BODY:
            continue
        try:
            number = float(entry)
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            faults.append(f"{line}: {name}: read {entry[:40]!r}; allowed: a finite number")
        numbers.append(number)
    return numbers, faults


def _refuse(path: Path, faults: Sequence[str]) -> None:
    """Raise `BadInput` if a file has faults, each of which begins with its line: with the first ones, each on a line."""
    if faults:
        more = [f"{path}: has more faults"] if len(faults) > MAX_FAULTS else []
        raise BadInput("\n".join([*(f"{path}:{fault}" for fault in faults[:MAX_FAULTS]), *more]))


def within(path: Path, columns: Mapping[str, Array], duration: float) -> tuple[Array, dict[str, Array], tuple[str, ...]]:
    """Return the instants of a file within the duration of the case (s), the columns there, and notes. Raises `BadInput`."""
    t = columns[TIME]
    if t[0] < 0 or not (np.diff(t) > 0).all():
        line = 2 if t[0] < 0 else int(np.argmax(np.diff(t) <= 0)) + 3
        raise BadInput(f"{path}:{line}: t: read {t[line - 2]:.12g}; allowed: ascending numbers of at least 0 s")
    kept = t <= duration * (1 + ROUNDED)
    if kept.sum() < 2:
        raise BadInput(f"{path}: has fewer than 2 instants within the duration of the case, {duration:.12g} s")
    notes = []
    if after := int((~kept).sum()):
        notes.append(f"{path}: {after} instants after the end of the case at {duration:.12g} s are not used")
    elif t[-1] < duration * (1 - ROUNDED):
        notes.append(f"{path}: ends at {t[-1]:.12g} s, before the end of the case at {duration:.12g} s")
    return t[kept], {name: values[kept] for name, values in columns.items()}, tuple(notes)


def _trajectory(path: Path, columns: Mapping[str, Array], t: Array, case: Case) -> tuple[set[str], Trajectory]:
    """Return the names of the columns that are used, and the states of all bodies. Raises `BadInput`."""
    scene = case.scene
    if not isinstance(scene, Mechanism):
        _require(path, columns, POSE)
        return _named("", (*POSE, *VELOCITY, *ANGULAR_VELOCITY)), _state(path, columns, "", t)
    prefixes = [f"{body.name}{OF_BODY}" for body in scene.bodies]
    lacking = [f"{prefix}{name}" for prefix in prefixes for name in POSE if f"{prefix}{name}" not in columns]
    if not lacking:
        used = set().union(*(_named(prefix, (*POSE, *VELOCITY, *ANGULAR_VELOCITY)) for prefix in prefixes))
        return used, stacked(t, [_state(path, columns, prefix, t) for prefix in prefixes])
    if not any(f"{joint.name}{OF_BODY}position" in columns for joint in scene.joints):
        raise BadInput(f"{path}: lacks the columns {_listed(lacking)}; allowed instead: JOINT.position of every joint")
    return _of_joints(path, columns, t, scene)


def _of_joints(path: Path, columns: Mapping[str, Array], t: Array, scene: Mechanism) -> tuple[set[str], Trajectory]:
    """Return the names of used columns, and the states of the bodies of a mechanism whose joints were recorded."""
    for joint in scene.joints:
        if COORDINATES[joint.type] > 1:
            what = f"{joint.name}, a {joint.type} joint, has several coordinates"
            raise BadInput(f"{path}: {what}; allowed: the poses of all bodies, BODY.px to BODY.qz")
    moving = [joint for joint in scene.joints if COORDINATES[joint.type]]
    free = [body for body, joint in zip(scene.bodies, scene.joint_of, strict=True) if joint is None]
    needed = [f"{joint.name}{OF_BODY}position" for joint in moving]
    _require(path, columns, (*needed, *(f"{body.name}{OF_BODY}{name}" for body in free for name in POSE)))
    unknown = np.full(len(t), np.nan)
    rates = [columns.get(f"{joint.name}{OF_BODY}velocity", unknown) for joint in moving]
    joints = JointMotion(_table([columns[name] for name in needed], len(t)), _table(rates, len(t)))
    states = [_state(path, columns, f"{body.name}{OF_BODY}", t) for body in free]
    used = {*needed, *(f"{joint.name}{OF_BODY}velocity" for joint in moving)}
    used |= set().union(*(_named(f"{body.name}{OF_BODY}", (*POSE, *VELOCITY, *ANGULAR_VELOCITY)) for body in free))
    return used, kinematics.bodies(scene, joints, stacked(t, states) if free else None, t)


def _state(path: Path, columns: Mapping[str, Array], prefix: str, t: Array) -> Trajectory:
    """Return the states of one body; velocities that are missing are NaN. Raises `BadInput` for a part of a velocity."""
    unknown = np.full((len(t), 3), np.nan)
    velocities = []
    for names in (VELOCITY, ANGULAR_VELOCITY):
        there = [f"{prefix}{name}" in columns for name in names]
        if any(there):
            _require(path, columns, [f"{prefix}{name}" for name in names])
        velocities.append(np.stack([columns[f"{prefix}{name}"] for name in names], axis=-1) if any(there) else unknown)
    pose = np.stack([columns[f"{prefix}{name}"] for name in POSE], axis=-1)
    wrong = np.abs(np.linalg.norm(pose[:, 3:], axis=-1) - 1) > NORM
    if wrong.any():
        line = int(np.argmax(wrong)) + 2
        length = float(np.linalg.norm(pose[line - 2, 3:]))
        raise BadInput(f"{path}:{line}: {prefix}qw to {prefix}qz: read a quaternion of length {length:.6g}; allowed: length 1")
    return Trajectory(t, pose[:, :3], pose[:, 3:], *velocities)


def _table(columns: Sequence[Array], count: int) -> Array:
    return np.stack(columns, axis=-1) if columns else np.zeros((count, 0))


def _named(prefix: str, names: Iterable[str]) -> set[str]:
    return {f"{prefix}{name}" for name in names}


def _require(path: Path, columns: Mapping[str, Array], names: Iterable[str]) -> None:
    """Raise `BadInput` if a file lacks one of the columns."""
    if lacking := [name for name in names if name not in columns]:
        raise BadInput(f"{path}: lacks the columns {_listed(lacking)}; it has: {_listed(list(columns))}")


def _listed(names: Sequence[str]) -> str:
    return ", ".join(first_names(names))
