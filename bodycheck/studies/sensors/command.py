"""The command `bodycheck sensors`.

Its imports are inside the function, so that `--help` answers at once.
"""

import sys
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from bodycheck.console.options import AS_USUAL, Integrators, Jobs, Json, Out, Quiet, Timesteps, Viewed
from bodycheck.errors import OK, BadInput


def sensors(
    *engines: Annotated[str, Parameter(help="Engines. Default: all that are installed.")],
    case: Annotated[
        tuple[str, ...], Parameter(help="A case. May be given several times. Default: the shipped cases with sensors.")
    ] = (),
    integrator: Annotated[
        Integrators, Parameter(help="A method. May be given several times. Default: the default method of each engine.")
    ] = (),
    timestep: Timesteps = (),
    readings: Path | None = None,
    name: str = "",
    version: str = "unknown",
    out: Out = None,
    jobs: Jobs = None,
    json: Json = False,
    view: Viewed = AS_USUAL,
    quiet: Quiet = False,
) -> int:
    """Show what the sensors of an engine read: their error, sign, frame, age, and the source of their accelerations.

    Each scene with sensors is run with the default method of each engine that reads sensors. Sensors are read after each step,
    and in further runs after the engine's own function that computes its present state again. Errors are those from the truth.
    The sign, the frame, the age and the source are found by comparing the readings after the first steps with what the sensor
    should read at the engine's own states. The table is sensors.csv, with a row for each sensor of each scene.

    With --readings, the readings are those of a CSV file, which may come from any engine or robot. Its column t has the
    instants in s, and the columns of a sensor are SENSOR.x SENSOR.y SENSOR.z, of a wrench SENSOR.fx SENSOR.fy SENSOR.fz
    SENSOR.tx SENSOR.ty SENSOR.tz, and of a joint_effort sensor SENSOR. The age of the readings needs --timestep.

    Parameters
    ----------
    readings
        A CSV file with readings of the sensors of one case.
    name
        The name of what gave the readings, such as isaac.
    version
        Its version.
    """
    from dataclasses import asdict

    from bodycheck.console import arguments, tables, terminal
    from bodycheck.console.output import end
    from bodycheck.console.ran import Selection, ran
    from bodycheck.judging.judgement import Compared
    from bodycheck.runner_log import escaped
    from bodycheck.studies.output import Output
    from bodycheck.studies.sensors import printing, study
    from bodycheck.studies.sensors.interface import carry_out, checked_readings, of_readings

    if readings is not None:
        tables.check(view, printing.ROWS)
        known = checked_readings(case, engines, integrator, timestep, name, version)
        results, notes = of_readings(readings, arguments.load_case(case[0]), *known, sys.argv, Output(out))
        for note in notes:
            print(escaped(note), file=sys.stderr)
        if json:
            terminal.print_json([asdict(row) for row in results.rows])
        elif not quiet:
            printing.print_rows(results.rows, view)
        return OK
    if name or version != "unknown":
        raise BadInput("--name and --version are for --readings")
    tables.check(view, printing.LINES)
    selection = Selection(case or study.scenes(), engines, integrator, timestep, jobs)
    compared = Compared()
    results = carry_out(ran(selection, study.plan, out, quiet, compared.meet), compared, Output(out))
    if json:
        terminal.print_json([asdict(row) for row in results.rows])
    elif not quiet:
        printing.print_sheet(results.rows, view)
    return end(results.decision, out, json=json, quiet=quiet)


#: The commands of the study.
COMMANDS = (sensors,)
