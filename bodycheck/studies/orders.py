"""The row of a method's observed order of convergence, with the claimed order and the textbook scheme it agrees with."""

from dataclasses import dataclass

from bodycheck.results.key import RunKey


@dataclass(frozen=True)
class Order:
    """The convergence of one quantity of an integrator on one case as the time step vanishes.

    Parameters
    ----------
    case, engine, version, integrator, quantity
        The case, the method and the quantity.
    order, order_low, order_high
        The observed order, and its interval over the time steps in the asymptotic range; None if no such range was found.
    floor
        The error, in the unit of the quantity, below which no time step gets; None if it was not reached.
    floor_cause
        Where the floor comes from: "limit", if runs with smaller and smaller time steps tend to a motion that differs from the
        truth by it, or "rounding" in the engine's precision; empty if there is no floor, or neither is known to be the cause.
    horizon
        The time (s) from the start in which order and floor were observed, if the body's attitude is lost after it at any time
        step; None for the whole run.
    claimed
        The order that the adapter claims; None if it claims none.
    scheme
        The textbook scheme whose trajectory equals that of the engine; empty if there is none.
    nearest_scheme
        That scheme, or else the closest one if it leaves at most a hundredth of the error; empty if none is that close.
    scheme_residual
        The largest attitude difference (rad) from the nearest scheme over the whole run; None if there is none.
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
    floor_cause: str
    horizon: float | None
    claimed: int | None
    scheme: str
    nearest_scheme: str
    scheme_residual: float | None

    @property
    def scheme_in_words(self) -> str:
        """The scheme, or the one that the method is near; empty if there is neither."""
        return self.scheme or (f"near {self.nearest_scheme}" if self.nearest_scheme else "")

    @property
    def method(self) -> RunKey:
        """The key of the engine and the method, over all cases and time steps."""
        return RunKey.of_method(self.engine, self.integrator)
