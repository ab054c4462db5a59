"""Journals: files of JSON lines that record work while it is done, so that interrupted work can be resumed.

A journal has a header, a record for each finished part of the work, and a footer. A journal without its footer records
interrupted work. An incomplete last line, left because its writer was killed or the disk was full, is ignored.

Each line ends with a checksum of the rest of it, so that a changed record is detected. Journals of earlier versions have no
checksums.

While a journal is written, a lock file beside it, `NAME.lock`, keeps other processes from writing it. The lock ends with its
process. The lock file of a killed process remains, but locks nothing, and is removed after the work is resumed.
"""

import contextlib
import json
import os
import re
from collections.abc import Callable, Collection
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from filelock import BaseFileLock, FileLock, Timeout, UnixFileLock

from bodycheck.errors import BadInput
from bodycheck.files import reading, writing

Record = dict[str, Any]

#: The largest size of a journal in bytes.
MAX_BYTES = 1 << 28

#: The key of a line's checksum, the number of its hexadecimal digits, and the pattern of a line with a checksum.
CHECK, DIGITS = "check", 16
CHECKED_LINE = re.compile(rb'(\{.*), "%s": "([0-9a-f]{%d})"\}' % (CHECK.encode(), DIGITS))


class BadJournal(BadInput):
    """A file is not a journal, or another process is writing it; the text says which."""


@dataclass(frozen=True)
class Contents:
    """The contents of a journal.

    Attributes
    ----------
    header
        The description of the work.
    records
        The finished parts of the work, in the order in which they were finished.
    complete
        Whether the journal has its footer.
    """

    header: Record
    records: tuple[Record, ...]
    complete: bool


class Journal:
    """A journal that is being written. As a context manager, it writes its footer at the end, except after an exception.

    Attributes
    ----------
    records
        The records that it had when it was opened.
    """

    def __init__(self, path: Path, lock: BaseFileLock, records: tuple[Record, ...] = ()) -> None:
        self.records = records
        self._path, self._lock, self._count = path, lock, len(records)
        with writing.failing(path):
            self._descriptor = os.open(path, os.O_WRONLY | os.O_APPEND | reading.NO_LINK | reading.NO_WAITING)

    def __enter__(self) -> "Journal":
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        try:
            if kind is None:
                self._append({"record": "footer", "records": self._count})
        finally:
            os.close(self._descriptor)
            _release(self._lock)

    def add(self, record: Record) -> None:
        """Write a record. When this returns, the operating system has it, so that it survives the end of this process.

        Raises `NotWritten`, for example if the disk is full; the work is then resumed after the last whole record.
        """
        self._append(record)
        self._count += 1

    def _append(self, record: Record) -> None:
        writing.append(self._descriptor, _line(record), self._path)


def begin(path: Path, header: Record) -> Journal:
    """Begin a journal, replacing an existing journal.

    Raises `BadJournal` if another process is writing the existing journal, and `NotWritten` if it cannot be written.
    """
    return _opened(path, _lock(path), header, ())


def _no_record(record: Record) -> bool:
    """Return False for every record."""
    return False


def resume(path: Path, header: Record, renewed: Collection[str] = (), lost: Callable[[Record], bool] = _no_record) -> Journal:
    """Resume the interrupted journal of the same work, or begin a new one if there is none.

    Parameters
    ----------
    path
        The file.
    header
        The description of the work. Work is the same if the `identity` in the headers is equal.
    renewed
        The entries of the header that resumed work takes from this header, and not from the existing journal.
    lost
        Whether the work of a record is repeated, because its process died or exceeded a limit, perhaps by what interrupted the
        work. Such records are not kept.

    Raises
    ------
    BadJournal
        Another process is writing the journal.
    NotWritten
        The journal cannot be written.
    """
    lock = _lock(path)  # from here on, no other process writes to it
    try:
        contents = read(path)
    except BadJournal:
        return _opened(path, lock, header, ())
    if contents.complete or contents.header.get("identity") != header["identity"]:
        return _opened(path, lock, header, ())
    kept = contents.header | {name: header[name] for name in renewed}
    return _opened(path, lock, kept, tuple(record for record in contents.records if not lost(record)))


