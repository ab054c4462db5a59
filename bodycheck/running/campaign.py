"""Make the runs of many tasks, and the truths they need, in worker processes, and store them in a results folder."""

import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Protocol

from bodycheck.adapters.contract import Engine
from bodycheck.adapters.offers import demonstrations
from bodycheck.adapters.registry import EngineMissing
from bodycheck.casefile.content import Case
from bodycheck.environments.subprocesses import MEMORY_LIMIT_BYTES
from bodycheck.files.writing import as_utf8
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.requirements import slides
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.results import resumption, store, versions
from bodycheck.results.header import Header
from bodycheck.results.outcome import Completed, Run
from bodycheck.results.store import Results, Writer
from bodycheck.results.unchecked import Unchecked
from bodycheck.results.versions import fingerprint
from bodycheck.running import engines, truths
from bodycheck.running.engines import locks
from bodycheck.running.pairing import Arrivals, Meet, unmet
from bodycheck.running.robot_notices import NO_ROBOTS, Robots
from bodycheck.running.roles import roles_of
from bodycheck.running.tasks import StopTask, Task, Truths, TruthTask, group, perform, perform_stop

#: Time limit (s) of one run or one truth.
TIME_LIMIT_S = 300.0

#: The cases without a method, if every engine has a method for each case.
NOTHING: Mapping[str, dict[str, str]] = {}


class Advance(Protocol):
    """A function that is called with a text about the last completed work, and the number of completed units."""

    def __call__(self, done: str, count: int = 1, /) -> None: ...


def _no_progress(done: str, count: int = 1, /) -> None:
    pass


def header(
    command: Sequence[str],
    records: Mapping[str, Engine],
    missing: Mapping[str, str],
    without_method: Mapping[str, dict[str, str]] = NOTHING,
    robots: Robots = NO_ROBOTS,
) -> Header:
    """Return the header of a results folder: versions, machine, command, and the engines that could not be used.

    records: the records of the engines that are used, by their requested names. missing: the reasons why other engines cannot
    be used, by name. without_method: the cases for which an engine has no method, with reasons, by the names of engines; see
    `bodycheck.running.plan.without_method`. robots: what is said of the cases with robots' files.
    """
    return {
        "bodycheck": version("bodycheck"),
        "command": [as_utf8(word) for word in command],
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
        "machine": fingerprint(),
        "packages": versions.packages(),
        "engines": {name: record.version for name, record in records.items()},
        "missing": dict(missing),
        "environments": locks(records),
        "demonstrations": {name: offered for name, record in records.items() if (offered := demonstrations(record))},
        "precisions": {name: record.precision for name, record in records.items()},
        "defaults": {name: dict(record.defaults) for name, record in records.items()},
        "soft": {name: dict(record.soft) for name, record in records.items() if record.soft},
        "without_method": dict(without_method),
        "robots": {name: list(sentences) for name, sentences in robots.sentences.items()},
        "departures": dict(robots.departures),
    }


@contextmanager
def results(
    tasks: Sequence[Task],
    folder: Path,
    head: Header,
    jobs: int = 1,
    limit: float = TIME_LIMIT_S,
    memory: int = MEMORY_LIMIT_BYTES,
    progress: Advance = _no_progress,
    unchecked: Sequence[Unchecked] = (),
    files: Mapping[str, Path] = store.NO_FILES,
    meet: Meet = unmet,
    known: Mapping[str, Mapping[float, Truth]] = NO_ROBOTS.truths,
) -> Iterator[Results]:
    """Make all runs and the truths they need, write each as it finishes, and provide the results.

    If the same work was interrupted in the folder, it is resumed, and finished parts are not repeated. The work counts as
    interrupted until the context ends, so that the caller's work with the results is part of it.

    Parameters
    ----------
    tasks
        The runs to make.
    folder
        The folder for the results.
    head
        The header of the results.
    jobs
        The number of processes.
    limit, memory
        The time limit (s) and the memory limit (bytes) of one run or truth.
    progress
        A function that is called after each run and each truth. A run counts as done when its truth exists too.
    unchecked
        The expectations of the cases that no run can check.
    files
        The files of the cases that are not shipped, by the name of the case.
    meet
        A function that is called with the truth and a completed run, for each run that is made here while the truth of its case
        is in memory.
    known
        Truths that were computed before, by the name of the case and by sampling.

    Raises
    ------
    BadFolder
        If the folder contains other files.
    BadJournal
        If another process is writing to the folder.
    """
    cases = {task.case.name: task.case for task in tasks}
    indices = {task: index for index, task in enumerate(tasks)}
    identity = _identity(tasks, head, limit, memory)
    with Writer(folder, head, identity, tuple(cases.values()), unchecked, files) as writer:
        everything: list[TruthTask | Task] = [*_truth_tasks(tasks), *tasks]
        left = [task for task in everything if _missing(writer, task)]
        count = _Count(tasks, left, writer, progress)
        if writer.resumed:
            print(
                f"bodycheck: resuming the interrupted run in {folder}: {count.done} of {len(tasks)} are done", file=sys.stderr
            )
            progress("", count.done)
        arrivals = _arrivals(meet, writer, left)
        with pool.Workers(perform, jobs, limit, memory, group, engines.home) as workers:
            for task, result in _performed(left, known, workers):
                if isinstance(task, Task):
                    _add_run(writer, arrivals, task, result, indices[task], head["engines"][task.engine])
                    count.add_run(task)
                else:
                    for sampling in _add_truths(writer, arrivals, task, result):
                        count.add_truth(task.case.name, sampling)
        if any(slides(case.scene) for case in cases.values()):
            _add_stops(writer, store.read(folder), cases, jobs, limit, memory, progress)
        yield replace(store.read(folder), complete=True, known=cases)


