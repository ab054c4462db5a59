"""Judge the runs of many members of an ensemble with one method: one value of every column for each member.

The status, the reason, the judgement and the figures of a member are the same as if `judgement.verdict` judged its run alone.
Members in free flight are judged together. Only runs that may not have completed, and runs that may break an expectation, are
examined one by one.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.adapters.contract import Method
from bodycheck.adapters.engine_name import in_words
from bodycheck.casefile.content import Case
from bodycheck.casefile.expectation import OK, Expectation, Limit
from bodycheck.figures.columns import FIGURES
from bodycheck.figures.definition import Comparison
from bodycheck.judging.discrepancy import Summary
from bodycheck.judging.judgement import settled, this_day, verdict
from bodycheck.reference.bounds import NAMES, Bounds
from bodycheck.reference.flight.flights import Flights
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.scenes import Scenes
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.results.outcome import Completed, Outcome, Run
from bodycheck.running import simulation
from bodycheck.running.members import blocks
from bodycheck.running.members.blocks import Flown, NormError
from bodycheck.running.states import trajectory_of

#: The number of members whose figures are computed at once: few enough for their numbers to stay in the cache of a processor.
AT_ONCE = 100

#: Values (m,) by the names of columns. "status" and "reason" are texts, "passed" is true, false or None, and a figure that was
#: not measured is NaN.
Columns = dict[str, NDArray[Any]]


def judged(
    scenes: Scenes,
    truth: Flights,
    flown: Flown,
    method: Method,
    expectations: Sequence[Expectation],
    today: date | None = None,
) -> Columns:
    """Return "status", "reason", "passed" and every figure of the runs of m scenes in free flight.

    Parameters
    ----------
    scenes, truth
        The m scenes, and their exact motions at the instants of the runs.
    flown
        Their runs, as `running.members.fly` returns them.
    method
        The method of the runs.
    expectations
        The expectations of the case; expectations of other methods are ignored.
    today
        The day from which on a known discrepancy may no longer be tolerated; by default the present day (UTC).
    """
    concerned = [expectation for expectation in expectations if expectation.concerns(flown.engine, method)]
    limited = {limit.name for expectation in concerned for limit in expectation.limits}
    measured = _together([_measured(_exact(scenes, truth, part), flown, part, limited) for part in _parts(len(scenes))])
    others = _other_outcomes(scenes, flown, measured.doubtful)
    columns: Columns = {name: np.full(len(scenes), value, dtype=object) for name, value in (("status", OK), ("reason", ""))}
    columns["passed"] = np.full(len(scenes), None, dtype=object)
    for index, outcome in others.items():
        columns["status"][index], columns["reason"][index] = outcome.status, outcome.reason
        for values in measured.largest.values():
            values[index] = np.nan
    if concerned:
        _settle(columns, measured, flown, concerned, others, today or this_day())
    else:
        columns["passed"][[index for index, outcome in others.items() if outcome.failed]] = False
    missing = np.full(len(scenes), np.nan)
    return columns | {name: measured.largest.get(name, missing) for name in FIGURES}


def one_by_one(cases: Sequence[Case], truths: Sequence[Truth | NoTruth], flown: Flown, today: date | None = None) -> Columns:
    """Return the same columns as `judged` for the runs of cases, each with its truth at the instants of its run.

    The runs in `flown` are the runs of these cases, or of the scenes of these cases.
    """
    rows = []
    for index, (case, truth) in enumerate(zip(cases, truths, strict=True)):
        outcome = _outcome(flown, index, case.scene)
        run = Run(case.name, flown.engine, flown.version, flown.method, outcome, scene=case.scene)
        rows.append(verdict(case, truth, run, today=today).row())
    columns: Columns = {name: np.array([row[name] for row in rows], dtype=object) for name in ("status", "reason", "passed")}
    return columns | {name: np.array([row.get(name, np.nan) for row in rows], dtype=float) for name in FIGURES}


@dataclass(frozen=True, eq=False)
class _Exact:
    """The exact motions of several scenes, as `figures.definition.Exact` has them."""

    scene: Scenes
    trajectory: Trajectory
    bounds: Bounds
    stop: None = None


@dataclass(frozen=True, eq=False)
class _Measured:
    """The quantities that are computed for m members at once.

    Attributes
    ----------
    largest
        The figures (m,) by name; for series over time, their largest values. NaN for a missing value.
    instants
        The instants (m,), s, at which limited series first reach their largest values, by name.
    doubtful
        Which runs (m,) may not have completed.
    """

    largest: dict[str, Array]
    instants: dict[str, Array]
    doubtful: NDArray[np.bool_]


def _parts(count: int) -> list[slice]:
    return [slice(first, first + AT_ONCE) for first in range(0, count, AT_ONCE)]


def _exact(scenes: Scenes, truth: Flights, part: slice) -> _Exact:
    """Return the exact motions of some of the scenes."""
    whole = truth.trajectory
    states = (whole.position[part], whole.quaternion[part], whole.velocity[part], whole.angular_velocity[part])
    bounds = Bounds(*(getattr(truth.bounds, name)[part] for name in NAMES))
    return _Exact(scenes.part(part), Trajectory(whole.t, *states), bounds)


def _measured(exact: _Exact, flown: Flown, part: slice, limited: Collection[str]) -> _Measured:
    """Return the quantities of some of the members. limited: the names of the figures whose instants are needed."""
    trajectory = trajectory_of(flown.times, flown.states[part])
    largest, instants = {}, {}
    with np.errstate(all="ignore"):  # impossible states may overflow; too large errors are infinite
        off = blocks.norm_deviations(trajectory)
        compared = Comparison(exact, trajectory, None, np.maximum(off.max(axis=-1), flown.norm_error[part]))
        for name, figure in FIGURES.items():
            values = figure.compute(compared)
            if isinstance(values, np.ndarray):
                largest[name] = values.max(axis=-1) if figure.largest else values
                if figure.largest and name in limited:
                    instants[name] = trajectory.t[np.argmax(values, axis=-1)]
        doubtful = blocks.doubtful(exact.scene, trajectory, compared.seen.kinetic_energy, off)
    return _Measured(largest, instants, doubtful)


def _together(parts: Sequence[_Measured]) -> _Measured:
    """Return the quantities of all members, joined from parts."""

    def column(columns_of: Callable[[_Measured], Mapping[str, Array]], name: str) -> Array:
        return np.concatenate([columns_of(part).get(name, np.full(len(part.doubtful), np.nan)) for part in parts])

    measured = {name for part in parts for name in part.largest}
    return _Measured(
        {name: column(lambda part: part.largest, name) for name in FIGURES if name in measured},
        {name: column(lambda part: part.instants, name) for name in parts[0].instants},
        np.concatenate([part.doubtful for part in parts]),
    )


def _other_outcomes(scenes: Scenes, flown: Flown, doubtful: NDArray[np.bool_]) -> dict[int, Outcome]:
    """Return the outcomes of the runs that have not completed, by the indices of their scenes."""
    outcomes = dict(flown.ended)
    for index in np.flatnonzero(doubtful).tolist():
        if index not in outcomes and not isinstance(outcome := _outcome(flown, index, scenes.scene(index)), Completed):
            outcomes[index] = outcome
    return outcomes


def _outcome(flown: Flown, index: int, scene: AnyScene) -> Outcome:
    """Return the outcome of the run of a member with a given scene."""
    if index in flown.ended:
        return flown.ended[index]
    seconds, normalised = flown.wall_time / len(flown), NormError(float(flown.norm_error[index]))
    try:
        return simulation.outcome_of(flown.states[index], normalised, scene, flown.method, flown.times, seconds)
    except simulation.AdapterFault as fault:
        return simulation.ended_by(fault, in_words(flown.engine, flown.version), flown.names[index])


def _settle(
    columns: Columns,
    measured: _Measured,
    flown: Flown,
    expectations: Sequence[Expectation],
    others: Mapping[int, Outcome],
    today: date,
) -> None:
    """Fill in the columns "passed" and "reason": whether runs meet expectations, and the reasons for runs that do not."""
    met = _surely_met(columns["status"], measured.largest, expectations)
    columns["passed"][met] = True
    for index in np.flatnonzero(~met).tolist():
        values = {name: float(column[index]) for name, column in measured.largest.items()}
        summary = Summary(values, {name: float(column[index]) for name, column in measured.instants.items()})
        bounds = {figure.name: values.get(figure.bounded_by, np.nan) for figure in FIGURES.values() if figure.bounded_by}
        known = {name: bound for name, bound in bounds.items() if not np.isnan(bound)}
        outcome = others.get(index) or _completed(flown, index)
        discrepancy = summary if isinstance(outcome, Completed) else None
        run = Run(flown.names[index], flown.engine, flown.version, flown.method, outcome)
        judgements, columns["reason"][index] = settled(expectations, outcome, discrepancy, None, known, today, run)
        columns["passed"][index] = all(one.held for one in judgements)


def _surely_met(status: NDArray[Any], largest: Mapping[str, Array], expectations: Sequence[Expectation]) -> NDArray[np.bool_]:
    """Return which runs (m,) certainly meet all expectations, so that they need no reason."""
    met = np.asarray(status == OK, dtype=bool)
    for expectation in expectations:
        met &= expectation.status == OK and not expectation.known
        for limit in expectation.limits:
            met &= _within(limit, largest[limit.name]) if limit.name in largest else False
    return met


def _within(limit: Limit, values: Array) -> NDArray[np.bool_]:
    """Return which values are in the range of a limit, as `Limit.holds` does for one value."""
    above = -np.inf if limit.at_least is None else limit.at_least
    below = np.inf if limit.at_most is None else limit.at_most
    return np.asarray((values >= above) & (values <= below))


def _completed(flown: Flown, index: int) -> Completed:
    trajectory = trajectory_of(flown.times, flown.states[index])
    return Completed(trajectory, int(flown.steps[index]), flown.wall_time / len(flown))
