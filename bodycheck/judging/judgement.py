"""Judge stored runs: compute their errors, check their expectations, and make one row of results per run."""

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, date, datetime
from typing import Any

from bodycheck.adapters.engine_name import in_words
from bodycheck.casefile.content import Case
from bodycheck.casefile.expectation import ORDER, REFINEMENTS, SENSORS, Expectation, Limit, unit
from bodycheck.figures.columns import (
    ALWAYS_TABLED,
    CASE_COLUMNS,
    DEPARTURE_COLUMNS,
    ENGINE_COLUMNS,
    FURTHER,
    LIMIT_COLUMNS,
    METHOD_COLUMNS,
    largest_bounds,
)
from bodycheck.judging.discrepancy import Summary, compare
from bodycheck.judging.margins import Margin, margins
from bodycheck.judging.schemes.convergence import attitude_order
from bodycheck.judging.schemes.driven_identification import control_law, tells_laws
from bodycheck.judging.schemes.scheme_rounding import ROUNDOFF
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.requirements import needs
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Completed, Outcome, Run, Unsupported
from bodycheck.results.store import Results

#: The columns of every table of results. They are followed by the columns of `FURTHER` that any run has, the columns of the
#: case, the columns of the limits and margins that any run has, and the columns of the method.
COLUMNS = (
    *("case", "engine", "version", "integrator", "timestep", "status", "passed", "reason"),
    *ALWAYS_TABLED,
    *("steps", "wall_time", "time_per_step", "realtime_factor"),
)

#: The first column of a table with the results of several sets.
LABEL = "set"


@dataclass(frozen=True)
class Breach:
    """A part of an expectation that does not hold.

    Attributes
    ----------
    name
        The column of a figure, or "status".
    measured, expected
        The measured and the expected value as text, with units.
    notes
        Additional information for the user.
    """

    name: str
    measured: str
    expected: str
    notes: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The breach in one sentence."""
        return "; ".join((f"{self.name} is {self.measured}, expected {self.expected}", *self.notes))


@dataclass(frozen=True)
class Judged:
    """The result of checking one expectation against one run on a given date.

    Attributes
    ----------
    expectation
        The expectation.
    breaches
        The parts of the expectation that do not hold.
    held
        Whether the expectation counts as held; this includes a known discrepancy that is still tolerated.
    text
        A message for the user; never empty for a known discrepancy.
    """

    expectation: Expectation
    breaches: tuple[Breach, ...]
    held: bool
    text: str


@dataclass(frozen=True, eq=False)
class Verdict:
    """A run and its judgement. The verdict on a stored run keeps its figures, but no series over time.

    Attributes
    ----------
    run
        The run.
    outcome
        The outcome of the run; `Unsupported` for a completed run that has no truth to be compared with.
    discrepancy
        The figures of the run; None for a run whose status is not ok.
    passed
        Whether every expectation holds; None if there are no expectations for the run.
    reason
        The reason why the run is not ok, the expectation that does not hold, or the known discrepancy.
    known
        Whether a discrepancy was known.
    judged
        The judgement on each expectation, in the order of the case.
    label
        The label of the results that contain the run, if several are judged together.
    kind, tags, duration
        The kind of the scene, and the tags and the duration (s) of the case.
    control_law
        The law of the controller that the motion equals, as the column of this name has it.
    """

    run: Run
    outcome: Outcome
    discrepancy: Summary | None
    passed: bool | None
    reason: str
    known: bool = False
    judged: tuple[Judged, ...] = ()
    label: str = ""
    kind: str = ""
    tags: tuple[str, ...] = ()
    duration: float = 0.0
    control_law: str = ""

    @property
    def margins(self) -> tuple[Margin, ...]:
        """The margins of the figures to their expected limits."""
        return margins((one.expectation for one in self.judged), self.discrepancy)

    @property
    def key(self) -> RunKey:
        """The key of the run, with the label of its set of results."""
        return replace(self.run.key, label=self.label)

    def row(self) -> dict[str, Any]:
        """Return the run's row of results. Columns without a value for the run are absent."""
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
            "kind": self.kind,
            "tags": ";".join(self.tags),
            "role": self.run.role or "",
        }
        if self.discrepancy is not None and isinstance(self.outcome, Completed):
            done, steps, wall_time = self.outcome, self.outcome.steps, self.outcome.wall_time
            row |= self.discrepancy.maxima() | dict(self.discrepancy.before) | {"steps": steps}
            row |= {"steps_taken": steps, "steps_rejected": done.rejected, "evaluations": done.evaluations}
            row |= {"efforts": done.efforts, "control_law": self.control_law} if done.efforts else {}
            row |= {"contact_terms": done.contact_terms} if done.contact_terms else {}
            if steps and wall_time:
                row |= {"wall_time": wall_time, "time_per_step": wall_time / steps}
                simulated = steps * method.timestep if method.accuracy is None else self.duration
                row |= {"realtime_factor": simulated / wall_time}
        for margin in self.margins:
            row |= margin.columns()
        return row


