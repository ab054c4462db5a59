"""Measure the error, the cost and the convergence of every method over a ladder of time steps."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from bodycheck.adapters.contract import Engine, Integrator, Method
from bodycheck.adapters.offers import chosen, integrator_of
from bodycheck.casefile.content import Case
from bodycheck.judging import judgement
from bodycheck.judging.judgement import Verdict
from bodycheck.judging.schemes.convergence import observe_convergence
from bodycheck.judging.schemes.identification import identify
from bodycheck.judging.schemes.scheme_rounding import ROUNDOFF
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import Truth
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Completed
from bodycheck.results.store import Results
from bodycheck.running import campaign
from bodycheck.running.instants import default_timestep
from bodycheck.running.plan import Task, check, refuse_nothing
from bodycheck.running.roles import refuse_timesteps
from bodycheck.studies.cost import Measured, Stretch, measure, stretch_of, summarise
from bodycheck.studies.orders import Order
from bodycheck.studies.timesteps import accuracies, ladder
from bodycheck.studies.tradeoff.measurements import COLUMNS
from bodycheck.studies.tradeoff.rows import BATCH_COLUMNS, COST_COLUMNS

#: The columns of a run whose cost is not known.
NO_COSTS: Mapping[str, Any] = dict.fromkeys(("wall_time", "time_per_step", "realtime_factor", *COST_COLUMNS))


def plan(
    cases: Sequence[Case], engines: Mapping[str, Engine], integrators: Sequence[str], timesteps: Sequence[float]
) -> tuple[Task, ...]:
    """Return a task for every case, engine, integrator and time step, or accuracy of a method with error control.

    Error control is searched over: any accuracy in a spelling stands for all of `timesteps.accuracies`, and the time steps are
    largest steps.

    Parameters
    ----------
    cases
        The cases.
    engines
        The records of the engines by name.
    integrators
        Spellings of methods, and aliases, which stand for a method without its time step; all that the engines offer if it is
        empty.
    timesteps
        Time steps (s). If it is empty, each case has the time steps of its ladder (`timesteps.ladder`), and error control its
        default largest step.

    Raises
    ------
    BadInput
        If no engine has a method, a time step is not possible, or there is nothing to run.
    """
    refuse_timesteps(integrators, timesteps)
    check(cases, engines, integrators, timesteps)
    tasks = dict.fromkeys(
        Task(case, name, method)
        for case in cases
        for name, engine in engines.items()
        for integrator in chosen(engine, case.scene, integrators)
        for method in _over(engine, case, Method.parse(integrator, 0.0), sorted(set(timesteps), reverse=True))
    )
    refuse_nothing(tuple(tasks), engines, integrators)
    return tuple(tasks)


def _over(engine: Engine, case: Case, method: Method, timesteps: Sequence[float]) -> Iterator[Method]:
    """Yield a method over time steps, the largest first, or with error control over accuracies, the largest first."""
    if method.accuracy is None:
        yield from map(method.at, timesteps or ladder(case))
        return
    integrator = integrator_of(engine, method)
    for timestep in timesteps or (default_timestep(engine, case, method),):
        for accuracy in accuracies(integrator.order if integrator is not None else None):
            yield method.at(timestep).with_accuracy(accuracy)


def price(
    results: Results,
    verdicts: Sequence[Verdict],
    engines: Mapping[str, Engine],
    progress: Callable[[str], None] = lambda done: None,
) -> list[dict[str, Any]]:
    """Measure the costs of runs, and return one row per run with the columns of results, `COST_COLUMNS` and `BATCH_COLUMNS`.

    Costs are measured while nothing else runs, for all runs of a case in turn, each engine in a separate process. A run that
    did not complete has no cost. If a measurement fails, the row has a reason instead of a cost. Missing values are None.

    Parameters
    ----------
    results
        The results of the runs.
    verdicts
        The verdicts on the runs.
    engines
        The records of the engines by name.
    progress
        A function that is called with a text after each case.
    """
    costs: dict[Task, Measured | Crashed | TimedOut] = {}
    for name, case_verdicts in _by_case(verdicts).items():
        tasks = {_task(results.cases[name], verdict): verdict for verdict in case_verdicts if verdict.discrepancy is not None}
        stretches = [_stretch(task, verdict) for task, verdict in tasks.items()]
        costs |= dict(zip(tasks, measure(stretches, campaign.TIME_LIMIT_S), strict=True))
        progress(f"{name} · costs")
    rows = judgement.records(verdicts)
    for row, verdict in zip(rows, verdicts, strict=True):
        cost = costs.get(_task(results.cases[verdict.run.case], verdict))
        claims = _claims(engines[verdict.run.engine], verdict.run.key)
        row.pop("evaluations")  # the column of this name in the table of the study is per step
        row |= _costs(verdict, cost if isinstance(cost, Measured) else None, claims.evaluations)
        engine = engines[verdict.run.engine]
        row |= dict.fromkeys(BATCH_COLUMNS) | {"device": engine.device, "precision": engine.precision}
        if isinstance(cost, Crashed | TimedOut):
            row["reason"] = row["reason"] or f"its cost could not be measured: {cost.reason}"
    return rows


def _task(case: Case, verdict: Verdict) -> Task:
    return Task(case, verdict.run.engine, verdict.run.method)


def _stretch(task: Task, verdict: Verdict) -> Stretch:
    assert isinstance(verdict.outcome, Completed)  # only completed runs have a discrepancy
    return stretch_of(task.case, task.engine, task.method, verdict.outcome.steps)


def _claims(engine: Engine, key: RunKey) -> Integrator:
    """Return the integrator of a run, with the order and the evaluations that its engine claims."""
    integrator = integrator_of(engine, key.method)
    assert integrator is not None  # the engine ran it
    return integrator


def _costs(verdict: Verdict, measured: Measured | None, evaluations: int | None) -> dict[str, Any]:
    """Return the cost columns of a run. They do not contain the times of the run itself, which other runs disturbed."""
    if measured is None or not isinstance(verdict.outcome, Completed):
        return dict(NO_COSTS)
    done, step = verdict.outcome, mean_step(verdict)
    in_step = step / verdict.run.method.timestep  # with error control, the times are those of largest steps
    costs = cost_columns(measured.times * in_step, measured.processor_times * in_step, step, done.steps)
    if done.evaluations is not None:
        evaluations = round(done.evaluations / done.steps)
    more = {"evaluations": evaluations, "setup_time": measured.setup, "engine_share": measured.engine_share}
    return {**NO_COSTS, **costs, **more}


def mean_step(verdict: Verdict) -> float:
    """Return the time step (s) of a completed run, or with error control the mean of its steps."""
    method, outcome = verdict.run.method, verdict.outcome
    assert isinstance(outcome, Completed)
    return method.timestep if method.accuracy is None else verdict.duration / outcome.steps


def cost_columns(times: Array, processor_times: Array, timestep: float, steps: int) -> dict[str, float]:
    """Return the columns of the cost that are computed from the times of the rounds.

    Parameters
    ----------
    times, processor_times
        The time (s) and the processor time (s) per step, or per step and scene, of each round.
    timestep
        The time step (s).
    steps
        The number of steps, summed over all scenes.
    """
    step = summarise(times)
    return {
        "wall_time": step.median * steps,
        "time_per_step": step.median,
        "realtime_factor": timestep / step.median,
        "time_per_step_low": step.low,
        "time_per_step_high": step.high,
        "cost": step.median / timestep,
        "processor_time_per_step": summarise(processor_times).median,
    }


def _by_case(verdicts: Iterable[Verdict]) -> dict[str, list[Verdict]]:
    by_case: dict[str, list[Verdict]] = defaultdict(list)
    for verdict in verdicts:
        by_case[verdict.run.case].append(verdict)
    return by_case


def orders(
    results: Results,
    verdicts: Iterable[Verdict],
    engines: Mapping[str, Engine],
    progress: Callable[[str], None] = lambda done: None,
) -> list[Order]:
    """Return the orders of every method in every quantity, with the scheme identified in the method's run at the largest step.

    Parameters
    ----------
    results
        The results of the runs.
    verdicts
        The verdicts on the runs.
    engines
        The records of the engines by name.
    progress
        A function that is called with a text after each case.
    """
    observed: list[Order] = []
    for name, case_verdicts in _by_case(verdicts).items():
        methods: dict[RunKey, list[Verdict]] = defaultdict(list)
        for verdict in case_verdicts:
            if verdict.discrepancy is not None:
                key = verdict.run.key.over_steps
                methods[replace(key, method=key.method.over_accuracies)].append(verdict)
        for key, runs in methods.items():
            # Only steps that differ say something about an order; loose accuracies may all have the largest step.
            by_step = {
                mean_step(verdict): verdict for verdict in sorted(runs, key=lambda verdict: -verdict.run.method.timestep)
            }
            ordered = [by_step[step] for step in sorted(by_step, reverse=True)]
            observed += _orders_of(results, results.cases[name], ordered, engines[key.engine])
        progress(f"{name} · orders")
    return observed


def _orders_of(results: Results, case: Case, verdicts: Sequence[Verdict], engine: Engine) -> Iterator[Order]:
    """Yield the orders of one method in its time step, or in its mean step with error control.

    verdicts: those on its completed runs, the largest step first.
    """
    coarsest = verdicts[0].run
    truth = results.truth(case.name, coarsest.method.sampling)
    assert isinstance(truth, Truth)  # a run without a truth has no discrepancy
    roundoff = ROUNDOFF[engine.precision]
    named = identify(case, coarsest, truth, roundoff)
    runs = [(mean_step(v), v.outcome.trajectory) for v in verdicts if isinstance(v.outcome, Completed)]
    maxima = [verdict.discrepancy.maxima() for verdict in verdicts if verdict.discrepancy is not None]
    errors = {
        quantity: [figures[column] for figures in maxima for column in columns if column in figures]
        for quantity, columns in COLUMNS.items()
    }
    for quantity, convergence in observe_convergence(runs, truth, errors, roundoff).items():
        yield Order(
            *(case.name, coarsest.engine, coarsest.version, coarsest.method.over_accuracies.name, quantity),
            order=convergence.order,
            order_low=convergence.low,
            order_high=convergence.high,
            floor=convergence.floor,
            floor_cause=convergence.cause,
            horizon=convergence.horizon,
            claimed=_claims(engine, coarsest.key).order,
            scheme=named.scheme if named is not None else "",
            nearest_scheme=named.nearest if named is not None else "",
            scheme_residual=named.residual if named is not None and named.nearest else None,
        )
