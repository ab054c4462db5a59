"""Make the runs that a search needs, compare them with truths that are computed together, and measure the costs of answers."""

import math
from collections.abc import Mapping, Sequence
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
from bodycheck.studies.recommend import search
from bodycheck.studies.recommend.rows import Answer, Asked, Probe

Answered = Run | Truths | Crashed | TimedOut

#: Worker processes that make tasks, as `tasks.perform` does.
Workers = pool.Workers[Task | TruthTask, Run | Truths]

#: The reason why a method whose runs all completed has no result.
UNSEEN = "no run shows this figure: the scene does not have it, or the time steps are too large to see it"


def probes(case: Case, tasks: Sequence[Task], versions: Sequence[str], figure: str, workers: Workers) -> list[Probe]:
    """Make runs of one case and return their measurements, in the order of the tasks.

    Parameters
    ----------
    case
        The case.
    tasks
        The runs.
    versions
        The version of the engine of each task.
    figure
        The figure that is measured.
    workers
        The worker processes that make the runs and compute the truths.

    Raises
    ------
    Failed
        If a run completed and there is no truth with which it can be compared.
    """
    needed = tuple(campaign.truth_tasks(case, (task.method.sampling for task in tasks)))
    answers = dict(workers.map([*needed, *tasks]))
    truths: dict[float, Truth | str] = {}
    for wanted in needed:
        answer = answers[wanted]
        assert not isinstance(answer, Run)
        truths |= answer if isinstance(answer, dict) else dict.fromkeys(wanted.samplings, answer.reason)
    return [
        Probe(task.engine, version, task.method.name, task.method.timestep, *_measured(task, answers[task], truths, figure))
        for task, version in zip(tasks, versions, strict=True)
    ]


def _measured(
    task: Task, answer: Answered, truths: Mapping[float, Truth | str], figure: str
) -> tuple[str, float | None, float | None, str]:
    """Return the status of a run, the value of the figure, the error bound of the truth in it, and why the run is not ok.

    The values are None if they are not known. Raises `Failed` if the run completed and there is no truth.
    """
    assert isinstance(answer, Run | Crashed | TimedOut)
    outcome = answer.outcome if isinstance(answer, Run) else answer
    if not isinstance(answer, Run) or not isinstance(outcome, Completed):
        return outcome.status, None, None, outcome.reason
    truth = truths[task.method.sampling]
    if isinstance(truth, str):
        raise Failed(f"{task.case.name}: there is no truth from which errors could be measured: {truth}")
    return Completed.status, *figures_of(compare(truth, answer).maxima(), figure), ""


def figures_of(maxima: Mapping[str, float], figure: str) -> tuple[float | None, float | None]:
    """Return the magnitude of a figure of a run, and the error bound of the truth in this figure; None if not known.

    The magnitude is infinite if the figure is not a number. maxima: the figures of the run by name.
    """
    error, truth_error = maxima.get(figure), maxima.get(FIGURES[figure].bounded_by)
    return (None if error is None else math.inf if math.isnan(error) else abs(error)), truth_error


def answer_of(engine: str, version: str, method: Method, probes: Sequence[Probe], asked: Asked, within: search.Range) -> Answer:
    """Return the answer for one method, without its cost.

    Parameters
    ----------
    engine, version, method
        The engine with its version, and the method, whose time step or accuracy is ignored.
    probes
        The measurements of the method.
    asked, within
        The question, and the range of the search.
    """
    errors, is_fixed = asked.errors(probes), method.accuracy is None
    methods = {asked.number(probe.engine_method): probe.engine_method for probe in probes}
    reached = search.answer(errors, within)
    finite = {steps: error for steps, error in errors.items() if math.isfinite(error)}
    steps = reached if reached is not None else min(finite, key=lambda steps: finite[steps], default=None)
    error = None if steps is None else finite[steps]
    worst = None if reached is None else max(errors[near] for near in search.neighbours(reached))
    least = error if worst is None else worst
    reasons = [probe.reason for probe in sorted(probes, key=lambda probe: probe.timestep) if probe.reason]
    why = reasons[0] if reasons else UNSEEN
    return Answer(
        *(engine, version, method.name if steps is None else methods[steps].name),
        *(None if steps is None else methods[steps].timestep, error),
        cost=None,
        margin=within.limit / least if least else None,
        reached=reached is not None,
        cost_low=None,
        cost_high=None,
        steps=len(probes),
        smallest=min((methods[steps].timestep for steps in errors if is_fixed), default=None),
        broken=min((methods[steps].timestep for steps in errors if is_fixed and errors[steps] > within.limit), default=None),
        reason=why if steps is None else "",
        worst=worst,
        monotone=None if len(finite) < 2 else search.reversal(errors, within.limit) is None,
    )


def priced(case: Case, answers: Sequence[Answer]) -> list[Answer]:
    """Measure the costs of answers in turn, while nothing else runs; return the answers in the order of `Recommendation`."""
    stretches = {
        index: cost.stretch_of(
            case, answer.engine, Method.parse(answer.integrator, step), int(sampling_steps(case.instants, step)[-1])
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
                answers[index],
                cost=seconds.median / step,
                cost_low=seconds.low / step,
                cost_high=seconds.high / step,
                efforts=measured.efforts,
            )
    return sorted(timed, key=_rank)


def _rank(answer: Answer) -> tuple[bool, bool, str, float, float]:
    """Return a sort key: answers that keep the limit come first, by cost, then the largest step; others follow by error.

    Costs are compared among answers whose efforts are computed in the same way: those at stages come before those between
    steps.
    """
    if answer.reached:
        unknown = answer.cost is None
        return False, unknown, answer.efforts, math.inf if answer.cost is None else answer.cost, -(answer.timestep or 0.0)
    return True, False, "", math.inf if answer.error is None else answer.error, 0.0
