"""Print the sheet of contact to the terminal."""

from collections.abc import Sequence
from dataclasses import dataclass

from bodycheck.console.figures import figure_text
from bodycheck.console.options import View
from bodycheck.console.tables import Column, attribute, show
from bodycheck.studies.contact.rows import ContactRow


@dataclass(frozen=True)
class Line:
    """A figure of a scene in an engine: at the defaults, and the best value with its method."""

    engine: str
    scene: str
    figure: str
    unit: str
    truth: float | None
    default: float | None
    best: float | None
    method: str
    status: str


def lines(rows: Sequence[ContactRow]) -> list[Line]:
    """Return one line for each figure of each scene and engine, from its rows at the defaults and at the best settings."""
    best = {(row.engine, row.scene, row.figure): row for row in rows if row.setting == "best"}
    usual = {(row.engine, row.scene, row.figure): row for row in rows if row.setting == "defaults"}
    found = []
    for key in dict.fromkeys((row.engine, row.scene, row.figure) for row in rows):
        one, other = usual.get(key), best.get(key)
        row = one or other
        assert row is not None  # the key is that of a row
        method = "" if other is None or other.timestep is None else f"{other.integrator} at {1e3 * other.timestep:g} ms"
        found.append(
            Line(
                *(row.engine, row.scene, row.figure, row.unit, row.truth),
                None if one is None else one.value,
                None if other is None else other.value,
                method,
                row.status,
            )
        )
    return found


def print_sheet(rows: Sequence[ContactRow], view: View) -> None:
    """Print one line for each figure of each scene and engine."""
    show(LINES, lines(rows), view)


#: The columns of the table.
LINES: tuple[Column[Line], ...] = (
    attribute("engine", goes=4),
    attribute("scene"),
    attribute("figure"),
    Column("default", "at defaults", lambda line: figure_text(line.default), lambda line: line.default),
    Column("best", "best", lambda line: figure_text(line.best), lambda line: line.best),
    attribute("unit", goes=3),
    Column("truth", "in mechanics", lambda line: figure_text(line.truth), lambda line: line.truth, goes=2),
    attribute("method", "best method", goes=1),
    attribute("status", goes=5),
)
