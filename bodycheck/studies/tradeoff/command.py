"""The command `bodycheck tradeoff`.

Its imports are inside the function, so that `--help` answers at once.
"""

from bodycheck.console.options import (
    AS_USUAL,
    Batches,
    CaseName,
    Engines,
    Figures,
    Integrators,
    Jobs,
    Json,
    Out,
    Quiet,
    Timesteps,
    Viewed,
)
from bodycheck.errors import FAILED, OK


def tradeoff(
    *cases: CaseName,
    engine: Engines = (),
    integrator: Integrators = (),
    timestep: Timesteps = (),
    batch: Batches = (),
    out: Out = None,
    figures: Figures = (),
    jobs: Jobs = None,
    json: Json = False,
    view: Viewed = AS_USUAL,
    quiet: Quiet = False,
) -> int:
    """Measure error and cost of every method over a range of time steps.

    The report also contains the order of convergence of every method and the textbook scheme that it agrees with. The default
    time steps suit the case; orders need five or more time steps. Costs are measured with one process. With --batch they are
    also measured where an engine steps many scenes at once. The tables are tradeoff.csv and orders.csv.
    """
    import sys
    from dataclasses import asdict

    from bodycheck import reports
    from bodycheck.console import tables, terminal
    from bodycheck.console.arguments import batch_sizes, check_has_folder
    from bodycheck.console.output import say_where
    from bodycheck.console.ran import Selection, ran
    from bodycheck.judging import judgement
    from bodycheck.judging.schemes.run_classes import classes_of
    from bodycheck.results import origin
    from bodycheck.studies.tradeoff import batch_page, batches, printing, study
    from bodycheck.studies.tradeoff.page import present

    check_has_folder(figures, out)
    sizes = batch_sizes("--batch", batch)
    tables.check(view, printing.RUNS, printing.METHODS, printing.BATCHES)
    with ran(Selection(cases, engine, integrator, timestep, jobs), study.plan, out, quiet) as made:
        results, engines = made.results, made.engines
        verdicts = judgement.judge(results)
        with terminal.progress("measuring", 2 * len(results.cases), quiet) as progress:
            rows = study.price(results, verdicts, engines, progress)
            orders = study.orders(results, verdicts, engines, progress)
        if sizes:
            if (text := batch_page.without(rows)) and not quiet:
                print(f"bodycheck: {text}", file=sys.stderr)
            planned = batches.plan(results, verdicts, engines, sizes, timestep)
            with terminal.progress("batches", len(planned), quiet) as progress:
                rows = batches.rows_alike(rows, batches.rows(planned, results, engines, progress))
        if out is not None:
            study.write(rows, orders, out, [origin.stored(results.header)])
            classes = classes_of(results, results.runs())
            reports.write_study(present(results.header, rows, orders, classes), out, figures)
    if json:
        terminal.print_json({"rows": rows, "orders": [asdict(order) for order in orders]})
    elif not quiet:
        printing.print_tradeoff(rows, orders, view)
    say_where(out, quiet)
    return FAILED if made.engine_failed else OK
