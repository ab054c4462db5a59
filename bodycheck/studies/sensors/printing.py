"""Print the sheet of sensors to the terminal."""

from collections.abc import Sequence

from bodycheck.console.figures import figure_text
from bodycheck.console.options import View
from bodycheck.console.tables import Column, attribute, show
from bodycheck.judging.sensors.rows import SensorRow
from bodycheck.studies.sensors.rows import Line, age_text, lines


def print_sheet(rows: Sequence[SensorRow], view: View) -> None:
    """Print one line for each engine, method and type of sensor, joined over all scenes."""
    show(LINES, lines(rows), view)


def print_rows(rows: Sequence[SensorRow], view: View) -> None:
    """Print one line for each sensor of a case."""
    show(ROWS, rows, view)


#: The columns of the sheet.
LINES: tuple[Column[Line], ...] = (
    attribute("engine", goes=1),
    attribute("version", goes=8),
    attribute("integrator", goes=7),
    attribute("type"),
    attribute("read", "after"),
    attribute("sign"),
    attribute("frame"),
    attribute("age_steps", "age"),
    attribute("source"),
    Column("relative_error", "error", lambda line: figure_text(line.error), lambda line: line.error, goes=4),
    Column("reset", "at reset", lambda line: figure_text(line.reset), lambda line: line.reset, goes=5),
    attribute("note", goes=3, wraps=True),
    attribute("scenes", goes=6),
)

#: The columns of recorded readings.
ROWS: tuple[Column[SensorRow], ...] = (
    attribute("sensor"),
    attribute("type", goes=4),
    Column("error", "error", lambda row: figure_text(row.error), lambda row: row.error),
    Column("relative_error", "relative", lambda row: figure_text(row.relative_error), lambda row: row.relative_error, goes=1),
    attribute("sign"),
    attribute("frame"),
    Column("age_steps", "age", age_text, lambda row: row.age_steps),
    attribute("source", goes=3),
    attribute("note", goes=2, wraps=True),
)
