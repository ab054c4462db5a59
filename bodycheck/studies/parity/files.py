"""The files of robots that a user names: single files, and those in folders and of patterns, each with a name of its own."""

import os
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from bodycheck.casefile.finding import MAX_CASES, Tally, below, is_case_file, is_pattern, matches
from bodycheck.errors import BadInput
from bodycheck.robots import elements
from bodycheck.robots.named_files import local

#: The ends of the names of robot files in folders. Programs of many kinds write files of the last one.
SUFFIXES = (".urdf", ".mjcf", ".xml")
OF_ANY_KIND = ".xml"

#: The names of files that many robots have. A file of such a name has the name of its folder.
OF_ANY_ROBOT = ("robot", "model")


@dataclass(frozen=True)
class NamedFile:
    """A file that the user names, or that is in a folder or matches a pattern which the user names.

    Attributes
    ----------
    name
        The name of its robot in tables: the name of the file without its ending, or the name of its folder if many robots have
        files of that name, or a relative path if several files would have one name.
    path
        The path.
    refused
        The reason why it must not be read; empty if it may be.
    """

    name: str
    path: Path
    refused: str = ""


@dataclass(frozen=True)
class NamedFiles:
    """All files that a user names.

    Attributes
    ----------
    files
        The files, in the order of the arguments; those of a folder or pattern are sorted.
    skipped
        The XML files in folders or of patterns that are no robots' files.
    """

    files: tuple[NamedFile, ...]
    skipped: tuple[Path, ...] = ()


def named(paths: Sequence[Path]) -> NamedFiles:
    """Return the files that paths stand for, each file once.

    A folder stands for all robot files in it and below it, and a pattern for all that match it or are in folders that do. Of
    their files *.xml, those are skipped that are evidently no robot's file: the root is neither <robot> nor <mujoco>, or it is
    <mujoco> without a body, as in files that others include.

    Raises `BadInput` if a folder cannot be read, or has too many files.
    """
    meant: dict[str, tuple[Path, str]] = {}
    skipped = []
    for path in paths:
        several = os.path.isdir(path) or is_pattern(str(path))
        for file, refused in _several(path) if several else [(path, "")]:
            if refused or not several or _may_be_robot(file):
                meant.setdefault(os.path.realpath(file), (file, refused))
            else:
                skipped.append(file)
    names = _names([file for file, _ in meant.values()])
    return NamedFiles(tuple(NamedFile(names[file], file, refused) for file, refused in meant.values()), tuple(skipped))


def _several(path: Path) -> list[tuple[Path, str]]:
    """Return the robot files that a folder or a pattern stands for, with the reasons not to read them."""
    tally = Tally(str(path))
    files: set[tuple[Path, str]] = set()
    for match in [path] if os.path.isdir(path) else matches(path, tally):
        if os.path.isdir(match):
            files |= set(below(match, _is_named_as_robot, tally))
        elif _is_named_as_robot(match.name) or is_case_file(match):
            files.add((match, ""))
    if len(files) > MAX_CASES:
        raise BadInput(f"{path}: stands for more than {MAX_CASES} files of robots; name fewer")
    ends = ", ".join(f"*{suffix}" for suffix in SUFFIXES)
    where = "in this folder or below it" if os.path.isdir(path) else "of this pattern"
    return sorted(files) or [(path, f"there is no robot file ({ends}) {where}")]


def _is_named_as_robot(name: str) -> bool:
    return name.lower().endswith(SUFFIXES)


def _may_be_robot(path: Path) -> bool:
    """Return whether a file in a folder may be a robot's; a file that cannot be read may be one."""
    if path.suffix.lower() != OF_ANY_KIND:
        return True
    try:
        root = elements.read(path)
    except BadInput:
        return True
    tags = {local(element.tag) for element in root.everything()} if root.tag == "mujoco" else set()
    return root.tag == "robot" or not tags.isdisjoint(("body", "include"))


def _names(paths: Sequence[Path]) -> dict[Path, str]:
    """Return distinct names of files: short ones, or paths from their common folder where several would have one name."""
    absolute = [Path(os.path.abspath(path)) for path in paths]
    shared = os.path.commonpath([path.parent for path in absolute]) if absolute else ""
    counts = Counter(map(_short, absolute))
    return {
        path: short if counts[short := _short(whole)] == 1 else whole.relative_to(shared).as_posix()
        for path, whole in zip(paths, absolute, strict=True)
    }


def _short(path: Path) -> str:
    """Return the short name of a file with an absolute path."""
    stem, folder = re.sub(r"\.case$", "", path.stem), path.parent.name
    return folder if folder and stem.lower() in OF_ANY_ROBOT else stem
