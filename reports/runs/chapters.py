"""Which cases of a report have curves and an animation: in a large report, those that its readers come for.

Curves and animations are most of a page and most of the time that it takes to make. Every case has its facts, its table and the
commands of its runs.
"""

import math
from collections.abc import Collection, Sequence

from bodycheck.reports.finding import Finding
from bodycheck.reports.runs.comparison import Shown
from bodycheck.reports.runs.matrix import kind_of

#: Most cases whose curves and animations a report has.
MOST_DRAWN = 100


def drawn(cases: Sequence[Shown], findings: Sequence[Finding]) -> Collection[str]:
    """Return the names of the cases that are drawn, at most `MOST_DRAWN`.

    The cases that findings name come first, then those that failed, then the others. Within each of these, the largest errors
    of each kind of scene come first, in the quantity that the matrix of this kind shows.
    """
    if len(cases) <= MOST_DRAWN:
        return [case.name for case in cases]
    named = {finding.where for finding in findings}
    by_kind: dict[str, list[Shown]] = {}
    for case in sorted(cases, key=_largest, reverse=True):
        by_kind.setdefault(kind_of(case.case.scene).name, []).append(case)
    ranks = {case.name: rank for own in by_kind.values() for rank, case in enumerate(own)}

    def urgency(case: Shown) -> tuple[bool, bool, int]:
        failed = any(verdict.passed is False for verdict in case.verdicts)
        return case.name not in named, not failed, ranks[case.name]

    return [case.name for case in sorted(cases, key=urgency)[:MOST_DRAWN]]


def undrawn(case: str) -> str:
    """Return what the chapter of a case that is not drawn says of it."""
    return f"curves and animation, to keep this page small; bodycheck report FOLDER --case {case} --out OTHER draws them"


def _largest(case: Shown) -> float:
    """Return the largest error of a case in the quantity of its kind; errors that are no numbers are larger than any."""
    name = kind_of(case.case.scene).quantity
    errors = [one.discrepancy.largest[name] for one in case.verdicts if one.discrepancy is not None]
    return max((math.inf if math.isnan(error) else error for error in errors), default=-math.inf)
