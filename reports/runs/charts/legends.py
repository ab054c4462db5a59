"""The methods that a case's charts show first, so that their legend is short. The reader adds the others on demand."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import chain, zip_longest

from bodycheck.judging.judgement import Verdict
from bodycheck.reports.lines import Line
from bodycheck.results.key import RunKey

#: The most entries of a legend.
MOST_ENTRIES = 6


def first_lines(verdicts: Sequence[Verdict], lines: Mapping[RunKey, Line], quantity: str) -> tuple[Line, ...]:
    """Return at most `MOST_ENTRIES` lines of the methods that matter most in a case, in the order of the report.

    These are, engine by engine, the default method, or the first if the default was not run, and the most accurate one; then
    the most accurate of all others. The engines with the largest and the smallest errors come first. All sets of results of a
    method are shown together.

    Parameters
    ----------
    verdicts
        The verdicts on the runs of the case.
    lines
        The lines of all methods.
    quantity
        The column of errors that counts.
    """
    methods: dict[RunKey, list[Verdict]] = {}
    for verdict in verdicts:
        if verdict.discrepancy is not None:
            methods.setdefault(replace(verdict.key.over_cases, label=""), []).append(verdict)
    engines: dict[str, list[list[Verdict]]] = {}
    for method, runs in methods.items():
        engines.setdefault(method.engine, []).append(runs)
    defaults = [
        next((runs for runs in offered if "default" in (runs[0].run.role or "")), offered[0]) for offered in engines.values()
    ]
    best = [min(offered, key=lambda runs: _error(runs, quantity)) for offered in engines.values()]
    defaults.sort(key=lambda runs: -_error(runs, quantity))
    best.sort(key=lambda runs: _error(runs, quantity))
    others = sorted(methods.values(), key=lambda runs: _error(runs, quantity))
    alternating = [runs for runs in chain.from_iterable(zip_longest(defaults, best)) if runs is not None]
    chosen: dict[RunKey, None] = {}
    for runs in (*alternating, *others):
        keys = [verdict.key.over_cases for verdict in runs]
        if len(chosen.keys() | keys) <= MOST_ENTRIES:
            chosen |= dict.fromkeys(keys)
    return tuple(line for key, line in lines.items() if key in chosen)


def _error(runs: Sequence[Verdict], quantity: str) -> float:
    """Return the largest error of the runs of a method; NaN counts as infinite."""
    errors = [run.discrepancy.largest.get(quantity, math.inf) for run in runs if run.discrepancy is not None]
    return max((math.inf if math.isnan(error) else error for error in errors), default=math.inf)
