"""What stored runs are worth: discrepancies from the truth, expectations, and one row of results a run."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, date, datetime
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bodycheck.casefile.case import Case
from bodycheck.casefile.expectation import ORDER, REFINEMENTS, Expectation, Limit, unit
from bodycheck.figures.columns import ALWAYS_TABLED, FURTHER, truth_bounds
from bodycheck.judging.convergence import attitude_order
from bodycheck.judging.discrepancy import Discrepancy, compare
from bodycheck.reference.truth import Truth
from bodycheck.running.outcome import Completed, Outcome, Run, Unsupported
from bodycheck.running.store import Results

#: Of every table of results. Those of `FURTHER` that any run has follow.
COLUMNS = (
    *("case", "engine", "version", "integrator", "timestep", "status", "passed", "reason"),
    *ALWAYS_TABLED,
    *("steps", "wall_time", "time_per_step", "realtime_factor"),
)

#: The column before these where results of several sets are in one table.
LABEL = "set"


@dataclass(frozen=True)
class Breach:
    """What of an expectation does not hold: a figure's name, or "status"; both sides in words; and what else is to be said."""

    name: str
    measured: str
    expected: str
    notes: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """As one sentence."""
        return "; ".join((f"{self.name} is {self.measured}, expected {self.expected}", *self.notes))


@dataclass(frozen=True)
class Judged:
    """An expectation, held against a run on a day. text: what is to be said of it; a known discrepancy is told either way."""

    expectation: Expectation
    breaches: tuple[Breach, ...]
    held: bool
    text: str


