"""Many runs at once: tasks in, a results folder out."""

import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from typing import Protocol

from bodycheck.casefile.case import Case
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.planar import Stop
from bodycheck.reference.scene import Plane
from bodycheck.reference.truth import NoTruth, Truth
from bodycheck.running import pool, store
from bodycheck.running.header import Header
from bodycheck.running.machine import fingerprint
from bodycheck.running.outcome import Completed, Crashed, Run, TimedOut
from bodycheck.running.plan import Task
from bodycheck.running.simulation import run, sampling_steps
from bodycheck.running.store import Results, Writer
from bodycheck.running.truths import stop_under, truth

#: Seconds that one run, or one truth, may take.
TIME_LIMIT = 300.0


class Advance(Protocol):
    """Is called with a word on what has just been done, and how many things that was."""

    def __call__(self, done: str, count: int = 1, /) -> None: ...


def _silent(done: str, count: int = 1, /) -> None:
    pass


@dataclass(frozen=True)
class TruthTask:
    """The truth that the runs of a case with one time step (s) are held against."""

    case: Case
    timestep: float


@dataclass(frozen=True)
class StopTask:
    """The stop of the body of a case if a law of friction acts on its plane."""

    case: Case
    law: Plane


def header(command: Sequence[str], engines: Mapping[str, str], missing: Mapping[str, str]) -> Header:
    """What a results folder says of itself: versions, machine, command; engines that could not be used, and why."""
    packages = ("numpy", "scipy", "pandas", "pyarrow")
    return {
        "bodycheck": version("bodycheck"),
        "command": list(command),
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
        "machine": fingerprint(),
        "packages": {package: version(package) for package in packages},
        "engines": dict(engines),
        "missing": dict(missing),
    }


def size(tasks: Sequence[Task]) -> int:
    """How many things there are to do for these tasks: the runs, and the truths they need."""
    return len(tasks) + len(_truth_tasks(tasks))


@contextmanager
def results(
    tasks: Sequence[Task],
    folder: Path,
    head: Header,
    jobs: int = 1,
    limit: float = TIME_LIMIT,
    memory: int = pool.MEMORY,
    progress: Advance = _silent,
) -> Iterator[Results]:
    """Run all tasks and the truths they need, in `jobs` processes, write each as it finishes, and give what came out.

    Where the same was interrupted in that folder, it is gone on with: what is there is not done again. What is made of the
    results within the context belongs to the run: it counts as interrupted until that is done too.

    limit (s) and memory (bytes) are those of one run or truth. Raises `BadFolder` for a folder that holds other things,
    `BadJournal` for one that another process is writing.
    """
    cases = tuple({task.case.name: task.case for task in tasks}.values())
    places = {task: place for place, task in enumerate(tasks)}
    identity = _identity(tasks, head, limit, memory)
    with Writer(folder, head, identity, cases) as writer:
        everything: list[TruthTask | Task] = [*_truth_tasks(tasks), *tasks]
        left = [argument for argument in everything if not _is_there(writer, argument)]
        if there := len(everything) - len(left):
            print(
                f"bodycheck: going on with the interrupted run in {folder}: {there} of {len(everything)} are there",
                file=sys.stderr,
            )
            progress("", there)
        with closing(pool.call_all(perform, left, jobs, limit, memory)) as answers:
            for argument, result in answers:
                match argument, result:
                    case Task(), Run():
                        writer.add_run(result, places[argument])
                    case Task(case, engine, method), Crashed() | TimedOut():
                        writer.add_run(Run(case.name, engine, head["engines"][engine], method, result), places[argument])
                    case TruthTask(case, timestep), Truth():
                        writer.add_truth(case, timestep, result)
                    case TruthTask(case, timestep), NoTruth() | Crashed() | TimedOut():
                        writer.add_missing_truth(case, timestep, f"the reference: {result.reason}")
                progress(_name(argument))
        needed = _stop_tasks({case.name: case for case in cases}, store.read(folder).runs())
        stops = [task for task in needed if not writer.has_stop(task.case.name, task.law)]
        with closing(pool.call_all(perform_stop, stops, jobs, limit, memory)) as found:
            for task, stop in found:
                match stop:
                    case Stop() | None:
                        writer.add_stop(task.case.name, task.law, stop)
                    case Crashed() | TimedOut():
                        writer.add_stop(task.case.name, task.law, None, stop.reason)
                progress(_name(task), 0)
        yield replace(store.read(folder), complete=True)


def _identity(tasks: Sequence[Task], head: Header, limit: float, memory: int) -> str:
    """A fingerprint of all that decides on the results, wherever and by whatever command they are made."""
    versions = [store.FORMAT, head["bodycheck"], head["packages"], head["engines"]]
    cases = {task.case.name: task.case for task in tasks}
    plan = [task.key for task in tasks]
    return sha256(repr((versions, limit, memory, cases, plan)).encode("utf-8")).hexdigest()


def _is_there(writer: Writer, argument: TruthTask | Task) -> bool:
    if isinstance(argument, Task):
        return writer.has_run(argument.key)
    return writer.has_truth(argument.case.name, argument.timestep)


def _truth_tasks(tasks: Sequence[Task]) -> tuple[TruthTask, ...]:
    return tuple(dict.fromkeys(TruthTask(task.case, task.method.timestep) for task in tasks))


def _stop_tasks(cases: Mapping[str, Case], runs: Sequence[Run]) -> tuple[StopTask, ...]:
    """The stops that attribution needs: under the law of the case, and under the laws of the engines' contacts.

    They are known after the runs, as an engine tells the law of its contacts in the process of its run.
    """
    found: dict[StopTask, None] = {}
    for made in runs:
        case = cases[made.case]
        if case.scene.plane is not None and isinstance(made.outcome, Completed):
            found |= {StopTask(case, law): None for law in (case.scene.plane, made.contact_law) if law is not None}
    return tuple(found)


def perform_run(task: Task) -> Run:
    """Return the run that is asked for."""
    return run(task.case, task.engine, task.method)


def perform_stop(task: StopTask) -> Stop | None:
    """Return the stop that is asked for, None if the reference knows none."""
    return stop_under(task.case, task.law)


def perform(argument: TruthTask | Task) -> Run | Truth | NoTruth:
    """Return the run or the truth that is asked for; `NoTruth` if the reference has none."""
    if isinstance(argument, Task):
        return perform_run(argument)
    case, timestep = argument.case, argument.timestep
    try:
        return truth(case, sampling_steps(case.instants, timestep) * timestep)
    except (NotModelled, OutOfReach) as error:
        return NoTruth(str(error))


def _name(argument: TruthTask | StopTask | Task) -> str:
    match argument:
        case Task(case, engine, method):
            return f"{case.name} · {engine} {method}"
        case TruthTask(case, timestep):
            return f"{case.name} · truth {timestep:g} s"
        case StopTask(case, law):
            return f"{case.name} · stop under the law {law.law}, {law.pressure} pressure"
