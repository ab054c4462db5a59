"""Print the tables of the tradeoff study to the terminal."""

from collections.abc import Mapping, Sequence
from typing import Any

from bodycheck.console.figures import error_text, figure_text, scaled
from bodycheck.console.terminal import print_errors, print_table
from bodycheck.judging.convergence import UNITS
from bodycheck.studies.orders import Order
from bodycheck.studies.tradeoff.recommendation import Measured, Recommendation


def print_tradeoff(rows: Sequence[Mapping[str, Any]], orders: Sequence[Order]) -> None:
    """Print one line per run, then one line per method and quantity."""
    runs = ("case", "engine", "integrator", "step", "status", "position m", "attitude rad", "us/step", "cost s/s", "reason")
    print_errors(runs, [_row(row) for row in rows])
    print()
    methods = ("case", "engine", "integrator", "quantity", "order", "claimed", "floor", "scheme", "residual rad")
    print_table(methods, map(_order, orders))


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


def _row(row: Mapping[str, Any]) -> tuple[str, ...]:
    texts = (row["case"], row["engine"], row["integrator"], f"{row['timestep']:g}", row["status"])
    errors = (error_text(row, "position_error"), error_text(row, "attitude_error"))
    return (*texts, *errors, figure_text(scaled(1e6, row["time_per_step"])), figure_text(row["cost"]), row["reason"])


def _order(order: Order) -> tuple[str, ...]:
    interval = "" if order.order is None else f"{order.order:.2f} ({order.order_low:.2f} to {order.order_high:.2f})"
    claimed = "" if order.claimed is None else str(order.claimed)
    names = (order.case, order.engine, order.integrator, order.quantity)
    return (*names, interval, claimed, figure_text(order.floor), order.scheme, figure_text(order.scheme_residual))


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
