"""The command `bodycheck run`.

Its imports are inside the function, so that `--help` answers at once.
"""

import os
from pathlib import Path

from bodycheck.console import arguments
from bodycheck.console.options import CaseName, Engines, Figures, Integrators, Jobs, Json, JUnit, Out, Timesteps
from bodycheck.errors import FAILED, OK


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
    """Run cases in engines, compare the motions with exact mechanics, and write a report.

    The default time steps are 2 ms and those of the expectations in the cases. The tables are results.csv and
    results.parquet; results.json contains the same numbers and the findings. An interrupted run resumes when it is run again
    with the same --out. In a GitHub workflow, failed expectations are annotated in the case files, and the report becomes the
    summary of the step.

    Exit codes: 0 all expectations hold; 1 an expectation failed, or an engine
    that was named or of which something is expected; 2 bad input or usage.

    Parameters
    ----------
    save
        A file (.parquet) to save the results as a baseline for `bodycheck diff`. Every run is made five times, to measure the
        effect of rounding.
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
    names = arguments.case_names(cases)
    with ran(Selection(names, engine, integrator, timestep, jobs), plan, out) as made:
        found = result_set.judged(made.results)
        verdicts = found.verdicts
        write([found], out, figures, junit)
        reports.annotate_github(found, arguments.files_of(made.cases, names), os.environ)
        if save is not None:
            with terminal.progress("nudging", baseline.size(verdicts)) as progress:
                baseline.save(save, made.results, verdicts, arguments.processes(jobs), progress)
    if json:
        terminal.print_json(judgement.records(verdicts))
    else:
        terminal.print_results(verdicts)
    return FAILED if made.engine_failed or any(verdict.passed is False for verdict in verdicts) else OK
