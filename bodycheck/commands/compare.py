"""The command `bodycheck compare`.

Its imports are inside the function, so that `--help` answers at once.
"""

import os
import sys
from pathlib import Path

from bodycheck.console import arguments
from bodycheck.console.arguments import AS_THEY_ARE
from bodycheck.console.options import AS_USUAL, Figures, Json, JUnit, OfRobots, Out, Quiet, Viewed


def compare(
    log: Path,
    case: str,
    /,
    *,
    name: str,
    version: str = "unknown",
    robots: OfRobots = AS_THEY_ARE,
    out: Out = None,
    figures: Figures = (),
    save: Path | None = None,
    junit: JUnit = None,
    json: Json = False,
    view: Viewed = AS_USUAL,
    quiet: Quiet = False,
) -> int:
    """Compare a motion that somebody recorded with the exact motion of a case.

    The motion may come from any simulator, or from a real robot. The log is a CSV file. Its column t has the instants in s.
    For a case of one body, px py pz is the position of the centre of mass in m, qw qx qy qz the quaternion from body to world,
    and, if they are known, vx vy vz the velocity in m/s along the axes of the world, and wx wy wz the angular velocity in
    rad/s along the axes of the body. In a case with several bodies, each name begins with that of the body and a point, as in
    pole.px; instead, joints with one coordinate may have JOINT.position and JOINT.velocity.

    The result is a folder of results like that of `bodycheck run`, for `report`, `diff` and `submit`. Its integrator is called
    "recorded", and its time step is the mean distance of the instants.

    Exit codes: 0 the motion was compared, and all expectations for it hold; 1 an expectation failed, or there is no truth of
    the case; 2 bad input or usage.

    Parameters
    ----------
    log
        The CSV file.
    case
        The name of a shipped case, the path of a case file, or the file of a robot (URDF or MJCF).
    name
        The name of what recorded the motion, such as isaac.
    version
        Its version.
    save
        A file (.parquet) to save the results as a baseline for `bodycheck diff`. The effect of rounding on a recorded motion
        is not measured, since it cannot be repeated.
    """
    from bodycheck import reports
    from bodycheck.adapters.method import checked_name
    from bodycheck.commands.report import write
    from bodycheck.commands.run import print_summary_of
    from bodycheck.console import output, results, tables, terminal
    from bodycheck.console.robots import noticed
    from bodycheck.judging import judgement, result_set
    from bodycheck.judging.baselines import baseline
    from bodycheck.runner_log import escaped
    from bodycheck.running import logs
    from bodycheck.running.named import Named, decide

    for option, path in (("--save", save), ("--junit", junit)):
        arguments.check_writable(option, path)
    arguments.check_has_folder(figures, out)
    tables.check(view, results.RUNS)
    names = arguments.case_names((case,))
    loaded = arguments.load_case(case, robots)
    noticed([loaded], 1, quiet)
    recording = logs.read(log, loaded, checked_name(name, "engine"), checked_name(version, "engine's version"))
    for note in recording.notes:
        print(escaped(note), file=sys.stderr)
    files = arguments.files_of([loaded], names)
    with logs.results(recording.run, loaded, out, sys.argv, files) as stored:
        result = result_set.judged(stored)
        write([result], out, figures, junit)
        reports.annotate_github(result, files, os.environ)
        if save is not None:
            baseline.save(save, stored, result.verdicts, 1)
        if json:
            terminal.print_json(judgement.records(result.verdicts))
        elif quiet:
            results.print_failed(result.verdicts, stored.files)
        else:
            results.print_runs(result.verdicts, view)
            print_summary_of(result, out)
    decision = decide(Named(), (verdict.row() for verdict in result.verdicts), result.failed)
    return output.end(decision, out, json=json, quiet=quiet)
