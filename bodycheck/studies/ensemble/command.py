"""The command `bodycheck ensemble`.

Its imports are inside the functions, so that `--help` answers at once.
"""

import sys
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from bodycheck.console.options import AS_USUAL, Engines, Figures, Integrators, Jobs, Json, Out, Quiet, Timesteps, View, Viewed
from bodycheck.console.output import end, tell
from bodycheck.errors import FAILED, OK, BadInput

if TYPE_CHECKING:
    from bodycheck.casefile.case import Case
    from bodycheck.console.arguments import Engines as Loaded
    from bodycheck.reports.plot_files import Format
    from bodycheck.running.members.executors import Executor
    from bodycheck.studies.ensemble.drawing.members import Source
    from bodycheck.studies.ensemble.report.reporting import Made

OneCase = Annotated[str, Parameter(help="The case: the name of a shipped case, or a case file. It has a table [ensemble].")]

From = Annotated[
    Path | None,
    Parameter(
        name="--from",
        help="A table (.parquet or .csv) with a row for each member, in place of [ensemble] in the case. Its columns are paths "
        "of keys, such as body.mass or initial.velocity.0.",
    ),
]

Members = Annotated[int | None, Parameter(help="The number of members. Default: that of the case, or all of the table.")]

Member = Annotated[
    int | None, Parameter(help="Write one member, counted from 0, as a case file, and run nothing. Needs --write.")
]

Write = Annotated[Path | None, Parameter(help="The case file (.case.toml) to write the member of --member to.")]

Dask = Annotated[
    str | None,
    Parameter(
        help="Run on a cluster of Dask: the address of its scheduler, or the word local for worker processes on this machine. "
        "Needs --out, a folder that all workers share."
    ),
]

ShardOf = Annotated[
    str | None,
    Parameter(help="I/N: run only share I of N, for array jobs of a queue. Needs --out; `bodycheck gather` joins the shares."),
]


def ensemble(
    case: OneCase,
    /,
    *,
    members: Members = None,
    engine: Engines = (),
    integrator: Integrators = (),
    timestep: Timesteps = (),
    from_: From = None,
    member: Member = None,
    write: Write = None,
    dask: Dask = None,
    shard: ShardOf = None,
    out: Out = None,
    figures: Figures = (),
    jobs: Jobs = None,
    json: Json = False,
    view: Viewed = AS_USUAL,
    quiet: Quiet = False,
) -> int:
    """Run many members drawn from one case, and report how often methods fail and how their errors are distributed.

    The table [ensemble] of the case says what is drawn. The report has the probability of failure and the quantiles of errors
    with their intervals, the ranking of the methods, and the numbers that errors depend on. The worst members are written as
    case files that run by themselves. The tables are ensemble.csv and sensitivity.csv, and `bodycheck query` answers questions
    about single runs. An interrupted ensemble resumes when it is run again with the same --out.

    Exit codes: 0 success; 1 a member breaks an expectation of the case, or a
    named engine or method has no result; 2 bad input or usage. A member that diverges, crashes
    or runs into the time limit is a result, unless the case expects something
    of its method.
    """
    from bodycheck.console import tables
    from bodycheck.console.arguments import check_has_folder, load_case, load_engines, processes
    from bodycheck.studies.ensemble import printing
    from bodycheck.studies.ensemble.drawing import members as drawing

    check_has_folder(figures, out)
    _check(member, write, out, dask, shard)
    tables.check(view, printing.ROWS, printing.DEPENDENCES)
    loaded = load_case(case)
    source = drawing.drawn(loaded, members) if from_ is None else drawing.tabled(loaded, from_, members)
    if member is not None and write is not None:
        return _write_member(loaded, source, member, write)
    drawing.check(loaded, source)
    engines = load_engines(engine, integrators=integrator)
    shown = _Shown(out, figures, json, view, quiet)
    executor = _executor(dask, shard, processes(jobs))
    results = _carry_out(loaded, source, engines, (integrator, timestep), executor, shown)
    if results is None:
        return FAILED if engines.failed([loaded]) else OK
    return end(engines.decided(results.outcomes, [loaded], bool(results.broken)), out, json=json, quiet=quiet)


@dataclass(frozen=True)
class _Shown:
    """The options of the command for output, under their names."""

    out: Path | None
    figures: "tuple[Format, ...]"
    json: bool
    view: View
    quiet: bool


def _check(member: int | None, write: Path | None, out: Path | None, dask: str | None, shard: str | None) -> None:
    """Raise `BadInput` for options that need others or exclude each other. This is checked before a long run."""
    from bodycheck.console.arguments import check_writable

    if (member is None) != (write is None):
        raise BadInput("--member and --write: give both, the number of a member and the file to write it to")
    check_writable("--write", write)
    if dask is not None and shard is not None:
        raise BadInput("--dask and --shard: give only one of them")
    for option, value in (("--dask", dask), ("--shard", shard)):
        if value is not None and out is None:
            raise BadInput(f"{option} {value}: needs --out, the folder for the results")


def _write_member(case: "Case", source: "Source", member: int, path: Path) -> int:
    """Write one member as a case file."""
    from bodycheck.files import writing
    from bodycheck.studies.ensemble.drawing import members

    writing.write_named(path, members.text(case, source, member).encode("utf-8"))
    return OK


def _executor(dask: str | None, shard: str | None, jobs: int) -> "Executor":
    """Return the executor of the chunks. Raises `BadInput` for an invalid share."""
    from bodycheck.running.members.executors.dask_cluster import Cluster
    from bodycheck.running.members.executors.own import Own, Shard

    if dask is not None:
        return Cluster(dask, jobs)
    return Own(jobs) if shard is None else Shard.parse(shard, jobs)


def _carry_out(
    case: "Case",
    source: "Source",
    engines: "Loaded",
    methods: tuple[tuple[str, ...], tuple[float, ...]],
    executor: "Executor",
    shown: _Shown,
) -> "Made | None":
    """Run an ensemble, write its report, and print its tables. Return its analysis; None if only a share of it was run."""
    from functools import partial

    from bodycheck.console import terminal
    from bodycheck.files.temporary import temporary_folder
    from bodycheck.running.named import check_planned
    from bodycheck.studies.ensemble import header, printing, study
    from bodycheck.studies.ensemble.drawing import members
    from bodycheck.studies.ensemble.report import publishing, reporting

    shares = study.planned(case, engines.records, *methods)
    check_planned(engines.named, engines.records, ((share.engine, method) for share in shares for method in share.methods))
    with ExitStack() as stack:
        folder = shown.out or stack.enter_context(temporary_folder())
        with terminal.progress("running", study.size(source, shares), shown.quiet) as progress:
            run = partial(study.run, command=sys.argv, missing=engines.missing)
            folder = run(case, source, engines.records, *methods, folder, executor, progress)
        if not executor.whole:
            if not shown.quiet:
                tell(f"This share is done. When all are, join them: bodycheck gather {folder} --out FOLDER")
            return None
        head = header.read(folder)
        results = reporting.read(folder, case, head)
        if shown.out is not None:
            text_of = partial(members.text, case, source)
            with terminal.progress("worst members", results.worst, shown.quiet) as progress:
                publishing.write(results, folder, case, head, text_of, study.executor_jobs(executor), progress, shown.figures)
    printing.print_made(results, shown.json, shown.view, shown.quiet)
    return results


#: The commands of the study.
COMMANDS = (ensemble,)
