"""Print the tables of the study of extremes to the terminal."""

from collections.abc import Sequence
from typing import Any

from bodycheck.console.options import View
from bodycheck.console.output import say, tell
from bodycheck.console.tables import Column, attribute, chosen, show
from bodycheck.studies.extremes.rows import Limit, Row

#: The columns of the table of runs.
RUNS = (
    attribute("case"),
    attribute("engine", goes=2),
    attribute("integrator"),
    attribute("timestep", "step", "g", goes=1),
    attribute("axis"),
    attribute("value", form=".10g"),
    attribute("status"),
    attribute("engine_said", "engine said", goes=3),
    attribute("seen", at="detail", goes=4, wraps=True),
)

#: The columns of the table of limits of stability.
LIMITS = (
    attribute("case"),
    attribute("engine", goes=2),
    attribute("integrator"),
    attribute("spin", "spin rad/s", "g"),
    attribute("largest_stable_timestep", "step s"),
    attribute("spin_times_step", "spin x step rad", goes=1),
)


#: The tables.
TABLES: tuple[Sequence[Column[Any]], ...] = (RUNS, LIMITS)


def print_rows(rows: Sequence[Row], limits: Sequence[Limit], view: View) -> None:
    """Print a line per run, first of the wrong runs that the engine did not report, and then a line per method and spin."""
    show(RUNS, sorted(rows, key=lambda row: not row.believed), view)
    if limits and chosen(LIMITS, view):
        say("\nthe largest stable step")
        show(LIMITS, limits, view)
    tell(f"{len(rows)} runs, {sum(row.believed for row in rows)} of them wrong without any report by the engine")
