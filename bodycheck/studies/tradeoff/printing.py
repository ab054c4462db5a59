"""Print the tables of the tradeoff study to the terminal."""

from collections.abc import Mapping, Sequence
from typing import Any

from bodycheck.console.figures import error_column, microseconds
from bodycheck.console.options import View
from bodycheck.console.output import say, tell
from bodycheck.console.tables import Column, attribute, chosen, entry, show
from bodycheck.console.terminal import print_errors
from bodycheck.studies.orders import Order
from bodycheck.studies.tradeoff.measurements import apart


def _interval(order: Order) -> str:
    return "" if order.order is None else f"{order.order:.2f} ({order.order_low:.2f} to {order.order_high:.2f})"


#: The columns of the table of runs.
RUNS = (
    entry("case"),
    entry("engine", goes=2),
    entry("integrator"),
    entry("timestep", "step", "g"),
    entry("status", goes=4),
    error_column("position_error", "position m", goes=1),
    error_column("attitude_error", "attitude rad"),
    microseconds("time_per_step", "us/step", goes=3),
    entry("cost", "cost s/s"),
    entry("reason", goes=5, wraps=True),
)

#: The columns of the table of orders.
METHODS: tuple[Column[Order], ...] = (
    attribute("case"),
    attribute("engine", goes=4),
    attribute("integrator"),
    attribute("quantity"),
    Column("order", "order", _interval, lambda order: order.order),
    attribute("claimed", form="g", goes=1),
    attribute("floor", goes=2),
    attribute("floor_cause", "cause", goes=2),
    attribute("horizon", "horizon s", goes=2),
    Column("scheme", "scheme", lambda order: order.scheme_in_words, goes=3, wraps=True),
    attribute("scheme_residual", "residual rad", goes=5),
)


#: The columns of the table of batches.
BATCHES = (
    entry("case", goes=1),
    entry("engine"),
    entry("integrator"),
    entry("timestep", "step", "g", goes=2),
    entry("batch", "scenes", "d"),
    entry("status", goes=6),
    error_column("attitude_error", "attitude rad"),
    entry("worst_attitude_error", "worst rad", goes=3),
    error_column("position_error", "position m", goes=4),
    entry("worst_position_error", "worst m", goes=5),
    microseconds("time_per_step", "us/step"),
    microseconds("processor_time_per_step", "processor us", goes=3),
    entry("device", goes=8),
    entry("precision", goes=7),
    entry("reason", goes=9, wraps=True),
)


def print_tradeoff(rows: Sequence[Mapping[str, Any]], orders: Sequence[Order], view: View) -> None:
    """Print one line per run, then one line per batch, if there are any, then one line per method and quantity."""
    single, batches = apart(rows)
    print_errors(RUNS, single, view)
    if batches and chosen(BATCHES, view):
        say("")
        tell(
            "Of batches, the errors are those of the case itself and the worst of all its turned copies, the time that of one "
            "step of one scene."
        )
        show(BATCHES, batches, view)
    if chosen(METHODS, view):
        say("")
        show(METHODS, orders, view)
