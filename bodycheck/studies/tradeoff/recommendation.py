"""Find the cheapest methods that keep an error below a limit, from the rows of a tradeoff study; nothing is extrapolated."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from bodycheck.running.key import RunKey

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


@dataclass(frozen=True)
class Recommendation:
    """A method that keeps the limit, and its integrator with the next larger and smaller measured time steps."""

    method: Measured
    coarser: Measured | None
    finer: Measured | None


def recommend(rows: Sequence[Row], quantity: str, limit: float) -> list[Recommendation]:
    """Return, for each integrator, the cheapest time step that keeps the limit; the cheapest integrator first.

    Parameters
    ----------
    rows
        The rows of one case in a tradeoff study.
    quantity
        A key of `COLUMNS`.
    limit
        The largest allowed error, in the quantity's unit.
    """
    found = []
    by_integrator: dict[RunKey, list[Measured]] = defaultdict(list)
    for method in measured(rows, quantity):
        by_integrator[method.method].append(method)
    for methods in by_integrator.values():
        methods.sort(key=lambda method: -method.timestep)
        keeping = [method for method in methods if method.error <= limit]
        if keeping:
            best = min(keeping, key=lambda method: method.cost)
            place = methods.index(best)
            coarser = methods[place - 1] if place else None
            finer = methods[place + 1] if place + 1 < len(methods) else None
            found.append(Recommendation(best, coarser, finer))
    return sorted(found, key=lambda recommendation: recommendation.method.cost)


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
