"""The runs that the report of an ensemble shows, kept in a file so that the report can be made again."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from bodycheck.errors import BadFolder
from bodycheck.files import reading, writing
from bodycheck.reports.study import Animation
from bodycheck.studies.ensemble.report.page import File

#: The file, inside the folder of an ensemble.
FILE = Path("worst", "report.json")

#: The largest size of the file in bytes: some animations of 200 kB each.
MAX_BYTES = 1 << 22


def write(folder: Path, files: Sequence[File], animations: Sequence[Animation]) -> None:
    """Write the case files of worst members that a report names, and its animations. Raises `NotWritten`."""
    content = {"files": [file._asdict() for file in files], "animations": [asdict(one) for one in animations]}
    writing.write(folder / FILE, json.dumps(content, allow_nan=False).encode("ascii"), folder)


def read(folder: Path) -> tuple[tuple[File, ...], tuple[Animation, ...]]:
    """Return what `write` wrote; nothing if there is no file. Raises `BadFolder` if it is damaged."""
    path = folder / FILE
    if not path.exists():
        return (), ()
    try:
        content = json.loads(reading.content(path, MAX_BYTES))
        files = tuple(File(int(one["member"]), str(one["name"]), str(one["title"])) for one in content["files"])
        return files, tuple(map(_animation, content["animations"]))
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        raise BadFolder(f"{path}: damaged: {type(error).__name__}: {error}") from error


def _animation(found: Any) -> Animation:
    """Return an animation. Raises `TypeError` and `KeyError` for anything else."""
    data = found["data"]
    if not (data is None or isinstance(data, dict)):
        raise TypeError("the data of an animation is no object")
    return Animation(str(found["title"]), data, str(found["alt"]), tuple(map(str, found["notes"])))
