"""One case of the tradeoff study: what was measured of it, as its report needs it."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from bodycheck.judging.convergence import UNITS
from bodycheck.reports.quantities import QUANTITIES, Quantity, bound
from bodycheck.running.key import RunKey
from bodycheck.studies.orders import Order
from bodycheck.studies.tradeoff.recommendation import COLUMNS, Measured, measured, pareto

#: A row of the tradeoff study.
Row = Mapping[str, Any]

COSTS = {"cost", "time_per_step_low", "time_per_step_high"}


@dataclass(frozen=True, eq=False)
class CaseMeasurements:
    """The rows and orders of one case. What is not a finite number in a row counts as not measured."""

    name: str
    rows: tuple[Row, ...]
    orders: tuple[Order, ...]

    @cached_property
    def quantities(self) -> dict[str, Quantity]:
        """Those of `convergence.UNITS` in which any run errs: by more than the truth itself, where that is known."""
        found = {}
        for name in UNITS:
            errors = [point.error for point in measured(self._told, name)]
            if any(error > self.truth_error(name) for error in errors):
                column = next(column for column in COLUMNS[name] if any(column in row for row in self._told))
                found[name] = QUANTITIES[column]
        return found

    @property
    def primary(self) -> str | None:
        """The quantity that tells most: attitude, position where nothing turns, None where neither was measured."""
        return next((name for name in ("attitude", "position") if name in self.quantities), None)

    @cached_property
    def contact(self) -> bool:
        """Whether the body is in contact, which is another model and no integrator's doing."""
        return any("penetration" in row for row in self._told)

    def truth_error(self, quantity: str) -> float:
        """The truth's own error in a quantity (rad), to the digits that are printed; known of the attitude, else 0."""
        if quantity != "attitude":
            return 0.0
        return float(bound(max((row["truth_error"] for row in self._told if "truth_error" in row), default=0.0)))

    def points(self, quantity: str) -> list[Measured]:
        """The runs that have both an error in a quantity and a cost."""
        return measured(self._told, quantity)

    def front(self, quantity: str) -> list[Measured]:
        """The runs that no other one beats in both error and cost, the cheapest first.

        Errors below the truth's own say nothing and count as equal to it, as do those that are printed alike.
        """
        least, columns = self.truth_error(quantity), COLUMNS[quantity]
        rows = [row | {name: _printed(max(row[name], least)) for name in columns if name in row} for row in self._told]
        return pareto(rows, quantity)

    def row(self, point: Measured) -> Row:
        """The row of a run."""
        return self._by_run[point.method, point.timestep]

    def coarsest(self, method: RunKey) -> Row | None:
        """The row of a method's completed run with the largest time step, of which its scheme is told; None without any."""
        own = [row for row in self._told if _method(row) == method]
        return max(own, key=lambda row: float(row["timestep"]), default=None)

    @cached_property
    def _by_run(self) -> Mapping[tuple[RunKey, float], Row]:
        return {(_method(row), row["timestep"]): row for row in reversed(self._told)}

    @cached_property
    def _told(self) -> Sequence[dict[str, Any]]:
        """The rows of runs with a cost, without what was not measured."""
        told = [{name: value for name, value in row.items() if _there(value)} for row in self.rows]
        return [row for row in told if row["status"] == "ok" and row.keys() >= COSTS]


def _method(row: Row) -> RunKey:
    return RunKey.of_method(row["engine"], row["integrator"])


def _printed(error: float) -> float:
    return float(f"{error:.4g}")


def _there(value: object) -> bool:
    return value is not None and not (isinstance(value, float) and not math.isfinite(value))