def _performed(
    tasks: Sequence[TruthTask | Task],
    known: Mapping[str, Mapping[float, Truth]],
    workers: "pool.Workers[TruthTask | Task, Run | Truths]",
) -> Iterator[tuple[TruthTask | Task, Run | Truths | Crashed | TimedOut]]:
    """Yield tasks with their results: first those of known truths, then the others as workers finish them."""
    others = []
    for task in tasks:
        truths_of_case = known.get(task.case.name, {}) if isinstance(task, TruthTask) else {}
        if isinstance(task, TruthTask) and truths_of_case.keys() >= set(task.samplings):
            yield task, dict(truths_of_case)
        else:
            others.append(task)
    yield from workers.map(others)


class _Count:
    """The number of runs that are done, with their truths."""

    def __init__(self, tasks: Sequence[Task], left: Sequence[TruthTask | Task], writer: Writer, progress: Advance) -> None:
        needed = [task for task in left if isinstance(task, TruthTask)]
        self.progress = progress
        self.truths = {(task.case.name, sampling) for task in needed for sampling in _left(writer, task)}
        keys = [(task.case.name, task.method.sampling) for task in tasks if writer.has_run(task.key)]
        self.waiting = Counter(key for key in keys if key in self.truths)
        self.done = len(keys) - self.waiting.total()

    def add_run(self, task: Task) -> None:
        """Count a run, unless its truth is missing."""
        key = task.case.name, task.method.sampling
        waits = key in self.truths
        self.waiting[key] += waits
        self.progress(_name(task), 0 if waits else 1)

    def add_truth(self, case: str, sampling: float) -> None:
        """Count the runs that waited for the truth of a case with a sampling."""
        self.truths.discard((case, sampling))
        which = f"truth {sampling:g} s" if sampling else "truth"
        self.progress(f"{case} · {which}", self.waiting.pop((case, sampling), 0))


def _arrivals(meet: Meet, writer: Writer, tasks: Sequence[TruthTask | Task]) -> Arrivals:
    """Return the object that brings runs and truths together, for tasks with missing results in the folder."""
    runs = [(task.case.name, task.method.sampling) for task in tasks if isinstance(task, Task)]
    needed = [task for task in tasks if isinstance(task, TruthTask)]
    return Arrivals(meet, runs, [(task.case.name, sampling) for task in needed for sampling in _left(writer, task)])


def _add_run(
    writer: Writer, arrivals: Arrivals, task: Task, result: Run | Truths | Crashed | TimedOut, index: int, version: str
) -> None:
    """Write a run at its index in the plan. version: the version of its engine."""
    assert not isinstance(result, dict | NoTruth)  # such a result answers a truth task
    run = (
        result if isinstance(result, Run) else Run(task.case.name, task.engine, version, task.method, result, role=_roles(task))
    )
    writer.add_run(run, index)
    arrivals.add_run(run)


def _roles(task: Task) -> str | None:
    """Return the roles of the method of a run whose process failed; None if the engine cannot be used any more."""
    try:
        return roles_of(engines.record(task.engine), task.case, task.method)
    except EngineMissing:
        return None


