"""Check who can change a folder: code that is run from the cache must come from this user or from the administrator."""

import os
import stat
import sys
from pathlib import Path

if sys.platform != "win32":
    import grp
    import pwd


def open_to_others(path: Path) -> Path | None:
    """Return the first path, among a path and its parents, that another user can change or replace; None if there is none.

    Each path must belong to this user or to the administrator, and nobody else may write to it, except that a folder with the
    sticky bit, such as /tmp, lets others add their own entries. If the path contains links, both the links and their targets
    are checked. On Windows, where folders have no such owner, the result is None.

    Raises `OSError` if there is no such path.
    """
    if sys.platform == "win32":
        return None
    absolute, real = path.absolute(), path.resolve(strict=True)
    return next(
        (candidate for candidate in (absolute, *absolute.parents, real, *real.parents) if not _is_ours(candidate)), None
    )


def make(folder: Path) -> None:
    """Make a folder and its missing parents for this user alone; existing folders stay unchanged. Raises `OSError`."""
    for missing in (*reversed(folder.parents), folder):
        if not missing.is_dir():
            missing.mkdir(mode=0o700, exist_ok=True)


def is_closed(folder: Path) -> bool:
    """Return whether nobody else can read, change or replace a folder or its content. Raises `OSError` if it is missing."""
    others = 0 if sys.platform == "win32" else folder.stat().st_mode & 0o077
    return not others and open_to_others(folder) is None


def _is_ours(folder: Path) -> bool:
    status = folder.lstat()
    if sys.platform == "win32" or status.st_uid not in (0, os.getuid()):
        return False
    if stat.S_ISLNK(status.st_mode) or status.st_mode & stat.S_ISVTX:
        return True
    others = bool(status.st_mode & stat.S_IWOTH)
    return not others and (not status.st_mode & stat.S_IWGRP or _is_own_group(status.st_gid))


def _is_own_group(number: int) -> bool:
    """Return whether a group is this user's private group, which many systems make for each user as its only member."""
    if sys.platform == "win32":
        return False
    else:
        try:
            group, user = grp.getgrgid(number), pwd.getpwuid(os.getuid())
        except KeyError:
            return False
        return group.gr_gid == user.pw_gid and group.gr_name == user.pw_name and not set(group.gr_mem) - {user.pw_name}
