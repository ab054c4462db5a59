"""Resume interrupted work: the digest that identifies the work, and the journal of its finished parts."""

import sys
from collections.abc import Callable, Mapping
from hashlib import sha256
from pathlib import Path
from typing import Any

from bodycheck.results import journal
from bodycheck.results.header import Header
from bodycheck.results.journal import Journal
from bodycheck.results.records import is_lost


def versions(head: Header) -> list[Any]:
    """Return the versions of everything that the numbers depend on."""
    return [head["bodycheck"], head["packages"], head["engines"]]


def identity(*work: object) -> str:
    """Return a digest of everything that determines results, regardless of the machine and the command.

    Work is the same if the `repr` of all arguments is the same.
    """
    return sha256(repr(work).encode("utf-8")).hexdigest()


def opened(
    path: Path,
    head: Header,
    *work: object,
    lost: Callable[[journal.Record], bool] = is_lost,
    what: str = "study",
    **entries: Mapping[str, Any],
) -> Journal:
    """Return the journal of some work.

    If the file is the journal of the same work, and this was interrupted, its records are kept, and a message says so.

    Parameters
    ----------
    path
        The file.
    head
        The header of the results.
    work
        Everything that determines the results in addition to the versions in the header.
    lost
        Whether the work of a record is repeated, because its process died or exceeded a limit.
    what
        The word for the work in the message.
    entries
        Further entries of the header.

    Raises
    ------
    BadJournal
        If another process is writing the file.
    """
    log = journal.resume(path, {**head, **entries, "identity": identity(versions(head), *work)}, lost=lost)
    if log.records:
        print(f"bodycheck: resuming the interrupted {what} in {path.parent}", file=sys.stderr)
    return log
