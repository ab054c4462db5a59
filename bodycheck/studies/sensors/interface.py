"""`bodycheck.sensors`: what the sensors of engines read."""

from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from pathlib import Path

from bodycheck.adapters.method import checked_name
from bodycheck.casefile.content import Case
from bodycheck.console.ran import Ran, Selection, ran_of
from bodycheck.errors import BadInput
from bodycheck.interface import arguments
from bodycheck.interface.arguments import Cases, Names, Numbers
from bodycheck.interface.results import StudyResults, Table
from bodycheck.judging import judgement
from bodycheck.judging.judgement import Compared
from bodycheck.judging.sensors import measurement
from bodycheck.judging.sensors.rows import SENSORS, SensorRow
from bodycheck.results import origin
from bodycheck.running import campaign
from bodycheck.running.named import Decision
from bodycheck.studies.output import Output
from bodycheck.studies.sensors import recorded, study
from bodycheck.studies.sensors.page import present


@dataclass(frozen=True, eq=False, repr=False)
class SensorResults(StudyResults):
    """What the sensors of engines read.

    Attributes
    ----------
    rows
        A row for each engine, method, scene and sensor.
    decision
        Whether everything that was named has a result, and what has none.
    """

    rows: Sequence[SensorRow]
    decision: Decision = field(default_factory=Decision)

    @property
    def tables(self) -> dict[str, Table]:
        """The table `sensors`. An error has the unit of its sensor."""
        return {SENSORS.name: Table.of(SENSORS, self.rows)}


def carry_out(running: AbstractContextManager[Ran], compared: Compared, output: Output) -> SensorResults:
    """Evaluate the runs that a context makes, and write the table and the report.

    Parameters
    ----------
    running
        The context that makes the runs.
    compared
        The figures of the runs that were compared when they were made.
    output
        The folder of the results.
    """
    with running as runs:
        verdicts = judgement.judge(runs.results, compared=compared)
        rows = measurement.measure(runs.results, verdicts)
        header = runs.results.header
        report = present(header, rows)
        output.write(report, ((SENSORS, rows),), [origin.stored(header)])
        return SensorResults(report, rows, runs.decided(study.measurements(verdicts)))


def of_readings(
    file: Path, case: Case, engine: str, version: str, timestep: float | None, command: Sequence[str], output: Output
) -> tuple[SensorResults, tuple[str, ...]]:
    """Evaluate readings in a CSV file, write the table and the report, and return the results and notes about the file.

    Parameters
    ----------
    file, case, engine, version, timestep
        As those of `recorded.rows`.
    command
        The words of the command, for the header of the results.
    output
        The folder of the results.

    Raises
    ------
    BadInput
        As `recorded.rows` does.
    """
    rows, notes = recorded.rows(file, case, engine, version, timestep)
    versions = {"engines": {engine: version}, "precisions": {engine: "float64"}}
    header = campaign.header(command, {}, {}) | versions
    report = present(header, rows)
    output.write(report, ((SENSORS, rows),), [origin.origin(header, {case.name: case.text})])
    return SensorResults(report, rows), notes


def sensors(
    engines: Names = (),
    *,
    case: Cases = (),
    integrator: Names = (),
    timestep: Numbers = (),
    readings: str | Path | None = None,
    name: str = "",
    version: str = "unknown",
    out: str | Path | None = None,
    jobs: int | None = None,
) -> SensorResults:
    """Show what the sensors of engines read, as the command `bodycheck sensors` does.

    Parameters
    ----------
    engines
        Names of engines, each `NAME` or `NAME@VERSION`. By default, all installed engines.
    case
        The same as the parameter `cases` of `bodycheck.run`. By default, the shipped cases with sensors.
    integrator
        Methods. By default, the default method of each engine.
    timestep
        Time steps (s). By default, that of each method; with `readings`, at most one, from which their age is identified.
    readings
        A CSV file with readings of the sensors of one case.
    name, version
        The name of what gave the readings, and its version.
    out
        A folder for the table, the recorded runs and the report. An interrupted study in it is resumed.
    jobs
        The same as the parameter of `bodycheck.run`.

    Raises
    ------
    BadInput, Failed
        In the same cases as by `bodycheck.run`, and `BadInput` for a file of readings with a fault.
    """
    each, folder = arguments.listed(case), arguments.path("--out", out)
    selection = Selection(
        cases=(),
        engines=(named := arguments.names("ENGINE", engines)),
        integrators=(spellings := arguments.names("--integrator", integrator)),
        timesteps=(timesteps := arguments.numbers("--timestep", timestep)),
        jobs=arguments.jobs_of(jobs),
    )
    cases = [one.name if isinstance(one, Case) else str(one) for one in each]
    file = arguments.path("--readings", readings)
    options = {"readings": None if file is None else str(file), "name": name}
    command = arguments.command("sensors", named, case=cases, integrator=spellings, timestep=timesteps, **options)
    given = arguments.given_cases(each or study.scenes())
    if file is None:
        compared = Compared()
        return carry_out(
            ran_of(given, selection, study.plan, folder, command, quiet=True, meet=compared.meet), compared, Output(folder)
        )
    known = checked_readings(each, named, spellings, timesteps, name, version)
    (one,) = given.cases
    return of_readings(file, one, *known, command, Output(folder))[0]


def checked_readings(
    cases: Sequence[object],
    engines: Sequence[str],
    integrators: Sequence[str],
    timesteps: Sequence[float],
    name: str,
    version: str,
) -> tuple[str, str, float | None]:
    """Return the name and version of what gave readings, and its time step (s); None if it is not known.

    Raises `BadInput` if other things are named beside the readings, or what they need is not named.
    """
    if len(cases) != 1 or not name or engines or integrators or len(timesteps) > 1:
        raise BadInput("--readings needs one --case and --name, at most one --timestep, and no engine or --integrator")
    for timestep in timesteps:
        if not 0 < timestep < float("inf"):
            raise BadInput(f"--timestep: read {timestep!r}; allowed: a positive number of seconds")
    return checked_name(name, "engine"), checked_name(version, "engine's version"), next(iter(timesteps), None)
