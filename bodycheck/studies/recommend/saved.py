"""Reading of the saved results of a search for time steps."""

from pathlib import Path

from bodycheck.errors import BadFolder
from bodycheck.reports.study import StudyReport
from bodycheck.results import records
from bodycheck.studies import reading
from bodycheck.studies.recommend import page as recommend
from bodycheck.studies.recommend.rows import ANSWERS, RECORDS, STEPS, Asked, Recommendation

#: The file by which the folder of a search is recognised.
FILE = RECORDS


def read(folder: Path) -> StudyReport:
    """Return the report of a finished search in a folder. Raises `BadFolder` and the errors of damaged files."""
    contents, header = reading.finished(folder / RECORDS)
    asked = records.typed(Asked, contents.header["asked"])
    answers, probes = reading.rows(folder, ANSWERS), reading.rows(folder, STEPS)
    if {probe.method for probe in probes} - {answer.method for answer in answers}:
        raise BadFolder(f"{folder}: damaged: recommend.csv does not list the same methods as steps.csv")
    report = recommend.present(header, Recommendation(asked, tuple(answers), tuple(probes)))
    return reading.dated(report, contents.header, {asked.figure})
