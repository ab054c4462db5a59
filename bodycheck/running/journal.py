"""A file of JSON lines that tells of some work: a header, a record of each thing as it is done, and a footer.

Without its footer it tells of work that was interrupted, and that can be gone on with. Half a line at its end, left by whoever
was killed while writing, is no record.
"""

import json
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from bodycheck.errors import BadInput

if sys.platform != "win32":
    import fcntl

Record = dict[str, Any]


class BadJournal(BadInput):
    """A file is no journal, or one that another process is writing; the text says which."""


@dataclass(frozen=True)
class Contents:
    """What a journal holds. complete: whether it has its footer."""

    header: Record
    records: tuple[Record, ...]
    complete: bool


class Journal:
    """A journal that is being written; use as a context, whose regular end writes the footer.

    records: those that were there when it was opened.
    """

    def __init__(self, stream: BinaryIO, records: tuple[Record, ...] = ()) -> None:
        self.records = records
        self._stream, self._count = stream, len(records)

    def __enter__(self) -> "Journal":
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None:
            _write(self._stream, {"record": "footer", "records": self._count})
        self._stream.close()

    def add(self, record: Record) -> None:
        """Write a record, which is in the hands of the system when this returns."""
        _write(self._stream, record)
        self._count += 1


def begin(path: Path, header: Record) -> Journal:
    """A new journal, in place of one that is there. Raises `BadJournal` while another process is writing that."""
    return _begin(_open(path), header)


def resume(path: Path, header: Record) -> Journal:
    """The interrupted journal of the same work, or else a new one.

    The work is the same where the headers have the same `identity`. Raises `BadJournal` as `begin` does.
    """
    stream = _open(path)  # from here on no other process adds to it
    try:
        contents = read(path)
    except BadJournal:
        return _begin(stream, header)
    if contents.complete or contents.header.get("identity") != header["identity"]:
        return _begin(stream, header)
    stream.truncate(len(_whole_lines(path)))
    return Journal(stream, contents.records)


def read(path: Path) -> Contents:
    """What is in a journal. Raises `BadJournal`."""
    try:
        header, *records = [json.loads(line) for line in _whole_lines(path).splitlines()]
        if not all(isinstance(record, dict) for record in (header, *records)) or header.get("record") != "header":
            raise ValueError("its first line is no header, or another one no record")
    except (OSError, ValueError, RecursionError) as error:
        raise BadJournal(f"{path}: no journal: {error}") from error
    complete = bool(records) and records[-1].get("record") == "footer"
    if complete and (ended := records[-1].get("records")) != len(records) - 1:
        raise BadJournal(f"{path}: no whole journal: {len(records) - 1} records, {ended} when it was ended")
    return Contents(header, tuple(records[:-1] if complete else records), complete)


def _open(path: Path) -> BinaryIO:
    """The file, locked until it is closed or this process ends, however it ends."""
    path.parent.mkdir(parents=True, exist_ok=True)
    stream = path.open("ab")
    if sys.platform != "win32":
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            stream.close()
            raise BadJournal(f"{path}: another process is writing it") from error
        except OSError:
            pass  # a file system without locks
    return stream


def _begin(stream: BinaryIO, header: Record) -> Journal:
    stream.truncate(0)
    _write(stream, {"record": "header", **header})
    return Journal(stream)


def _write(stream: BinaryIO, record: Record) -> None:
    stream.write(json.dumps(record, ensure_ascii=False).encode("utf-8") + b"\n")
    stream.flush()


def _whole_lines(path: Path) -> bytes:
    content = path.read_bytes()
    return content[: content.rfind(b"\n") + 1]
