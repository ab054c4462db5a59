"""Read a folder of saved results, which contains runs or a study.

The files in the folder tell which of the two it is. Nothing is simulated, and no engine needs to be installed.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from bodycheck.casefile.case import CaseFaults
from bodycheck.errors import BadFolder
from bodycheck.files.reading import refuse_links
from bodycheck.reports.study import StudyReport
from bodycheck.results import store
from bodycheck.results.store import Results
from bodycheck.studies import plain_report, registry

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
    readers = _readers()
    files = (store.RECORDS, *(name for name in readers if not name.endswith(".csv")))
    present = [name for name in files if (folder / name).is_file()]
    if len(present) != 1:
        content = " and ".join(present) or f"neither {', '.join(files[:-1])} nor {files[-1]}"
        raise BadFolder(
            f"{folder}: not a folder of results: it contains {content}; bodycheck writes exactly one of them into each folder"
        )
    tables = [name for name in readers if name.endswith(".csv") and (folder / name).is_file()]
    with undamaged(folder):
        if present[0] in readers:
            return readers[present[0]](folder)
        if len(tables) > 1:
            raise BadFolder(
                f"{folder}: contains {' and '.join(tables)}, but only one can belong to these results; remove the other"
            )
        return readers[tables[0]](folder) if tables else store.read(folder)


def _readers() -> dict[str, Callable[[Path], StudyReport]]:
    """Return the functions that read the folders of studies, by the name of the file by which a folder is recognised.

    That is the journal of the study, or the table beside the records of its runs.
    """
    readers: dict[str, Callable[[Path], StudyReport]] = {}
    for name in registry.STUDIES:
        if (saved := registry.part(name, "saved")) is not None:
            readers[saved.FILE] = saved.read
        elif registry.is_plain(name):
            readers[plain_report.journal(name)] = partial(plain_report.read, name)
    return readers


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
