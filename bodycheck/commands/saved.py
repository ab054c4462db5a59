"""Read a folder of saved results, which contains runs or a study.

The files in the folder tell which of the two it is. Nothing is simulated, and no engine needs to be installed.
"""

import importlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from bodycheck.casefile.case import CaseFaults
from bodycheck.errors import BadFolder
from bodycheck.files.reading import refuse_links
from bodycheck.reports.study import StudyReport
from bodycheck.results import store
from bodycheck.results.store import Results
from bodycheck.studies import reading
from bodycheck.studies.audit import rows as audit
from bodycheck.studies.ensemble import header as ensemble
from bodycheck.studies.extremes import rows as extremes
from bodycheck.studies.recommend import rows as recommend

#: The studies whose folder has a file of records of its own, by its name, each with the study's folder.
JOURNALS = {extremes.RECORDS: "extremes", recommend.RECORDS: "recommend", audit.RECORDS: "audit", ensemble.FILE: "ensemble"}

#: The studies whose folder contains the records of runs and a table, by the name of the table, each with the study's folder.
TABLES = {"tradeoff.csv": "tradeoff", "ablation.csv": "ablation"}

#: What reading and judging damaged files may raise, beside `BadInput`.
DAMAGE = (
    *(OSError, ArithmeticError, LookupError, TypeError, ValueError),
    *(AttributeError, AssertionError, RecursionError, MemoryError),
)


def read(folder: Path) -> Results | StudyReport:
    """Return the results of the runs in a folder, or the report of the study in it.

    Results of interrupted runs are returned with `complete` false. Raises `BadFolder` for a folder that contains neither runs
    nor a study, or both, for an interrupted study, and for damaged files.
    """
    if not folder.is_dir():
        raise BadFolder(f"{folder}: there is no such folder" if not folder.exists() else f"{folder}: is not a folder")
    refuse_links(folder)
    files = (store.RECORDS, *JOURNALS)
    present = [name for name in files if (folder / name).is_file()]
    if len(present) != 1:
        content = " and ".join(present) or f"neither {', '.join(files[:-1])} nor {files[-1]}"
        raise BadFolder(
            f"{folder}: not a folder of results: it contains {content}; bodycheck writes exactly one of them into each folder"
        )
    with undamaged(folder):
        if present[0] in JOURNALS:
            return _study(JOURNALS[present[0]], folder)
        results = store.read(folder)
        return _study_of_runs(results) or results


@contextmanager
def undamaged(*folders: Path) -> Iterator[None]:
    """Turn errors of reading folders within the context into `BadFolder`: the files are not as bodycheck wrote them."""
    try:
        yield
    except CaseFaults as error:
        raise BadFolder(f"{_names(folders)}: damaged: {error}") from error
    except DAMAGE as error:
        raise BadFolder(f"{_names(folders)}: damaged: {type(error).__name__}: {error}") from error


def _names(folders: tuple[Path, ...]) -> str:
    return " or ".join(map(str, folders))


def _study_of_runs(results: Results) -> StudyReport | None:
    """Return the report of the study whose table is beside the runs; None if there is no such table."""
    tables = [name for name in TABLES if (results.folder / name).is_file()]
    if not tables:
        return None
    if len(tables) > 1:
        raise BadFolder(
            f"{results.folder}: contains {' and '.join(tables)}, but only one can belong to these results; remove the other"
        )
    if not results.complete:
        raise BadFolder(f"{results.folder}: the study {reading.INTERRUPTED}")
    return _study(TABLES[tables[0]], results)


def _study(name: str, saved: Path | Results) -> StudyReport:
    """Return the report of a saved study, which the module `saved` in the study's folder reads."""
    report: StudyReport = importlib.import_module(f"bodycheck.studies.{name}.saved").read(saved)
    return report
