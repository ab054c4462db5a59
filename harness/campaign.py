"""Many runs at once: tasks in, a results folder out."""

import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

from bodycheck import pool
from bodycheck.case import Case
from bodycheck.outcome import Crashed, Run, TimedOut, Unsupported
from bodycheck.plan import Task
from bodycheck.reference.integration import OutOfReach
from bodycheck.reference.truth import NotModelled, Truth
from bodycheck.simulation import sampling_steps, simulate
from bodycheck.store import Writer
from bodycheck.truths import truth

TIME_LIMIT = 300.0
"""Seconds that one run, or one truth, may take."""


@dataclass(frozen=True)
class TruthTask:
    """The truth that the runs of a case with one time step (s) are held against."""

    case: Case
    timestep: float


def header(command: Sequence[str], engines: Mapping[str, str], missing: Mapping[str, str]) -> dict[str, Any]:
    """What a results folder says of itself: versions, machine, command; engines that could not be used, and why."""
    packages = ("numpy", "scipy", "pandas", "pyarrow")
    return {
        "bodycheck": version("bodycheck"),
        "command": list(command),
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
        "machine": {"system": platform.platform(), "processor": platform.machine(), "python": platform.python_version()},
        "packages": {package: version(package) for package in packages},
        "engines": dict(engines),
        "missing": dict(missing),
    }


def size(tasks: Sequence[Task]) -> int:
    """How many things there are to do for these tasks: the runs, and the truths they need."""
    return len(tasks) + len(_truth_tasks(tasks))


def execute(
    tasks: Sequence[Task],
    folder: Path,
    head: dict[str, Any],
    jobs: int = 1,
    limit: float = TIME_LIMIT,
    progress: Callable[[str], None] = lambda done: None,
) -> None:
    """Run all tasks and the truths they need, in `jobs` processes, and write each as it finishes.

    progress is called with a word on each finished one. Raises `BadFolder` for a folder that holds other things.
    """
    cases = tuple({task.case.name: task.case for task in tasks}.values())
    places = {task: place for place, task in enumerate(tasks)}
    with Writer(folder, head, cases) as writer:
        everything: list[TruthTask | Task] = [*_truth_tasks(tasks), *tasks]
        for argument, result in pool.call_all(_call, everything, jobs, limit):
            match argument, result:
                case Task(), Run():
                    writer.add_run(result, places[argument])
                case Task(case, engine, method), Crashed() | TimedOut():
                    writer.add_run(Run(case.name, engine, head["engines"][engine], method, result), places[argument])
                case TruthTask(case, timestep), Truth():
                    writer.add_truth(case, timestep, result)
                case TruthTask(case, timestep), Unsupported() | Crashed() | TimedOut():
                    writer.add_missing_truth(case, timestep, f"the reference: {result.reason}")
            progress(_name(argument))


def _truth_tasks(tasks: Sequence[Task]) -> tuple[TruthTask, ...]:
    return tuple(dict.fromkeys(TruthTask(task.case, task.method.timestep) for task in tasks))


def _call(argument: TruthTask | Task) -> Run | Truth | Unsupported:
    if isinstance(argument, Task):
        return simulate(argument.case, argument.engine, argument.method.integrator, argument.method.timestep)
    case, timestep = argument.case, argument.timestep
    try:
        return truth(case, sampling_steps(case.instants, timestep) * timestep)
    except (NotModelled, OutOfReach) as error:
        return Unsupported(str(error))


def _name(argument: TruthTask | Task) -> str:
    match argument:
        case Task(case, engine, method):
            return f"{case.name} · {engine} {method.integrator} {method.timestep:g} s"
        case TruthTask(case, timestep):
            return f"{case.name} · truth {timestep:g} s"
