"""Print the tables of the tradeoff study to the terminal."""

from collections.abc import Mapping, Sequence
from typing import Any

from bodycheck.console.figures import error_column, figure_text, microseconds
from bodycheck.console.options import View
from bodycheck.console.output import say
from bodycheck.console.tables import Column, attribute, entry, print_table, show
from bodycheck.console.terminal import print_errors
from bodycheck.judging.convergence import UNITS
from bodycheck.studies.orders import Order
from bodycheck.studies.tradeoff.recommendation import Measured, Recommendation


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
METHODS = (
    attribute("case"),
    attribute("engine", goes=4),
    attribute("integrator"),
    attribute("quantity"),
    Column("order", "order", _interval, lambda order: order.order),
    attribute("claimed", form="g", goes=1),
    attribute("floor", goes=2),
    attribute("scheme", goes=3, wraps=True),
    attribute("scheme_residual", "residual rad", goes=5),
)


def print_tradeoff(rows: Sequence[Mapping[str, Any]], orders: Sequence[Order], view: View) -> None:
    """Print one line per run, then one line per method and quantity."""
    print_errors(RUNS, rows, view)
    if not view.names or {column.name for column in METHODS} & set(view.names):
        say("")
        show(METHODS, orders, view)


def print_recommendations(found: Sequence[Recommendation], front: Sequence[Measured], quantity: str, error: float) -> None:
    """Print the methods that keep the limit, with their next larger and smaller time steps, then the Pareto front.

    Parameters
    ----------
    found
        The methods that keep the limit.
    front
        The Pareto front.
    quantity
        The quantity whose error is limited.
    error
        The limit, in the quantity's unit.
    """
    limit = f"{quantity} error of at most {error:g} ({UNITS[quantity] or 'relative'})"
    print(f"{limit}, the cheapest first" if found else f"no measured method keeps an {limit}")
    if found:
        header = ("engine", "integrator", "step s", "error", "cost s/s", "coarser step", "its error", "finer step", "its error")
        print_table(header, map(_recommendation, found))
    print("\nno other method surpasses these in both error and cost")
    print_table(("engine", "integrator", "step s", "error", "cost s/s"), map(_method, front))


def _recommendation(found: Recommendation) -> tuple[str, ...]:
    neighbours = [
        text
        for method in (found.coarser, found.finer)
        for text in (("-", "-") if method is None else (f"{method.timestep:g}", figure_text(method.error)))
    ]
    return (*_method(found.method), *neighbours)


def _method(method: Measured) -> tuple[str, ...]:
    cost = f"{method.cost:.3g} ({method.cost_low:.3g} to {method.cost_high:.3g})"
    return (method.engine, method.integrator, f"{method.timestep:g}", figure_text(method.error), cost)
