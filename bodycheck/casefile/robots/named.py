"""The names of robots' files: by which they are known, and short ones of which each belongs to one file."""

import os
import re
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

from bodycheck.errors import BadInput
from bodycheck.robots import elements
from bodycheck.robots.named_files import local

#: The ends of the names of robots' files. Programs of many kinds write files of the last one.
SUFFIXES = (".urdf", ".mjcf", ".xml")
OF_ANY_KIND = ".xml"

#: The names of files that many robots have. A file of such a name has the name of its folder.
OF_ANY_ROBOT = frozenset({"main", "model", "robot", "scene"})

#: The name of a case of a robot whose file or folder has a name without letters and digits.
NAMELESS = "robot"


def is_named_as_robot(path: str | Path) -> bool:
    """Return whether a path ends as those of robots' files do."""
    return str(path).lower().endswith(SUFFIXES)


def may_be_robot(path: Path) -> bool:
    """Return whether a file with the name of a robot's file may be one; a file that cannot be read may.

    A file *.xml is none if its root is neither <robot> nor <mujoco>, or is <mujoco> without a body, as in files that others
    include.
    """
    if path.suffix.lower() != OF_ANY_KIND:
        return True
    try:
        root = elements.read(path)
    except BadInput:
        return True
    tags = {local(element.tag) for element in root.everything()} if root.tag == "mujoco" else set()
    return root.tag == "robot" or not tags.isdisjoint(("body", "include"))


def short_name(path: Path) -> str:
    """Return the name of a robot: that of its file without the ending, or that of the folder if many robots' files have it."""
    whole = Path(os.path.abspath(path))
    stem, folder = re.sub(r"\.case$", "", whole.stem), whole.parent.name
    return folder if folder and stem.lower() in OF_ANY_ROBOT else stem


def case_name(text: str) -> str:
    """Return the name of a case, made from the short name or the path of a robot's file."""
    from bodycheck.casefile.values import MAX_NAME_LENGTH  # the pytest plug-in finds files, and needs no grammar of cases

    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:MAX_NAME_LENGTH].rstrip("-") or NAMELESS


def distinct(paths: Sequence[Path], written: Callable[[str], str] = str) -> dict[Path, str]:
    """Return the short names of files, or the ends of their paths where several files would have one name.

    These ends begin with the folder, or with a folder above it if the names would still be the same.

    written: a function from such a name or path to the name that is returned.
    """
    names = {path: written(short_name(path)) for path in paths}
    parts = {path: Path(os.path.abspath(path)).parts for path in paths}
    counts = Counter(names.values())
    alike, length = [path for path in paths if counts[names[path]] > 1], 1
    while alike and length < max(len(parts[path]) for path in alike):
        length += 1
        names |= {path: written("/".join(parts[path][-length:])) for path in alike}
        counts = Counter(names.values())
        alike = [path for path in alike if counts[names[path]] > 1]
    return names
