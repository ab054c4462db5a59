"""The command `bodycheck parity`.

Its imports are inside the function, so that `--help` answers at once.
"""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from bodycheck.console.options import AS_USUAL, Engines, Jobs, Json, Out, Quiet, Viewed
from bodycheck.errors import BadInput

if TYPE_CHECKING:
    pass


def parity(
    *models: Annotated[
        Path, Parameter(help="Files of robots (URDF, MJCF, or cases of format 2), or folders or patterns of them.")
    ],
    engine: Engines = (),
    states: Annotated[int, Parameter(help="The number of states at which terms are compared. Default: 100.")] = 100,
    seed: Annotated[int, Parameter(help="The seed of the states. Default: 0.")] = 0,
    tolerance: Annotated[
        float, Parameter(help="The largest relative difference that counts as agreement. Default: 1e-9.")
    ] = 1e-9,
    package_path: Annotated[
        tuple[Path, ...], Parameter(help="A folder in which packages are found. May be given several times.")
    ] = (),
    motion: Annotated[
        float, Parameter(help="A time in s: also say how far each difference takes a free motion within it.")
    ] = 0.0,
    out: Out = None,
    junit: Annotated[Path | None, Parameter(help="A file (.xml) for the result of each model and engine as a test.")] = None,
    jobs: Jobs = None,
    json: Json = False,
    table: bool = False,
    view: Viewed = AS_USUAL,
    quiet: Quiet = False,
) -> int:
    """Compare what engines make of the file of a robot with what the file says, term by term, and name the causes.

    Each engine reads the file by its own reader. The truth is the file, read as its specification says, and bodycheck's own
    algorithms; of an MJCF it is what MuJoCo makes of it. Differences of masses, inertias and joints, of the mass matrix and of
    forces have a cause that was recomputed, or are called unexplained. The table is parity.csv.

    Each engine reads a copy of its own of a file. A folder stands for the URDF and MJCF files in it and below it. A file that
    is not there or is no robot's file has the status unreadable.

    Exit codes: 0 everything agrees; 1 something differs, is refused, crashes or cannot be read; 2 no file can be read, or an
    option is wrong.

    Parameters
    ----------
    table
        Print all rows. --columns, --sort and --wide do so too.
    """
    from dataclasses import asdict

    from bodycheck.console import tables, terminal
    from bodycheck.console.arguments import check_writable, load_engines, make_folder, processes
    from bodycheck.console.output import end
    from bodycheck.files import writing
    from bodycheck.studies.output import Output
    from bodycheck.studies.parity import files, printing, rows, study
    from bodycheck.studies.parity.interface import carry_out, check
    from bodycheck.studies.parity.page import as_junit

    if not models:
        raise BadInput("parity: give at least one file of a robot")
    asks = study.Asking(states, seed, tolerance, package_path, motion)
    check(asks)
    tables.check(view, printing.ROWS)
    check_writable("--junit", junit)
    make_folder("--out", out)
    loaded = load_engines(engine)
    given = files.named(models)
    results = carry_out(given.files, loaded, asks, sys.argv, processes(jobs), Output(out, quiet=quiet))
    if junit is not None:
        writing.write_named(junit, as_junit(results.models, results.header).encode("utf-8", "replace"))
    if json:
        terminal.print_json([asdict(row) for row in results.rows])
    elif not quiet:
        printing.print_models(results.models)
        if table or view != AS_USUAL:
            printing.print_rows(results.rows, view)
    printing.tell_unread(results.models, () if quiet else given.skipped)
    decision = loaded.decided(rows.comparisons(results.rows), failed=not results.agrees)
    return end(decision, out, json=json, quiet=quiet)


#: The commands of the study.
COMMANDS = (parity,)
