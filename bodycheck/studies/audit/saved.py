"""Reading of the saved results of an audit."""

from pathlib import Path

from bodycheck.errors import BadFolder
from bodycheck.reports.study import StudyReport
from bodycheck.results import records
from bodycheck.studies import reading
from bodycheck.studies.audit import page as audit
from bodycheck.studies.audit.rows import RECORDS, ROWS, Facts, Fault, read_classes

#: The file by which the folder of an audit is recognised.
FILE = RECORDS


def read(folder: Path) -> StudyReport:
    """Return the report of a finished audit in a folder. Raises `BadFolder` and the errors of damaged files."""
    contents, header = reading.finished(folder / RECORDS)
    facts = {name: records.typed(Facts, defaults) for name, defaults in contents.header["facts"].items()}
    rows = reading.rows(folder, ROWS)
    probed = [record for record in contents.records if record["record"] == "probe"]
    if {(row.engine, row.integrator) for row in rows} != {(one["engine"], one["integrator"]) for one in probed}:
        raise BadFolder(f"{folder}: damaged: audit.csv does not list the same methods as {RECORDS}")
    names = ("engine", "integrator", "probe")
    silent = [record for record in contents.records if "fault" in record]
    faults = [records.typed(Fault, {name: one[name] for name in names} | {"reason": one["fault"]}) for one in silent]
    (classed,) = (read_classes(record) for record in contents.records if record["record"] == "classes")
    return audit.present(header, facts, rows, faults, classed)
