"""Print the tables of the study of extremes to the terminal."""

from collections.abc import Sequence

from bodycheck.console.figures import figure_text
from bodycheck.console.terminal import print_table
from bodycheck.studies.extremes.rows import Limit, Row


def print_extremes(rows: Sequence[Row], limits: Sequence[Limit]) -> None:
    """Print one line per run, beginning with wrong runs that the engine did not report, then one line per method and spin."""
    header = ("case", "engine", "integrator", "step", "axis", "value", "status", "engine said", "seen")
    print_table(header, map(_extreme, sorted(rows, key=lambda row: not row.believed)))
    if limits:
        print("\nthe largest stable step")
        print_table(("case", "engine", "integrator", "spin rad/s", "step s", "spin x step rad"), map(_limit, limits))
    print(f"{len(rows)} runs, {sum(row.believed for row in rows)} of them wrong without any report by the engine")


def _extreme(row: Row) -> tuple[str, ...]:
    place = (row.case, row.engine, row.integrator, f"{row.timestep:g}", row.axis, f"{row.value:.10g}")
    return (*place, row.status, row.engine_said, row.detail)


def _limit(limit: Limit) -> tuple[str, ...]:
    figures = (limit.largest_stable_timestep, limit.spin_times_step)
    return (limit.case, limit.engine, limit.integrator, f"{limit.spin:g}", *map(figure_text, figures))
