"""The files of robots that a user names: single files, and those in folders and of patterns, each with a name of its own."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from bodycheck.casefile.finding import MAX_CASES, Tally, below, is_case_file, is_pattern, matches
from bodycheck.casefile.robots.named import SUFFIXES, distinct, is_named_as_robot, may_be_robot
from bodycheck.errors import BadInput


@dataclass(frozen=True)
class NamedFile:
    """A file that the user names, or that is in a folder or matches a pattern which the user names.

    Attributes
    ----------
    name
        The name of its robot in tables: the name of the file without its ending, or the name of its folder if many robots have
        files of that name, or the end of its path if several files would have one name.
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
            if refused or not several or may_be_robot(file):
                meant.setdefault(os.path.realpath(file), (file, refused))
            else:
                skipped.append(file)
    names = distinct([file for file, _ in meant.values()])
    return NamedFiles(tuple(NamedFile(names[file], file, refused) for file, refused in meant.values()), tuple(skipped))


def _several(path: Path) -> list[tuple[Path, str]]:
    """Return the robot files that a folder or a pattern stands for, with the reasons not to read them."""
    tally = Tally(str(path))
    files: set[tuple[Path, str]] = set()
    for match in [path] if os.path.isdir(path) else matches(path, tally):
        if os.path.isdir(match):
            files |= set(below(match, is_named_as_robot, tally))
        elif is_named_as_robot(match.name) or is_case_file(match):
            files.add((match, ""))
    if len(files) > MAX_CASES:
        raise BadInput(f"{path}: stands for more than {MAX_CASES} files of robots; name fewer")
    ends = ", ".join(f"*{suffix}" for suffix in SUFFIXES)
    where = "in this folder or below it" if os.path.isdir(path) else "of this pattern"
    return sorted(files) or [(path, f"there is no robot file ({ends}) {where}")]
