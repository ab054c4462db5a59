"""The commands of the studies. Each imports what it needs when it runs, so that help answers at once."""

import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Literal

from bodycheck.errors import FAILED, OK, BadInput

if TYPE_CHECKING:
    from bodycheck.adapters.contract import Adapter
    from bodycheck.plan import Plan
    from bodycheck.store import Results


def tradeoff(
    *cases: str,
    engine: tuple[str, ...] = (),
    integrator: tuple[str, ...] = (),
    timestep: tuple[float, ...] = (),
    out: Path | None = None,
    jobs: int | None = None,
    json: bool = False,
) -> int:
    """Measure the trade of speed for accuracy: error and cost over a ladder of time steps, orders, and which scheme it is.

    Parameters
    ----------
    cases
        Names of shipped cases, or paths of case files; all shipped cases if none is given.
    engine
        An engine to run; may be given several times. All that are installed by default.
    integrator
        An integrator to run; may be given several times. All of each engine by default.
    timestep
        A time step in s; may be given several times. By default a ladder that suits the case. Orders need five or more.
    out
        The folder for tradeoff.csv, orders.csv, trajectories/, report.html and report.md.
    jobs
        How many processes. By default as many as there are processors. Costs are measured with one.
    json
        Print rows and orders as JSON instead of tables.
    """
    from dataclasses import asdict

    from bodycheck import judgement, reports, terminal
    from bodycheck.reports.tradeoff import present
    from bodycheck.studies import printing
    from bodycheck.studies import tradeoff as study

    with _ran(study.plan, cases, engine, integrator, timestep, out, jobs) as (results, adapters):
        verdicts = judgement.judge(results)
        with terminal.progress("measuring", 2 * len(results.cases)) as progress:
            rows = study.price(results, verdicts, adapters, progress)
            orders = study.orders(results, verdicts, adapters, progress)
        if out is not None:
            study.write(rows, orders, out)
            reports.write_study(present(results.header, rows, orders), out)
            print(f"report: {out / 'report.html'}", file=sys.stderr)
    if json:
        terminal.print_json({"rows": rows, "orders": [asdict(order) for order in orders]})
    else:
        printing.print_tradeoff(rows, orders)
    return OK


def recommend(
    case: str,
    /,
    *,
    error: float,
    quantity: Literal["attitude", "position", "energy", "angular_momentum"] = "attitude",
    engine: tuple[str, ...] = (),
    integrator: tuple[str, ...] = (),
    timestep: tuple[float, ...] = (),
    jobs: int | None = None,
    json: bool = False,
) -> int:
    """Find the cheapest methods that keep an error below a limit, all measured, none extrapolated.

    Parameters
    ----------
    case
        The name of a shipped case, or the path of a case file.
    error
        The most that the error may be: in rad, m, or relative.
    quantity
        What the error is of.
    engine
        An engine to consider; may be given several times. All that are installed by default.
    integrator
        An integrator to consider; may be given several times. All of each engine by default.
    timestep
        A time step in s to consider; may be given several times. By default a ladder that suits the case.
    jobs
        How many processes. By default as many as there are processors. Costs are measured with one.
    json
        Print as JSON instead of tables.
    """
    from dataclasses import asdict

    from bodycheck import judgement, terminal
    from bodycheck.studies import printing, recommendation
    from bodycheck.studies import tradeoff as study

    if not error > 0:
        raise BadInput(f"--error {error:g}: must be positive")
    with _ran(study.plan, (case,), engine, integrator, timestep, None, jobs) as (results, adapters):
        with terminal.progress("measuring", 1) as progress:
            rows = study.price(results, judgement.judge(results), adapters, progress)
        (name,) = results.cases
    found = recommendation.recommend(rows, quantity, error)
    front = recommendation.pareto(rows, quantity)
    if json:
        document = {"case": name, "quantity": quantity, "error": error}
        terminal.print_json(
            document | {"recommended": [asdict(entry) for entry in found], "pareto": [asdict(method) for method in front]}
        )
    else:
        printing.print_recommendations(found, front, quantity, error)
    return OK if found else FAILED


