"""Print the estimates to the terminal."""

from bodycheck.console.figures import figure_text
from bodycheck.console.options import AS_USUAL, View
from bodycheck.console.output import say, tell
from bodycheck.console.tables import Column, attribute, show
from bodycheck.studies.estimate import wording
from bodycheck.studies.estimate.quantities import AT_END
from bodycheck.studies.estimate.rows import EstimateRow, Estimates, choices

#: The columns of the table.
ROWS: tuple[Column[EstimateRow], ...] = (
    attribute("engine", goes=2),
    attribute("version", asked=True),
    attribute("integrator"),
    attribute("timestep", "step s", ".6g"),
    attribute("quantity"),
    Column("estimate", "error", lambda row: figure_text(row.estimate), lambda row: row.estimate),
    Column("low", "from", lambda row: figure_text(row.low), lambda row: row.low, goes=3),
    Column("high", "to", lambda row: figure_text(row.high), lambda row: row.high),
    attribute("order", "order", ".2f", goes=4),
    attribute("verdict"),
    attribute("horizon", "until s", goes=5),
    attribute("cost", "cost s/s", goes=1),
    attribute("reason", goes=6, wraps=True, asked=True),
)


def _usual(results: Estimates) -> list[EstimateRow]:
    """Return the rows of the largest errors with the present step, and with the steps that keep the allowed error."""
    steps = {(one.engine, one.integrator, one.timestep) for one in choices(results)}
    steps |= {(engine, *method) for engine, method in results.present.items()}
    return [
        row for row in results.rows if (row.engine, row.integrator, row.timestep) in steps and not row.quantity.endswith(AT_END)
    ]


def print_estimates(results: Estimates, view: View) -> None:
    """Print sentences, and a table of the present step and of those that keep the allowed error; a view prints all rows."""
    tell(wording.headline(results))
    for sentence in wording.sentences(results):
        if sentence:
            tell(sentence)
    rows = results.rows if view != AS_USUAL else _usual(results)
    if rows:
        say("")
        show(ROWS, rows, view)
