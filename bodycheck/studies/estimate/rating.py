"""Make the rows of estimate.csv from the runs of one method: verdicts, intervals and reasons."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bodycheck.reports.quantities import number
from bodycheck.robots.elements import printable
from bodycheck.studies.estimate import factors, refinement
from bodycheck.studies.estimate.levels import Levels
from bodycheck.studies.estimate.method import Refined, Subject, horizons
from bodycheck.studies.estimate.quantities import AT_END, OF_ONE_RUN
from bodycheck.studies.estimate.refinement import Interval, Reference
from bodycheck.studies.estimate.rows import CHAOTIC, ESTIMATE, NO_TIME, NOT_ASYMPTOTIC, UNSUPPORTED, EstimateRow

#: The reason of rows whose error is due to rounding.
ROUNDED = "the error is that of rounding"

#: The reason of rows whose error at the end may be zero, and has only an upper end.
BORROWED = "the error at the end does not fall evenly, and is at most this"

#: The reason of rows whose run is not compared with a finer one.
SCALED = "the error follows from that of other time steps by the order"


@dataclass(frozen=True)
class Head:
    """The part that all rows of a method have in common: the names of file and engine, its version, and the method."""

    file: str
    engine: str
    version: str
    integrator: str


@dataclass(frozen=True)
class _Judged:
    """The statement of a row on its error."""

    interval: Interval | None
    order: float | None
    verdict: str
    reason: str
    horizon: float | None


def rows(head: Head, subject: Subject, known: Refined, wanted: Sequence[str]) -> list[EstimateRow]:
    """Return the rows of a method: for each time step that was tried, the largest first, and each quantity.

    wanted: the quantities; those of them that the scene does not have are left out.
    """
    cost = seconds_per_step(known)
    judged: dict[float, list[tuple[str, _Judged]]] = {}
    names = [name for name in wanted if name.removesuffix(AT_END) in known.levels.quantities]
    reasons = tuple(differs(known.levels))
    for name in names:
        for timestep, verdict in _of_quantity(subject, known, name, reasons):
            judged.setdefault(timestep, []).append((name, _trusted(known, verdict)))
    for timestep, why in known.ended.items():
        judged[timestep] = [(name, _Judged(None, None, *_ended(why.status, why.reason), None)) for name in names or [""]]
    for level in (*known.stray, *(() if known.levels.quantities else known.levels.levels)):
        unmatched = _Judged(None, None, *_unmatched(known), None)
        judged[level.timestep] = [(name, unmatched) for name in names or [""]]
    return [
        _row(head, timestep, name, one, cost)
        for timestep in sorted(judged, reverse=True)
        for name, one in sorted(judged[timestep], key=lambda entry: wanted.index(entry[0]) if entry[0] else 0)
    ]


def _trusted(known: Refined, judged: _Judged) -> _Judged:
    """Return a statement without its numbers if intervals of the class of the scene are not right often enough."""
    factor = factors.factors()[known.kind]
    if judged.interval is None or factor.holds(known.kind):
        return judged
    why = factor.told if factor.sample else "was not tried on runs whose error is known"
    reason = f"no interval is stated, since one of this class ({known.kind}) {why}"
    return _Judged(None, judged.order, NOT_ASYMPTOTIC if judged.verdict == ESTIMATE else judged.verdict, reason, None)


def seconds_per_step(known: Refined) -> float | None:
    """Return the computing time of a step (s): that of the fastest run of a method; None if no run was timed."""
    runs = [*known.levels.levels, *known.stray, *(one for pair in known.pairs for one in pair.levels)]
    times = [one.motion.wall_time / one.motion.steps for one in runs if one.motion.steps and one.motion.wall_time]
    return min(times, default=None)


def _row(head: Head, timestep: float, quantity: str, judged: _Judged, cost: float | None) -> EstimateRow:
    interval = judged.interval
    order = judged.order if judged.order is not None and np.isfinite(judged.order) else None
    return EstimateRow(
        *(head.file, head.engine, head.version, head.integrator, timestep, quantity),
        estimate=None if interval is None else interval.estimate,
        low=None if interval is None else interval.low,
        high=None if interval is None else interval.high,
        order=order,
        verdict=judged.verdict,
        reason=printable(judged.reason),
        horizon=judged.horizon,
        cost=None if cost is None else cost / timestep,
    )


def _ended(status: str, reason: str) -> tuple[str, str]:
    """Return the verdict and the reason of a run that did not complete."""
    return (status if status in ("diverged", "reset") else NO_TIME if status == "timeout" else UNSUPPORTED), reason


def _unmatched(known: Refined) -> tuple[str, str]:
    """Return the verdict and the reason of a run that cannot be compared with a finer one."""
    if len(known.levels.levels) > 1 and not known.levels.quantities:
        return UNSUPPORTED, "no body of the scene can move"
    if known.out_of_time:
        return NO_TIME, known.out_of_time
    return NOT_ASYMPTOTIC, "no run with half the time step completed, with which it could be compared"


def _of_quantity(subject: Subject, known: Refined, name: str, reasons: Sequence[str]) -> Iterator[tuple[float, _Judged]]:
    """Yield the time step and the judgement of each run for one quantity. reasons: what differs between the finest runs."""
    quantity, at_end = name.removesuffix(AT_END), name.endswith(AT_END)
    end = float(subject.instants[-1])
    last = horizons(subject, known, quantity)
    whole = known.assessed(quantity, end)
    at_last = known.assessed(quantity, end, at_end=True) if at_end else whole
    if isinstance(at_last, str) or at_last.kind == "uneven":
        # The difference at one instant may pass through zero; the largest over time does not.
        at_last = whole if isinstance(whole, str) else replace(whole, borrowed=at_end)
    for index, level in enumerate(known.levels.levels):
        seen = last[index]
        horizon, order = (None, None) if seen is None else (seen[0], _order(seen[2], last, index))
        if known.chaos is not None:
            interval = None if seen is None else _until(known, quantity, index, seen, at_end)
            yield level.timestep, _Judged(interval, order, *_chaotic(known.chaos, horizon), horizon)
        elif seen is not None and seen[0] == end and isinstance(at_last, Reference):
            interval = known.intervals(quantity, end, at_last, at_end)[index] or replace(seen[1], low=0.0)
            without_low = BORROWED if at_last.borrowed and at_last.kind != "rounding" else ROUNDED
            yield level.timestep, _Judged(interval, order, ESTIMATE, without_low if interval.low == 0 else "", end)
        else:
            why = whole if isinstance(whole, str) else whole.reason or "its error is not clear of that of the finest run"
            yield level.timestep, _Judged(None, order, *_none(known, why, reasons), horizon)
    if known.chaos is None and isinstance(whole, Reference) and isinstance(at_last, Reference) and at_last.kind != "uneven":
        for pair in known.pairs:
            yield from _of_pair(known, pair, quantity, at_last, at_end, end)


def _until(known: Refined, quantity: str, index: int, seen: tuple[float, Interval, Reference], at_end: bool) -> Interval | None:
    """Return the estimate of the error of a level until its horizon, or that at the horizon."""
    return known.intervals(quantity, seen[0], seen[2], at_end)[index] if at_end else seen[1]


def _of_pair(
    known: Refined, pair: Levels, quantity: str, reference: Reference, at_end: bool, end: float
) -> Iterator[tuple[float, _Judged]]:
    """Yield the judgements of a step that the search tried, and of the finer run with which it was compared."""
    order = reference.order if np.isfinite(reference.order) else None
    for level, interval in zip(pair.levels, known.of_pair(pair, quantity, reference, at_end), strict=True):
        scaled = level is pair.levels[-1] and quantity not in OF_ONE_RUN
        yield level.timestep, _Judged(interval, order, ESTIMATE, SCALED if scaled else "", end)


def _order(reference: Reference, last: Sequence[tuple[float, Interval, Reference] | None], index: int) -> float | None:
    """Return the order that the estimates of a level and of the next finer one show."""
    here, finer = last[index], last[index + 1] if index + 1 < len(last) else None
    if here is None or finer is None or index >= reference.level or here[0] != finer[0]:
        return reference.order if reference.kind == "even" and index >= reference.level else None
    return refinement.order(here[1].estimate, finer[1].estimate)


def _chaotic(chaos: float, horizon: float | None) -> tuple[str, str]:
    """Return the verdict and the reason of a row of a chaotic scene."""
    until = "" if horizon is None else f"; the numbers are until {number(horizon)} s"
    why = f"one rounding at the start makes a difference above the allowed error from {number(chaos)} s on{until}"
    return f"{CHAOTIC} {chaos:.6g}", why


def _none(known: Refined, why: str, reasons: Sequence[str]) -> tuple[str, str]:
    """Return the verdict and the reason of a row without an estimate."""
    if known.out_of_time and (len(known.levels.levels) < refinement.FEWEST_LEVELS or known.levels.nudged is None):
        return NO_TIME, f"{why}; {known.out_of_time}"
    return NOT_ASYMPTOTIC, "; ".join((why, *reasons))


def differs(levels: Levels) -> Iterator[str]:
    """Yield what differs between the two finest runs: contacts, limits, saturation, and the iterations and warnings."""
    if len(levels.levels) < 2:
        return
    coarse, fine = levels.levels[-2:]
    if coarse.motion.regimes and fine.motion.regimes:
        steps = np.intersect1d(coarse.steps * 2, fine.steps)
        here, there = np.searchsorted(coarse.steps * 2, steps), np.searchsorted(fine.steps, steps)
        for one, other, step in zip(here, there, steps, strict=True):
            before, after = coarse.motion.regimes[one], fine.motion.regimes[other]
            if before != after:
                name = min(before ^ after)
                where, not_where = (coarse, fine) if name in before else (fine, coarse)
                yield (
                    f"{name} at {number(step * fine.timestep)} s with a step of {number(1e3 * where.timestep)} ms, "
                    f"but not with {number(1e3 * not_where.timestep)} ms"
                )
                break
    for name in sorted({*coarse.motion.notes, *fine.motion.notes}):
        one, other = coarse.motion.notes.get(name, 0), fine.motion.notes.get(name, 0)
        if one != other:
            what = "iterations of the solver" if name == "iterations" else f"warnings {name}"
            yield f"{what}: at most {one} and {other}"
