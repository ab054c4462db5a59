"""Reading of the saved results of a study."""

from pathlib import Path

from bodycheck.errors import BadFolder
from bodycheck.reports.study import StudyReport
from bodycheck.results import records
from bodycheck.studies import reading
from bodycheck.studies.estimate import page
from bodycheck.studies.estimate.rows import RECORDS, ROWS, About, OfEngine, joined

#: The file by which the folder of a study is recognised.
FILE = RECORDS


def read(folder: Path) -> StudyReport:
    """Return the report of a finished study in a folder. Raises `BadFolder` and the errors of damaged files."""
    contents, header = reading.finished(folder / RECORDS)
    about = records.typed(About, contents.header["about"])
    engines = [records.typed(OfEngine, record["engine"]) for record in contents.records if record["record"] == "engine"]
    spread: object = next((record["spread"] for record in contents.records if record["record"] == "spread"), [])
    causes: object = next((record["causes"] for record in contents.records if record["record"] == "causes"), {})
    apart = records.typed(list[tuple[str, str, dict[str, tuple[float, float]]]], spread)
    results = joined(about, engines, apart, records.typed(dict[str, str], causes))
    if sorted(map(repr, reading.rows(folder, ROWS))) != sorted(map(repr, results.rows)):
        raise BadFolder(f"{folder}: damaged: {ROWS.file} does not list the same runs as {RECORDS}")
    try:
        return page.present(header, results)
    except (KeyError, TypeError) as error:
        raise BadFolder(f"{folder / RECORDS}: damaged: {type(error).__name__}: {error}") from error
