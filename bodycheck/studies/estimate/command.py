"""The command `bodycheck estimate`.

Its imports are inside the function, so that `--help` answers at once.
"""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from bodycheck.console.options import AS_USUAL, Engines, Figures, Integrators, Jobs, Json, Out, Quiet, View, Viewed
from bodycheck.errors import BadInput

if TYPE_CHECKING:
    from bodycheck.studies.estimate.interface import Wanted
    from bodycheck.studies.output import Output


def estimate(
    file: Annotated[
        str, Parameter(help="The file of a robot (URDF or MJCF), the name of a shipped case, or the path of a case file.")
    ] = "",
    /,
    *,
    engine: Engines = (),
    integrator: Integrators = (),
    duration: Annotated[
        float | None, Parameter(help="The duration of the runs in s. Default: that of the case, or 1 s for a file.")
    ] = None,
    keyframe: Annotated[str, Parameter(help="The keyframe in which the runs start. Default: the first of the file.")] = "",
    controls: Annotated[
        Path | None,
        Parameter(
            help="A CSV file with the column t (s) and a column for each actuator, held until the next row. Default: the "
            "controls of the keyframe, or zero."
        ),
    ] = None,
    quantity: Annotated[
        str, Parameter(help="The figure whose error is estimated, such as attitude_error. Default: all that the scene has.")
    ] = "",
    error: Annotated[
        float, Parameter(help="The error that is allowed, in rad or m, or relative for energy. Default: 0.001.")
    ] = 1e-3,
    blind: Annotated[bool, Parameter(negative="", help="Do not use the truth of a case.")] = False,
    package_path: Annotated[
        tuple[Path, ...],
        Parameter(help="A folder in which packages, meshes and included files are found. May be given several times."),
    ] = (),
    calibrate: Annotated[
        bool, Parameter(negative="", help="Measure how often intervals are right, on scenes that are drawn anew.")
    ] = False,
    members: Annotated[int | None, Parameter(help="For --calibrate: the number of scenes of each class.")] = None,
    seed: Annotated[int, Parameter(help="For --calibrate: the seed of the scenes. Default: 2.")] = 2,
    jobs: Jobs = None,
    out: Out = None,
    figures: Figures = (),
    json: Json = False,
    view: Viewed = AS_USUAL,
    quiet: Quiet = False,
) -> int:
    """Estimate how wrong an engine is on any scene, and find the cheapest method and time step for an error.

    The scene is run with the time step of the file and with coarser and finer ones. If the differences between the runs fall as
    they should, the error of each run from the engine's own limit as the time step goes to zero has an estimate and an
    interval; else the verdict says why not: not-asymptotic, chaotic beyond an instant, diverged, reset, or no-time. What the
    model itself is worth is not asked. The engine loads the file itself. The table is estimate.csv.

    Exit codes: 0 there are results; 1 an engine or method that was named has none, or nothing has; 2 bad input or usage.
    """
    from bodycheck.console import tables
    from bodycheck.console.arguments import check_has_folder, processes
    from bodycheck.studies.estimate import calibration, printing
    from bodycheck.studies.estimate.interface import Wanted
    from bodycheck.studies.output import Output

    check_has_folder(figures, out)
    tables.check(view, printing.ROWS)
    if calibrate:
        if file or blind or controls is not None or keyframe or quantity or duration is not None:
            raise BadInput("--calibrate: draws its own scenes; give no file and none of its options")
        return calibration.printed(engine, members, seed, processes(jobs), out, json=json, quiet=quiet)
    if not file:
        raise BadInput("estimate: give the file of a robot or a case, or --calibrate")
    wanted = Wanted(integrator, duration, keyframe, controls, quantity, error, blind, package_path)
    return _finished(file, wanted, engine, Output(out, figures, quiet), json, view)


def estimate_whole(
    file: str,
    error: float,
    quantity: str,
    engines: tuple[str, ...],
    integrators: tuple[str, ...],
    packages: tuple[Path, ...],
    output: "Output",
    json: bool,
    view: View,
) -> int:
    """Estimate the errors of the whole scene of a robot's file for `bodycheck recommend`, and return the exit code.

    The parameters are those of both commands. Raises `BadInput` as they do.
    """
    from bodycheck.console import tables
    from bodycheck.studies.estimate import printing
    from bodycheck.studies.estimate.interface import Wanted

    tables.check(view, printing.ROWS)
    wanted = Wanted(integrators, quantity=quantity, error=error, packages=packages)
    return _finished(file, wanted, engines, output, json, view)


def _finished(file: str, wanted: "Wanted", engine: tuple[str, ...], output: "Output", json: bool, view: View) -> int:
    """Make a study, print its results, and return the exit code."""
    from dataclasses import asdict

    from bodycheck.console import terminal
    from bodycheck.console.arguments import load_engines
    from bodycheck.console.output import end
    from bodycheck.studies.estimate import printing
    from bodycheck.studies.estimate.interface import carry_out

    engines = load_engines(engine, integrators=wanted.integrators)
    results = carry_out(file, wanted, engines, sys.argv, output)
    if json:
        terminal.print_json([asdict(row) for row in results.rows])
    elif not output.quiet:
        printing.print_estimates(results.estimates, view)
    return end(results.decision, output.folder, json=json, quiet=output.quiet)


#: The commands of the study.
COMMANDS = (estimate,)
