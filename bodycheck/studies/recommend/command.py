"""The command `bodycheck recommend`.

Its imports are inside the function, so that `--help` answers at once.
"""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from bodycheck.casefile.robot_notes import Ignored
from bodycheck.console.arguments import AS_THEY_ARE
from bodycheck.console.options import AS_USUAL, Engines, Figures, Integrators, Jobs, Json, OfRobots, Out, Quiet, Viewed
from bodycheck.errors import BadInput

if TYPE_CHECKING:
    from bodycheck.studies.recommend.rows import Recommendation


def recommend(
    case: str,
    /,
    *,
    error: float,
    quantity: str = "attitude",
    engine: Engines = (),
    integrator: Integrators = (),
    robots: OfRobots = AS_THEY_ARE,
    without: Annotated[
        tuple[Ignored, ...],
        Parameter(
            help="A part that is left out of a robot's file, so that the rest has a truth, as --ignore does. Without this, the "
            "whole scene is run as the engine loads it, and its error is an estimate. May be given several times."
        ),
    ] = (),
    reuse: Annotated[
        Path | None,
        Parameter(help="A folder with results of `tradeoff` or `run`; steps that were measured there are not measured again."),
    ] = None,
    out: Out = None,
    figures: Figures = (),
    jobs: Jobs = None,
    json: Json = False,
    view: Viewed = AS_USUAL,
    quiet: Quiet = False,
) -> int:
    """Find the method that keeps an error at the lowest cost, and the largest time step with which it does.

    The time step of every method is searched: the largest one such that every smaller measured one keeps the error too, within
    10 %, from a tenth of the duration down to 100,000 steps. All is measured, nothing is extrapolated. The tables are
    recommend.csv and steps.csv. An interrupted search resumes when it is run again with the same --out.

    The whole of a robot's file has no truth: its errors are estimated as by `bodycheck estimate`, and the first line says so.

    Exit codes: 0 a method was found; 1 no method keeps the error, an engine failed, or a named engine or method has no result;
    2 bad input or usage.

    Parameters
    ----------
    case
        The name of a shipped case, the path of a case file, or the file of a robot (URDF or MJCF).
    error
        The largest allowed error over the duration of the case, in the unit of the figure: rad for the attitude, m for the
        position, relative for energy and angular momentum.
    quantity
        The figure whose error is limited: attitude, position, energy, angular_momentum, or the name of a figure in the tables
        of results. Default: attitude.
    """
    from dataclasses import asdict, replace

    from bodycheck.casefile.robots.loading import is_robot
    from bodycheck.console import tables
    from bodycheck.console.arguments import check_has_folder, load_case, load_engines, processes
    from bodycheck.console.output import end
    from bodycheck.running.named import of_search
    from bodycheck.studies.estimate.command import estimate_whole
    from bodycheck.studies.output import Output
    from bodycheck.studies.recommend import printing, study
    from bodycheck.studies.recommend.interface import carry_out

    check_has_folder(figures, out)
    kept = replace(robots, ignore=tuple(dict.fromkeys((*robots.ignore, *without))))
    if is_robot(case) and not kept.ignore:
        if reuse is not None:
            raise BadInput("--reuse: is for cases and for robots' files with --without, whose errors are measured from a truth")
        output = Output(out, figures, quiet)
        return estimate_whole(case, error, quantity, engine, integrator, robots.package_path, output, json, view)
    tables.check(view, printing.ANSWERS)
    loaded = load_case(case, kept)
    engines = load_engines(engine, integrators=integrator)
    planned = study.prepare(loaded, engines.records, integrator, quantity, error)
    recommendation = carry_out(planned, engines, sys.argv, processes(jobs), Output(out, figures, quiet), reuse).found
    _tell(recommendation, json, view, quiet)
    decision = engines.decided(
        of_search(map(asdict, recommendation.probes), integrator), [loaded], failed=not recommendation.reached
    )
    return end(decision, out, json=json, quiet=quiet)


def _tell(recommendation: "Recommendation", json: bool, view: Viewed, quiet: bool) -> None:
    """Print the answers, as JSON if asked. If the command is quiet, print only that no method keeps the error, if so."""
    from dataclasses import asdict

    from bodycheck.console.output import tell
    from bodycheck.console.terminal import print_json
    from bodycheck.studies.recommend import printing, wording

    if json:
        print_json([asdict(answer) for answer in recommendation.answers])
    elif not quiet:
        printing.print_recommendation(recommendation, view)
    elif not recommendation.reached:
        tell(wording.headline(recommendation))


#: The commands of the study.
COMMANDS = (recommend,)
