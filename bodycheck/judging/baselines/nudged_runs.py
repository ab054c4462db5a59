"""Completed runs, repeated from nudged initial states: by how much rounding may change their figures."""

from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache

from bodycheck.judging.baselines import rounding
from bodycheck.judging.judgement import Verdict
from bodycheck.processes import pool
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Run
from bodycheck.results.store import Results
from bodycheck.running import campaign
from bodycheck.running.engines import home
from bodycheck.running.plan import Task
from bodycheck.running.tasks import group, perform_run

#: Suffix of the column with the allowed difference of a figure if nothing has changed; see `rounding.allowances`.
ALLOWANCE = "_allowance"


def measured(
    results: Results, verdicts: Sequence[Verdict], jobs: int, progress: Callable[[str], None]
) -> dict[RunKey, dict[str, float]]:
    """Repeat the completed runs with nudged initial states, and return the allowances of figures by the key of the run."""
    truths = lru_cache(1)(results.truth)
    waiting = {verdict.run.key: verdict.run for verdict in verdicts if verdict.discrepancy is not None}
    tasks = [
        Task(rounding.nudged(results.cases[run.case], run, seed), run.engine, run.method)
        for run in waiting.values()
        for seed in range(rounding.NUDGES)
    ]
    answers: dict[RunKey, list[Run]] = defaultdict(list)
    found = {}
    with pool.Workers(perform_run, jobs, campaign.TIME_LIMIT_S, group=group, home=home) as workers:
        for task, answer in workers.map(tasks):
            progress(f"{task.case.name} · {task.engine} {task.method}, nudged")
            key = task.key
            answers[key].append(answer if isinstance(answer, Run) else replace(waiting[key], outcome=answer))
            if len(answers[key]) == rounding.NUDGES:
                run = waiting.pop(key)
                found[key] = _row_of(truths(run.case, run.method.timestep), run, answers.pop(key))
    return found


def _row_of(truth: Truth | NoTruth, run: Run, others: Sequence[Run]) -> dict[str, float]:
    assert isinstance(truth, Truth)  # the run has a discrepancy
    return {f"{name}{ALLOWANCE}": value for name, value in rounding.allowances(truth, run, others).items()}