def extremes(
    *cases: str,
    engine: tuple[str, ...] = (),
    integrator: tuple[str, ...] = (),
    out: Path | None = None,
    jobs: int | None = None,
    json: bool = False,
) -> int:
    """Push cases and methods until they break, and say how they break.

    A study that was killed is gone on with when it is started again with the same --out.

    Parameters
    ----------
    cases
        Names of shipped cases, or paths of case files, that have a table [extremes]; all such shipped cases if none is given.
    engine
        An engine to push; may be given several times. All that are installed by default.
    integrator
        An integrator to push; may be given several times. All of each engine by default.
    out
        The folder for extremes.csv, limits.csv, report.html and report.md.
    jobs
        How many processes. By default as many as there are processors.
    json
        Print runs and limits as JSON instead of tables.
    """
    from dataclasses import asdict

    from bodycheck import campaign, reports, terminal
    from bodycheck.arguments import load_cases, load_engines, processes
    from bodycheck.reports.extremes import present
    from bodycheck.studies import extremes as study
    from bodycheck.studies import printing

    loaded = [case for case in load_cases(cases) if cases or case.extremes]
    adapters, missing = load_engines(engine)
    planned = study.prepare(loaded, adapters, integrator)
    head = campaign.header(sys.argv, {name: adapter.version() for name, adapter in adapters.items()}, missing)
    with ExitStack() as stack:
        folder = out or Path(stack.enter_context(TemporaryDirectory(prefix="bodycheck-")))
        progress = stack.enter_context(terminal.progress("pushing", planned.size))
        rows, limits = stack.enter_context(study.results(planned, folder, head, processes(jobs), progress))
        if out is not None:
            study.write(rows, limits, out)
            reports.write_study(present(head, rows, limits), out)
    if json:
        terminal.print_json({"rows": [asdict(row) for row in rows], "limits": [asdict(limit) for limit in limits]})
    else:
        printing.print_extremes(rows, limits)
    if out is not None:
        print(f"report: {out / 'report.html'}", file=sys.stderr)
    return OK


def ablate(
    *cases: str,
    engine: tuple[str, ...] = (),
    integrator: tuple[str, ...] = (),
    timestep: tuple[float, ...] = (),
    out: Path | None = None,
    jobs: int | None = None,
    json: bool = False,
) -> int:
    """Measure what a scene does not require: the same case on models that grow step by step, their costs and their errors.

    Parameters
    ----------
    cases
        Names of shipped cases, or paths of case files; all shipped cases if none is given.
    engine
        An engine to run; may be given several times. All that are installed by default.
    integrator
        An integrator to run; may be given several times. The first of each engine that has models by default.
    timestep
        A time step in s; may be given several times. 0.002 by default. Half of it is run too.
    out
        The folder for ablation.csv, trajectories/, report.html and report.md.
    jobs
        How many processes. By default as many as there are processors. Costs are measured with one.
    json
        Print the rows as JSON instead of a table.
    """
    from bodycheck import reports, terminal
    from bodycheck.reports.ablation import present
    from bodycheck.studies import ablation, printing

    with _ran(ablation.plan, cases, engine, integrator, timestep, out, jobs) as (results, adapters):
        rows = ablation.evaluate(results, timestep, adapters)
        if out is not None:
            ablation.write(rows, out)
            reports.write_study(present(results.header, results.cases, rows), out)
            print(f"report: {out / 'report.html'}", file=sys.stderr)
    if json:
        terminal.print_json(ablation.records(rows))
    else:
        printing.print_ablation(rows)
    return OK


@contextmanager
def _ran(
    plan: "Plan",
    cases: tuple[str, ...],
    engine: tuple[str, ...],
    integrator: tuple[str, ...],
    timestep: tuple[float, ...],
    out: Path | None,
    jobs: int | None,
) -> "Iterator[tuple[Results, dict[str, Adapter]]]":
    """The results of a study's plan, in a folder that lasts as long as the context, and the engines."""
    from bodycheck import campaign, terminal
    from bodycheck.arguments import load_cases, load_engines, processes

    loaded = load_cases(cases)
    adapters, missing = load_engines(engine)
    tasks = plan(loaded, adapters, integrator, timestep)
    head = campaign.header(sys.argv, {name: adapter.version() for name, adapter in adapters.items()}, missing)
    with ExitStack() as stack:
        folder = out or Path(stack.enter_context(TemporaryDirectory(prefix="bodycheck-")))
        with terminal.progress("running", campaign.size(tasks)) as progress:
            results = stack.enter_context(campaign.results(tasks, folder, head, processes(jobs), progress=progress))
        yield results, adapters
