"""Read a folder of saved results, which contains runs or a study.

The files in the folder tell which of the two it is. Nothing is simulated, and no engine needs to be installed.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from bodycheck.casefile.case import CaseFaults
from bodycheck.errors import BadFolder
from bodycheck.files.reading import refuse_links
from bodycheck.reports.study import StudyReport
from bodycheck.results import store
from bodycheck.results.store import Results
from bodycheck.studies import reading
from bodycheck.studies.ablation import saved as ablation
from bodycheck.studies.audit import saved as audit
from bodycheck.studies.audit.rows import RECORDS as AUDIT
from bodycheck.studies.ensemble.header import FILE as ENSEMBLE
from bodycheck.studies.ensemble.report import reporting as ensemble
from bodycheck.studies.extremes import saved as extremes
from bodycheck.studies.extremes.rows import RECORDS as EXTREMES
from bodycheck.studies.recommend import saved as recommend
from bodycheck.studies.recommend.rows import RECORDS as RECOMMEND
from bodycheck.studies.tradeoff import saved as tradeoff

#: How a study is read whose folder has a file of records of its own, by the name of that file.
JOURNALS: dict[str, Callable[[Path], StudyReport]] = {
    EXTREMES: extremes.read,
    RECOMMEND: recommend.read,
    AUDIT: audit.read,
    ENSEMBLE: ensemble.again,
}

#: How a study is read whose folder contains the records of runs and a table, by the name of the table.
TABLES: dict[str, Callable[[Results], StudyReport]] = {"tradeoff.csv": tradeoff.read, "ablation.csv": ablation.read}

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
            return JOURNALS[present[0]](folder)
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
    return TABLES[tables[0]](results)
