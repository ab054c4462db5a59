"""What a case expects of a method."""

import math
from dataclasses import dataclass
from datetime import date

from bodycheck.adapters.method import Method
from bodycheck.figures import columns

#: Name of the limit on the observed order of convergence.
ORDER = columns.ORDER.name

#: The status of a run that came to its end, which is expected where no other is.
OK = "ok"


def unit(name: str) -> str:
    """The unit of a column as it follows a number."""
    return f" {columns.UNITS[name]}" if name in columns.UNITS else ""


@dataclass(frozen=True)
class Limit:
    """The range that one figure must be in. name: a column of results, or `ORDER`. None where a side is open."""

    name: str
    at_least: float | None
    at_most: float | None

    def holds(self, value: float) -> bool:
        at_least = -math.inf if self.at_least is None else self.at_least
        at_most = math.inf if self.at_most is None else self.at_most
        return at_least <= value <= at_most

    @property
    def text(self) -> str:
        sides = (("at least", self.at_least), ("at most", self.at_most))
        return " and ".join(f"{side} {value:g}{unit(self.name)}" for side, value in sides if value is not None)


@dataclass(frozen=True)
class Expectation:
    """What must hold of one method.

    status: how its run must end. known: where a discrepancy is discussed that is known to break it; until: the last day on
    which it may.
    """

    engine: str
    method: Method
    limits: tuple[Limit, ...] = ()
    status: str = OK
    known: str = ""
    until: date | None = None

    @property
    def needs_order(self) -> bool:
        return any(limit.name == ORDER for limit in self.limits)

    def concerns(self, engine: str, method: Method) -> bool:
        """Whether it is about this method of an engine."""
        same = (self.engine, self.method.name) == (engine, method.name)
        return same and self.method.is_at(method.timestep)


#: What a time step is divided by to see the order at it.
REFINEMENTS = (2, 4)
