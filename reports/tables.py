"""Tables as every writer lays them out."""

from collections.abc import Sequence
from dataclasses import dataclass

from bodycheck.attribution import Attribution
from bodycheck.reports.quantities import milliseconds, number

ORIGINS = {"stop_time": ("Stop time", "s"), "stop_distance": ("Way to the stop", "m"), "stop_yaw": ("Turn to the stop", "rad")}

NOTHING = 1e-12
"""A quantity that is off by less in every run of a case is left out of the table of origins."""


@dataclass(frozen=True)
class Entry:
    """One field of a table. value: the number as it was measured, for a field that is one."""

    text: str
    value: float | None = None
    meaning: str = ""


@dataclass(frozen=True)
class Table:
    """Runs of one case: a title a column, a row a run, the line of each run's method."""

    columns: tuple[str, ...]
    numeric: tuple[bool, ...]
    rows: tuple[tuple[Entry, ...], ...]
    failed: tuple[bool, ...]
    notes: tuple[str, ...]


def origins_table(parts: Sequence[Attribution]) -> Table:
    """Where the discrepancies of one case come from, a row a method, step and quantity, each engine minus truth."""
    told = [part for part in parts if abs(part.total) > NOTHING]
    numeric = ("Off by", "of it model form", "constraint", "time step")
    halved = any(part.constraint is None for part in told)
    notes = (
        "Engine minus truth. Model form: the law that the engine's contacts make, against the law of the case, both exact. "
        "Constraint: what the engine tends to as its step vanishes, against that law. "
        "Time step: the rest, which vanishes with it.",
        *(("–: told only of methods that were run with two time steps or more.",) if halved else ()),
    )
    return Table(
        columns=("Engine", "Integrator", "Time step", "Quantity", *numeric),
        numeric=(False,) * 4 + (True,) * 4,
        rows=tuple(_origin(part) for part in told),
        failed=(False,) * len(told),
        notes=notes,
    )


def _origin(part: Attribution) -> tuple[Entry, ...]:
    title, unit = ORIGINS[part.quantity]
    figures = (part.total, part.model_form, part.constraint, part.time_step)
    return (
        Entry(f"{part.engine} {part.version}".rstrip()),
        Entry(part.integrator),
        Entry(milliseconds(part.timestep)),
        Entry(f"{title}, {unit}"),
        *(Entry(number(figure, 3), figure) for figure in figures),
    )
