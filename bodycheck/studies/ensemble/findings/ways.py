"""The failures of members: a status, a broken expectation, or the largest value of a figure."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import ROUND_CEILING, Context
from math import inf, isfinite
from typing import Any

import numpy as np

from bodycheck.adapters.method import Method
from bodycheck.casefile.content import Case
from bodycheck.casefile.expectation import OK, Expectation, Limit, unit
from bodycheck.casefile.values import MAX_NUMBER
from bodycheck.figures.columns import FIGURES
from bodycheck.reference.trajectory import Array
from bodycheck.results.outcome import Unsupported
from bodycheck.studies.ensemble.findings.intervals import quantile
from bodycheck.studies.ensemble.findings.stored import EngineMethod, Ensemble

#: A value that is more than this many times the quantile stands out. It must then stay above half of itself.
OUTSTANDING = 10.0

#: The quantile above which the largest value of a figure must stay.
HIGH = 0.99

#: The numbers of digits to which a limit is rounded. The first one that leaves the limit below the value is taken.
DIGITS = (2, 3, 4, 6)

#: Most worst members that are written, the worst ways of failing first.
MOST_FILES = 40


@dataclass(frozen=True)
class Way:
    """A way in which a member fails with a method: a status that was not expected, or a value of a figure beyond a limit.

    Attributes
    ----------
    member
        The number of the member.
    method
        The method.
    status
        The status of its run.
    limit
        The limit that a figure breaks; None for a status that was not expected.
    expected
        The status that was expected.
    value
        The value of the figure; None for a status.
    explanation
        A sentence on where the limit comes from.
    severity
        The key by which ways are sorted, the worst first.
    """

    member: int
    method: EngineMethod
    status: str
    limit: Limit | None = None
    expected: str = OK
    value: float | None = None
    explanation: str = ""
    severity: tuple[int, float] = (0, 0.0)

    @property
    def name(self) -> str:
        """The figure with the method, or the status with it, in words."""
        return f"{self.limit.name if self.limit else self.status} with {self.method.engine} {self.method.integrator}"

    @property
    def is_largest(self) -> bool:
        """True if the largest value of a figure sets the limit, and not an expectation of the case."""
        return self.severity[0] == 2

    def shown(self, status: str, figures: dict[str, float]) -> bool:
        """Return whether a run with this status and these figures fails in this way."""
        if status != self.status:
            return False
        if self.limit is None:
            return True
        value = figures.get(self.limit.name)
        return value is not None and not self.limit.holds(value)


def chosen(case: Case, ensemble: Ensemble) -> list[tuple[Way, tuple[Way, ...]]]:
    """Return the worst members, each by its worst way of failing and the other ways in which it is the worst.

    For each method, these are the first member with each status that was not expected, the member that breaks each expectation
    the most, and the member with the largest value of each figure. At most `MOST_FILES` members are returned.
    """
    by_member: dict[int, list[Way]] = {}
    for way in sorted(ways(case, ensemble), key=lambda one: one.severity):
        by_member.setdefault(way.member, []).append(way)
    return [(first, tuple(others)) for first, *others in list(by_member.values())[:MOST_FILES]]


def ways(case: Case, ensemble: Ensemble) -> Iterator[Way]:
    """Yield all ways in which members fail, each with its worst member."""
    expectations = [_concerning(case, by) for by in ensemble.methods]
    for index, by in enumerate(ensemble.methods):
        yield from _statuses(ensemble, index, by, expectations[index])
    for name, figure in FIGURES.items():
        if name not in ensemble.figures or not figure.limited or figure.ideal:
            continue
        values = ensemble.column(name)
        for index, by in enumerate(ensemble.methods):
            for limit in (limit for one in expectations[index] for limit in one.limits if limit.name == name):
                yield from _breach(ensemble, by, values[index], limit)
            yield from _largest(ensemble, by, values[index], name)


def _concerning(case: Case, by: EngineMethod) -> list[Expectation]:
    """Return the expectations of a case about a method, without those that are known to fail."""
    method = Method.parse(by.integrator, by.timestep)
    return [one for one in case.expectations if one.concerns(by.engine, method) and not one.known]


def _statuses(ensemble: Ensemble, index: int, by: EngineMethod, expectations: Sequence[Expectation]) -> Iterator[Way]:
    """Yield a way for each status that was not expected, with the first member that has it."""
    expected = next((one.status for one in expectations if one.status != OK), OK)
    for code, status in enumerate(ensemble.statuses):
        having: Any = ensemble.status[index] == code
        if having.any() and status not in (expected, Unsupported.status):
            yield Way(int(ensemble.members[np.argmax(having)]), by, status, expected=expected)


def _breach(ensemble: Ensemble, by: EngineMethod, values: Array, limit: Limit) -> Iterator[Way]:
    """Yield the way of the member that breaks a limit the most, if any does; values (n,): NaN where a member has none."""
    at_most = inf if limit.at_most is None else limit.at_most
    at_least = -inf if limit.at_least is None else limit.at_least
    with np.errstate(all="ignore"):
        excess = np.where(values > at_most, values / at_most, np.where(values < at_least, at_least / values, np.nan))
    excess[np.isnan(excess) & ((values > at_most) | (values < at_least))] = inf  # infinite, or a limit of zero
    if np.isnan(excess).all():
        return
    worst = int(np.nanargmax(excess))
    explanation = f"The case expects {limit.text}."
    value = float(values[worst])
    yield Way(int(ensemble.members[worst]), by, OK, limit, OK, value, explanation, (1, -float(excess[worst])))


def _largest(ensemble: Ensemble, by: EngineMethod, values: Array, name: str) -> Iterator[Way]:
    """Yield the way of the member with the largest value of a figure; values (n,): NaN where a member has none."""
    known = values[~np.isnan(values)]
    if not known.size:
        return
    worst = int(np.nanargmax(values))
    value, high = float(values[worst]), quantile(known, HIGH)
    bound = value / 2 if isfinite(value) and value > OUTSTANDING * high else high
    limit = _below(bound, value)
    if limit is None:
        return
    explanation = f"{HIGH:.0%} of {len(known)} members have at most {high:.3g}{unit(name)}."
    severity = (2, -value / high if high else -inf)
    yield Way(int(ensemble.members[worst]), by, OK, Limit(name, None, limit), OK, value, explanation, severity)


def _below(bound: float, value: float) -> float | None:
    """Return a bound rounded up to as few digits as leave it below `value`; None if it is not below, or is no valid limit."""
    bound = max(bound, 1 / MAX_NUMBER)
    if not bound < value or bound > MAX_NUMBER:
        return None
    rounded = (float(Context(prec=digits, rounding=ROUND_CEILING).create_decimal(repr(bound))) for digits in DIGITS)
    return next((one for one in rounded if one < value), bound)