def read(path: Path) -> Contents:
    """Return the contents of a journal. Raises `BadJournal` if it is not a journal."""
    try:
        content = reading.content(path, MAX_BYTES)
        lines = content[: content.rfind(b"\n") + 1].splitlines()
        checked = bool(lines) and CHECKED_LINE.fullmatch(lines[0]) is not None
        header, *records = [_record(line, number, checked) for number, line in enumerate(lines, start=1)]
        if header.get("record") != "header":
            raise ValueError("the first line must be a header")
    except (OSError, ValueError, RecursionError) as error:
        raise BadJournal(f"{path}: not a journal: {error}") from error
    complete = bool(records) and records[-1].get("record") == "footer"
    if complete and (ended := records[-1].get("records")) != len(records) - 1:
        raise BadJournal(f"{path}: damaged: it has {len(records) - 1} records, but its footer counts {ended}")
    return Contents(header, tuple(records[:-1] if complete else records), complete)


def header(path: Path) -> Record:
    """Return the header of a journal, without reading the rest. Raises `BadJournal` if it is not a journal."""
    try:
        line = reading.content(path, MAX_BYTES).partition(b"\n")[0]
        record = _record(line, 1, CHECKED_LINE.fullmatch(line) is not None)
        if record.get("record") != "header":
            raise ValueError("the first line must be a header")
    except (OSError, ValueError, RecursionError) as error:
        raise BadJournal(f"{path}: not a journal: {error}") from error
    return record


def _lock(path: Path) -> BaseFileLock:
    """Lock a journal, and make its folder if it is missing. Raises `BadJournal` if another process has locked it."""
    writing.make_folder(path.parent)
    file = path.with_name(f"{path.name}.lock")
    if file.is_symlink() or (file.exists() and (not file.is_file() or file.stat().st_size > 0)):
        raise BadJournal(f"{file}: is not a lock file of bodycheck; remove it")
    lock = FileLock(file)
    with writing.failing(file):
        try:
            lock.acquire(timeout=0)
        except Timeout as error:
            raise BadJournal(f"{path}: another process is writing it") from error
    return lock


def _release(lock: BaseFileLock) -> None:
    """Release a lock and remove its file."""
    if isinstance(lock, UnixFileLock):
        # Unlike other kinds, this lock leaves its file. Removed before the release, the file cannot belong to another process;
        # a process that has already opened it finds that it is gone, and takes no lock on it.
        with contextlib.suppress(OSError):  # somebody may have removed the folder meanwhile, or replaced it
            Path(lock.lock_file).unlink()
    lock.release()


def _opened(path: Path, lock: BaseFileLock, header: Record, records: tuple[Record, ...]) -> Journal:
    """Write a journal with a header and the records that are kept, and open it to add further ones.

    The journal replaces an existing file, which may share its content with another file through a hard link.
    """
    try:
        writing.write(path, b"".join(map(_line, ({"record": "header", **header}, *records))))
        return Journal(path, lock, records)
    except BaseException:
        _release(lock)
        raise


def _line(record: Record) -> bytes:
    """Return the line of a record, with its checksum at the end."""
    try:
        text = json.dumps(record, ensure_ascii=False).encode("utf-8")
    except UnicodeEncodeError:  # the command contains a file name that is not UTF-8
        text = json.dumps(record).encode("ascii")
    return b'%s, "%s": "%s"}\n' % (text[:-1], CHECK.encode(), _checksum(text[:-1]))


def _record(line: bytes, number: int, checked: bool) -> Record:
    """Return the record in a line. Raises `ValueError` if its checksum is wrong, or missing although it is required."""
    match = CHECKED_LINE.fullmatch(line)
    if checked and (match is None or _checksum(match[1]) != match[2]):
        raise ValueError(f"line {number} was changed after it was written: its checksum is wrong")
    record: Any = json.loads(line)
    if not isinstance(record, dict):
        raise ValueError(f"line {number} is not a record")
    record.pop(CHECK, None)
    return record


def _checksum(text: bytes) -> bytes:
    return sha256(text).hexdigest()[:DIGITS].encode()
