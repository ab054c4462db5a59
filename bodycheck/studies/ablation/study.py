"""Compare the cost and the motion of every model of a case with the cost and the motion of its smallest model."""

from collections.abc import Mapping, Sequence

import numpy as np

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Engine, Method, Model, Models, kind_of
from bodycheck.adapters.method import DEFAULT_TIMESTEP
from bodycheck.adapters.offers import offered
from bodycheck.adapters.roles import resolved
from bodycheck.casefile.content import Case
from bodycheck.errors import BadInput
from bodycheck.judging import judgement
from bodycheck.judging.judgement import Verdict
from bodycheck.judging.schemes.convergence import common
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.kinematics import geodesic_angle, normalise
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import distance
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Completed
from bodycheck.results.store import Results
from bodycheck.running import campaign
from bodycheck.running.engines import home
from bodycheck.running.plan import Task, check
from bodycheck.running.roles import refuse_timesteps
from bodycheck.studies import cost
from bodycheck.studies.ablation.rows import Change, ModelRow
from bodycheck.studies.cost import Cost, Measured, Stretch

#: Ratio of an error of first order to its change when the time step is halved; the ratio is smaller for higher orders.
FIRST_ORDER_FACTOR = 2.0

#: Models by the spelling of a method, and then by the name of the model.
ModelsByMethod = dict[str, dict[str, Model]]


def plan(
    cases: Sequence[Case], engines: Mapping[str, Engine], integrators: Sequence[str], timesteps: Sequence[float]
) -> tuple[Task, ...]:
    """Return a task for every case, engine, integrator, model and time step, and for half of each time step.

    Parameters
    ----------
    cases
        The cases.
    engines
        The records of the engines by name.
    integrators
        Spellings of methods; if it is empty, the first method with models of each engine.
    timesteps
        Time steps (s); the default time step if it is empty.

    Raises
    ------
    BadInput
        If no engine has a method, a time step is not possible, an engine fails to list its models, or there are no models to
        compare.
    """
    refuse_timesteps(integrators, timesteps)
    steps = [part for timestep in timesteps or (DEFAULT_TIMESTEP,) for part in (timestep, timestep / 2)]
    check(cases, engines, integrators, steps)
    offered_models = models_of(cases, engines, integrators)
    tasks = dict.fromkeys(
        Task(case, engine, Method.parse(model.method, step))
        for case in cases
        for engine in engines
        for models in offered_models[case.name, engine].values()
        for step in steps
        for model in models.values()
    )
    if not tasks:
        raise BadInput(f"nothing to compare: {', '.join(engines)} offer no models of these cases for the selected methods")
    return tuple(tasks)


def models_of(
    cases: Sequence[Case], engines: Mapping[str, Engine], integrators: Sequence[str]
) -> dict[tuple[str, str], ModelsByMethod]:
    """Return the models of each case's scene for the selected methods that have models, by the names of case and engine.

    Each engine lists its models in a separate process. `integrators` contains the spellings of the selected methods; if it is
    empty, the first method with models of each engine is used. Raises `BadInput` if an engine fails to list its models.
    """
    questions = [(case, engine, tuple(integrators)) for case in cases for engine in engines]
    models_by_case: dict[tuple[str, str], ModelsByMethod] = {}
    with pool.Workers(with_models, 1, campaign.TIME_LIMIT_S, group=lambda question: question[1], home=home) as workers:
        for (case, engine, _), answer in workers.map(questions):
            if isinstance(answer, Crashed | TimedOut):
                raise BadInput(f"{engine} does not say which models it has of {case.name}: {answer.reason}")
            models_by_case[case.name, engine] = answer
    return models_by_case


def with_models(question: tuple[Case, str, tuple[str, ...]]) -> ModelsByMethod:
    """Return the models of a case's scene for the selected methods of an engine, by the spelling of the method.

    question: the case, the name of the engine, and the spellings of the selected methods; see `models_of`.
    """
    case, engine, integrators = question
    adapter = registry.load(engine)
    names = offered(adapter.engine, case.scene)
    spellings = resolved(adapter.engine, kind_of(case.scene), integrators)
    wanted = {Method.parse(spelling, 0.0).name for spelling in spellings}
    if (integrators and not wanted) or not isinstance(adapter, Models):
        return {}
    offered_models = {name: dict(adapter.models(case.scene, name)) for name in names}
    growing = {name: models for name, models in offered_models.items() if models and (not wanted or name in wanted)}
    return growing if wanted else dict(list(growing.items())[:1])


def evaluate(
    results: Results, engines: Mapping[str, Engine], integrators: Sequence[str], timesteps: Sequence[float]
) -> list[ModelRow]:
    """Measure costs, and return one row per model for every case, engine, integrator and time step.

    Costs are measured while nothing else runs. The models of one case, engine, integrator and time step are timed in turn.

    Parameters
    ----------
    results
        The results of the tasks of `plan`.
    engines
        The records of the engines by name.
    integrators, timesteps
        The integrators and time steps (s) for which `plan` was called.
    """
    verdicts = {verdict.run.key: verdict for verdict in judgement.judge(results)}
    cases = list(results.cases.values())
    offered_models = models_of(cases, engines, integrators)
    rows = []
    for case in cases:
        for engine in engines:
            for integrator, models in offered_models[case.name, engine].items():
                for timestep in dict.fromkeys(timesteps or (DEFAULT_TIMESTEP,)):
                    group = RunKey(case.name, engine, Method.parse(integrator, timestep))
                    rows += rows_of(case, group, models, verdicts)
    return rows


