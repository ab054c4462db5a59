"""Measure what a search asks for: runs, which are compared with truths that are computed together, and costs of answers."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from bodycheck.adapters.contract import Method
from bodycheck.casefile.content import Case
from bodycheck.errors import Failed
from bodycheck.figures.columns import FIGURES
from bodycheck.judging.discrepancy import compare
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed, Run
from bodycheck.running import campaign
from bodycheck.running.instants import sampling_steps
from bodycheck.running.plan import Task
from bodycheck.running.tasks import Truths, TruthTask
from bodycheck.studies import cost
from bodycheck.studies.cost import Stretch
from bodycheck.studies.recommend import search
from bodycheck.studies.recommend.rows import Answer, Probe

Answered = Run | Truths | Crashed | TimedOut

#: Worker processes that make tasks, as `tasks.perform` does.
Workers = pool.Workers[Task | TruthTask, Run | Truths]

#: Why a method whose runs ended well has no result.
UNSEEN = "no run shows this figure: the scene does not have it, or the time steps are too large to see it"


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
    error, truth_error = maxima.get(figure), maxima.get(FIGURES[figure].bounded_by)
    return (None if error is None else math.inf if math.isnan(error) else abs(error)), truth_error


def errors_of(probes: Iterable[Probe]) -> dict[float, float]:
    """Return the errors of a method by its time steps (s); infinite where a run failed, none where it timed out."""
    return {
        probe.timestep: math.inf if probe.error is None else probe.error for probe in probes if probe.status != TimedOut.status
    }


def answer_of(engine: str, version: str, method: Method, probes: Sequence[Probe], limit: float) -> Answer:
    """Return the answer for one method, without its cost.

    Parameters
    ----------
    engine, version, method
        The engine with its version, and the method; its time step does not matter.
    probes
        What was measured with the method.
    limit
        The largest allowed error.
    """
    errors = errors_of(probes)
    kept = search.answer(errors, limit)
    finite = {step: error for step, error in errors.items() if math.isfinite(error)}
    step = kept if kept is not None else min(finite, key=lambda step: finite[step], default=None)
    error = None if step is None else finite[step]
    reasons = [probe.reason for probe in sorted(probes, key=lambda probe: probe.timestep) if probe.reason]
    why = reasons[0] if reasons else UNSEEN
    return Answer(
        *(engine, version, method.name, step, error),
        cost=None,
        margin=limit / error if error else None,
        reached=kept is not None,
        cost_low=None,
        cost_high=None,
        steps=len(probes),
        smallest=min(errors, default=None),
        broken=min((step for step in errors if errors[step] > limit), default=None),
        reason=why if step is None else "",
    )


def priced(case: Case, answers: Sequence[Answer]) -> list[Answer]:
    """Measure the costs of answers in turn, with nothing else running, and return them in the order of `Recommendation`."""
    stretches = {
        index: Stretch(
            case.scene, answer.engine, Method.parse(answer.integrator, step), int(sampling_steps(case.instants, step)[-1])
        )
        for index, answer in enumerate(answers)
        if (step := answer.timestep) is not None
    }
    timed = list(answers)
    costs = cost.measure(tuple(stretches.values()), campaign.TIME_LIMIT_S) if stretches else []
    for measured, (index, stretch) in zip(costs, stretches.items(), strict=True):
        if isinstance(measured, Crashed | TimedOut):
            timed[index] = replace(answers[index], reason=f"its cost could not be measured: {measured.reason}")
        else:
            seconds, step = cost.summarise(measured.times), stretch.method.timestep
            timed[index] = replace(
                answers[index], cost=seconds.median / step, cost_low=seconds.low / step, cost_high=seconds.high / step
            )
    return sorted(timed, key=_rank)


def _steps(case: Case, timestep: float) -> int:
    """Return the number of steps of a run of a case."""
    return int(sampling_steps(case.instants, timestep)[-1])


def _rank(answer: Answer) -> tuple[bool, float, float]:
    """Return a key that orders answers: those that keep the limit by cost, and by step if that is unknown; others by error."""
    if answer.reached:
        return False, math.inf if answer.cost is None else answer.cost, -(answer.timestep or 0.0)
    return True, math.inf if answer.error is None else answer.error, 0.0
