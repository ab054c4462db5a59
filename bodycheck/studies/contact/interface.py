"""`bodycheck.contact`: how bodies roll, bounce, rest and tip in engines."""

from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

from bodycheck.casefile.content import Case
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
from bodycheck.studies.contact.rows import SHEET, ContactRow
from bodycheck.studies.output import Output


@dataclass(frozen=True, eq=False, repr=False)
class ContactResults(StudyResults):
    """The figures of touching bodies at the defaults of engines, and at the best settings.

    Attributes
    ----------
    rows
        A row for each engine, scene, setting and figure.
    decision
        Whether everything that was named has a result, and what has none.
    """

    rows: Sequence[ContactRow]
    decision: Decision

    @property
    def tables(self) -> dict[str, Table]:
        """The table `contact`. A value has the unit in its row."""
        return {SHEET.name: Table.of(SHEET, self.rows)}


def carry_out(running: AbstractContextManager[Ran], compared: Compared, output: Output) -> ContactResults:
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
        rows = study.evaluate(runs.results, runs.engines, verdicts)
        header = runs.results.header
        report = present(header, runs.results.cases, rows, study.reasons(runs.results, runs.engines))
        output.write(report, ((SHEET, rows),), [origin.stored(header)])
        return ContactResults(report, rows, runs.decided(study.measurements(verdicts)))


def contact(
    engines: Names = (),
    *,
    case: Cases = (),
    integrator: Names = (),
    timestep: Numbers = (),
    out: str | Path | None = None,
    jobs: int | None = None,
) -> ContactResults:
    """Show how bodies roll, bounce, rest and tip in engines, as the command `bodycheck contact` does.

    Parameters
    ----------
    engines
        Names of engines, each `NAME` or `NAME@VERSION`. By default, all installed engines.
    case
        The same as the parameter `cases` of `bodycheck.run`. By default, the shipped cases of contact.
    integrator
        Methods to try besides those that the engines offer.
    timestep
        Time steps (s). By default, the time step of each engine and a quarter of it.
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
    return carry_out(
        ran_of(given, selection, study.plan, folder, command, quiet=True, meet=compared.meet), compared, Output(folder)
    )
