"""Reading of a saved ensemble."""

from pathlib import Path

from bodycheck.casefile.case import parse_stored
from bodycheck.errors import BadFolder
from bodycheck.reports.study import StudyReport
from bodycheck.studies.ensemble import header as headers
from bodycheck.studies.ensemble.header import FILE as FILE
from bodycheck.studies.ensemble.report import page, reporting


def read(folder: Path) -> StudyReport:
    """Return the report of an ensemble in a folder. Raises `BadFolder` and errors of damaged files."""
    header = headers.read(folder)
    if not header["complete"]:
        raise BadFolder(f"{folder}: the ensemble was interrupted; run it again with the same --out to resume it")
    case = parse_stored(header["text"], header["case"])
    analysis = reporting.read(folder, case, header).analysis
    return page.present(reporting.material(case, header, analysis, *reporting.shown(folder)))
