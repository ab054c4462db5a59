"""A method's order of convergence as it was observed, beside what is claimed of it and the scheme that it is."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Order:
    """How one quantity of an integrator converges on one case as its time step vanishes.

    order, order_low, order_high: observed, and the interval that the time steps in the asymptotic range give; None where
    no such range was found. floor: the error, in the unit that `convergence.UNITS` gives, that it does not get
    below however small the step; None where none was reached. claimed: by the adapter; None where nothing is claimed.
    scheme: the textbook scheme whose trajectory is the engine's, empty where none is. scheme_residual: largest attitude
    difference (rad) from the nearest scheme over the whole run; None where no scheme was tried.
    """

    case: str
    engine: str
    version: str
    integrator: str
    quantity: str
    order: float | None
    order_low: float | None
    order_high: float | None
    floor: float | None
    claimed: int | None
    scheme: str
    scheme_residual: float | None
