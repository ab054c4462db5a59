"""Make the runs of a search in worker processes, and compare them with truths that are computed together."""

import math
from collections.abc import Callable, Mapping, Sequence

from bodycheck.casefile.content import Case
from bodycheck.errors import Failed
from bodycheck.figures.columns import FIGURES
from bodycheck.judging.discrepancy import compare
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed, Run
from bodycheck.running import campaign
from bodycheck.running.plan import Task
from bodycheck.running.tasks import Truths, TruthTask
from bodycheck.studies.recommend.rows import Probe

Answered = Run | Truths | Crashed | TimedOut

#: Makes tasks in worker processes, as `tasks.perform` does, and returns their results in the order of the tasks.
CallEach = Callable[[Sequence[Task | TruthTask]], list[Answered]]


def probes(case: Case, tasks: Sequence[Task], versions: Sequence[str], figure: str, call_each: CallEach) -> list[Probe]:
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
    call_each
        Makes tasks in worker processes.

    Raises
    ------
    Failed
        If a run completed and there is no truth.
    """
    needed = tuple(campaign.truth_tasks(case, (task.method.timestep for task in tasks)))
    answers = call_each([*needed, *tasks])
    truths: dict[float, Truth | str] = {}
    for wanted, found in zip(needed, answers, strict=False):
        assert not isinstance(found, Run)  # answers are in the order of the tasks
        truths |= found if isinstance(found, dict) else dict.fromkeys(wanted.timesteps, found.reason)
    return [
        Probe(task.engine, version, task.method.name, task.method.timestep, *_measured(task, answer, truths, figure))
        for task, version, answer in zip(tasks, versions, answers[len(needed) :], strict=True)
    ]


def _measured(
    task: Task, answer: Answered, truths: Mapping[float, Truth | str], figure: str
) -> tuple[str, float | None, float | None, str]:
    """Return the status of a run, the figure, the bound of the truth's own error in it, and why the run is not ok."""
    assert isinstance(answer, Run | Crashed | TimedOut)  # answers are in the order of the tasks
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
