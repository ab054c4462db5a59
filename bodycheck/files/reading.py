"""Read files that may come from strangers: only regular files of limited size, so that reading never blocks forever.

A symbolic link that the user names is followed. Inside a results folder no link is followed, because the maker of the folder
chose its target.
"""

import os
import stat
from collections.abc import Iterator
from pathlib import Path

from bodycheck.errors import BadFolder

#: Most bytes that are read from a file at once.
CHUNK_BYTES = 1 << 20

#: Flags of `open` that some systems lack. They make opening a pseudo-file without content, such as some in /proc, fail instead
#: of wait.
NO_WAITING = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
NO_LINK = getattr(os, "O_NOFOLLOW", 0)


class Refused(OSError):
    """A file is not read because of its kind or its size.

    Attributes
    ----------
    reason
        The reason, without the name of the file.
    """

    def __init__(self, path: Path, reason: str) -> None:
        super().__init__(f"{path}: {reason}")
        self.reason = reason


def content(path: Path, limit: int, follow: bool = False) -> bytes:
    """Return the content of a file.

    Parameters
    ----------
    path
        The file.
    limit
        The largest size of the file in bytes.
    follow
        Whether the path itself may be a symbolic link, because the user named it.

    Raises
    ------
    Refused
        It is not a regular file, or larger than the limit.
    OSError
        It cannot be read.
    """
    _check_kind(path, os.stat(path, follow_symlinks=follow).st_mode)  # before it is opened: opening a device may change it
    descriptor = os.open(path, os.O_RDONLY | NO_WAITING | (0 if follow else NO_LINK))
    try:
        status = os.fstat(descriptor)
        _check_kind(path, status.st_mode)
        chunks, room = [], 0 if status.st_size > limit else limit + 1  # a file that is too large is not read at all
        while room > 0 and (chunk := os.read(descriptor, min(room, CHUNK_BYTES))):
            chunks.append(chunk)
            room -= len(chunk)
    finally:
        os.close(descriptor)
    if room == 0:
        raise Refused(path, f"larger than {limit} bytes, the limit for such files")
    return b"".join(chunks)


def names_in(folder: Path) -> list[str]:
    """Return the names of all entries of a folder, none if it does not exist. Raises `BadFolder` if it cannot be read."""
    try:
        return os.listdir(folder) if folder.exists() else []
    except OSError as error:
        raise BadFolder(f"{folder}: cannot be read: {error.strerror}") from error


def refuse_links(folder: Path) -> None:
    """Raise `BadFolder` if anything in a results folder is a symbolic link; the folder itself may be one."""
    for entry in _entries(folder):
        if entry.is_symlink():
            raise BadFolder(f"{entry.path}: is a symbolic link; a results folder must not contain any, remove it")


def _entries(folder: Path) -> Iterator[os.DirEntry[str]]:
    """Yield all entries of a folder and of the folders in it, none if it does not exist. No link is followed."""
    left: list[str | Path] = [folder]
    while left:
        try:
            with os.scandir(left.pop()) as entries:
                for entry in entries:
                    yield entry
                    if entry.is_dir(follow_symlinks=False):
                        left.append(entry.path)
        except FileNotFoundError:
            continue
        except OSError as error:
            raise BadFolder(f"{folder}: cannot be read: {error}") from error


def check_regular(path: Path) -> None:
    """Raise `Refused` unless a path named by the user leads to a regular file, and `OSError` if it does not exist."""
    _check_kind(path, os.stat(path).st_mode)


def _check_kind(path: Path, mode: int) -> None:
    """Raise `Refused` unless the mode is the mode of a regular file."""
    if stat.S_ISLNK(mode):
        raise Refused(path, "is a symbolic link, and none is followed here; put the file itself there")
    if not stat.S_ISREG(mode):
        raise Refused(path, "is not a regular file")