def rows_of(case: Case, group: RunKey, models: Mapping[str, Model], verdicts: Mapping[RunKey, Verdict]) -> list[ModelRow]:
    """Return the rows of one case, engine, integrator and time step, one for each model, from the smallest to the largest.

    Parameters
    ----------
    case
        The case.
    group
        The case, the engine, the integrator without a model, and the time step.
    models
        The models by name.
    verdicts
        The verdicts on the runs of all models, with the time step and with half of it.
    """

    def verdict(model: Model, timestep: float) -> Verdict:
        return verdicts[RunKey(group.case, group.engine, Method.parse(model.method, timestep))]

    step = group.method.timestep
    pairs = {name: (verdict(model, step), verdict(model, step / 2)) for name, model in models.items()}
    completed = {model: coarse for model, (coarse, _) in pairs.items() if coarse.discrepancy is not None}
    times, untimed = measured(case, completed)
    smallest = next(iter(pairs))
    rows = []
    for model, (coarse, finer) in pairs.items():
        seconds, relative = times.get(model, (None, None))
        rows.append(
            ModelRow(
                *(group.case, group.engine, coarse.run.version, group.method.name, step, model, models[model].adds),
                status=coarse.outcome.status,
                reason=coarse.outcome.reason or untimed,
                time_per_step=seconds.median if seconds else None,
                relative_cost=relative.median if relative and smallest in times else None,
                relative_cost_low=relative.low if relative and smallest in times else None,
                relative_cost_high=relative.high if relative and smallest in times else None,
                changes=changes(coarse, finer, *pairs[smallest]),
                errors=coarse.discrepancy.maxima() if coarse.discrepancy is not None else {},
            )
        )
    return rows


def measured(case: Case, completed: Mapping[str, Verdict]) -> tuple[dict[str, tuple[Cost, Cost]], str]:
    """Return the time per step of each model and its ratio to the first model's; and if the timing failed, the reason.

    If it failed for any model, the mapping is empty for all. completed: the verdicts on the completed runs by model.
    """
    stretches = [
        Stretch(case.scene, verdict.run.engine, verdict.run.method, verdict.outcome.steps)
        for verdict in completed.values()
        if isinstance(verdict.outcome, Completed)
    ]
    if not stretches:
        return {}, ""
    costs = cost.measure(stretches, campaign.TIME_LIMIT_S)
    if failed := [measurement for measurement in costs if isinstance(measurement, Crashed | TimedOut)]:
        return {}, f"its cost could not be measured: {failed[0].reason}"
    return dict(
        zip(completed, compared([measurement.times for measurement in costs if isinstance(measurement, Measured)]), strict=True)
    ), ""


def compared(times: Sequence[Array]) -> list[tuple[Cost, Cost]]:
    """Return for each model the cost from its times (rounds,), and the cost as a ratio to the first model's, round by round."""
    return [(cost.summarise(model_times), cost.summarise(model_times / times[0])) for model_times in times]


def changes(coarse: Verdict, finer: Verdict, smallest: Verdict, finer_smallest: Verdict) -> dict[str, Change]:
    """Return the differences of a model's motion from the smallest model's, by quantity; empty if any run did not complete.

    Parameters
    ----------
    coarse, finer
        The verdicts on the model's runs with the time step and with half of it.
    smallest, finer_smallest
        The verdicts on the smallest model's runs with the same time steps.
    """
    outcomes = [verdict.outcome for verdict in (coarse, finer, smallest, finer_smallest)]
    runs = [outcome for outcome in outcomes if isinstance(outcome, Completed)]
    if len(runs) < len(outcomes):
        return {}
    here, half, there, half_there = common([run.trajectory for run in runs])
    differences = {}
    for quantity, apart, size in (
        ("position", positions_apart, float(np.abs(here.position).max())),
        ("attitude", attitudes_apart, 1.0),
    ):
        time_step = FIRST_ORDER_FACTOR * (apart(here, half) + apart(there, half_there))
        # In the worst case, the rounding errors of all steps add up.
        rounding = runs[0].steps * float(np.finfo(float).eps) * size
        differences[quantity] = Change(apart(here, there), rounding, time_step)
    return differences


def positions_apart(one: Trajectory, other: Trajectory) -> float:
    """Return the largest distance (m) between the centres of mass of two trajectories with the same instants."""
    return largest(distance(one.position, other.position))


def attitudes_apart(one: Trajectory, other: Trajectory) -> float:
    """Return the largest angle (rad) between the attitudes of two trajectories with the same instants."""
    return largest(geodesic_angle(normalise(one.quaternion), normalise(other.quaternion)))


def largest(values: Array) -> float:
    """Return the largest value of an array as a float."""
    return float(values.max())
