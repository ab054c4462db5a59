"""The measurements of one case of the tradeoff study, as the report needs them, and their Pareto front."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from bodycheck.adapters.method import Method
from bodycheck.figures.columns import FIGURES
from bodycheck.judging.schemes.convergence import UNITS
from bodycheck.reports.quantities import QUANTITIES, Quantity, bound, milliseconds
from bodycheck.results.key import RunKey
from bodycheck.studies.orders import Order

#: A row of the tradeoff study.
Row = Mapping[str, Any]

#: Columns of the cost.
COSTS = {"cost", "time_per_step_low", "time_per_step_high"}

#: The columns with the error of a quantity; the second column is for scenes with friction or drag.
COLUMNS = {
    "attitude": ("attitude_error",),
    "position": ("position_error",),
    "energy": ("energy_drift", "energy_error"),
    "angular_momentum": ("angular_momentum_drift", "angular_momentum_error"),
}


@dataclass(frozen=True)
class Measured:
    """A measured run. `error` is in the unit of its quantity; the costs are computing times (s) per simulated second.

    `step` is the time step (s), or with error control the mean of the steps, whose largest is `timestep`. `efforts` is when the
    efforts of driven joints were computed; costs are compared among runs with the same alone.
    """

    engine: str
    version: str
    integrator: str
    timestep: float
    step: float
    error: float
    cost: float
    cost_low: float
    cost_high: float
    efforts: str = ""

    @property
    def method(self) -> RunKey:
        """The key of the engine and the method, over all cases, time steps and accuracies."""
        return method_of({"engine": self.engine, "integrator": self.integrator})

    @property
    def setting(self) -> str:
        """The time step, or with error control the accuracy, in words."""
        accuracy = Method.parse(self.integrator, self.timestep).option("accuracy")
        return milliseconds(self.timestep, 4) if accuracy is None else f"an accuracy of {accuracy}"


def pareto(rows: Sequence[Row], quantity: str) -> list[Measured]:
    """Return the Pareto front of the runs: those for which no other run has both a lower error and a lower cost.

    They are sorted by cost, the cheapest first. Of runs with equal costs or equal errors, the front has only the best one. Runs
    whose efforts were computed in different ways are not compared.
    """
    fronts: dict[str, list[Measured]] = {}
    for method in sorted(measured(rows, quantity), key=lambda method: (method.cost, method.error)):
        front = fronts.setdefault(method.efforts, [])
        if not front or method.error < front[-1].error:
            front.append(method)
    return sorted((method for front in fronts.values() for method in front), key=lambda method: method.cost)


def measured(rows: Sequence[Row], quantity: str) -> list[Measured]:
    """Return the runs of those rows that have both an error in a quantity and a cost."""
    methods = []
    for row in rows:
        errors = [row[column] for column in COLUMNS[quantity] if row.get(column) is not None]
        if errors and row["cost"] is not None:
            names, timestep = (row["engine"], row["version"], row["integrator"]), row["timestep"]
            fixed = Method.parse(row["integrator"], timestep).accuracy is None
            step = timestep if fixed else row["time_per_step"] / row["cost"]
            low, high = (row[column] / step for column in ("time_per_step_low", "time_per_step_high"))
            methods.append(Measured(*names, timestep, step, errors[0], row["cost"], low, high, row.get("efforts") or ""))
    return methods


def apart(rows: Sequence[Row]) -> tuple[list[Row], list[Row]]:
    """Return two lists: the rows of single runs, and the rows of batches."""
    return [row for row in rows if row.get("batch") is None], [row for row in rows if row.get("batch") is not None]


@dataclass(frozen=True, eq=False)
class CaseMeasurements:
    """The rows of single runs, the orders and the rows of batches of one case. Infinite numbers count as not measured."""

    name: str
    rows: tuple[Row, ...]
    orders: tuple[Order, ...]
    batches: tuple[Row, ...] = ()

    @cached_property
    def quantities(self) -> dict[str, Quantity]:
        """Return the quantities of `convergence.UNITS` in which the error of any run exceeds the truth's own error, by name."""
        by_name = {}
        for name in UNITS:
            errors = [point.error for point in measured(self._complete, name)]
            if any(error > self.truth_error(name) for error in errors):
                column = next(column for column in COLUMNS[name] if any(column in row for row in self._complete))
                by_name[name] = QUANTITIES[column]
        return by_name

    @property
    def primary(self) -> str | None:
        """Return the main quantity of the case: attitude, or else position; None if neither is in `quantities`."""
        return next((name for name in ("attitude", "position") if name in self.quantities), None)

    @cached_property
    def contact(self) -> bool:
        """Return whether the body is in contact, so that errors depend on the contact model more than on the integrator."""
        return any("penetration" in row for row in self._complete)

    @cached_property
    def comparable(self) -> bool:
        """Return whether the costs of all runs can be compared: efforts, if any, were computed in the same way."""
        return len({row.get("efforts") for row in self._complete}) <= 1

    def truth_error(self, quantity: str) -> float:
        """Return the truth's own error in a quantity, in its unit and rounded as it is printed; 0 if it is not known."""
        column = FIGURES[COLUMNS[quantity][0]].bounded_by
        return float(bound(max((row[column] for row in self._complete if column in row), default=0.0)))

    def points(self, quantity: str) -> list[Measured]:
        """Return the runs that have both an error in a quantity and a cost."""
        return measured(self._complete, quantity)

    def front(self, quantity: str) -> list[Measured]:
        """Return the Pareto front of error and cost, the cheapest run first.

        An error below the truth's own error counts as equal to it. Errors with the same printed digits count as equal.
        """
        least, columns = self.truth_error(quantity), COLUMNS[quantity]
        rows = [row | {name: _printed(max(row[name], least)) for name in columns if name in row} for row in self._complete]
        return pareto(rows, quantity)

    def row(self, point: Measured) -> Row:
        """Return the row of a run."""
        return self._by_run[point.engine, point.integrator, point.timestep]

    def coarsest(self, method: RunKey) -> Row | None:
        """Return the row of a method's completed run with the largest time step, or None if no run completed.

        The scheme of a method is identified in this run.
        """
        method_rows = [row for row in self._complete if method_of(row) == method]
        return max(method_rows, key=lambda row: float(row["timestep"]), default=None)

    @cached_property
    def _by_run(self) -> Mapping[tuple[str, str, float], Row]:
        return {(row["engine"], row["integrator"], row["timestep"]): row for row in reversed(self._complete)}

    @cached_property
    def _complete(self) -> Sequence[dict[str, Any]]:
        """Return the rows of completed runs with a cost, without the columns that were not measured."""
        known = [{name: value for name, value in row.items() if _is_measured(value)} for row in self.rows]
        return [row for row in known if row["status"] == "ok" and row.keys() >= COSTS]


def method_of(row: Row) -> RunKey:
    """Return the key of the engine and the method of a row, over all cases, time steps and accuracies."""
    return RunKey.of_method(row["engine"], Method.parse(row["integrator"], 0.0).over_accuracies.name)


def _printed(error: float) -> float:
    return float(f"{error:.4g}")


def _is_measured(value: object) -> bool:
    return value is not None and not (isinstance(value, float) and not math.isfinite(value))
