"""Results folders as campaigns leave them."""

from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Any

from bodycheck import Case
from bodycheck.adapters import registry
from bodycheck.adapters.contract import Engine
from bodycheck.results import store
from bodycheck.results.store import Results
from bodycheck.running import campaign
from bodycheck.running.plan import Task, plan
from tests.support.processes import calls_here

#: Columns that are different whenever something is run again.
TIMINGS = ["wall_time", "time_per_step", "realtime_factor"]


def records(*engines: str) -> dict[str, Engine]:
    """The records of some engines by name."""
    return {name: registry.load(name).engine for name in engines}


#: What a header says of the command that made the results.
COMMAND = ("bodycheck", "run")


def header(*engines: str, command: Sequence[str] = COMMAND) -> dict[str, Any]:
    """The header of results of some engines, of which none is missing."""
    return campaign.header(command, records(*engines), {})


def results(tasks: Sequence[Task], folder: Path, jobs: int = 0, command: Sequence[str] = COMMAND, **options: Any) -> Results:
    """What became of some tasks, all engines of which are installed, in a folder.

    jobs: the number of worker processes; 0 for none, where no engine dies or hangs. options: those of `campaign.results`.
    """
    head = header(*dict.fromkeys(task.engine for task in tasks), command=command)
    with nullcontext() if jobs else calls_here(), campaign.results(tasks, folder, head, jobs or 1, **options):
        pass
    return store.read(folder)


def run_all(case: Case, engines: Sequence[str], folder: Path, timestep: float = 0.1, **options: Any) -> Results:
    """A case through all methods of some engines with one time step (s); options: those of `results`."""
    return results(plan([case], records(*engines), (), (timestep,)), folder, **options)
