"""What every command does that runs cases: load them and the engines, plan, run, and keep the results while it uses them."""

import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from bodycheck.adapters.contract import Adapter
from bodycheck.casefile.case import Case
from bodycheck.console import terminal
from bodycheck.console.arguments import load_cases, load_engines, processes
from bodycheck.running import campaign
from bodycheck.running.plan import Plan
from bodycheck.running.store import Results


@dataclass(frozen=True)
class Selection:
    """What a command was asked to run: names or paths of cases, names of engines and integrators, time steps (s).

    An empty tuple means all, or the default. jobs: the number of processes; None for one a processor.
    """

    cases: tuple[str, ...]
    engines: tuple[str, ...] = ()
    integrators: tuple[str, ...] = ()
    timesteps: tuple[float, ...] = ()
    jobs: int | None = None


@dataclass(frozen=True)
class Ran:
    """Results, the cases that were run, and the adapters of the engines by name."""

    results: Results
    cases: list[Case]
    adapters: dict[str, Adapter]


@contextmanager
def ran(selection: Selection, plan: Plan, out: Path | None) -> Iterator[Ran]:
    """Run what a plan makes of a selection; the results last as long as the context, in `out` for good.

    Raises `BadInput` for cases, engines, methods or a folder that cannot be used.
    """
    cases = load_cases(selection.cases)
    adapters, missing = load_engines(selection.engines)
    tasks = plan(cases, adapters, selection.integrators, selection.timesteps)
    header = campaign.header(sys.argv, {name: adapter.engine.version for name, adapter in adapters.items()}, missing)
    with ExitStack() as stack:
        folder = out or Path(stack.enter_context(TemporaryDirectory(prefix="bodycheck-")))
        with terminal.progress("running", campaign.size(tasks)) as progress:
            done = campaign.results(tasks, folder, header, processes(selection.jobs), progress=progress)
            results = stack.enter_context(done)
        yield Ran(results, cases, adapters)
