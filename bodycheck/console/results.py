"""Print the runs of a set of results, and the expectations that no run could check."""

from collections.abc import Mapping, Sequence
from typing import Any, TextIO

from bodycheck.console.figures import bound_column, error_column, microseconds
from bodycheck.console.options import View
from bodycheck.console.output import say, tell
from bodycheck.console.tables import Column, entry
from bodycheck.console.terminal import print_errors
from bodycheck.figures.columns import COLUMNS
from bodycheck.judging import advice
from bodycheck.judging.judgement import Verdict
from bodycheck.results.unchecked import SHIPPED, Unchecked, sentences
from bodycheck.results.verdicts import PASSED

Row = Mapping[str, Any]

#: The column that this table has, but files of results have not: the narrowest margin.
NARROWEST = "margin"


def _narrowest(row: Row) -> str:
    margin = row[NARROWEST]
    return "" if margin is None else f"{margin.room:.3g} {margin.name}"


#: The columns of the table of runs that are printed by default.
USUAL: tuple[Column[Row], ...] = (
    entry("case"),
    entry("engine", goes=1),
    entry("integrator"),
    entry("timestep", "step", "g"),
    entry("status", goes=4),
    Column("passed", "passed", lambda row: PASSED[row["passed"]], goes=2),
    error_column("position_error", "position m", goes=3),
    bound_column("truth_position_error", "truth m", goes=9),
    error_column("attitude_error", "attitude rad"),
    bound_column("truth_error", "truth rad", goes=8),
    error_column("energy_drift", "energy", "energy_error", goes=6),
    Column(NARROWEST, "margin", _narrowest, lambda row: row[NARROWEST] and row[NARROWEST].room, goes=5),
    microseconds("time_per_step", "us/step", goes=7),
    entry("reason", goes=10, wraps=True),
)

#: The columns of the table of runs: the default columns, and the columns of results that are printed if they are named.
RUNS = (
    *USUAL,
    *(
        entry(name, f"{name} {column.unit}".rstrip(), asked=True)
        for name, column in COLUMNS.items()
        if name not in {usual.name for usual in USUAL} and name != "set"
    ),
)


def print_runs(verdicts: Sequence[Verdict], view: View) -> None:
    """Print a table with one row per run. The margin is the factor by which the figure nearest to its limit may still grow."""
    rows = [
        verdict.row() | {NARROWEST: min(verdict.margins, key=lambda margin: margin.room, default=None)} for verdict in verdicts
    ]
    print_errors(RUNS, rows, view)


def print_failed(verdicts: Sequence[Verdict], files: Mapping[str, str]) -> None:
    """Print one line per failed run, with the reason, and below it the next steps, on lines that can be copied.

    files: the paths of the cases that are not shipped, by name.
    """
    for verdict in verdicts:
        if verdict.passed is False:
            run = verdict.run
            tell(f"FAILED {run.case}, {run.engine} {run.method.name} at {run.method.timestep:g} s: {verdict.reason}")
            for line in advice.lines(verdict, files.get(run.case, run.case)):
                say(f"  {line}")


def print_unchecked(unchecked: Sequence[Unchecked], stream: TextIO) -> None:
    """Print the expectations whose engines cannot be used: a sentence for each engine and reason.

    Those of shipped cases are left out: a user need not have all engines that their expectations name.
    """
    for sentence in sentences(one for one in unchecked if one.tolerated != SHIPPED):
        print(sentence, file=stream)
