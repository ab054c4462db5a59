"""Make the runs of a search in worker processes, and compare them with truths that are computed together."""

import math
from collections.abc import Mapping, Sequence

from bodycheck.casefile.content import Case
from bodycheck.errors import Failed
from bodycheck.figures.columns import FIGURES
from bodycheck.judging.discrepancy import compare
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed, Run
from bodycheck.running import campaign
from bodycheck.running.plan import Task
from bodycheck.running.tasks import Truths, TruthTask
from bodycheck.studies.recommend.rows import Probe

Answered = Run | Truths | Crashed | TimedOut

#: Worker processes that make tasks, as `tasks.perform` does.
Workers = pool.Workers[Task | TruthTask, Run | Truths]


def probes(case: Case, tasks: Sequence[Task], versions: Sequence[str], figure: str, workers: Workers) -> list[Probe]:
    """Make runs of one case and return what they measured, in the same order.

    Parameters
    ----------
    case
        The case.
    tasks
        The runs.
    versions
        The versions of their engines.
    figure
        The figure that is measured.
    workers
        The worker processes that make them.

    Raises
    ------
    Failed
        If a run completed and there is no truth.
    """
    needed = tuple(campaign.truth_tasks(case, (task.method.timestep for task in tasks)))
    answers = dict(workers.map([*needed, *tasks]))
    truths: dict[float, Truth | str] = {}
    for wanted in needed:
        answer = answers[wanted]
        assert not isinstance(answer, Run)
        truths |= answer if isinstance(answer, dict) else dict.fromkeys(wanted.timesteps, answer.reason)
    return [
        Probe(task.engine, version, task.method.name, task.method.timestep, *_measured(task, answers[task], truths, figure))
        for task, version in zip(tasks, versions, strict=True)
    ]


def _measured(
    task: Task, answer: Answered, truths: Mapping[float, Truth | str], figure: str
) -> tuple[str, float | None, float | None, str]:
    """Return the status of a run, the figure, the bound of the truth's own error in it, and why the run is not ok."""
    assert isinstance(answer, Run | Crashed | TimedOut)
    outcome = answer.outcome if isinstance(answer, Run) else answer
    if not isinstance(answer, Run) or not isinstance(outcome, Completed):
        return outcome.status, None, None, outcome.reason
    truth = truths[task.method.timestep]
    if isinstance(truth, str):
        raise Failed(f"{task.case.name}: there is no truth from which errors could be measured: {truth}")
    return Completed.status, *figures_of(compare(truth, answer).maxima(), figure), ""


def figures_of(maxima: Mapping[str, float], figure: str) -> tuple[float | None, float | None]:
    """Return the size of a figure of a run and the bound of the truth's own error in it; None where they are not known."""
    error, own = maxima.get(figure), maxima.get(FIGURES[figure].bounded_by)
    return (None if error is None else math.inf if math.isnan(error) else abs(error)), own
