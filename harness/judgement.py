"""What stored runs are worth: discrepancies from the truth, expectations, and one row of results a run."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import pandas as pd

from bodycheck.case import Case, Expectation
from bodycheck.discrepancy import COLUMNS as DISCREPANCIES
from bodycheck.discrepancy import FURTHER_COLUMNS, Discrepancy, compare
from bodycheck.outcome import Completed, Outcome, Run, Unsupported
from bodycheck.reference.truth import Truth
from bodycheck.store import Results

COLUMNS = (
    *("case", "engine", "version", "integrator", "timestep", "status", "passed", "reason"),
    *DISCREPANCIES,
    *("steps", "wall_time", "time_per_step", "realtime_factor"),
)
"""Of every table of results. Those of `FURTHER_COLUMNS` that any run has follow."""


@dataclass(frozen=True, eq=False)
class Verdict:
    """A run, judged. discrepancy: None for a run that is not ok. passed: None where nothing was expected of it.

    reason: why it is not ok, or which expectation does not hold.
    """

    run: Run
    outcome: Outcome
    discrepancy: Discrepancy | None
    passed: bool | None
    reason: str

    def row(self) -> dict[str, Any]:
        """The run's row of results, with the columns `COLUMNS`; what a run that is not ok lacks is absent."""
        method = self.run.method
        row: dict[str, Any] = {
            "case": self.run.case,
            "engine": self.run.engine,
            "version": self.run.version,
            "integrator": method.integrator,
            "timestep": method.timestep,
            "status": self.outcome.status,
            "passed": self.passed,
            "reason": self.reason,
        }
        if self.discrepancy is not None and isinstance(self.outcome, Completed):
            steps, wall_time = self.outcome.steps, self.outcome.wall_time
            row |= self.discrepancy.maxima() | {"steps": steps, "wall_time": wall_time}
            if steps:
                row |= {"time_per_step": wall_time / steps, "realtime_factor": steps * method.timestep / wall_time}
        return row


def judge(results: Results) -> list[Verdict]:
    """The verdicts on all runs of a results folder, in the order of its cases."""
    truths = cache(results.truth)
    return [verdict(results.cases[run.case], truths(run.case, run.method.timestep), run) for run in results.runs()]


def verdict(case: Case, truth: Truth | Unsupported, run: Run) -> Verdict:
    """The verdict on one run against the truth at its instants; a run without a truth counts as unsupported."""
    outcome: Outcome = run.outcome
    if isinstance(outcome, Completed) and isinstance(truth, Unsupported):
        outcome = truth
    discrepancy = compare(truth, run) if isinstance(outcome, Completed) and isinstance(truth, Truth) else None
    expectations = [expectation for expectation in case.expectations if _concerns(expectation, run)]
    if discrepancy is None:
        passed = False if outcome.failed or expectations else None
        return Verdict(run, outcome, None, passed, outcome.reason)
    broken = [text for expectation in expectations for text in _broken(expectation, discrepancy)]
    return Verdict(run, outcome, discrepancy, not broken if expectations else None, "; ".join(broken))


def records(verdicts: Iterable[Verdict]) -> list[dict[str, Any]]:
    """The rows of results with all of `COLUMNS`, in their order; None where a run has no figure."""
    rows = [verdict.row() for verdict in verdicts]
    more = [name for name in FURTHER_COLUMNS if any(name in row for row in rows)]
    return [dict.fromkeys((*COLUMNS, *more)) | row for row in rows]


def table(verdicts: Iterable[Verdict]) -> pd.DataFrame:
    """One row a run, in the columns and order of `records`."""
    rows = records(verdicts)
    columns = list(rows[0]) if rows else list(COLUMNS)
    frame = pd.DataFrame(rows, columns=columns)
    figures = dict.fromkeys(columns[columns.index("reason") + 1 :], "Float64")
    return frame.astype({"passed": "boolean", **figures, "steps": "Int64"})


def write(verdicts: Iterable[Verdict], folder: Path) -> None:
    """results.csv and results.parquet in a folder."""
    frame = table(verdicts)
    frame.to_csv(folder / "results.csv", index=False)
    frame.to_parquet(folder / "results.parquet", index=False)


def _concerns(expectation: Expectation, run: Run) -> bool:
    return (
        expectation.engine == run.engine
        and expectation.integrator == run.method.integrator
        and math.isclose(expectation.timestep, run.method.timestep, rel_tol=1e-12)
    )


def _broken(expectation: Expectation, discrepancy: Discrepancy) -> list[str]:
    maxima = discrepancy.maxima()
    return [
        f"{name} is {maxima[name]:.3g}, expected at most {limit:g}"
        if name in maxima
        else f"{name} is expected, but not measured in this scene"
        for name, limit in expectation.limits
        if not maxima.get(name, math.inf) <= limit
    ]
