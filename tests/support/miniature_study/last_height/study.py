"""Run cases with the default time step, and measure the height at the end of each."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

from bodycheck.adapters.contract import Engine, Method
from bodycheck.casefile.content import Case
from bodycheck.reference.scene import Scene
from bodycheck.results import resumption
from bodycheck.results.header import Header
from bodycheck.results.outcome import Completed
from bodycheck.running import plan
from bodycheck.running.campaign import Advance
from bodycheck.running.plan import Task
from bodycheck.running.simulation import run
from tests.support.miniature_study.last_height.rows import RECORDS, Row


@dataclass(frozen=True)
class Plan:
    """The runs of a study, with the versions of their engines."""

    tasks: tuple[Task, ...]
    versions: Mapping[str, str]

    @property
    def size(self) -> int:
        """The number of runs."""
        return len(self.tasks)

    @property
    def methods(self) -> tuple[tuple[str, Method], ...]:
        """The name of the engine and the method of each run."""
        return tuple((task.engine, task.method) for task in self.tasks)


def suits(case: Case) -> bool:
    """Return whether a case has one body."""
    return isinstance(case.scene, Scene)


def prepare(cases: Sequence[Case], engines: Mapping[str, Engine], integrators: Sequence[str]) -> Plan:
    """Return a run for each case and method. Raises `BadInput` if there is none."""
    tasks = plan.plan(cases, engines, integrators, ())
    return Plan(tuple(tasks), {name: engine.version for name, engine in engines.items()})


@contextmanager
def results(planned: Plan, folder: Path, header: Header, jobs: int, progress: Advance) -> Iterator[tuple[list[Row]]]:
    """Make the runs that the folder does not have yet, and provide all rows."""
    with resumption.opened(folder / RECORDS, header, [str(task.key) for task in planned.tasks]) as log:
        rows = [Row(**record["row"]) for record in log.records]
        for task in planned.tasks[len(rows) :]:
            outcome = run(task.case, task.engine, task.method).outcome
            height = float(outcome.trajectory.position[-1, 2]) if isinstance(outcome, Completed) else None
            method = (task.engine, planned.versions[task.engine], task.method.name, task.method.timestep)
            rows.append(Row(task.case.name, *method, height))
            log.add({"record": "run", "row": asdict(rows[-1])})
            progress(task.case.name)
        yield (rows,)
