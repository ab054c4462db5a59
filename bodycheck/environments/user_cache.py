"""The folder for files that bodycheck can make again: the user's cache folder, or the folder in a variable.

An entry is a text with its digest and the time at which it was made. A damaged entry counts as missing. If another user can
change the folder, all entries count as missing, and nothing is kept.
"""

import contextlib
import os
import sys
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache
from hashlib import sha256
from pathlib import Path

from platformdirs import user_cache_path

from bodycheck.environments import privacy
from bodycheck.files import reading, writing

#: The environment variable that names another cache folder.
VARIABLE = "BODYCHECK_CACHE"

#: The largest size of an entry in bytes.
MAX_BYTES = 1 << 26


#: The largest size in bytes of the lines before the text of an entry.
MAX_LINE = 100


@dataclass(frozen=True)
class Entry:
    """An entry of the cache: its text, and when it was made."""

    text: str
    time: datetime


def folder() -> Path:
    """Return the cache folder, which may not exist yet."""
    chosen = os.environ.get(VARIABLE)
    return Path(chosen).absolute() if chosen else user_cache_path("bodycheck")


def kept(name: str) -> Entry | None:
    """Return the entry of a name, such as `records/mujoco.json`; None if it is missing, damaged, or not trusted."""
    path = folder() / name
    try:
        if not _is_trusted(path):
            return None
        digest, _, content = reading.content(path, MAX_BYTES).partition(b"\n")
        if digest != _digest(content):
            return None
        time, _, text = content.decode("utf-8").partition("\n")
        return Entry(text, datetime.fromisoformat(time))
    except (OSError, ValueError):
        return None


def keep(name: str, text: str) -> None:
    """Store an entry, replacing an existing one, if the cache folder can be written to and is trusted."""
    path = folder() / name
    content = f"{datetime.now(UTC).isoformat(timespec='seconds')}\n{text}".encode()
    with contextlib.suppress(OSError, writing.NotWritten):
        privacy.make(path.parent)
        if _is_trusted(path.parent):
            writing.write(path, _digest(content) + b"\n" + content)
            path.chmod(0o600)


def forget(name: str) -> None:
    """Remove the entry of a name if there is one."""
    with contextlib.suppress(OSError):
        (folder() / name).unlink()


def times(subfolder: str) -> list[datetime]:
    """Return the times at which the entries in a folder of the cache were made, ascending; none if it is not trusted."""
    all_times = []
    with contextlib.suppress(OSError):
        if _is_trusted(folder() / subfolder):
            for path in (folder() / subfolder).iterdir():
                with contextlib.suppress(OSError, ValueError):
                    reading.check_regular(path)
                    with path.open("rb") as stream:
                        stream.readline(MAX_LINE)
                        all_times.append(datetime.fromisoformat(stream.readline(MAX_LINE).decode("ascii").strip()))
    return sorted(all_times)


def untrusted(path: Path, open_path: Path) -> str:
    """Return the sentence about a path of the cache that is not used, because another user can change `open_path`."""
    remedy = f"let {VARIABLE} name a folder that only you can write to"
    return f"{path}: not used, because another user can change {open_path}; {remedy}"


def _is_trusted(path: Path) -> bool:
    """Return whether nobody else can change an existing path of the cache; otherwise say so once. Raises `OSError`."""
    if (open_path := privacy.open_to_others(path)) is not None:
        _warn(open_path)
    return open_path is None


@cache
def _warn(open_path: Path) -> None:
    print(f"bodycheck: {untrusted(folder(), open_path)}", file=sys.stderr)


def _digest(content: bytes) -> bytes:
    return sha256(content).hexdigest().encode("ascii")
