"""What a scene does not require costs, and changes: a case on models that grow step by step, each against the smallest."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bodycheck.adapters.contract import Adapter, Method, Model, Models
from bodycheck.adapters.method import DEFAULT_TIMESTEP
from bodycheck.adapters.offers import offered
from bodycheck.casefile.case import Case
from bodycheck.errors import BadInput
from bodycheck.judging import judgement
from bodycheck.judging.convergence import common
from bodycheck.judging.judgement import Verdict
from bodycheck.reference.kinematics import geodesic_angle, normalise
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import distance
from bodycheck.running import campaign, csv_tables, pool
from bodycheck.running.key import RunKey
from bodycheck.running.outcome import Completed
from bodycheck.running.plan import Task, check
from bodycheck.running.store import Results
from bodycheck.studies import cost
from bodycheck.studies.ablation.rows import Change, ModelRow
from bodycheck.studies.cost import Cost, Stretch

#: Of ablation.csv, followed by the errors, the changes against the smallest model with the rounding and the time-step errors
#: that they may be due to, what became of the run, and what the model adds to the one before it.
COLUMNS = (
    *("case", "engine", "version", "integrator", "timestep", "model"),
    *("relative_cost", "relative_cost_low", "relative_cost_high"),
)

#: An error of first order is twice what it changes by when the step is halved; one of higher order is less.
LEFT = 2.0

#: Seconds a step, and relative to the first.
Timed = tuple[list[Cost], list[Cost]]


def plan(
    cases: Sequence[Case], engines: Mapping[str, Adapter], integrators: Sequence[str], timesteps: Sequence[float]
) -> tuple[Task, ...]:
    """Every case x engine x integrator x time step (s) x model, each with its step and the half of it.

    Without integrators the first that each engine has models for, without time steps the default. Raises `BadInput` as
    `bodycheck.running.plan.plan` does, and where there are no models to compare.
    """
    steps = [part for timestep in timesteps or (DEFAULT_TIMESTEP,) for part in (timestep, timestep / 2)]
    check(cases, engines, integrators, steps)
    tasks = dict.fromkeys(
        Task(case, engine, Method.parse(model.method, step))
        for case in cases
        for engine, adapter in engines.items()
        for integrator, models in with_models(adapter, case, integrators).items()
        for step in steps
        for model in models.values()
    )
    if not tasks:
        raise BadInput(f"nothing to compare: {', '.join(engines)} offer no models of these cases for what was asked")
    return tuple(tasks)


def with_models(adapter: Adapter, case: Case, integrators: Sequence[str]) -> dict[str, Mapping[str, Model]]:
    """The models of a case's scene by the spelling of the method that was asked for, of those that have any.

    Where none was asked for, it is the first method of the engine that has models.
    """
    if not isinstance(adapter, Models):
        return {}
    asked = {Method.parse(spelling, 0.0).name for spelling in integrators}
    found = {name: adapter.models(case.scene, name) for name in offered(adapter.engine, case.scene)}
    growing = {name: models for name, models in found.items() if models and (not asked or name in asked)}
    return growing if asked else dict(list(growing.items())[:1])


def evaluate(
    results: Results, engines: Mapping[str, Adapter], integrators: Sequence[str], timesteps: Sequence[float]
) -> list[ModelRow]:
    """A row a model, of the runs with the integrators and time steps (s) that were asked for.

    Costs are measured now, with nothing else running, the models of one case and integrator in turn.
    """
    verdicts = {verdict.run.key: verdict for verdict in judgement.judge(results)}
    rows = []
    for case in results.cases.values():
        for engine, adapter in engines.items():
            for integrator, models in with_models(adapter, case, integrators).items():
                for timestep in dict.fromkeys(timesteps or (DEFAULT_TIMESTEP,)):
                    group = RunKey(case.name, engine, Method.parse(integrator, timestep))
                    rows += rows_of(case, group, models, verdicts)
    return rows


def rows_of(case: Case, group: RunKey, models: Mapping[str, Model], verdicts: Mapping[RunKey, Verdict]) -> list[ModelRow]:
    """The rows of one case, engine, integrator and time step: a model each, in order of growth.

    verdicts: on the runs of all models with this time step and with its half.
    """

    def verdict(model: Model, timestep: float) -> Verdict:
        return verdicts[RunKey(group.case, group.engine, Method.parse(model.method, timestep))]

    step = group.method.timestep
    pairs = {name: (verdict(model, step), verdict(model, step / 2)) for name, model in models.items()}
    completed = {model: own for model, (own, _) in pairs.items() if own.discrepancy is not None}
    times, untimed = measured(case, completed)
    smallest = next(iter(pairs))
    rows = []
    for model, (own, finer) in pairs.items():
        seconds, relative = times.get(model, (None, None))
        rows.append(
            ModelRow(
                *(group.case, group.engine, own.run.version, group.method.name, step, model, models[model].adds),
                status=own.outcome.status,
                reason=own.outcome.reason or untimed,
                time_per_step=seconds.median if seconds else None,
                relative_cost=relative.median if relative and smallest in times else None,
                relative_cost_low=relative.low if relative and smallest in times else None,
                relative_cost_high=relative.high if relative and smallest in times else None,
                changes=changes(own, finer, *pairs[smallest]),
                errors=own.discrepancy.maxima() if own.discrepancy is not None else {},
            )
        )
    return rows


def measured(case: Case, completed: Mapping[str, Verdict]) -> tuple[dict[str, tuple[Cost, Cost]], str]:
    """Seconds a step of each model, and their ratio to those of the first in the same round; and why there are none."""
    stretches = [
        Stretch(case.scene, verdict.run.engine, verdict.run.method, verdict.outcome.steps)
        for verdict in completed.values()
        if isinstance(verdict.outcome, Completed)
    ]
    if not stretches:
        return {}, ""
    ((_, answer),) = pool.call_all(time_in_turn, [stretches], jobs=1, limit=campaign.TIME_LIMIT)
    if not isinstance(answer, tuple):
        return {}, f"its cost could not be measured: {answer.reason}"
    return dict(zip(completed, zip(*answer, strict=True), strict=True)), ""


def time_in_turn(stretches: Sequence[Stretch]) -> Timed:
    """The cost of each stretch, and its ratio to that of the first."""
    times = cost.measure(stretches)
    return cost.summarise(times), cost.summarise(times / times[0])


def changes(own: Verdict, finer: Verdict, smallest: Verdict, finer_smallest: Verdict) -> dict[str, Change]:
    """How far a model's motion is from the smallest model's; empty where one of the four runs has not completed."""
    outcomes = [verdict.outcome for verdict in (own, finer, smallest, finer_smallest)]
    runs = [outcome for outcome in outcomes if isinstance(outcome, Completed)]
    if len(runs) < len(outcomes):
        return {}
    here, half, there, half_there = common([run.trajectory for run in runs])
    found = {}
    for quantity, apart, size in (
        ("position", positions_apart, float(np.abs(here.position).max())),
        ("attitude", attitudes_apart, 1.0),
    ):
        time_step = LEFT * (apart(here, half) + apart(there, half_there))
        # Every step rounds once, and roundings add up at worst.
        rounding = runs[0].steps * float(np.finfo(float).eps) * size
        found[quantity] = Change(apart(here, there), rounding, time_step)
    return found


def positions_apart(one: Trajectory, other: Trajectory) -> float:
    return largest(distance(one.position, other.position))


def attitudes_apart(one: Trajectory, other: Trajectory) -> float:
    return largest(geodesic_angle(normalise(one.quaternion), normalise(other.quaternion)))


def largest(values: Array) -> float:
    return float(values.max())


def write(rows: Sequence[ModelRow], folder: Path) -> None:
    """Write ablation.csv into a folder."""
    table = records(rows)
    csv_tables.write(folder / "ablation.csv", list(table[0]), table)


def records(rows: Sequence[ModelRow]) -> list[dict[str, Any]]:
    """The rows with all of their columns, None where a run has no figure."""
    errors = dict.fromkeys(name for row in rows for name in row.errors)
    found = []
    for row in rows:
        record: dict[str, Any] = {name: getattr(row, name) for name in COLUMNS} | errors | dict(row.errors)
        for quantity in ("position", "attitude"):
            change = row.changes.get(quantity)
            record[f"{quantity}_change"] = change.size if change else None
            record[f"{quantity}_rounding"] = change.rounding if change else None
            record[f"{quantity}_time_step"] = change.time_step if change else None
        told = {"time_per_step": row.time_per_step, "status": row.status, "reason": row.reason, "adds": row.adds}
        found.append(record | told)
    return found