@dataclass(frozen=True, eq=False)
class Verdict:
    """A run, judged. discrepancy: None for a run that is not ok. passed: None where nothing was expected of it.

    reason: why it is not ok, which expectation does not hold, or what is to be said of a discrepancy that is known.
    known: whether one was. judged: what was expected of it, in the order of the case.
    label: of the results that the run is from, where several are looked at together.
    """

    run: Run
    outcome: Outcome
    discrepancy: Discrepancy | None
    passed: bool | None
    reason: str
    known: bool = False
    judged: tuple[Judged, ...] = ()
    label: str = ""

    def row(self) -> dict[str, Any]:
        """The run's row of results, with the columns `COLUMNS`; what a run that is not ok lacks is absent."""
        method = self.run.method
        row: dict[str, Any] = {
            **({LABEL: self.label} if self.label else {}),
            "case": self.run.case,
            "engine": self.run.engine,
            "version": self.run.version,
            "integrator": method.name,
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


def judge(results: Results, today: date | None = None) -> list[Verdict]:
    """The verdicts on all runs of a results folder, in the order of its cases, as of a day."""
    truths = cache(results.truth)
    runs = list(results.runs())
    return [
        verdict(results.cases[run.case], truths(run.case, run.method.timestep), run, _finer(run, runs), today) for run in runs
    ]


def verdict(case: Case, truth: Truth | Unsupported, run: Run, finer: Sequence[Run] = (), today: date | None = None) -> Verdict:
    """The verdict on one run against the truth at its instants; a run without a truth counts as unsupported.

    finer: those of the same method with a half and a quarter of its time step, for expectations of an order.
    today: the day by which a known discrepancy may be over; this day by default.
    """
    outcome: Outcome = run.outcome
    if isinstance(outcome, Completed) and isinstance(truth, Unsupported):
        outcome = truth
    discrepancy = compare(truth, run) if isinstance(outcome, Completed) and isinstance(truth, Truth) else None
    expectations = [e for e in case.expectations if e.concerns(run.engine, run.method)]
    if not expectations:
        return Verdict(run, outcome, discrepancy, False if outcome.failed else None, outcome.reason)
    order = _order(truth, (run, *finer)) if any(expectation.needs_order for expectation in expectations) else None
    bounds = {} if isinstance(truth, Unsupported) else {name: float(b.max()) for name, b in truth_bounds(truth).items()}
    judged = tuple(
        settle(expectation, broken(expectation, outcome, discrepancy, order, bounds), today or datetime.now(UTC).date())
        for expectation in expectations
    )
    reasons = [one.text for one in judged if one.text] or [outcome.reason]
    known = any(expectation.known for expectation in expectations)
    return Verdict(run, outcome, discrepancy, all(one.held for one in judged), "; ".join(reasons), known, judged)


def records(verdicts: Iterable[Verdict]) -> list[dict[str, Any]]:
    """The rows of results with all of `COLUMNS`, in their order; None where a run has no figure."""
    rows = [verdict.row() for verdict in verdicts]
    more = [name for name in FURTHER if any(name in row for row in rows)]
    labels = (LABEL,) if any(LABEL in row for row in rows) else ()
    return [dict.fromkeys((*labels, *COLUMNS, *more)) | row for row in rows]


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


def broken(
    expectation: Expectation,
    outcome: Outcome,
    discrepancy: Discrepancy | None,
    order: float | None,
    bounds: Mapping[str, float],
) -> tuple[Breach, ...]:
    """What of an expectation does not hold.

    discrepancy: of a run that is ok. order: what was observed, None where the runs with finer steps are not there.
    bounds: of the truth's own errors, by the figure's name.
    """
    if outcome.status != expectation.status:
        return (Breach("status", outcome.status, expectation.status, (outcome.reason,) if outcome.reason else ()),)
    if discrepancy is None:
        return ()
    measured = discrepancy.maxima() | ({} if order is None else {ORDER: order})
    return tuple(
        _breach(limit, measured, discrepancy, bounds)
        for limit in expectation.limits
        if not limit.holds(measured.get(limit.name, math.nan))
    )


def _breach(limit: Limit, measured: Mapping[str, float], discrepancy: Discrepancy, bounds: Mapping[str, float]) -> Breach:
    name = limit.name
    if name not in measured:
        missing = "the runs with finer steps are not there" if name == ORDER else "it is not measured in this scene"
        return Breach(name, "unknown", limit.text, (missing,))
    notes = []
    if name in discrepancy.series:
        notes.append(f"worst at t = {discrepancy.t[int(np.argmax(discrepancy.series[name]))]:.6g} s")
    if name in bounds:
        notes.append(f"the truth's own error is at most {bounds[name]:.2g}{unit(name)}")
    return Breach(name, f"{measured[name]:.4g}{unit(name)}", limit.text, tuple(notes))


def settle(expectation: Expectation, breaches: tuple[Breach, ...], today: date) -> Judged:
    """Whether an expectation counts as held on a day."""
    text = "; ".join(breach.text for breach in breaches)
    if not expectation.known:
        return Judged(expectation, breaches, not breaches, text)
    if not breaches:
        return Judged(expectation, breaches, True, f"what is known to fail ({expectation.known}) holds now")
    assert expectation.until is not None  # the grammar requires it
    tolerated = today <= expectation.until
    told = "known until" if tolerated else "no longer tolerated since"
    return Judged(expectation, breaches, tolerated, f"{told} {expectation.until.isoformat()} ({expectation.known}): {text}")


def _finer(run: Run, runs: Sequence[Run]) -> list[Run]:
    def is_finer(other: Run, by: int) -> bool:
        return run.key.over_steps == other.key.over_steps and run.method.is_at(other.method.timestep * by)

    return [other for by in REFINEMENTS for other in runs if is_finer(other, by)]


def _order(truth: Truth | Unsupported, runs: Sequence[Run]) -> float | None:
    """The observed order in attitude; None where not all the runs are there."""
    trajectories = [(run.method.timestep, run.outcome.trajectory) for run in runs if isinstance(run.outcome, Completed)]
    if len(trajectories) != 1 + len(REFINEMENTS) or isinstance(truth, Unsupported):
        return None
    return attitude_order(trajectories, truth)
