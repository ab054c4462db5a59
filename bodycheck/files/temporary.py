"""Temporary folders of commands. Each command first removes the folders that killed commands have left.

The process that uses a folder holds a lock of it, which ends with the process. On Windows there is no such lock, and a process
removes only its own folder.
"""

import contextlib
import os
import shutil
import stat
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

if sys.platform != "win32":
    import fcntl

#: Beginning of the names of the folders.
PREFIX = "bodycheck-run-"


@contextlib.contextmanager
def temporary_folder() -> Iterator[Path]:
    """Provide a new folder of this user in the folder for temporary files; the end of the context removes it.

    The folders of processes that have ended are removed first.
    """
    _remove_left()
    folder, lock = _made()
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        if lock is not None:
            os.close(lock)


def _made() -> tuple[Path, int | None]:
    """Make a folder and lock it; make a new one if another process removed it before it was locked."""
    while True:
        folder = Path(tempfile.mkdtemp(prefix=PREFIX))
        if sys.platform == "win32":
            return folder, None
        else:
            with contextlib.suppress(FileNotFoundError):
                descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
                with contextlib.suppress(OSError):  # a file system without locks: no process can remove the folder
                    fcntl.flock(descriptor, fcntl.LOCK_EX)
                if folder.exists():
                    return folder, descriptor
                os.close(descriptor)


def _remove_left() -> None:
    """Remove the folders of processes that have ended: folders of this user, closed to others, without a lock."""
    if sys.platform != "win32":
        for folder in Path(tempfile.gettempdir()).glob(f"{PREFIX}*"):
            with contextlib.suppress(OSError):  # a link, no folder, or removed by another process meanwhile
                descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
                try:
                    status = os.fstat(descriptor)
                    if status.st_uid == os.getuid() and not stat.S_IMODE(status.st_mode) & 0o077:
                        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                        shutil.rmtree(folder, ignore_errors=True)
                finally:
                    os.close(descriptor)
