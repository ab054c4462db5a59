"""`bodycheck.tradeoff`: error and cost of every method over a range of time steps."""

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from bodycheck import reports
from bodycheck.console.arguments import batch_sizes
from bodycheck.console.ran import Selection, ran_of
from bodycheck.figures.columns import COLUMNS, UNITS
from bodycheck.interface import arguments
from bodycheck.interface.arguments import Cases, Names, Numbers
from bodycheck.interface.results import StudyResults, Table
from bodycheck.judging import judgement
from bodycheck.judging.schemes.run_classes import classes_of
from bodycheck.results import origin
from bodycheck.studies.orders import Order
from bodycheck.studies.tradeoff import batches, study
from bodycheck.studies.tradeoff.page import present

#: The units of the columns of the cost that have one; that of `cost` is computing time for simulated time.
COST_UNITS = {
    **dict.fromkeys(("time_per_step_low", "time_per_step_high", "processor_time_per_step", "setup_time"), "s"),
    "cost": "s/s",
    "worst_position_error": "m",
    "worst_attitude_error": "rad",
}

#: The columns of the cost that hold numbers which are not integers.
COSTS = frozenset((*COST_UNITS, "engine_share"))

#: The columns that a notebook shows.
SHOWN = (
    *("case", "engine", "integrator", "timestep", "status", "position_error", "attitude_error"),
    *("energy_drift", "energy_error", "cost", "reason"),
)

#: Those of the table of orders.
SHOWN_ORDERS = ("case", "engine", "integrator", "quantity", "order", "order_low", "order_high", "claimed", "floor", "scheme")


@dataclass(frozen=True, eq=False, repr=False)
class TradeoffResults(StudyResults):
    """What errors cost with each method, and the orders at which they vanish.

    Attributes
    ----------
    rows
        One for each run, with the columns of tradeoff.csv. Missing values are None.
    orders
        The orders of each method in each quantity.
    """

    rows: Sequence[dict[str, Any]]
    orders: Sequence[Order]

    @property
    def tables(self) -> dict[str, Table]:
        """The tables `tradeoff` and `orders`. The unit of a floor is that of its quantity."""
        columns = list(self.rows[0])
        units = {name: unit for name, unit in (UNITS | COST_UNITS).items() if name in columns}
        numbers = frozenset(name for name in columns if name in COSTS or (name in COLUMNS and _is_number(name)))
        of_orders = [field.name for field in fields(Order)]
        figures = frozenset(("order", "order_low", "order_high", "floor", "scheme_residual"))
        rows = [asdict(order) for order in self.orders]
        return {
            "tradeoff": Table(self.rows, columns, numbers, units, SHOWN),
            "orders": Table(rows, of_orders, figures, {"scheme_residual": "rad"}, SHOWN_ORDERS),
        }


def tradeoff(
    cases: Cases = (),
    *,
    engine: Names = (),
    integrator: Names = (),
    timestep: Numbers = (),
    batch: int | str | Iterable[int | str] = (),
    out: str | Path | None = None,
    jobs: int | None = None,
) -> TradeoffResults:
    """Measure error, cost and order of every method over a range of time steps, as the command `bodycheck tradeoff` does.

    Parameters
    ----------
    cases, engine, integrator, jobs
        As those of `bodycheck.run`.
    timestep
        Time steps (s); those that suit each case for none. Orders need five or more.
    batch
        Numbers of scenes: that many turned copies of each case are also run in one batch, with the engines that step many
        scenes at once. Without time steps, this is done at the step of each method nearest to 2 ms.
    out
        A folder for the tables, the recorded runs and the report, which continues what was interrupted there.

    Raises
    ------
    BadInput, Failed
        As `bodycheck.run`.
    """
    each = arguments.listed(cases)
    given = arguments.given_cases(each)
    selection = Selection(
        cases=(),
        engines=(engines := arguments.names("--engine", engine)),
        integrators=(integrators := arguments.names("--integrator", integrator)),
        timesteps=(timesteps := arguments.numbers("--timestep", timestep)),
        jobs=arguments.jobs_of(jobs),
    )
    sizes = batch_sizes("--batch", map(str, (batch,) if isinstance(batch, int | str) else batch))
    command = arguments.command("tradeoff", each, engine=engines, integrator=integrators, timestep=timesteps, batch=sizes)
    folder = arguments.path("--out", out)
    with ran_of(given, selection, study.plan, folder, command, quiet=True) as made:
        verdicts = judgement.judge(made.results)
        rows = study.price(made.results, verdicts, made.engines)
        orders = study.orders(made.results, verdicts, made.engines)
        if sizes:
            planned = batches.plan(made.results, verdicts, made.engines, sizes, timesteps)
            rows = batches.rows_alike(rows, batches.rows(planned, made.results, made.engines))
        report = present(made.results.header, rows, orders, classes_of(made.results, made.results.runs()))
        if folder is not None:
            study.write(rows, orders, folder, [origin.stored(made.results.header)])
            reports.write_study(report, folder)
    return TradeoffResults(report, rows, orders)


def _is_number(name: str) -> bool:
    return COLUMNS[name].kind == "number"
