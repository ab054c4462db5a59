"""Journals: files of JSON lines that record work while it is done, so that work that was interrupted can be resumed.

A journal has a header, a record for each thing that was done, and a footer. Without its footer it tells of interrupted work. A
last line that is incomplete, because its writer was killed, does not count.

While a journal is written, a lock file beside it, `NAME.lock`, keeps other processes from writing it. The lock ends with its
process. The lock file of a process that was killed is left, locks nothing, and is removed after the work is resumed.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from filelock import BaseFileLock, FileLock, Timeout, UnixFileLock

from bodycheck.errors import BadInput

Record = dict[str, Any]


class BadJournal(BadInput):
    """A file is not a journal, or another process is writing it; the text says which."""


@dataclass(frozen=True)
class Contents:
    """The contents of a journal.

    Attributes
    ----------
    header
        What the work is.
    records
        What was done, in the order in which it was done.
    complete
        Whether the journal has its footer.
    """

    header: Record
    records: tuple[Record, ...]
    complete: bool


class Journal:
    """A journal that is being written. As a context it writes its footer at the end, unless that is an exception.

    Attributes
    ----------
    records
        The records that were there when it was opened.
    """

    def __init__(self, stream: BinaryIO, lock: BaseFileLock, records: tuple[Record, ...] = ()) -> None:
        self.records = records
        self._stream, self._lock, self._count = stream, lock, len(records)

    def __enter__(self) -> "Journal":
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None:
            _write(self._stream, {"record": "footer", "records": self._count})
        self._stream.close()
        _release(self._lock)

    def add(self, record: Record) -> None:
        """Write a record; when this returns, the operating system has it, and the end of this process does not lose it."""
        _write(self._stream, record)
        self._count += 1


def begin(path: Path, header: Record) -> Journal:
    """Begin a journal, in place of any that is there. Raises `BadJournal` if another process is writing that one."""
    return _begin(*_open(path), header)


def resume(path: Path, header: Record) -> Journal:
    """Resume the interrupted journal of the same work, or begin a new one if there is none.

    Parameters
    ----------
    path
        The file.
    header
        What the work is. Work is the same if the `identity` in the headers is equal.

    Raises
    ------
    BadJournal
        Another process is writing the journal.
    """
    stream, lock = _open(path)  # from here on no other process adds to it
    try:
        contents = read(path)
    except BadJournal:
        return _begin(stream, lock, header)
    if contents.complete or contents.header.get("identity") != header["identity"]:
        return _begin(stream, lock, header)
    stream.truncate(len(_whole_lines(path)))
    return Journal(stream, lock, contents.records)


def read(path: Path) -> Contents:
    """Return the contents of a journal. Raises `BadJournal`."""
    try:
        header, *records = [json.loads(line) for line in _whole_lines(path).splitlines()]
        if not all(isinstance(record, dict) for record in (header, *records)) or header.get("record") != "header":
            raise ValueError("the first line must be a header and all others records")
    except (OSError, ValueError, RecursionError) as error:
        raise BadJournal(f"{path}: not a journal: {error}") from error
    complete = bool(records) and records[-1].get("record") == "footer"
    if complete and (ended := records[-1].get("records")) != len(records) - 1:
        raise BadJournal(f"{path}: damaged: it has {len(records) - 1} records, but its footer counts {ended}")
    return Contents(header, tuple(records[:-1] if complete else records), complete)


def _open(path: Path) -> tuple[BinaryIO, BaseFileLock]:
    """Open and lock a journal. Raises `BadJournal` if another process has locked it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    stream = path.open("ab")
    lock = FileLock(path.with_name(f"{path.name}.lock"))
    try:
        lock.acquire(timeout=0)
    except Timeout as error:
        stream.close()
        raise BadJournal(f"{path}: another process is writing it") from error
    return stream, lock


def _release(lock: BaseFileLock) -> None:
    """Release a lock and remove its file."""
    if isinstance(lock, UnixFileLock):
        # This kind leaves its file, unlike the others. Removed before the release, it cannot be that of another process; a
        # process that has opened it already finds that it is gone, and takes no lock on it.
        Path(lock.lock_file).unlink(missing_ok=True)
    lock.release()


def _begin(stream: BinaryIO, lock: BaseFileLock, header: Record) -> Journal:
    stream.truncate(0)
    _write(stream, {"record": "header", **header})
    return Journal(stream, lock)


def _write(stream: BinaryIO, record: Record) -> None:
    stream.write(json.dumps(record, ensure_ascii=False).encode("utf-8") + b"\n")
    stream.flush()


def _whole_lines(path: Path) -> bytes:
    content = path.read_bytes()
    return content[: content.rfind(b"\n") + 1]
