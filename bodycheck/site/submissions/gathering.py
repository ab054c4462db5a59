"""Submissions from paths: zip files, results folders, and folders of both. Paths that cannot be read are left out."""

import os
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

from bodycheck.adapters.engine_name import adapter_of
from bodycheck.errors import BadInput
from bodycheck.files import reading
from bodycheck.site import released
from bodycheck.site.submissions import archive, packing, personal
from bodycheck.site.submissions.contents import checked
from bodycheck.site.submissions.submission import LeftOut, Submission
from bodycheck.site.submissions.tables import TABLES
from bodycheck.site.submissions.texts import shown

#: The exceptions, apart from `BadInput`, that reading a stranger's file may raise.
DAMAGE = (OSError, ArithmeticError, LookupError, TypeError, ValueError, AttributeError, RecursionError, MemoryError)

#: The most characters of a reason.
LONGEST = 500


def gathered(paths: Sequence[Path], now: datetime | None = None) -> tuple[tuple[Submission, ...], tuple[LeftOut, ...]]:
    """Return the submissions at paths, the oldest first, and the paths that are left out with their reasons.

    A submission that was started after the present time is left out, and one with a version of an engine that is not in the
    list of its releases.

    Parameters
    ----------
    paths
        Zip files of `bodycheck submit`, results folders, and folders that contain either.
    now
        The present time; by default, that of this machine.

    Raises
    ------
    BadInput
        A path does not exist.
    """
    present = datetime.now(UTC) if now is None else now
    found: dict[str, Submission] = {}
    left_out = []
    for path in paths:
        if not path.exists():
            raise BadInput(f"{path}: there is no such file or folder")
        for one in _places(path):
            try:
                submission = read(one)
                _check_origin(submission, present)
            except BadInput as error:
                left_out.append(LeftOut(_name(one), _reason(str(error), one)))
            except DAMAGE as error:
                left_out.append(LeftOut(_name(one), _reason(f"is damaged: {type(error).__name__}: {error}", one)))
            else:
                found[submission.key] = submission
    in_order = sorted(found.values(), key=lambda one: (one.header.started, one.key))
    return tuple(in_order), tuple(left_out)


def _check_origin(submission: Submission, now: datetime) -> None:
    """Raise `BadInput` for a submission that was started after the present time, or with an unknown release of an engine."""
    started = submission.header.started
    if datetime.fromisoformat(started) > now:
        clock = now.isoformat(timespec="seconds")
        raise BadInput(f"header: started: {started} is after the present time of this site, {clock}")
    # A study of releases has the first and the last of them in its header.
    headed = submission.header.engines.items()
    versions = {(engine, version) for engine, both in headed for version in both.split(" to ")}
    for rows in submission.tables.values():
        versions |= {(row["engine"], row["version"]) for row in rows if row.get("engine") and row.get("version")}
    for engine, version in sorted(versions):
        if (why := released.fault(adapter_of(engine), version)) is not None:
            raise BadInput(why)


def read(path: Path) -> Submission:
    """Return the submission in a zip file or results folder. Raises `BadInput` or one of `DAMAGE` if it cannot be read."""
    if path.is_dir():
        return checked(packing.contents(path))
    try:
        content = reading.content(path, archive.MOST_PACKED)
    except OSError as error:
        raise BadInput(str(error)) from error
    return archive.read(content)


def _places(path: Path) -> list[Path]:
    """Return the path itself if it is a file or a results folder, or else the zip files and folders in it.

    If the folder contains neither, return the path itself.
    """
    if not path.is_dir() or any(os.path.lexists(path / name) for name in TABLES):
        return [path]
    inner = [path / name for name in sorted(reading.names_in(path)) if not name.startswith(".")]
    return [one for one in inner if one.suffix == ".zip" or one.is_dir()] or [path]


def _name(path: Path) -> str:
    """Return the name of a path for readers."""
    return shown(path.name, 100)


def _reason(text: str, path: Path) -> str:
    """Return a reason on one line, without `path` at its beginning and without the folders of other paths."""
    return shown(personal.Cleaning().text(" ".join(text.removeprefix(f"{path}: ").split())), LONGEST)
