"""Measure the errors of batches, which are many scenes that an engine steps at once, and the cost of a step of one scene.

A batch has the scene of a case and copies of it that are turned about the vertical. It is run over the whole duration, and its
cost and its errors come from the same run. States are compared with the truth and discarded block by block, so that the memory
does not grow with the number of samples.

No horizontal direction is distinguished in the scenes of a batch: gravity and the normal of the plane are vertical; drag and
Coulomb friction oppose the motion. The truth of a copy is therefore the truth of the scene, turned by the same angle. Inclined
planes and pushes distinguish a direction, and scenes with them have no batches. The copies have different numbers, so that no
result can be reused for another scene, but they are equally difficult.
"""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import (
    Engine,
    EngineDiverged,
    Method,
    SceneUnsupported,
    Signals,
    Simulation,
    Strides,
)
from bodycheck.adapters.method import DEFAULT_TIMESTEP
from bodycheck.casefile.content import Case
from bodycheck.judging import judgement
from bodycheck.judging.judgement import Verdict
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.kinematics import conjugate, geodesic_angle, multiply, rotate
from bodycheck.reference.mechanisms.mechanism import alone
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Quaternion, Scene, vector_of
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed, Diverged, Outcome, Run, Unsupported
from bodycheck.results.store import Results
from bodycheck.running import campaign
from bodycheck.running.engines import home
from bodycheck.running.instants import sampling_steps, sampling_times
from bodycheck.running.simulation import AdapterFault, outcome_of
from bodycheck.studies.cost import ROUNDS
from bodycheck.studies.tradeoff.rows import BATCH_COLUMNS
from bodycheck.studies.tradeoff.study import NO_COSTS, cost_columns

#: Most states, over all scenes, that are in memory at a time: 26 MiB.
MOST_STATES = 1 << 18

#: Most steps, over all scenes, that are taken at a time. After each such block the time of the whole run is estimated again.
MOST_STEPS = 1 << 18

#: A batch is run repeatedly, at most `ROUNDS` times, until its steps have taken this time (s) in all.
ENOUGH_S = 1.0

#: Most time (s) of the steps of one batch. A batch that would take longer is stopped.
MOST_S = 100.0

#: The reason why scenes with bodies that touch have no copies. A body that lies flat on a level plane does have copies.
NOT_TURNED = "the scenes of a batch are turned about the vertical, and bodies that touch are not turned"

#: The seed of the angles.
SEED = 20


@dataclass(frozen=True, eq=False)
class Batch:
    """A batch to be run: the scene of a case and turned copies of it, `scenes` scenes in all, with the truth of the case."""

    case: Case
    engine: str
    method: Method
    scenes: int
    truth: Trajectory


@dataclass(frozen=True, eq=False)
class Ran:
    """The measurements of a batch.

    Attributes
    ----------
    outcome
        The outcome of the case itself, the first scene of the batch.
    times, processor_times
        The time (s) and the processor time (s) per step and scene, of each round.
    setup
        The time (s) of the first preparation, in which some engines compile code.
    position_error, attitude_error
        The largest errors (m, rad) over all scenes that did not fail.
    failed
        The number of scenes that failed: those whose errors are not finite.
    """

    outcome: Outcome
    times: tuple[float, ...] = ()
    processor_times: tuple[float, ...] = ()
    setup: float | None = None
    position_error: float | None = None
    attitude_error: float | None = None
    failed: int | None = None


def plan(
    results: Results,
    verdicts: Sequence[Verdict],
    engines: Mapping[str, Engine],
    sizes: Sequence[int],
    timesteps: Sequence[float],
) -> list[Batch]:
    """Return the batches of all methods with completed runs. Mechanisms have none, and methods with error control.

    Both are stepped one at a time, so that the cost of a batch is the cost of its runs.

    Parameters
    ----------
    results, verdicts
        The results of single runs, and the verdicts on them.
    engines
        The records of the engines by name.
    sizes
        The numbers of scenes. Of these, an engine that steps one scene at a time is run only with 1.
    timesteps
        The time steps (s) that the user chose. If it is empty, each method is run with that of its time steps which is nearest
        to the default.
    """
    return [
        Batch(results.cases[verdict.run.case], verdict.run.engine, verdict.run.method, size, truth.trajectory)
        for verdict in _chosen(verdicts, timesteps)
        for truth in [results.truth(verdict.run.case, verdict.run.method.sampling)]
        if isinstance(truth, Truth) and isinstance(truth.scene, Scene)  # mechanisms are stepped one at a time
        for size in sizes
        if size == 1 or engines[verdict.run.engine].batch > 1
    ]


