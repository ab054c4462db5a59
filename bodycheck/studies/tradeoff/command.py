"""The command `bodycheck tradeoff`.

Its imports are inside the function, so that `--help` answers at once.
"""

from bodycheck.console.arguments import AS_THEY_ARE
from bodycheck.console.options import (
    AS_USUAL,
    Batches,
    CaseName,
    Engines,
    Figures,
    Integrators,
    Jobs,
    Json,
    OfRobots,
    Out,
    Quiet,
    Timesteps,
    Viewed,
)


def tradeoff(
    *cases: CaseName,
    engine: Engines = (),
    integrator: Integrators = (),
    timestep: Timesteps = (),
    batch: Batches = (),
    robots: OfRobots = AS_THEY_ARE,
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
    from bodycheck.console import tables, terminal
    from bodycheck.console.arguments import batch_sizes, check_has_folder
    from bodycheck.console.output import end
    from bodycheck.console.ran import Selection, ran
    from bodycheck.running.named import of_search
    from bodycheck.studies.output import Output
    from bodycheck.studies.tradeoff import printing, study
    from bodycheck.studies.tradeoff.interface import carry_out

    check_has_folder(figures, out)
    sizes = batch_sizes("--batch", batch)
    tables.check(view, printing.RUNS, printing.METHODS, printing.BATCHES)
    with ran(Selection(cases, engine, integrator, timestep, jobs, robots=robots), study.plan, out, quiet) as runs:
        results = carry_out(runs, timestep, sizes, Output(out, figures, quiet))
    if json:
        terminal.print_json({"rows": results.tables["tradeoff"].rows, "orders": results.tables["orders"].rows})
    elif not quiet:
        printing.print_tradeoff(results.rows, results.orders, view)
    return end(runs.decided(of_search(results.rows, integrator), batch=sizes), out, json=json, quiet=quiet)


#: The commands of the study.
COMMANDS = (tradeoff,)
