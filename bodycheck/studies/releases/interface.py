"""`bodycheck.releases`: what changed from release to release of an engine."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from bodycheck import conversion, reports
from bodycheck.console.arguments import check_engine, make_folder
from bodycheck.console.progress import progress
from bodycheck.interface import arguments
from bodycheck.interface.arguments import Cases, Names, Numbers
from bodycheck.interface.results import StudyResults, Table
from bodycheck.studies.releases import rows as release_rows
from bodycheck.studies.releases import study
from bodycheck.studies.releases.page import present
from bodycheck.studies.releases.rows import CHANGES, RELEASES, Change


@dataclass(frozen=True, eq=False, repr=False)
class ReleasesResults(StudyResults):
    """The results of releases of an engine, and the changes between them.

    Attributes
    ----------
    measured
        The rows of all versions, methods and cases, the changes from version to version, and their header.
    versions
        The versions, ascending.
    notices
        Sentences on what limits the study.
    """

    measured: release_rows.Found
    versions: Sequence[str]
    notices: Sequence[str]

    @property
    def rows(self) -> Sequence[Mapping[str, Any]]:
        """The rows of all versions, methods and cases."""
        return self.measured.rows

    @property
    def changes(self) -> Sequence[Change]:
        """The changes from version to version."""
        return self.measured.changes

    @property
    def tables(self) -> dict[str, Table]:
        """The tables `releases` and `changes`."""
        return {RELEASES.name: Table.of(RELEASES, self.rows), CHANGES.name: Table.of(CHANGES, self.changes)}


def releases(
    engine: str,
    versions: Names = (),
    *,
    case: Cases = (),
    integrator: Names = (),
    timestep: Numbers = (),
    last: int | None = None,
    again: bool = False,
    package_path: str | Path | Iterable[str | Path] = (),
    ignore: Names = (),
    out: str | Path | None = None,
    jobs: int | None = None,
) -> ReleasesResults:
    """Run the same cases in several releases of an engine, and find what changed, as the command `bodycheck releases` does.

    Parameters
    ----------
    engine
        The name of the engine.
    versions
        The releases to compare, for example `["3.2.7", "3.3.0"]`. Each is installed into an environment of its own.
    case
        The same as the parameter `cases` of `bodycheck.run`.
    integrator, timestep, jobs
        The same as the parameters of `bodycheck.run`.
    last
        The number of newest releases to compare, in addition to the named ones.
    again
        Whether everything is measured anew, and what is kept of earlier measurements is replaced.
    package_path, ignore
        The same as the parameters of `bodycheck.run`.
    out
        A folder for the tables and the report.

    Raises
    ------
    BadInput, Failed
        In the same cases as by `bodycheck.run`, and `BadInput` for a text that is no version.
    """
    check_engine(name := conversion.name("ENGINE", engine))
    each = arguments.listed(case)
    spellings, timesteps = arguments.names("--integrator", integrator), arguments.numbers("--timestep", timestep)
    newest = None if last is None else conversion.whole_number("--last", last)
    processes, folder = arguments.jobs_of(jobs), arguments.path("--out", out)
    make_folder("--out", folder)
    chosen, notices = study.chosen(name, arguments.names("VERSION", versions), newest)
    cases = arguments.given_cases(each, arguments.robots(package_path, ignore)).cases
    bar = partial(progress, quiet=True)
    measured, _ = study.study(name, chosen, cases, spellings, timesteps, processes, bar, notices, again)
    report = present({"": measured})
    if folder is not None:
        release_rows.write(measured, folder)
        reports.write_study(report, folder)
    return ReleasesResults(report, measured, chosen, notices)
