"""The expectations of a case: limits and a status that must hold for the runs of one method."""

import math
from dataclasses import dataclass
from datetime import date

from bodycheck.adapters.method import Method
from bodycheck.figures import columns

#: Name of the observed order of convergence of the attitude error, which can be limited like a column of results.
ORDER = columns.ORDER.name

#: The prefix of the names of limits for the errors of sensors.
SENSORS = "sensors."

#: The status of a completed run, which is expected by default.
OK = "ok"


def unit(name: str) -> str:
    """Return the unit of a column with a space before it; empty if it has none."""
    return f" {columns.UNITS[name]}" if name in columns.UNITS else ""


@dataclass(frozen=True)
class Limit:
    """The allowed range of one figure of a run.

    Parameters
    ----------
    name
        A column of results, `ORDER`, or `SENSORS` with the name of a sensor or of a part of it, such as "sensors.imu".
    at_least, at_most
        The ends of the range; None for no limit.
    sensor_unit
        The unit of the readings if the limit is of the error of a sensor; else empty.
    """

    name: str
    at_least: float | None
    at_most: float | None
    sensor_unit: str = ""

    def holds(self, value: float) -> bool:
        """Return whether a value is within the range."""
        at_least = -math.inf if self.at_least is None else self.at_least
        at_most = math.inf if self.at_most is None else self.at_most
        return at_least <= value <= at_most

    @property
    def in_unit(self) -> str:
        """The unit of the ends with a space before it; empty if they have none."""
        return f" {self.sensor_unit}" if self.sensor_unit else unit(self.name)

    @property
    def text(self) -> str:
        """The range in words, with units."""
        sides = (("at least", self.at_least), ("at most", self.at_most))
        return " and ".join(f"{side} {value:g}{self.in_unit}" for side, value in sides if value is not None)


@dataclass(frozen=True)
class Expectation:
    """A requirement for the runs of one method of an engine.

    Parameters
    ----------
    engine
        The name of the engine.
    method
        The integrator, its options and the time step.
    limits
        The allowed ranges of figures.
    status
        The status with which the run must end.
    known
        A reference to a known discrepancy that breaks the expectation; empty if there is none.
    until
        The last day on which a known discrepancy is tolerated.
    version
        The version of the engine with which the limits were measured; empty if the case does not say it.
    """

    engine: str
    method: Method
    limits: tuple[Limit, ...] = ()
    status: str = OK
    known: str = ""
    until: date | None = None
    version: str = ""

    @property
    def needs_order(self) -> bool:
        """True if the order is limited, which needs runs with smaller time steps."""
        return any(limit.name == ORDER for limit in self.limits)

    def concerns(self, engine: str, method: Method) -> bool:
        """Return whether the expectation is about this method of an engine."""
        same = (self.engine, self.method.name) == (engine, method.name)
        return same and self.method.is_at(method.timestep)


#: The divisors of a time step that give the smaller time steps from which its order is measured.
REFINEMENTS = (2, 4)
