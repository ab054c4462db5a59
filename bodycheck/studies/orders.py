"""The table of observed orders of convergence, with the claimed orders and the textbook schemes with which methods agree."""

from dataclasses import dataclass
from typing import Annotated

from bodycheck.results.key import RunKey
from bodycheck.results.tables import Meaning, table_of


@dataclass(frozen=True)
class Order:
    """The convergence of one quantity of an integrator on one case as the time step vanishes."""

    case: str
    engine: str
    version: str
    integrator: str
    quantity: Annotated[str, Meaning("Quantity", "what the numbers of the row are of")]
    order: Annotated[
        float | None,
        Meaning("Order", "observed order of convergence; empty where no asymptotic range was found", signed=True),
    ]
    order_low: Annotated[
        float | None, Meaning("Order, low", "least order over the time steps in the asymptotic range", signed=True)
    ]
    order_high: Annotated[
        float | None, Meaning("Order, high", "largest order over the time steps in the asymptotic range", signed=True)
    ]
    floor: Annotated[
        float | None,
        Meaning("Floor", "error below which no time step gets, in rad, m or relative; empty where it was not reached"),
    ]
    floor_cause: Annotated[
        str,
        Meaning(
            "Cause of the floor",
            "limit, if small steps tend to a motion that is not the truth, or rounding; empty if neither is known to be it",
            words=frozenset(("limit", "rounding")),
        ),
    ]
    horizon: Annotated[
        float | None,
        Meaning(
            "Horizon",
            "time from the start in which order and floor were observed, if the attitude is lost after it at any time step; "
            "empty for the whole run",
            "s",
        ),
    ]
    claimed: Annotated[int | None, Meaning("Claimed order", "order that the method claims; empty if it claims none")]
    scheme: Annotated[
        str, Meaning("Scheme", "textbook scheme whose trajectory equals that of the engine; empty if there is none")
    ]
    nearest_scheme: Annotated[
        str, Meaning("Nearest scheme", "that scheme, or else one that leaves at most a hundredth of the error")
    ]
    scheme_residual: Annotated[
        float | None,
        Meaning("Residual of the scheme", "largest attitude difference from the nearest scheme over the whole run", "rad"),
    ]

    @property
    def scheme_in_words(self) -> str:
        """The name of the scheme, or "near" and the name of the nearest scheme; empty if there is neither."""
        return self.scheme or (f"near {self.nearest_scheme}" if self.nearest_scheme else "")

    @property
    def method(self) -> RunKey:
        """The key of the engine and the method, over all cases and time steps."""
        return RunKey.of_method(self.engine, self.integrator)


#: The table of orders.
ORDERS = table_of(
    Order,
    "orders",
    "orders of convergence",
    key=("case", "engine", "integrator", "quantity"),
    filled=("case", "engine", "version", "integrator", "quantity"),
    shown=(
        *("case", "engine", "integrator", "quantity", "order"),
        *("order_low", "order_high", "claimed", "floor", "scheme"),
    ),
)
