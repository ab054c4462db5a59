"""The cases of a report that have curves over time and an animation."""

import math
from collections.abc import Collection, Sequence

from bodycheck.reports.finding import Finding
from bodycheck.reports.runs.comparison import Shown
from bodycheck.reports.runs.kinds import kind_of

#: The most cases that have curves and an animation, which need most of the size of a page and most of the time to make it.
#: Every case has its facts, its table and the commands of its runs.
MOST_DRAWN = 100


def drawn_cases(cases: Sequence[Shown], findings: Sequence[Finding]) -> Collection[str]:
    """Return the names of the cases that are drawn, at most `MOST_DRAWN`.

    The cases that findings name come first, then cases with failed runs, then all others. Within each of these groups, the
    cases with the largest errors of each kind of scene come first, in the quantity that the matrix of the kind shows.
    """
    if len(cases) <= MOST_DRAWN:
        return [case.name for case in cases]
    named = {finding.where for finding in findings}
    by_kind: dict[str, list[Shown]] = {}
    for case in sorted(cases, key=_largest, reverse=True):
        by_kind.setdefault(kind_of(case.case.scene).name, []).append(case)
    ranks = {case.name: rank for same_kind in by_kind.values() for rank, case in enumerate(same_kind)}

    def urgency(case: Shown) -> tuple[bool, bool, int]:
        failed = any(verdict.passed is False for verdict in case.verdicts)
        return case.name not in named, not failed, ranks[case.name]

    return [case.name for case in sorted(cases, key=urgency)[:MOST_DRAWN]]


def _largest(case: Shown) -> float:
    """Return the largest error of a case in the quantity of its kind. NaN counts as infinite; without errors, return -inf."""
    name = kind_of(case.case.scene).quantity
    errors = [one.discrepancy.largest[name] for one in case.verdicts if one.discrepancy is not None]
    return max((math.inf if math.isnan(error) else error for error in errors), default=-math.inf)
