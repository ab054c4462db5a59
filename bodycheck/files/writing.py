"""Write files whole or not at all: under another name in the same folder, which then takes the place of the file.

So a file that was there, or that a hard link shares with another folder, is never written through, and a full disk leaves it as
it was. A symbolic link is refused inside a results folder, whose maker chose where it leads, and followed where the user names
the file.
"""

import contextlib
import os
import secrets
import stat
from collections.abc import Iterator
from pathlib import Path

from bodycheck.errors import BadInput

#: Beginning and end of the names under which files are written before they take their place.
PART_PREFIX, PART_SUFFIX = ".bodycheck-", ".part"

#: A new file, which no other process has and to which no link leads.
NEW_FILE = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)


class NotWritten(BadInput):
    """A file or folder cannot be written, for example because the disk is full; the text names it and says why."""


def write(path: Path, content: bytes, inside: Path | None = None) -> None:
    """Write a file of a results folder, in place of any that is there.

    Parameters
    ----------
    path
        The file.
    content
        Its content.
    inside
        The results folder, which may be a symbolic link, while nothing below it may. Folders between it and the file are made.
        The folder of the file if None.

    Raises
    ------
    NotWritten
        The file cannot be written, or it or a folder below `inside` is a symbolic link.
    """
    with failing(path):
        for below in _below(inside, path.parent):
            _refuse_link(below)
            below.mkdir(exist_ok=True)
        _refuse_link(path)
        _replace(path, content)


def write_named(path: Path, content: bytes) -> None:
    """Write a file that the user named, in place of any that is there. A symbolic link is followed.

    What is not a regular file, such as /dev/stdout, is written to. Raises `NotWritten`.
    """
    with failing(path):
        target = path.resolve()
        if target.exists() and not target.is_file():
            with path.open("wb") as stream:
                stream.write(content)
        else:
            _replace(target, content)


def make_folder(path: Path) -> None:
    """Make a folder that the user named, and those that it is in. Raises `NotWritten`."""
    with failing(path):
        path.mkdir(parents=True, exist_ok=True)


def append(descriptor: int, content: bytes, path: Path) -> None:
    """Write to the end of an open file, which has this path. Raises `NotWritten`; part of the content may then be written."""
    with failing(path):
        _write_all(descriptor, content)


@contextlib.contextmanager
def failing(path: Path) -> Iterator[None]:
    """Turn errors of the operating system within the context into `NotWritten` for a path."""
    try:
        yield
    except OSError as error:
        raise NotWritten(f"{path}: cannot be written: {error.strerror or error}") from error


def is_part(path: Path) -> bool:
    """Return whether a file is what a process that was killed left of `write`."""
    return path.name.startswith(PART_PREFIX) and path.name.endswith(PART_SUFFIX)


def _replace(path: Path, content: bytes) -> None:
    """Write a file under another name, and give it its name. A file that was there passes on its permissions."""
    part = path.with_name(f"{PART_PREFIX}{secrets.token_hex(8)}{PART_SUFFIX}")
    descriptor = os.open(part, NEW_FILE, 0o666)
    try:
        try:
            _write_all(descriptor, content)
        finally:
            os.close(descriptor)
        with contextlib.suppress(FileNotFoundError):
            part.chmod(stat.S_IMODE(path.stat().st_mode))
        os.replace(part, path)
    except BaseException:
        part.unlink(missing_ok=True)
        raise


def _write_all(descriptor: int, content: bytes) -> None:
    left = memoryview(content)
    while left:
        left = left[os.write(descriptor, left) :]


def _below(inside: Path | None, folder: Path) -> list[Path]:
    """Return the folders from a results folder, which is left out, down to another one in it."""
    if inside is None:
        return []
    names = folder.relative_to(inside).parts
    return [inside.joinpath(*names[: count + 1]) for count in range(len(names))]


def _refuse_link(path: Path) -> None:
    """Raise `NotWritten` if a path is a symbolic link."""
    if path.is_symlink():
        raise NotWritten(f"{path}: is a symbolic link; a results folder must not contain any, remove it")
