"""Print the tables of an ensemble to the terminal."""

from collections.abc import Sequence
from typing import Any

from bodycheck.console.options import View
from bodycheck.console.output import say, tell
from bodycheck.console.tables import Column, attribute, chosen, show
from bodycheck.console.terminal import print_json
from bodycheck.studies.ensemble.findings.aggregates import Aggregates
from bodycheck.studies.ensemble.findings.sensitivity import FAILURE, RELEVANT
from bodycheck.studies.ensemble.report.reporting import Made
from bodycheck.studies.ensemble.rows import DependenceRow, Row

#: The most dependences that are printed, of failures and of the figure that methods are ranked by; sensitivity.csv has all.
MOST_DEPENDENCES = 6


def _failed(row: Row) -> str:
    return f"{100 * row.failed:.2g} %"


def _interval(row: Row) -> str:
    return f"{100 * row.failed_low:.2g}-{100 * row.failed_high:.2g} %"


#: The columns of the table of methods, which are those of ensemble.csv.
ROWS: tuple[Column[Any], ...] = (
    attribute("case", goes=9),
    attribute("engine"),
    attribute("version", goes=10),
    attribute("integrator"),
    attribute("timestep", "step", "g", goes=5),
    attribute("members", "members", "d", goes=8),
    Column("failed", "failed", _failed, lambda row: row.failed),
    Column("failed_low", "interval", _interval, lambda row: row.failed_low, goes=2),
    Column("failed_high", "at most", lambda row: f"{100 * row.failed_high:.2g} %", lambda row: row.failed_high, asked=True),
    attribute("figure", goes=7),
    attribute("q05", "5 %", goes=6),
    attribute("q50", "median"),
    attribute("q95", "95 %", goes=4),
    attribute("q99", "99 %"),
    attribute("max", goes=1),
    attribute("worst_member", "member", "d", goes=3),
)

#: The columns of the table of dependences, which are those of sensitivity.csv.
DEPENDENCES: tuple[Column[Any], ...] = (
    attribute("engine"),
    attribute("integrator"),
    attribute("timestep", "step", "g", goes=3),
    attribute("figure"),
    attribute("number", "drawn number"),
    attribute("share", "of variance", ".2f"),
    attribute("rank_correlation", "rank corr.", ".2f", goes=2),
)


def print_made(ensemble: Made, json: bool, view: View, quiet: bool) -> None:
    """Print the results of an ensemble: its tables, or JSON, or only the methods that break expectations."""
    if json:
        print_json(ensemble.records())
    elif quiet:
        for sentence in ensemble.broken:
            tell(f"FAILED {sentence}")
    else:
        print_ensemble(ensemble.analysis.aggregates, ensemble.analysis.dependence_rows(), ensemble.sentences, view)


def print_ensemble(ensemble: Aggregates, dependences: Sequence[DependenceRow], sentences: Sequence[str], view: View) -> None:
    """Print the methods with the figure that ranks them, the best first, then the strongest dependences, then sentences."""
    if ensemble.ranking:
        say(f"{ensemble.members} members, {ensemble.ranking}, the best method first")
    show(ROWS, [ensemble.row(index, ensemble.ranking) for index in ensemble.ranked], view)
    relevant = [one for one in dependences if one.share >= RELEVANT and one.figure in (FAILURE, ensemble.ranking)]
    strongest = sorted(relevant, key=lambda one: -one.share)[:MOST_DEPENDENCES]
    if strongest and chosen(DEPENDENCES, view):
        say("\nwhat errors depend on most")
        show(DEPENDENCES, strongest, view)
    if sentences:
        say("")
    for sentence in sentences:
        tell(sentence)