class Compared:
    """The figures of runs that were compared with their truths during a campaign, by the key of the run."""

    def __init__(self) -> None:
        self.summaries: dict[RunKey, Summary] = {}

    def meet(self, truth: Truth, run: Run) -> None:
        """Compare a run with its truth; see `bodycheck.running.pairing`."""
        self.summaries[run.key] = compare(truth, run).summary()


def judge(results: Results, today: date | None = None, compared: Compared | None = None) -> list[Verdict]:
    """Return the verdicts on all runs of a results folder, in the order of the plan, as of a day.

    The cost grows with the number of runs. Each truth and each trajectory is read once; a trajectory is read again if the order
    of a coarser run is expected. Only one truth and the trajectories of one run are in memory at a time. Nothing is read for a
    run that was already compared, unless its order is expected.
    """
    known = compared.summaries if compared is not None else {}
    groups: dict[tuple[str, float], list[tuple[int, Run]]] = defaultdict(list)
    for index, run in enumerate(results.runs()):
        groups[run.case, run.method.sampling].append((index, run))
    verdicts: dict[int, Verdict] = {}
    for (name, sampling), runs in groups.items():
        case, truth = results.cases[name], None
        departure = results.header["departures"].get(name)
        for index, run in runs:
            ordered, names_law = any(e.needs_order for e in _concerning(case, run)), tells_laws(case.scene)
            if not (ordered or names_law) and departure is None and (summary := known.get(run.key)) is not None:
                verdicts[index] = _verdict(case, run, run.outcome, summary, None, today)
                continue
            truth = truth or results.truth(name, sampling)
            one = verdict(case, truth, run, _finer(run, results) if ordered else (), today, departure)
            precision = results.header["precisions"].get(run.engine)
            if names_law and precision is not None and one.discrepancy is not None and isinstance(truth, Truth):
                one = replace(one, control_law=control_law(run, truth, ROUNDOFF[precision]))
            verdicts[index] = one
    return [verdicts[index] for index in range(len(verdicts))]


def verdict(
    case: Case,
    truth: Truth | NoTruth,
    run: Run,
    finer: Sequence[Run] = (),
    today: date | None = None,
    departure: float | None = None,
) -> Verdict:
    """Return the verdict on one run; a completed run without a truth ends as the computation of the truth did.

    Parameters
    ----------
    case
        The case of the run, with its expectations.
    truth
        The truth of the case at the instants of the run, or the reason why there is none.
    run
        The run.
    finer
        The runs of the same method with a half and a quarter of its time step, for expectations of an order.
    today
        The day from which on a known discrepancy may no longer be tolerated; by default the present day (UTC).
    departure
        The last instant (s) at which neither limits nor contacts of a robot's file have acted; None if they do not act.

    Raises
    ------
    ValueError
        If the truth is not at the instants of the run.
    BadFolder
        If the trajectory of a stored run cannot be read.
    """
    outcome: Outcome = run.outcome
    discrepancy = None
    if isinstance(outcome, Completed) and isinstance(truth, NoTruth):
        outcome = _without_truth(truth)
    elif isinstance(outcome, Completed) and isinstance(truth, Truth):
        discrepancy = compare(truth, run).summary(departure)
    ordered = any(expectation.needs_order for expectation in _concerning(case, run))
    return _verdict(case, run, outcome, discrepancy, _order(truth, (run, *finer)) if ordered else None, today)


def _verdict(
    case: Case, run: Run, outcome: Outcome, discrepancy: Summary | None, order: float | None, today: date | None
) -> Verdict:
    """Return the verdict on a run with its outcome, figures and observed order."""
    expectations = _concerning(case, run)
    common: dict[str, Any] = {"kind": needs(case.scene).kind, "tags": case.tags, "duration": case.duration}
    if not expectations:
        return Verdict(run, outcome, discrepancy, False if outcome.failed else None, outcome.reason, **common)
    bounds = {} if discrepancy is None else largest_bounds(discrepancy.largest)
    judged, reason = settled(expectations, outcome, discrepancy, order, bounds, today or this_day(), run)
    known = any(expectation.known for expectation in expectations)
    return Verdict(run, outcome, discrepancy, all(one.held for one in judged), reason, known, judged, **common)


def this_day() -> date:
    """Return the present day (UTC)."""
    return datetime.now(UTC).date()


def settled(
    expectations: Sequence[Expectation],
    outcome: Outcome,
    discrepancy: Summary | None,
    order: float | None,
    bounds: Mapping[str, float],
    today: date,
    run: Run,
) -> tuple[tuple[Judged, ...], str]:
    """Return the judgement on each expectation that concerns a run, and the run's reason. For the arguments see `broken`."""
    judged = tuple(
        settle(expectation, broken(expectation, outcome, discrepancy, order, bounds), today, run)
        for expectation in expectations
    )
    return judged, "; ".join([one.text for one in judged if one.text] or [outcome.reason])


