"""Print the sheet of contact to the terminal."""

from collections.abc import Sequence

from bodycheck.console.figures import figure_text
from bodycheck.console.options import View
from bodycheck.console.tables import Column, attribute, show
from bodycheck.studies.contact.rows import ContactRow, Line, lines


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
