"""The command `bodycheck ablate`.

Its imports are inside the function, so that `--help` answers at once.
"""

from typing import Annotated

from cyclopts import Parameter

from bodycheck.console.arguments import AS_THEY_ARE
from bodycheck.console.options import (
    AS_USUAL,
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


def ablate(
    *cases: CaseName,
    engine: Engines = (),
    integrator: Annotated[
        Integrators,
        Parameter(
            help="A method to use, or default or recommended. May be given several times. If none is named: the first of each "
            "engine that has models."
        ),
    ] = (),
    timestep: Timesteps = (),
    robots: OfRobots = AS_THEY_ARE,
    out: Out = None,
    figures: Figures = (),
    jobs: Jobs = None,
    json: Json = False,
    view: Viewed = AS_USUAL,
    quiet: Quiet = False,
) -> int:
    """Measure the cost and the effect of model parts that a case does not require.

    The same case is run on models of growing size, from the smallest that represents it to one with everything computed. The
    default time step is 2 ms; half of it is run too. Costs are measured with one process. The table is ablation.csv.
    """
    from bodycheck.console import tables, terminal
    from bodycheck.console.arguments import check_has_folder
    from bodycheck.console.output import end
    from bodycheck.console.ran import Selection, ran
    from bodycheck.results import origin
    from bodycheck.studies.ablation import printing, study
    from bodycheck.studies.ablation.page import present
    from bodycheck.studies.ablation.rows import MODELS, records
    from bodycheck.studies.output import Output

    check_has_folder(figures, out)
    tables.check(view, printing.MODELS)
    with ran(Selection(cases, engine, integrator, timestep, jobs, robots=robots), study.plan, out, quiet) as runs:
        results = runs.results
        rows = study.evaluate(results, runs.engines, integrator, timestep)
        report = present(results.header, results.cases, rows)
        Output(out, figures).write(report, ((MODELS, records(rows)),), [origin.stored(results.header)])
    if json:
        terminal.print_json(records(rows))
    elif not quiet:
        printing.print_ablation(rows, view)
    return end(runs.decided(records(rows)), out, json=json, quiet=quiet)


#: The commands of the study.
COMMANDS = (ablate,)
