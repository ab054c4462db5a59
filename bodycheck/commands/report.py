"""The command `bodycheck report`.

It imports what it needs when it runs, so that `--help` answers at once.
"""

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from bodycheck.console import arguments
from bodycheck.console.options import Figures, JUnit
from bodycheck.errors import BAD_INPUT, FAILED, OK, BadInput

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bodycheck.judging.result_set import ResultSet


def report(*folders: Path, out: Path | None = None, figures: Figures = (), junit: JUnit = None) -> int:
    """Make reports again from saved results, without simulating anything: of runs or of a study, as `--out` has written them.

    Several folders of runs become one report, which says first what differs between them: those of two releases of an engine,
    of two machines, or before and after a change of a case; so do several of `bodycheck releases`. What is interrupted is
    reported as far as it went, with exit code 2.

    Parameters
    ----------
    folders
        Folders of results; what is in each is found from its files.
    out
        The folder for the report and its tables. By default that of the results, where one is given.
    """
    from bodycheck import reports
    from bodycheck.commands import saved
    from bodycheck.judging import result_set
    from bodycheck.reports.study import StudyReport
    from bodycheck.studies.releases import rows as release_rows

    arguments.check_writable("--junit", junit)
    into = arguments.folder_for(folders, out)
    if all((folder / release_rows.RECORDS).is_file() for folder in folders):
        return _report_releases(folders, into, figures, junit)
    found = [saved.read(folder) for folder in folders]
    arguments.make_folder("--out", into)
    if isinstance(found[0], StudyReport) and len(found) == 1:
        if junit is not None:
            raise BadInput(f"--junit {junit}: {folders[0]} holds a study, of which nothing is expected")
        reports.write_study(found[0], into, figures)
        print(f"report: {into / 'report.html'}", file=sys.stderr)
        return OK
    sets = []
    for folder, label, one in zip(folders, result_set.labels(folders), found, strict=True):
        if isinstance(one, StudyReport):
            raise BadInput(f"{folder}: holds a study; several folders are compared in one report where all are of runs")
        with saved.undamaged(folder):
            sets.append(result_set.judged(one, label))
    write(sets, into, figures, junit)
    if interrupted := [str(one.results.folder) for one in sets if not one.results.complete]:
        print(f"bodycheck: interrupted, and reported as far as it went: {', '.join(interrupted)}", file=sys.stderr)
        return BAD_INPUT
    return FAILED if any(verdict.passed is False for one in sets for verdict in one.verdicts) else OK


def _report_releases(folders: tuple[Path, ...], into: Path, figures: Figures, junit: Path | None) -> int:
    """One report of studies of releases, made on several machines for one."""
    from bodycheck import reports
    from bodycheck.studies.releases import rows as release_rows
    from bodycheck.studies.releases.page import present

    if junit is not None:
        raise BadInput(f"--junit {junit}: {folders[0]} holds a study, of which nothing is expected")
    found = [release_rows.read(folder) for folder in folders]
    arguments.make_folder("--out", into)
    reports.write_study(present(dict(zip(release_rows.labels(found), found, strict=True))), into, figures)
    print(f"report: {into / 'report.html'}", file=sys.stderr)
    return OK


def write(sets: "Sequence[ResultSet]", out: Path | None, figures: Figures, junit: Path | None) -> None:
    """Write the reports and tables of judged results: into the folder `out`, and as JUnit XML, each where it is asked for."""
    from bodycheck import reports
    from bodycheck.judging import result_set

    if out is not None:
        result_set.write(sets, out)
        reports.write(sets, out, figures)
        print(f"report: {out / 'report.html'}", file=sys.stderr)
    if junit is not None:
        reports.write_junit(sets, junit)
