"""Write the tables and the report of an ensemble, for which its worst members are run again."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from bodycheck import reports
from bodycheck.casefile.content import Case
from bodycheck.files.temporary import temporary_folder
from bodycheck.reports.study import Animation, StudyReport
from bodycheck.results import csv_tables, origin
from bodycheck.running.campaign import Advance
from bodycheck.running.members import compaction
from bodycheck.studies.ensemble.findings import stored
from bodycheck.studies.ensemble.header import WORST, EnsembleHeader
from bodycheck.studies.ensemble.report import page
from bodycheck.studies.ensemble.report.reporting import Made, keep_shown, material
from bodycheck.studies.ensemble.rows import DEPENDENCES, ROWS
from bodycheck.studies.ensemble.worst_members import playing, worst

if TYPE_CHECKING:
    from bodycheck.reports.plot_files import Format


def write(
    results: Made,
    folder: Path,
    case: Case,
    header: EnsembleHeader,
    text_of: Callable[[int], str] | None,
    jobs: int,
    progress: Advance,
    formats: "Sequence[Format]" = (),
) -> StudyReport:
    """Write ensemble.csv and sensitivity.csv, the worst members as case files, and the report, and return the report.

    Parameters
    ----------
    results
        The result of `reporting.read`.
    folder
        The folder of the runs.
    case, header
        The case, and the header of the results, which names the source of the members.
    text_of
        Function from the number of a member to its case file. If it is None, nothing is run: there are no files of worst
        members, and no animations.
    jobs
        The number of processes.
    progress
        A function that is called after each worst member.
    formats
        Formats in which every plot is also written as a separate file.

    Raises
    ------
    NotWritten
        A file cannot be written.
    """
    analysis, origins = results.analysis, [origin.origin(header, {case.name: case.text})]
    csv_tables.write(folder, ROWS, analysis.aggregates.rows(), origins)
    csv_tables.write(folder, DEPENDENCES, analysis.dependence_rows(), origins)
    files, animations = ((), ()) if text_of is None else _run_worst(results, folder, case, header, text_of, jobs, progress)
    keep_shown(folder, files, animations)
    report = page.present(material(case, header, analysis, files, animations))
    reports.write_study(report, folder, formats)
    return report


def _run_worst(
    results: Made,
    folder: Path,
    case: Case,
    header: EnsembleHeader,
    text_of: Callable[[int], str],
    jobs: int,
    progress: Advance,
) -> tuple[tuple[page.File, ...], tuple[Animation, ...]]:
    """Write the worst members as case files, and return the files and the animations. The parameters are those of `write`."""
    compaction.remove(folder / WORST, folder)  # the files of an earlier ensemble
    ensemble = stored.read(folder, case.name, tuple(header["engines"]))
    written = worst.write(folder, case, ensemble, text_of, header["source"], progress)
    del ensemble  # it is large
    files = tuple(page.File(one.way.member, one.path.name if one.path else "", one.title) for one in written)
    with temporary_folder() as runs:
        return files, playing.animations(results.analysis.aggregates, text_of, runs, header, jobs)
