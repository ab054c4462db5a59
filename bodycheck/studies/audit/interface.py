"""`bodycheck.audit`: what engines do that mechanics does not have."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from bodycheck import conversion
from bodycheck.console.arguments import Engines, load_engines
from bodycheck.interface import arguments
from bodycheck.interface.arguments import Names
from bodycheck.interface.results import StudyResults, Table
from bodycheck.results import origin
from bodycheck.running import campaign
from bodycheck.studies.audit import study
from bodycheck.studies.audit.page import present
from bodycheck.studies.audit.rows import CLASSES, ROWS, Classes, Facts, Fault, Row
from bodycheck.studies.output import Output


@dataclass(frozen=True, eq=False, repr=False)
class AuditResults(StudyResults):
    """The properties of methods that mechanics does not have, and the methods that are one algorithm.

    Attributes
    ----------
    rows
        A row for each property of each method.
    classes
        The classes of methods that are the same algorithm.
    faults
        The probes that gave no answer.
    facts
        The precision and the settings of each engine, by its name.
    """

    rows: Sequence[Row]
    classes: Classes
    faults: Sequence[Fault]
    facts: dict[str, Facts]

    @property
    def tables(self) -> dict[str, Table]:
        """The table `audit` with the properties, and the table `classes`."""
        return {ROWS.name: Table.of(ROWS, self.rows), CLASSES.name: Table.of(CLASSES, self.classes.rows)}


def carry_out(planned: study.Plan, engines: Engines, command: Sequence[str], jobs: int, output: Output) -> AuditResults:
    """Audit methods, and write the tables and the report. For the parameters see `recommend.interface.carry_out`."""
    engines.check_planned([planned.flip], [(one.engine, one.method) for one in planned.methods])
    head = campaign.header(command, engines.records, engines.missing)
    facts = study.facts(engines.records)
    with (
        output.work("auditing", planned.size) as (folder, progress),
        study.results(planned, folder, head, jobs, progress) as results,
    ):
        report = present(head, facts, results.rows, results.faults, results.classes)
        origins = [origin.origin(head, {planned.flip.name: planned.flip.text})]
        output.write(report, ((ROWS, results.rows), (CLASSES, results.classes.rows)), origins)
    return AuditResults(report, results.rows, results.classes, results.faults, facts)


def audit(
    engines: Names = (),
    *,
    integrator: Names = (),
    timestep: float | None = None,
    long: bool = False,
    out: str | Path | None = None,
    jobs: int | None = None,
) -> AuditResults:
    """Find by short flights what engines do that mechanics does not have, as the command `bodycheck audit` does.

    Parameters
    ----------
    engines
        Names of engines, each `NAME` or `NAME@VERSION`. By default, all installed engines.
    integrator, jobs
        The same as the parameters of `bodycheck.run`.
    timestep
        The time step (s). By default, the one that belongs to each method: 2 ms, the usual largest step of a method with error
        control, or the time step of an alias.
    long
        Whether the default method of each engine also takes ten million steps, or as many as it takes in three minutes.
    out
        A folder for the tables and the report. An interrupted audit in it is resumed.

    Raises
    ------
    BadInput, Failed
        In the same cases as by `bodycheck.run`.
    """
    named, spellings = arguments.names("ENGINE", engines), arguments.names("--integrator", integrator)
    step = None if timestep is None else conversion.number("--timestep", timestep)
    processes, folder = arguments.jobs_of(jobs), arguments.path("--out", out)
    loaded = load_engines(named, integrators=spellings)
    planned = study.prepare(loaded.records, spellings, step, long=long)
    command = arguments.command("audit", named, integrator=spellings, timestep=step, long=long)
    return carry_out(planned, loaded, command, processes, Output(folder))
