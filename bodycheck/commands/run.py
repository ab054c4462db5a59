"""The commands `bodycheck run` and `export`.

The imports are inside the functions, so that `--help` answers at once.
"""

import os
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from bodycheck.console import arguments
from bodycheck.console.arguments import AS_THEY_ARE
from bodycheck.console.options import (
    AS_USUAL,
    AllowMissing,
    CaseName,
    Engines,
    Figures,
    Integrators,
    Jobs,
    Json,
    JUnit,
    OfRobots,
    Out,
    Quiet,
    Timesteps,
    Viewed,
)
from bodycheck.errors import OK, BadInput

if TYPE_CHECKING:
    from bodycheck.judging.result_set import ResultSet


def run(
    *cases: CaseName,
    engine: Engines = (),
    integrator: Integrators = (),
    timestep: Timesteps = (),
    robots: OfRobots = AS_THEY_ARE,
    out: Out = None,
    figures: Figures = (),
    save: Path | None = None,
    junit: JUnit = None,
    jobs: Jobs = None,
    allow_missing: AllowMissing = False,
    json: Json = False,
    table: bool = False,
    view: Viewed = AS_USUAL,
    quiet: Quiet = False,
) -> int:
    """Run cases in engines, compare the motions with exact mechanics, and write a report.

    Without --integrator and --timestep, the methods that each engine offers run at 2 ms, the default and the recommended
    method of the engine at their own time steps, and methods of which a case expects something at those of its expectations.
    The tables are results.csv and results.parquet; results.json contains the same numbers and the findings. An interrupted run
    resumes when it is run again with the same --out. In a GitHub workflow, failed expectations are annotated in the case files,
    and the report becomes the summary of the step.

    Exit codes: 0 all expectations hold; 1 an expectation failed, or an engine
    of which something is expected, or something that was named has no result,
    or a case file has a fault and was left out; 2 bad input or usage, or no
    case file can be read. An expectation of an engine that is not installed
    counts as failed, except in a shipped case, or with --allow-missing.

    Parameters
    ----------
    save
        A file (.parquet) to save the results as a baseline for `bodycheck diff`. Every run is made five times, to measure the
        effect of rounding.
    table
        Print the table of all runs before the summary. This is the default where stdout is not a terminal, and with --columns,
        --sort and --wide. --columns may name any column of results.csv.
    """
    from bodycheck import reports
    from bodycheck.commands.report import write
    from bodycheck.console import output, results, tables, terminal
    from bodycheck.console.ran import Selection, ran
    from bodycheck.judging import judgement, result_set
    from bodycheck.judging.baselines import baseline
    from bodycheck.running.plan import plan_with_roles

    for option, path in (("--save", save), ("--junit", junit)):
        arguments.check_writable(option, path)
    arguments.check_has_folder(figures, out)
    tables.check(view, results.RUNS)
    compared = judgement.Compared()
    selection = Selection(cases, engine, integrator, timestep, jobs, allow_missing, robots)
    with ran(selection, plan_with_roles, out, quiet, compared.meet) as runs:
        result = result_set.judged(runs.results, compared=compared)
        verdicts = result.verdicts
        write([result], out, figures, junit)
        reports.annotate_github(result, runs.files, os.environ)
        if save is not None:
            with terminal.progress("nudging", baseline.size(verdicts), quiet) as progress:
                baseline.save(save, runs.results, verdicts, arguments.processes(jobs), progress)
        if json:
            terminal.print_json(judgement.records(verdicts))
        elif quiet:
            results.print_failed(verdicts, runs.results.files)
        else:
            if table or view != AS_USUAL or not sys.stdout.isatty():
                results.print_runs(verdicts, view)
            print_summary_of(result, out)
    if json or quiet:
        results.print_unchecked(runs.results.unchecked, sys.stderr)
    decision = runs.decided((verdict.row() for verdict in verdicts), result.failed)
    return output.end(decision if json else replace(decision, unsupported=""), out, json=json, quiet=quiet)


def print_summary_of(result: "ResultSet", out: Path | None) -> None:
    """Print the summary of judged results. out: the folder with their report; None if there is none."""
    from bodycheck import reports
    from bodycheck.console.summary import Summary, print_summary

    brief = reports.brief([result])
    sentences = (brief.broken, *brief.answers, *brief.findings)
    findings = [f"{finding.subject}: {finding.text}" for finding in sentences if finding is not None]
    more = [] if out is not None else ["--out FOLDER writes a report, and --table prints all runs."]
    print_summary(Summary(brief.headline, findings, brief.counts, brief.unsupported, [*brief.limits, *more], brief.steps))


def export(
    case: str,
    /,
    *,
    engine: str,
    integrator: str | None = None,
    timestep: Annotated[float | None, Parameter(help="The time step in s. Default: 0.002, or that of the alias.")] = None,
    robots: OfRobots = AS_THEY_ARE,
    out: Path | None = None,
) -> int:
    """Write what a run does as a Python script for the engine alone.

    The script builds the same model, takes the same steps and prints the same states, to the last bit, without bodycheck, so
    that a finding can be shown to the authors of the engine. A script for MuJoCo contains the model as MJCF. Exit codes: 1 the
    engine cannot model the case, or there is no script of this method; 2 bad input.

    Parameters
    ----------
    case
        The name of a shipped case, the path of a case file, or the file of a robot (URDF or MJCF).
    engine
        The engine.
    integrator
        The method, or default or recommended. If none is named: the first one that the engine offers for the case.
    out
        The file for the script. Default: standard output.
    """
    from bodycheck.adapters.registry import EngineMissing
    from bodycheck.console.robots import tell
    from bodycheck.files import writing
    from bodycheck.running import exporting
    from bodycheck.running.robot_notices import as_loaded

    arguments.check_engine(engine)
    arguments.check_writable("--out", out)
    loaded = arguments.load_case(case, robots)
    tell(as_loaded([loaded]))
    try:
        script = exporting.script(loaded, engine, integrator, timestep)
    except EngineMissing as error:
        raise BadInput(str(error)) from error
    if out is None:
        print(script, end="")
    else:
        writing.write_named(out, script.encode("utf-8"))
        print(out)
    return OK
