"""Write files completely or not at all: a new file with another name in the same folder then replaces the old file.

An existing file, which a hard link may share with another folder, is therefore never overwritten in place, and a full disk
leaves it unchanged. A symbolic link is refused inside a results folder, because the maker of the folder chose its target. It is
followed if the user names the file.
"""

import contextlib
import os
import secrets
import stat
from collections.abc import Iterator
from pathlib import Path

from bodycheck.errors import BadInput

#: Beginning and end of the temporary names of files while they are written.
PART_PREFIX, PART_SUFFIX = ".bodycheck-", ".part"

#: Flags of `open` for a new file: opening fails if a file or link of this name exists.
NEW_FILE = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)


def as_utf8(text: str) -> str:
    r"""Return a text that UTF-8 can encode: bytes of a name or an argument that are not UTF-8 become escapes such as `\xe9`."""
    return text.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")


class NotWritten(BadInput):
    """A file or folder cannot be written, for example because the disk is full; the text names it and says why."""


def write(path: Path, content: bytes, inside: Path | None = None) -> None:
    """Write a file of a results folder, replacing an existing file.

    Parameters
    ----------
    path
        The file.
    content
        Its content.
    inside
        The results folder, which may itself be a symbolic link, but must not contain any. Missing folders between it and the
        file are made. If None, it is the folder of the file.

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
    """Write a file that the user named, replacing an existing file. A symbolic link is followed.

    A path that is not a regular file, such as /dev/stdout, is written to directly. Raises `NotWritten` if writing fails.
    """
    with failing(path):
        target = path.resolve()
        if target.exists() and not target.is_file():
            with path.open("wb") as stream:
                stream.write(content)
        else:
            _replace(target, content)


def make_folder(path: Path) -> None:
    """Make a folder that the user named, and its parents. Raises `NotWritten` if that fails."""
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
    """Return whether a file is an unfinished file of `write` that a killed process has left."""
    return path.name.startswith(PART_PREFIX) and path.name.endswith(PART_SUFFIX)


def _replace(path: Path, content: bytes) -> None:
    """Write a file under another name, and then rename it. The new file gets the permissions of an existing file."""
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
    """Return the folders below a results folder down to `folder`, which is inside it; empty if `inside` is None."""
    if inside is None:
        return []
    names = folder.relative_to(inside).parts
    return [inside.joinpath(*names[: count + 1]) for count in range(len(names))]


def _refuse_link(path: Path) -> None:
    """Raise `NotWritten` if a path is a symbolic link."""
    if path.is_symlink():
        raise NotWritten(f"{path}: is a symbolic link; a results folder must not contain any, remove it")
