"""`bodycheck.contact`: how bodies roll, bounce, rest and tip in engines."""

from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

from bodycheck.casefile.content import Case
from bodycheck.console.arguments import processes
from bodycheck.console.ran import Ran, Selection, ran_of
from bodycheck.interface import arguments
from bodycheck.interface.arguments import Cases, Names, Numbers
from bodycheck.interface.results import StudyResults, Table
from bodycheck.judging import judgement
from bodycheck.judging.judgement import Compared
from bodycheck.results import origin
from bodycheck.running.named import Decision
from bodycheck.studies.contact import sheet, study
from bodycheck.studies.contact.page import present
from bodycheck.studies.contact.rows import MEASURED, SETTINGS, SHEET, ContactRow, PropertyRow, SettingRow
from bodycheck.studies.output import Output


@dataclass(frozen=True, eq=False, repr=False)
class ContactResults(StudyResults):
    """The figures of touching bodies at the defaults of engines, with recommended methods and at the best settings found.

    Attributes
    ----------
    rows
        A row for each engine, scene, setting and figure.
    settings
        A row for each engine, group of scenes and setting: its method, and its errors relative to the defaults.
    properties
        A row for each engine, setting and property that a probe measured.
    decision
        Whether everything that was named has a result, and what has none.
    """

    rows: Sequence[ContactRow]
    settings: Sequence[SettingRow]
    properties: Sequence[PropertyRow]
    decision: Decision

    @property
    def tables(self) -> dict[str, Table]:
        """The tables `contact`, `contact_settings` and `contact_properties`. A value has the unit in its row."""
        rows = ((SHEET, self.rows), (SETTINGS, self.settings), (MEASURED, self.properties))
        return {table.name: Table.of(table, of_table) for table, of_table in rows}


def carry_out(running: AbstractContextManager[Ran], selection: Selection, compared: Compared, output: Output) -> ContactResults:
    """Search for the best settings after the runs that a context makes, and write the tables and the report.

    Parameters
    ----------
    running
        The context that makes the runs.
    selection
        The selected methods, time steps and number of processes.
    compared
        The figures of the runs that were compared when they were made.
    output
        The folder of the results.
    """
    named = (tuple(selection.integrators), tuple(selection.timesteps))
    with running as runs:
        verdicts, jobs = judgement.judge(runs.results, compared=compared), processes(selection.jobs)
        with study.evaluated(runs.results, runs.engines, verdicts, named, jobs, output.quiet) as sheet:
            header = runs.results.header
            report = present(header, runs.results.cases, sheet, study.reasons(runs.results, runs.engines))
            tables = ((SHEET, sheet.figures), (SETTINGS, sheet.settings), (MEASURED, sheet.properties))
            output.write(report, tables, [origin.stored(header)])
        decision = runs.decided(study.measurements(verdicts))
        return ContactResults(report, sheet.figures, sheet.settings, sheet.properties, decision)


def contact(
    engines: Names = (),
    *,
    case: Cases = (),
    integrator: Names = (),
    timestep: Numbers = (),
    out: str | Path | None = None,
    jobs: int | None = None,
) -> ContactResults:
    """Show how bodies roll, bounce, rest and tip in engines, and with which settings best, as `bodycheck contact` does.

    Parameters
    ----------
    engines
        Names of engines, each `NAME` or `NAME@VERSION`. By default, all installed engines.
    case
        The same as the parameter `cases` of `bodycheck.run`. By default, the shipped cases of contact.
    integrator
        Methods at which the search also begins, besides the default and the recommended method of each engine.
    timestep
        Time steps (s) at which the search also begins, besides those of each engine.
    out
        A folder for the table, the recorded runs and the report. An interrupted study in it is resumed.
    jobs
        The same as the parameter of `bodycheck.run`.

    Raises
    ------
    BadInput, Failed
        In the same cases as by `bodycheck.run`.
    """
    each = arguments.listed(case)
    selection = Selection(
        cases=(),
        engines=(named := arguments.names("ENGINE", engines)),
        integrators=(spellings := arguments.names("--integrator", integrator)),
        timesteps=(timesteps := arguments.numbers("--timestep", timestep)),
        jobs=arguments.jobs_of(jobs),
    )
    names = [one.name if isinstance(one, Case) else str(one) for one in each]
    command = arguments.command("contact", named, case=names, integrator=spellings, timestep=timesteps)
    folder, compared = arguments.path("--out", out), Compared()
    given = arguments.given_cases(each or sheet.scenes())
    running = ran_of(given, selection, study.plan, folder, command, quiet=True, meet=compared.meet)
    return carry_out(running, selection, compared, Output(folder))