def _add_truths(
    writer: Writer, arrivals: Arrivals, task: TruthTask, result: Run | Truths | Crashed | TimedOut
) -> Iterator[float]:
    """Write the truths of a task, or the reason why there are none, and yield the sampling of each written truth.

    Truths that the folder already had are not changed.
    """
    assert not isinstance(result, Run)  # a run is the answer to another task
    for sampling in _left(writer, task):
        truth = result[sampling] if isinstance(result, dict) else no_truth(result)
        if isinstance(truth, NoTruth):
            writer.add_missing_truth(task.case, sampling, truth)
            arrivals.add_truth((task.case.name, sampling), None)
        else:
            writer.add_truth(task.case, sampling, truth)
            arrivals.add_truth((task.case.name, sampling), truth)
        yield sampling


def _add_stops(
    writer: Writer, results: Results, cases: Mapping[str, Case], jobs: int, limit: float, memory: int, progress: Advance
) -> None:
    """Write the missing stops that attribution needs; compute the stops that are not in a truth."""
    stops = [task for task in _stop_tasks(cases, results.runs()) if not writer.has_stop(task.case.name, task.law)]
    left = []
    for task in stops:
        scene = task.case.scene
        stop = results.stop_of(task.case.name) if slides(scene) and scene.plane == task.law else None
        if stop is None:
            left.append(task)
        else:
            writer.add_stop(task.case.name, task.law, stop)
    with pool.Workers(perform_stop, jobs, limit, memory) as workers:
        for task, result in workers.map(left):
            stop, reason = (None, result.reason) if isinstance(result, Crashed | TimedOut) else (result, "")
            writer.add_stop(task.case.name, task.law, stop, reason)
            progress(_name(task), 0)


def no_truth(result: NoTruth | Crashed | TimedOut) -> NoTruth:
    """Return the reason why there is no truth. A computation that was stopped or failed does not count as unsupported."""
    limit = result.limit if isinstance(result, TimedOut | NoTruth) else None
    return NoTruth(f"the reference: {result.reason}", limit, crashed=isinstance(result, Crashed))


def _identity(tasks: Sequence[Task], head: Header, limit: float, memory: int) -> str:
    """Return a digest of everything that determines the results, regardless of the machine and the command."""
    everything = [store.FORMAT, *resumption.versions(head)]
    cases = {task.case.name: task.case for task in tasks}
    return resumption.identity(everything, limit, memory, cases, [task.key for task in tasks])


def _missing(writer: Writer, argument: TruthTask | Task) -> int:
    """Return the number of units of work of a task that the folder does not have yet."""
    return int(not writer.has_run(argument.key)) if isinstance(argument, Task) else len(_left(writer, argument))


def _left(writer: Writer, needed: TruthTask) -> list[float]:
    """Return the samplings whose truths the folder did not have yet when it was opened."""
    return [sampling for sampling in needed.samplings if not writer.has_truth(needed.case.name, sampling)]


def truth_tasks(case: Case, samplings: Iterable[float]) -> Iterator[TruthTask]:
    """Yield the tasks that compute the truths for the runs of a case with some samplings; usually one task."""
    yield from (TruthTask(case, batch) for batch in truths.batches(case, samplings))


def _truth_tasks(tasks: Sequence[Task]) -> tuple[TruthTask, ...]:
    """Return the tasks that compute the needed truths of runs, long computations first, so that none of them runs last."""
    samplings: dict[Case, list[float]] = {}
    for task in tasks:
        samplings.setdefault(task.case, []).append(task.method.sampling)
    ordered = sorted(samplings, key=truths.effort, reverse=True)
    return tuple(needed for case in ordered for needed in truth_tasks(case, samplings[case]))


def _stop_tasks(cases: Mapping[str, Case], runs: Sequence[Run]) -> tuple[StopTask, ...]:
    """Return the tasks for the stops that attribution needs: under the law of the case, and the laws of engines' contacts.

    The tasks are known only after the runs, because an engine reports the law of its contacts in the process of its run.
    """
    tasks: dict[StopTask, None] = {}
    for run in runs:
        case = cases[run.case]
        scene = case.scene
        if slides(scene) and isinstance(run.outcome, Completed):
            tasks |= {StopTask(case, law): None for law in (scene.plane, run.contact_law) if law is not None}
    return tuple(tasks)


def _name(argument: StopTask | Task) -> str:
    match argument:
        case Task(case, engine, method):
            return f"{case.name} · {engine} {method}"
        case StopTask(case, law):
            return f"{case.name} · stop under the law {law.law}, {law.pressure} pressure"
