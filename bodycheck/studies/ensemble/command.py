"""The command `bodycheck ensemble`.

Its imports are inside the functions, so that `--help` answers at once.
"""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from bodycheck.console.arguments import AS_THEY_ARE
from bodycheck.console.options import (
    AS_USUAL,
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
from bodycheck.console.output import end, tell
from bodycheck.errors import FAILED, OK, BadInput

if TYPE_CHECKING:
    from bodycheck.casefile.case import Case
    from bodycheck.running.members.executors import Executor
    from bodycheck.studies.ensemble.drawing.members import Source

OneCase = Annotated[
    str,
    Parameter(
        help="The case: the name of a shipped case or a case file with a table [ensemble], or with --from also a robot's file."
    ),
]

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
    robots: OfRobots = AS_THEY_ARE,
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
    from bodycheck.console.robots import tell as tell_robots
    from bodycheck.running.robot_notices import as_loaded
    from bodycheck.studies.ensemble import printing
    from bodycheck.studies.ensemble.drawing import members as drawing
    from bodycheck.studies.ensemble.interface import carry_out
    from bodycheck.studies.output import Output

    check_has_folder(figures, out)
    _check(member, write, out, dask, shard)
    tables.check(view, printing.ROWS, printing.DEPENDENCES)
    loaded = load_case(case, robots)
    source = drawing.drawn(loaded, members) if from_ is None else drawing.tabled(loaded, from_, members)
    if member is not None and write is not None:
        return _write_member(loaded, source, member, write)
    drawing.check(loaded, source)
    if not quiet:
        tell_robots(as_loaded([loaded]))
    engines = load_engines(engine, integrators=integrator)
    output, executor = Output(out, figures, quiet), _executor(dask, shard, processes(jobs))
    results = carry_out(loaded, source, engines, (integrator, timestep), executor, sys.argv, output)
    if results is None:
        if not quiet:
            tell(f"This share is done. When all are, join them: bodycheck gather {out} --out FOLDER")
        return FAILED if engines.failed([loaded]) else OK
    printing.print_made(results.analysed, json, view, quiet)
    decision = engines.decided(results.analysed.outcomes, [loaded], not results.passed)
    return end(decision, out, json=json, quiet=quiet)


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


#: The commands of the study.
COMMANDS = (ensemble,)
