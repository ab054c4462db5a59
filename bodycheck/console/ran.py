"""Run cases for a command: load cases and engines, plan and make the runs, and keep the results while the command uses them."""

import sys
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from bodycheck.adapters.contract import Engine
from bodycheck.adapters.engine_name import EngineName
from bodycheck.casefile.case import Case, is_shipped
from bodycheck.console.arguments import (
    AS_THEY_ARE,
    Engines,
    Robots,
    files_of,
    load_engines,
    processes,
    read_cases,
    tell_left_out,
)
from bodycheck.console.progress import progress as shown
from bodycheck.console.robots import noticed
from bodycheck.files.temporary import temporary_folder
from bodycheck.results.store import Results
from bodycheck.results.unchecked import ALLOWED, SHIPPED, unchecked
from bodycheck.running import campaign
from bodycheck.running.named import Decision
from bodycheck.running.pairing import Meet, unmet
from bodycheck.running.plan import Plan, Task, without_method
from bodycheck.suggestion import first_names


@dataclass(frozen=True)
class Selection:
    """The selection of runs on the command line. An empty tuple stands for all cases, engines or methods, or default steps.

    Parameters
    ----------
    cases
        Names of shipped cases and paths of case files.
    engines
        Names of engines.
    integrators
        Spellings of methods.
    timesteps
        Time steps (s).
    jobs
        The number of processes; None for the number of processors.
    allow_missing
        Whether missing engines are tolerated: expectations of engines that are not installed then do not count as failed.
    robots
        The way in which robots' files are read.
    """

    cases: tuple[str, ...]
    engines: tuple[str, ...] = ()
    integrators: tuple[str, ...] = ()
    timesteps: tuple[float, ...] = ()
    jobs: int | None = None
    allow_missing: bool = False
    robots: Robots = AS_THEY_ARE


@dataclass(frozen=True)
class Given:
    """The cases of a command, and their origins.

    Attributes
    ----------
    cases
        The cases.
    files
        The files of the cases that were not given by the name of a shipped case, by the name of the case.
    shipped
        The names of the cases that come with the package.
    """

    cases: Sequence[Case]
    files: Mapping[str, Path]
    shipped: frozenset[str]

    @classmethod
    def of(cls, cases: list[Case], names: tuple[str, ...]) -> "Given":
        """Return cases with their origins. names: the names and paths from which `load_cases` loaded them."""
        files = files_of(cases, names)
        shipped = frozenset(case.name for case in cases if case.name not in files or is_shipped(files[case.name]))
        return cls(cases, files, shipped)


@dataclass(frozen=True)
class Ran:
    """The results of a command's runs.

    Attributes
    ----------
    results, cases, files
        The results, the cases that were run, and the files of those that were not given by the name of a shipped case.
    loaded
        The engines, with the names that the user gave.
    left_out
        Whether the user named a file with faults, which was left out.
    """

    results: Results
    cases: list[Case]
    files: Mapping[str, Path]
    loaded: Engines
    left_out: bool = False

    @property
    def engines(self) -> dict[str, Engine]:
        """The records of the engines by name."""
        return self.loaded.records

    def decided(self, rows: Iterable[Mapping[str, Any]], failed: bool = False, batch: tuple[int, ...] = ()) -> Decision:
        """Return the decision on the command from the rows of its main table; see `bodycheck.running.named.decide`."""
        return self.loaded.decided(rows, self.cases, failed or self.left_out, batch=batch)


@contextmanager
def ran(selection: Selection, plan: Plan, out: Path | None, quiet: bool = False, meet: Meet = unmet) -> Iterator[Ran]:
    """Run the tasks that a plan makes from a selection, and provide the results. Case files with faults are left out.

    Parameters
    ----------
    selection
        The selected cases, engines, integrators and time steps.
    plan
        Function that returns the tasks for cases, engines, integrators and time steps.
    out
        The folder for the results. If it is None, they are in a temporary folder that the end of the context deletes.
    quiet
        Whether no progress is shown.
    meet
        See `campaign.results`.

    Raises
    ------
    BadInput
        If an engine, method or folder cannot be used, or no case can.
    Failed
        If all engines that the user named fail when they are loaded.
    """
    loaded = read_cases(selection.cases, selection.robots)
    tell_left_out(loaded)
    with ran_of(Given.of(loaded.cases, loaded.names), selection, plan, out, sys.argv, quiet, meet) as results:
        yield replace(results, left_out=bool(loaded.faults))


@contextmanager
def ran_of(
    given: Given,
    selection: Selection,
    plan: Plan,
    out: Path | None,
    command: Sequence[str],
    quiet: bool = False,
    meet: Meet = unmet,
) -> Iterator[Ran]:
    """Run the tasks that a plan makes from loaded cases, and provide the results. Raises as `ran` does.

    Parameters
    ----------
    given
        The cases, which replace the cases named in the selection.
    selection, plan, out, quiet, meet
        See `ran`.
    command
        The words of the command, for the header of the results.
    """
    cases = list(given.cases)
    tolerated = _tolerated(selection.allow_missing, given.shipped)
    engines = load_engines(selection.engines, _releases(cases, tolerated), selection.integrators)
    tasks = plan(cases, engines.records, selection.integrators, selection.timesteps)
    engines.check_planned(cases, ((task.engine, task.method) for task in tasks))
    if selection.cases and not quiet:
        _tell_not_run(cases, tasks)
    jobs, without = processes(selection.jobs), without_method(cases, engines.records, tasks)
    samplings = {case.name: [task.method.sampling for task in tasks if task.case == case] for case in cases}
    robots = noticed(cases, jobs, quiet, samplings)
    header = campaign.header(command, engines.records, engines.missing, without, robots)
    lost = tuple(unchecked(cases, engines.absence, tolerated, selection.integrators, selection.timesteps))
    with ExitStack() as stack:
        folder = out or stack.enter_context(temporary_folder())
        with shown("running", len(tasks), quiet) as progress:
            done = campaign.results(
                tasks,
                folder,
                header,
                jobs,
                progress=progress,
                unchecked=lost,
                files=given.files,
                meet=meet,
                known=robots.truths,
            )
            results = stack.enter_context(done)
        yield Ran(results, cases, given.files, engines)


def _tell_not_run(cases: Iterable[Case], tasks: Iterable[Task]) -> None:
    """Print to stderr which cases have no run, because no engine has a method for their scenes."""
    planned = {task.case.name for task in tasks}
    if left_out := [case.name for case in cases if case.name not in planned]:
        names = ", ".join(first_names(left_out))
        print(f"bodycheck: not run, since no engine has a method for the scene: {names}", file=sys.stderr)


def _releases(cases: Iterable[Case], tolerated: Callable[[Case], str]) -> dict[str, bool]:
    """Return the releases, each `NAME@VERSION`, in expectations of cases, and whether their absence is tolerated."""
    releases: dict[str, bool] = {}
    for case in cases:
        for name in {expectation.engine for expectation in case.expectations if EngineName.parse(expectation.engine).version}:
            releases[name] = releases.get(name, True) and bool(tolerated(case))
    return releases


def _tolerated(allow_missing: bool, shipped: Collection[str]) -> Callable[[Case], str]:
    """Return a function from a case to the reason why a missing engine is tolerated; the reason is empty if it is not.

    shipped: the names of the cases that come with the package.
    """

    def tolerated(case: Case) -> str:
        return ALLOWED if allow_missing else SHIPPED if case.name in shipped else ""

    return tolerated