def rows(
    batches: Sequence[Batch],
    results: Results,
    engines: Mapping[str, Engine],
    progress: Callable[[str], None] = lambda done: None,
) -> list[dict[str, Any]]:
    """Run batches while nothing else runs, each engine in a separate process, and return one row for each batch.

    Rows have the columns of results, `COST_COLUMNS` and `BATCH_COLUMNS`.

    Parameters
    ----------
    batches
        The batches, as `plan` returns them.
    results
        The results of single runs.
    engines
        The records of the engines by name.
    progress
        A function that is called with a text after each batch.
    """
    batch_rows = []
    with pool.Workers(run, 1, campaign.TIME_LIMIT_S, group=lambda batch: batch.engine, home=home, kept=1) as workers:
        for batch in batches:
            ran = workers.call(batch)
            truth = results.truth(batch.case.name, batch.method.sampling)
            assert isinstance(truth, Truth)  # the batch was made with this truth
            batch_rows.append(_row(batch, ran if isinstance(ran, Ran) else Ran(ran), truth, engines[batch.engine]))
            progress(f"{batch.case.name} · {batch.engine} {batch.method.name} · in batches of {batch.scenes}")
    return batch_rows


def rows_alike(*tables: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Return the rows of several tables, all with the columns of the table that has the most columns.

    These columns contain those of the other tables. Values that a row lacks are None.
    """
    columns = max((list(rows[0]) for rows in tables if rows), key=len)
    return [dict.fromkeys(columns) | dict(row) for rows in tables for row in rows]


def _chosen(verdicts: Sequence[Verdict], timesteps: Sequence[float]) -> Iterator[Verdict]:
    """Yield the verdicts on completed runs with the chosen time steps, or with each method's step nearest to the default."""
    fixed = [verdict for verdict in verdicts if verdict.run.method.accuracy is None]
    completed = [verdict for verdict in fixed if verdict.discrepancy is not None]
    nearest: dict[object, float] = {}
    for verdict in completed:
        key, step = verdict.run.key.over_steps, verdict.run.method.timestep
        nearest[key] = min(nearest.get(key, step), step, key=lambda other: abs(np.log(other / DEFAULT_TIMESTEP)))
    for verdict in completed:
        step = verdict.run.method.timestep
        if step in timesteps or (not timesteps and step == nearest[verdict.run.key.over_steps]):
            yield verdict


def _row(batch: Batch, ran: Ran, truth: Truth, engine: Engine) -> dict[str, Any]:
    """Return the row of a batch. Its errors are those of the case itself; its times are per step of one scene."""
    case = replace(batch.case, expectations=())  # expectations are about single runs
    run = Run(case.name, batch.engine, engine.version, batch.method, ran.outcome, scene=case.scene)
    (row,) = judgement.records([judgement.verdict(case, truth, run)])
    row.pop("evaluations")  # the column of this name in the table of the study is per step
    row |= {**NO_COSTS, **dict.fromkeys(BATCH_COLUMNS)}
    row |= {"batch": batch.scenes, "device": engine.device, "precision": engine.precision, "failed_scenes": ran.failed}
    if not isinstance(ran.outcome, Completed):
        return row
    integrator, steps = offers.integrator_of(engine, batch.method), ran.outcome.steps * batch.scenes
    costs = cost_columns(np.array(ran.times), np.array(ran.processor_times), batch.method.timestep, steps)
    return row | {
        **costs,
        "evaluations": integrator.evaluations if integrator is not None else None,
        "setup_time": ran.setup,
        "worst_position_error": ran.position_error,
        "worst_attitude_error": ran.attitude_error,
    }


def run(batch: Batch) -> Ran:
    """Run a batch in this process, and return its measurements. Failures of the engine and the adapter are outcomes."""
    try:
        return _measured(batch)
    except SceneUnsupported as error:
        return Ran(Unsupported(str(error)))
    except EngineDiverged as error:
        return Ran(Diverged(str(error), "gave up"))
    except AdapterFault as fault:
        return Ran(Crashed(f"the adapter of {batch.engine} is at fault in the case {batch.case.name}: {fault}"))


@dataclass
class _Pass:
    """One run of a batch: the states of its first scene, the largest errors of each scene, and the times (s) of the run."""

    rows: Array
    position_error: Array
    attitude_error: Array
    seconds: float = 0.0
    processor_seconds: float = 0.0


def _measured(batch: Batch) -> Ran:
    adapter, scenes = registry.load(batch.engine), turned(alone(batch.case.scene), batch.scenes)
    steps = sampling_steps(batch.case.instants, batch.method.timestep)
    start = time.perf_counter()
    simulation = offers.prepare(adapter, scenes, batch.method)
    setup = time.perf_counter() - start
    passes = [_pass(simulation, batch, steps)]
    while (
        passes[0] is not None and len(passes) < ROUNDS and sum(run_pass.seconds for run_pass in passes if run_pass) < ENOUGH_S
    ):
        passes.append(_pass(offers.prepare(adapter, scenes, batch.method), batch, steps))
    complete = [run_pass for run_pass in passes if run_pass is not None]
    if not complete:
        return Ran(TimedOut(MOST_S, f"stopped, because the batch would take more than {MOST_S:g} s"))
    first, taken = complete[0], int(steps[-1]) * batch.scenes
    if isinstance(simulation, Signals) and 0 in simulation.signals:
        outcome: Outcome = Diverged(simulation.signals[0], "gave up")
    else:
        times = sampling_times(batch.case.instants, batch.method.sampling)
        outcome = outcome_of(first.rows, simulation, batch.case.scene, batch.method, times, first.seconds)
    sound = np.isfinite(first.position_error) & np.isfinite(first.attitude_error)
    return Ran(
        outcome,
        times=tuple(run_pass.seconds / taken for run_pass in complete),
        processor_times=tuple(run_pass.processor_seconds / taken for run_pass in complete),
        setup=setup,
        position_error=float(first.position_error[sound].max()) if sound.any() else None,
        attitude_error=float(first.attitude_error[sound].max()) if sound.any() else None,
        failed=int((~sound).sum()),
    )


def _pass(simulation: Simulation, batch: Batch, steps: Strides) -> _Pass | None:
    """Run a batch from its start, and return its states, errors and times; None if it would take too long."""
    strides = np.diff(steps, prepend=0)
    stride = max(1, int(strides.max(initial=0)))
    size = max(1, min(MOST_STATES, MOST_STEPS // stride) // batch.scenes)
    run_pass = _Pass(np.empty((len(steps), 13)), *np.zeros((2, batch.scenes)))
    for first in range(0, len(strides), size):
        part = slice(first, first + size)
        with np.errstate(all="ignore"):  # scenes that overflow are judged by their states
            processor, start = time.process_time(), time.perf_counter()
            states = np.asarray(simulation.advance(strides[part]), dtype=np.float64)
            run_pass.seconds += time.perf_counter() - start
            run_pass.processor_seconds += time.process_time() - processor
            if states.shape != (shape := (batch.scenes, len(strides[part]), 1, 13)):
                raise AdapterFault(f"its states have the shape {states.shape}, not {shape}")
            run_pass.rows[part] = states[0, :, 0]
            position, attitude = errors(states[:, :, 0], batch.truth.part(part))
            run_pass.position_error = np.maximum(run_pass.position_error, position.max(axis=1))
            run_pass.attitude_error = np.maximum(run_pass.attitude_error, attitude.max(axis=1))
        done = int(steps[part][-1])
        if run_pass.seconds * (int(steps[-1]) / max(1, done)) > MOST_S and done:
            return None
    return run_pass


def turns(count: int) -> Array:
    """Return quaternions (count, 4), w x y z, of turns about the vertical by random angles; the first is the identity.

    Every call returns the same quaternions.
    """
    halves = np.random.default_rng(SEED).uniform(0.0, np.pi, count)
    halves[0] = 0.0
    nothing = np.zeros(count)
    return np.column_stack([np.cos(halves), nothing, nothing, np.sin(halves)])


def turned(scene: Scene, count: int) -> list[Scene]:
    """Return a scene and copies of it that are turned about the vertical, `count` scenes in all.

    Raises `SceneUnsupported` for bodies that touch, except for a body that lies flat on a level plane.
    """
    if touches(scene):
        raise SceneUnsupported(NOT_TURNED)
    initial, by = scene.initial, turns(count)
    position, velocity = (rotate(by, np.array(part)).tolist() for part in (initial.position, initial.velocity))
    quaternion = multiply(by, np.array(initial.quaternion)).tolist()
    copies = [
        replace(scene, initial=replace(initial, position=vector_of(p), quaternion=_quaternion(q), velocity=vector_of(v)))
        for p, q, v in zip(position, quaternion, velocity, strict=True)
    ]
    return [scene, *copies[1:]]


def errors(states: Array, truth: Trajectory) -> tuple[Array, Array]:
    """Return the position errors (m) and the attitude errors (rad) of turned scenes, both of shape (scenes, n).

    Parameters
    ----------
    states
        The states (scenes, n, 13) of the scenes that `turned` returns.
    truth
        The truth of the scene itself at the n instants.
    """
    back = conjugate(turns(len(states)))[:, None]
    apart = rotate(back, states[..., :3]) - truth.position
    return np.linalg.norm(apart, axis=-1), geodesic_angle(multiply(back, states[..., 3:7]), truth.quaternion)


def _quaternion(components: list[float]) -> Quaternion:
    w, x, y, z = components
    return w, x, y, z
