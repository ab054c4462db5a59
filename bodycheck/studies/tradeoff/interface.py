"""`bodycheck.tradeoff`: error and cost of every method over a range of time steps."""

import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bodycheck.console.arguments import batch_sizes
from bodycheck.console.progress import progress
from bodycheck.console.ran import Ran, Selection, ran_of
from bodycheck.interface import arguments
from bodycheck.interface.arguments import Cases, Names, Numbers
from bodycheck.interface.results import StudyResults, Table
from bodycheck.judging import judgement
from bodycheck.judging.schemes.run_classes import classes_of
from bodycheck.results import origin
from bodycheck.studies.orders import ORDERS, Order
from bodycheck.studies.output import Output
from bodycheck.studies.tradeoff import batch_page, batches, study
from bodycheck.studies.tradeoff.page import present
from bodycheck.studies.tradeoff.rows import RUNS


@dataclass(frozen=True, eq=False, repr=False)
class TradeoffResults(StudyResults):
    """The errors and costs of all runs, and the orders at which the errors of each method vanish.

    Attributes
    ----------
    rows
        A row for each run, with the columns of tradeoff.csv. Missing values are None.
    orders
        The orders of each method in each quantity.
    """

    rows: Sequence[dict[str, Any]]
    orders: Sequence[Order]

    @property
    def tables(self) -> dict[str, Table]:
        """The tables `tradeoff` and `orders`. A floor has the unit of its quantity."""
        return {RUNS.name: Table.of(RUNS, self.rows), ORDERS.name: Table.of(ORDERS, self.orders)}


def carry_out(runs: Ran, timesteps: Sequence[float], batch_sizes: Sequence[int], output: Output) -> TradeoffResults:
    """Measure the costs of runs and the convergence of their errors, and write the tables and the report.

    Parameters
    ----------
    runs
        The runs of the methods over their time steps.
    timesteps
        The time steps (s) that the user chose; empty if each case was run with the time steps that suit it.
    batch_sizes
        The numbers of scenes that are also run in one batch.
    output
        The folder and the formats of the results, and the display of progress.
    """
    results, engines = runs.results, runs.engines
    verdicts = judgement.judge(results)
    with progress("measuring", 2 * len(results.cases), output.quiet) as advance:
        rows = study.price(results, verdicts, engines, advance)
        orders = study.orders(results, verdicts, engines, advance)
    if batch_sizes:
        if (text := batch_page.without(rows)) and not output.quiet:
            print(f"bodycheck: {text}", file=sys.stderr)
        planned = batches.plan(results, verdicts, engines, batch_sizes, timesteps)
        with progress("batches", len(planned), output.quiet) as advance:
            rows = batches.rows_alike(rows, batches.rows(planned, results, engines, advance))
    report = present(results.header, rows, orders, classes_of(results, results.runs()))
    output.write(report, ((RUNS, rows), (ORDERS, orders)), [origin.stored(results.header)])
    return TradeoffResults(report, rows, orders)


def tradeoff(
    cases: Cases = (),
    *,
    engine: Names = (),
    integrator: Names = (),
    timestep: Numbers = (),
    batch: int | str | Iterable[int | str] = (),
    package_path: str | Path | Iterable[str | Path] = (),
    ignore: Names = (),
    out: str | Path | None = None,
    jobs: int | None = None,
) -> TradeoffResults:
    """Measure error, cost and order of every method over a range of time steps, as the command `bodycheck tradeoff` does.

    Parameters
    ----------
    cases, engine, integrator, jobs
        The same as the parameters of `bodycheck.run`.
    timestep
        Time steps (s). If none are given, each case is run with time steps that suit it. Orders need five or more.
    batch
        Numbers of scenes. For each of them, the case and turned copies of it, so many scenes in all, are also run in one batch
        with the engines that step many scenes at once. If no time steps are given, each method is run with that of its time
        steps which is nearest to 2 ms.
    package_path, ignore
        The same as the parameters of `bodycheck.run`.
    out
        A folder for the tables, the recorded runs and the report. An interrupted study in it is resumed.

    Raises
    ------
    BadInput, Failed
        In the same cases as by `bodycheck.run`.
    """
    each = arguments.listed(cases)
    selected = arguments.given_cases(each, read := arguments.robots(package_path, ignore))
    selection = Selection(
        cases=(),
        engines=(engines := arguments.names("--engine", engine)),
        integrators=(integrators := arguments.names("--integrator", integrator)),
        timesteps=(timesteps := arguments.numbers("--timestep", timestep)),
        jobs=arguments.jobs_of(jobs),
    )
    sizes = batch_sizes("--batch", map(str, (batch,) if isinstance(batch, int | str) else batch))
    command = arguments.command(
        "tradeoff",
        each,
        engine=engines,
        integrator=integrators,
        timestep=timesteps,
        batch=sizes,
        **arguments.of_robots(read),
    )
    folder = arguments.path("--out", out)
    with ran_of(selected, selection, study.plan, folder, command, quiet=True) as runs:
        return carry_out(runs, timesteps, sizes, Output(folder))