def _without_truth(missing: NoTruth) -> Outcome:
    """Return the outcome of a run without a truth: unsupported, unless computing the truth was stopped or failed."""
    if missing.limit is not None:
        return TimedOut(missing.limit, missing.reason)
    return Crashed(missing.reason) if missing.crashed else Unsupported(missing.reason)


def records(verdicts: Iterable[Verdict]) -> list[dict[str, Any]]:
    """Return the rows of results with all of `COLUMNS`, in their order; missing values are None."""
    rows = [verdict.row() for verdict in verdicts]
    more = [name for name in FURTHER if any(name in row for row in rows)]
    more += [column.name for column in CASE_COLUMNS]
    more += [column.name for column in LIMIT_COLUMNS if any(column.name in row for row in rows)]
    more += [column.name for column in METHOD_COLUMNS]
    more += [column.name for column in (*DEPARTURE_COLUMNS, *ENGINE_COLUMNS) if any(column.name in row for row in rows)]
    labels = (LABEL,) if any(LABEL in row for row in rows) else ()
    texts = {column.name: "" for column in ENGINE_COLUMNS if column.name in more}
    return [dict.fromkeys((*labels, *COLUMNS, *more)) | texts | row for row in rows]


def broken(
    expectation: Expectation,
    outcome: Outcome,
    discrepancy: Summary | None,
    order: float | None,
    bounds: Mapping[str, float],
) -> tuple[Breach, ...]:
    """Return the parts of an expectation that do not hold.

    Parameters
    ----------
    expectation
        The expectation.
    outcome
        The outcome of the run.
    discrepancy
        The figures of the run; None for a run whose status is not ok.
    order
        The observed order; None if the runs with smaller time steps are missing.
    bounds
        The bounds of the truth's own errors, by the columns of the figures.
    """
    if outcome.status != expectation.status:
        return (Breach("status", outcome.status, expectation.status, (outcome.reason,) if outcome.reason else ()),)
    if discrepancy is None:
        return ()
    sensors = {SENSORS + name: error for name, error in discrepancy.sensors.items()}
    measured = discrepancy.maxima() | sensors | ({} if order is None else {ORDER: order})
    return tuple(
        _breach(limit, measured, discrepancy, bounds)
        for limit in expectation.limits
        if not limit.holds(measured.get(limit.name, math.nan))
    )


def _breach(limit: Limit, measured: Mapping[str, float], discrepancy: Summary, bounds: Mapping[str, float]) -> Breach:
    name = limit.name
    if name not in measured:
        missing = "the runs with finer steps are not there" if name == ORDER else "it is not measured in this scene"
        return Breach(name, "unknown", limit.text, (missing,))
    notes = []
    if name in discrepancy.instants:
        notes.append(f"worst at t = {discrepancy.instants[name]:.6g} s")
    if name in bounds:
        notes.append(f"the truth's own error is at most {bounds[name]:.2g}{unit(name)}")
    return Breach(name, f"{measured[name]:.4g}{limit.in_unit}", limit.text, tuple(notes))


def settle(expectation: Expectation, breaches: tuple[Breach, ...], today: date, run: Run) -> Judged:
    """Return the judgement on an expectation with the given breaches in a run: whether it counts as held on a date."""
    written = in_words(run.engine, expectation.version)
    then = f"it was written with {written}, this is {run.version}" if expectation.version else ""
    text = "; ".join((*(breach.text for breach in breaches), *([then] if breaches and then else [])))
    if not expectation.known:
        return Judged(expectation, breaches, not breaches, text)
    if not breaches:
        return Judged(expectation, breaches, True, f"what is known to fail ({expectation.known}) holds now")
    assert expectation.until is not None  # the grammar requires it
    tolerated = today <= expectation.until
    state = "known until" if tolerated else "no longer tolerated since"
    return Judged(expectation, breaches, tolerated, f"{state} {expectation.until.isoformat()} ({expectation.known}): {text}")


def _concerning(case: Case, run: Run) -> list[Expectation]:
    return [expectation for expectation in case.expectations if expectation.concerns(run.engine, run.method)]


def _finer(run: Run, results: Results) -> list[Run]:
    """Return the existing runs of the same method with a half and a quarter of the time step."""
    finer = (results.run(replace(run.key, method=run.method.at(run.method.timestep / by))) for by in REFINEMENTS)
    return [one for one in finer if one is not None]


def _order(truth: Truth | NoTruth, runs: Sequence[Run]) -> float | None:
    """Return the observed order of the attitude; None if a run is missing or has not completed."""
    completed = [(run.method.timestep, run.outcome) for run in runs if isinstance(run.outcome, Completed)]
    if len(completed) != 1 + len(REFINEMENTS) or isinstance(truth, NoTruth):
        return None
    return attitude_order([(timestep, outcome.trajectory) for timestep, outcome in completed], truth)
