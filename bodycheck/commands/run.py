"""The command `bodycheck run`.

It imports what it needs when it runs, so that `--help` answers at once.
"""

import os
from pathlib import Path
from typing import TYPE_CHECKING

from bodycheck.console import arguments
from bodycheck.console.options import CaseName, Engines, Figures, Integrators, Jobs, Json, JUnit, Out, Timesteps
from bodycheck.errors import FAILED, OK

if TYPE_CHECKING:
    pass


def run(
    *cases: CaseName,
    engine: Engines = (),
    integrator: Integrators = (),
    timestep: Timesteps = (),
    out: Out = None,
    figures: Figures = (),
    save: Path | None = None,
    junit: JUnit = None,
    jobs: Jobs = None,
    json: Json = False,
) -> int:
    """Run cases through engines, compare them with mechanics and report.

    Time steps are 2 ms by default, and what a case's expectations ask for. The tables are results.csv and results.parquet;
    results.json has them too, and the findings.
    In a workflow of GitHub, broken expectations are annotated in the case files, and the report is the summary of the step.

    Parameters
    ----------
    save
        A file (.parquet) for the results as a baseline, which `bodycheck diff` holds others against. Every run is made five
        times, to see what rounding does to it.
    """
    from bodycheck import reports
    from bodycheck.commands.report import write
    from bodycheck.console import terminal
    from bodycheck.console.ran import Selection, ran
    from bodycheck.judging import baseline, judgement, result_set
    from bodycheck.running.plan import plan

    for option, path in (("--save", save), ("--junit", junit)):
        arguments.check_writable(option, path)
    arguments.check_has_folder(figures, out)
    with ran(Selection(cases, engine, integrator, timestep, jobs), plan, out) as made:
        found = result_set.judged(made.results)
        verdicts = found.verdicts
        write([found], out, figures, junit)
        reports.annotate_github(found, arguments.files_of(made.cases, cases), os.environ)
        if save is not None:
            with terminal.progress("nudging", baseline.size(verdicts)) as progress:
                baseline.save(save, made.results, verdicts, arguments.processes(jobs), progress)
    if json:
        terminal.print_json(judgement.records(verdicts))
    else:
        terminal.print_results(verdicts)
    return FAILED if any(verdict.passed is False for verdict in verdicts) else OK
