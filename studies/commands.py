"""The commands of the studies. Each imports what it needs when it runs, so that help answers at once."""

import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from bodycheck.errors import FAILED, OK, BadInput
from bodycheck.options import CaseName, Engines, Figures, Integrators, Jobs, Json, Out, Timesteps

if TYPE_CHECKING:
    from bodycheck.adapters.contract import Adapter
    from bodycheck.plan import Plan
    from bodycheck.store import Results


def tradeoff(
    *cases: CaseName,
    engine: Engines = (),
    integrator: Integrators = (),
    timestep: Timesteps = (),
    out: Out = None,
    figures: Figures = (),
    jobs: Jobs = None,
    json: Json = False,
) -> int:
    """Measure the trade of speed for accuracy: error and cost over a ladder of time steps, orders, and which scheme it is.

    Time steps are by default a ladder that suits the case; orders need five or more. Costs are measured with one process. The
    tables are tradeoff.csv and orders.csv.
    """
    from dataclasses import asdict

    from bodycheck import judgement, reports, terminal
    from bodycheck.arguments import check_has_folder
    from bodycheck.reports.tradeoff import present
    from bodycheck.studies import printing
    from bodycheck.studies import tradeoff as study

    check_has_folder(figures, out)
    with _ran(study.plan, cases, engine, integrator, timestep, out, jobs) as (results, adapters):
        verdicts = judgement.judge(results)
        with terminal.progress("measuring", 2 * len(results.cases)) as progress:
            rows = study.price(results, verdicts, adapters, progress)
            orders = study.orders(results, verdicts, adapters, progress)
        if out is not None:
            study.write(rows, orders, out)
            reports.write_study(present(results.header, rows, orders), out, figures)
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
    engine: Engines = (),
    integrator: Integrators = (),
    timestep: Timesteps = (),
    jobs: Jobs = None,
    json: Json = False,
) -> int:
    """Find the cheapest methods that keep an error below a limit, all measured, none extrapolated.

    Time steps are by default a ladder that suits the case. Costs are measured with one process.

    Parameters
    ----------
    case
        The name of a shipped case, or the path of a case file.
    error
        The most that the error may be: in rad, m, or relative.
    quantity
        What the error is of.
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
    *cases: CaseName,
    engine: Engines = (),
    integrator: Integrators = (),
    out: Out = None,
    figures: Figures = (),
    jobs: Jobs = None,
    json: Json = False,
) -> int:
    """Push cases and methods until they break, and say how they break.

    Cases are those that have a table [extremes]. The tables are extremes.csv and limits.csv. A study that was killed is gone on
    with when it is started again with the same --out.
    """
    from dataclasses import asdict

    from bodycheck import campaign, reports, terminal
    from bodycheck.arguments import check_has_folder, load_cases, load_engines, processes
    from bodycheck.reports.extremes import present
    from bodycheck.studies import extremes as study
    from bodycheck.studies import printing

    check_has_folder(figures, out)
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
            reports.write_study(present(head, rows, limits), out, figures)
    if json:
        terminal.print_json({"rows": [asdict(row) for row in rows], "limits": [asdict(limit) for limit in limits]})
    else:
        printing.print_extremes(rows, limits)
    if out is not None:
        print(f"report: {out / 'report.html'}", file=sys.stderr)
    return OK


def ablate(
    *cases: CaseName,
    engine: Engines = (),
    integrator: Annotated[
        Integrators,
        Parameter(help="An integrator to use; may be given several times. By default the first of each that has models."),
    ] = (),
    timestep: Timesteps = (),
    out: Out = None,
    figures: Figures = (),
    jobs: Jobs = None,
    json: Json = False,
) -> int:
    """Measure what a scene does not require: the same case on models that grow step by step, their costs and their errors.

    The time step is 2 ms by default; half of it is run too. Costs are measured with one process. The table is ablation.csv.
    """
    from bodycheck import reports, terminal
    from bodycheck.arguments import check_has_folder
    from bodycheck.reports.ablation import present
    from bodycheck.studies import ablation, printing

    check_has_folder(figures, out)
    with _ran(ablation.plan, cases, engine, integrator, timestep, out, jobs) as (results, adapters):
        rows = ablation.evaluate(results, timestep, adapters)
        if out is not None:
            ablation.write(rows, out)
            reports.write_study(present(results.header, results.cases, rows), out, figures)
            print(f"report: {out / 'report.html'}", file=sys.stderr)
    if json:
        terminal.print_json(ablation.records(rows))
    else:
        printing.print_ablation(rows)
    return OK


def releases(
    engine: str,
    /,
    *versions: str,
    case: Annotated[
        tuple[str, ...],
        Parameter(help="A shipped case or the path of a case file; may be given several times. By default all shipped cases."),
    ] = (),
    integrator: Integrators = (),
    timestep: Timesteps = (),
    last: int | None = None,
    out: Out = None,
    figures: Figures = (),
    remove: bool = False,
    jobs: Jobs = None,
    json: Json = False,
) -> int:
    """Say what an upgrade of an engine changed: the same cases and methods in each of its releases, held against one another.

    Each release has an environment of its own, which is kept, and so is what was measured in it. Time steps are as in `run`.
    The tables are releases.csv and changes.csv. Exit codes: 0 every release was measured, whatever changed; 1 one was not.

    Parameters
    ----------
    engine
        The engine.
    versions
        Releases of it.
    last
        So many of its newest releases, besides those that are named.
    remove
        Instead of all this, delete the environments of the versions that are named; of all where none is.
    """
    from dataclasses import asdict

    from bodycheck import reports, terminal
    from bodycheck.arguments import check_engine, check_has_folder, load_cases, make_folder, processes
    from bodycheck.reports.releases import present
    from bodycheck.studies import environments, printing, release_rows
    from bodycheck.studies import releases as study

    check_engine(engine)
    if remove:
        if last is not None:
            raise BadInput("--remove goes with versions, not with --last")
        named = tuple(map(study.version, versions)) or tuple(study.kept(engine))
        removed = environments.remove(engine, named)
        terminal.print_json({"removed": removed}) if json else printing.print_removed(engine, removed)
        return OK
    check_has_folder(figures, out)
    make_folder("--out", out)
    loaded = load_cases(case)
    chosen, notices = study.chosen(engine, versions, last)
    found, tally = study.study(engine, chosen, loaded, integrator, timestep, processes(jobs), terminal.progress, notices)
    if out is not None:
        release_rows.write(found, out)
        reports.write_study(present({"": found}), out, figures)
    if json:
        document = {"engine": engine, "versions": chosen, "notices": notices, "took": asdict(tally)}
        terminal.print_json(document | {"rows": found.rows, "changes": [asdict(change) for change in found.changes]})
    else:
        printing.print_releases(found)
    for line in (*notices, tally.text, *(() if out is None else (f"report: {out / 'report.html'}",))):
        print(line, file=sys.stderr)
    return FAILED if notices or found.header["unmeasured"] else OK


def bisect(
    engine: str,
    good: str,
    bad: str,
    /,
    *,
    case: str,
    quantity: str,
    limit: float,
    integrator: str = "",
    timestep: float | None = None,
    jobs: Jobs = None,
    json: Json = False,
) -> int:
    """Find the release of an engine at which a figure broke a limit, with as few releases installed as possible.

    Either of the two releases may be the newer one. Releases that cannot be installed, or that lack the integrator, are stepped
    around. Exit codes: 0 found; 1 one of the two cannot be told, or releases beside the one that was found; 2 the one that is
    to be good is not, or the one that is to be bad is not bad, and bad usage.

    Parameters
    ----------
    engine
        The engine.
    good
        A release that keeps the limit.
    bad
        A release that breaks it; a run that fails breaks it too.
    case
        The name of a shipped case, or the path of a case file.
    quantity
        A column of results, attitude_error for one.
    limit
        The most that the figure may be.
    integrator
        The integrator. By default the first of the engine.
    timestep
        The time step in s, 0.002 by default.
    """
    from dataclasses import asdict

    from bodycheck import terminal
    from bodycheck.arguments import check_engine, load_cases, processes
    from bodycheck.simulation import DEFAULT_TIMESTEP
    from bodycheck.studies import bisection, printing

    check_engine(engine)
    (loaded,) = load_cases((case,))
    kept = bisection.Limit(loaded, integrator, timestep or DEFAULT_TIMESTEP, quantity, limit)
    observer = bisection.Observer(engine, kept, processes(jobs), lambda text: print(text, file=sys.stderr))
    try:
        found, notice = bisection.find(engine, good, bad, observer)
    except bisection.Undecided as error:
        print(f"bodycheck: cannot be told: {error}", file=sys.stderr)
        return FAILED
    if notice:
        print(notice, file=sys.stderr)
    if json:
        looks = [asdict(look) for look in observer.looks.values()]
        where = {"case": loaded.name, "integrator": observer.limit.integrator, "timestep": kept.timestep}
        what = {"quantity": quantity, "limit": limit, **asdict(found), "looks": looks, "made": observer.made}
        terminal.print_json(where | what)
    else:
        printing.print_bisection(found, observer)
    return FAILED if found.unknown or notice else OK


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
