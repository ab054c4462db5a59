"""The beginning of a report of runs, in a few lines, which a terminal shows too."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bodycheck.judging import advice
from bodycheck.judging.result_set import ResultSet
from bodycheck.reports.finding import Finding
from bodycheck.reports.lines import Line, assign
from bodycheck.reports.quantities import count
from bodycheck.reports.runs import comparison
from bodycheck.reports.runs.choices import (
    MOST_DEFAULTS,
    Choice,
    Default,
    Extreme,
    attention,
    choices,
    defaults,
    extremes,
    tried,
)
from bodycheck.reports.runs.demonstrations import demonstrated
from bodycheck.reports.runs.differences import compare
from bodycheck.reports.runs.findings import findings, measured
from bodycheck.reports.runs.summary import broken, headline, limits, notices, tally, unsupported
from bodycheck.reports.same_algorithm import NO_CLASSES


@dataclass(frozen=True)
class Brief:
    """The beginning of a report.

    Parameters
    ----------
    headline, tally, notices
        The verdict in one line, the number of runs with each outcome, and sentences about the limits of the report.
    limits
        The notices without those about robots and about unsupported runs.
    unsupported
        The number of unsupported runs and the reasons, in one line; empty if there are none. The notices give the reasons too.
    broken
        A sentence about the failed runs; None if there are none.
    steps
        The next steps for the first failed run, which `broken` names; one line for each step.
    answers
        What changed, or what needs attention, which method is accurate enough for each kind of scene, and what the defaults
        of the engines cost in accuracy.
    choices
        The methods of each kind of scene with the chosen one; empty in a comparison.
    foremost
        The cases and methods whose motions a reader should see first, in this order: what changed, or the worst default
        method of all engines, a better one there, and the methods that were chosen.
    extremes
        The methods with the smallest and the largest error of each case; empty in a comparison.
    findings
        Where discrepancies come from.
    """

    headline: str
    tally: tuple[tuple[str, int], ...]
    notices: tuple[str, ...]
    limits: tuple[str, ...]
    unsupported: str
    broken: Finding | None
    steps: tuple[str, ...]
    answers: tuple[Finding, ...]
    choices: tuple[Choice, ...]
    foremost: tuple[tuple[str, Line], ...]
    extremes: Mapping[str, tuple[Extreme, ...]]
    findings: tuple[Finding, ...]

    @property
    def counts(self) -> str:
        """The number of runs with each outcome, as text."""
        (_, runs), *ways = self.tally
        return f"{count(runs, 'run')}: {', '.join(f'{amount} {name}' for name, amount in ways)}"


@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def brief(sets: Sequence[ResultSet]) -> Brief:
    """Return the beginning of a report of one set of results, or of a comparison of several sets, which have labels."""
    shown = comparison.shown(sets)
    verdicts = [verdict for case in shown for verdict in case.verdicts]
    lines = assign(verdict.key.over_cases for verdict in verdicts)
    first, *others = sets
    differences = compare(sets, shown) if others else None
    demonstrations = demonstrated(comparison.header(sets), lines)
    failed = next(((case, verdict) for case in shown for verdict in case.verdicts if verdict.passed is False), None)
    runs = {} if differences else tried(shown, lines, demonstrations)
    chosen = choices(runs)
    worst = defaults(runs)
    attended = () if differences else attention(shown, lines, demonstrations)
    return Brief(
        headline=differences.headline if differences else headline(first.results, verdicts),
        tally=tally(verdicts, [lost for one in sets for lost in one.results.unchecked]),
        notices=(*(differences.notices if differences else ()), *(text for one in sets for text in notices(one))),
        limits=tuple(text for one in sets for text in limits(one)),
        unsupported=unsupported(verdicts),
        broken=broken(verdicts, lines),
        steps=tuple(advice.lines(failed[1], failed[0].file(failed[1].label))) if failed else (),
        answers=(
            *(differences.findings if differences else ()),
            *(choice.finding for choice in chosen[:1]),
            *(default.finding for default in worst[:MOST_DEFAULTS]),
            *(choice.finding for choice in chosen[1:]),
            *attended,
        ),
        choices=chosen,
        foremost=tuple((case, lines[method]) for case, method in differences.foremost)
        if differences
        else _foremost(worst, chosen),
        extremes=extremes(runs),
        findings=findings(
            measured(verdicts, lines),
            () if differences else first.parts,
            lines,
            demonstrations,
            NO_CLASSES if differences else first.classes,
        ),
    )


def _foremost(worst: Sequence[Default], chosen: Sequence[Choice]) -> tuple[tuple[str, Line], ...]:
    runs = [run for default in worst[:1] for run in (default.worst, default.better)]
    return tuple((run.case, run.line) for run in (*runs, *(choice.chosen.worst for choice in chosen)))
