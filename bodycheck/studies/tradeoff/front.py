"""Find the methods that no other one surpasses in both error and cost, from the rows of a tradeoff study."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from bodycheck.results.key import RunKey

#: A row of the tradeoff study.
Row = Mapping[str, Any]

#: The columns with the error of a quantity; the second column is for scenes with friction or drag.
COLUMNS = {
    "attitude": ("attitude_error",),
    "position": ("position_error",),
    "energy": ("energy_drift", "energy_error"),
    "angular_momentum": ("angular_momentum_drift", "angular_momentum_error"),
}


@dataclass(frozen=True)
class Measured:
    """One measured method. `error` is in the quantity's unit, `cost` is the computing time (s) per simulated second."""

    engine: str
    version: str
    integrator: str
    timestep: float
    error: float
    cost: float
    cost_low: float
    cost_high: float

    @property
    def method(self) -> RunKey:
        """The key of the engine and the method, over all cases and time steps."""
        return RunKey.of_method(self.engine, self.integrator)


def pareto(rows: Sequence[Row], quantity: str) -> list[Measured]:
    """Return the methods that no other method surpasses in both error and cost, the cheapest first."""
    front: list[Measured] = []
    for method in sorted(measured(rows, quantity), key=lambda method: (method.cost, method.error)):
        if not front or method.error < front[-1].error:
            front.append(method)
    return front


def measured(rows: Sequence[Row], quantity: str) -> list[Measured]:
    """Return the methods of those rows that have both an error of a quantity and a cost."""
    found = []
    for row in rows:
        errors = [row[column] for column in COLUMNS[quantity] if row.get(column) is not None]
        if errors and row["cost"] is not None:
            low, high = (row[column] / row["timestep"] for column in ("time_per_step_low", "time_per_step_high"))
            names = row["engine"], row["version"], row["integrator"]
            found.append(Measured(*names, row["timestep"], errors[0], row["cost"], low, high))
    return found
