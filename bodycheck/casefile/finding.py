"""Find the cases that a user names: by the name of a shipped case, a path of a case file or of a robot's file, a folder or a
pattern.

A folder stands for every case file in it and in the folders below it, or for every robot's file if there is no case file there:
robots beside case files are commonly their models. A repository may come from a stranger: links to folders are not followed,
links to files only within the named folder, and the number of entries is bounded.
"""

import fnmatch
import os
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from pathlib import Path

from bodycheck.casefile.robots.named import SUFFIXES, is_named_as_robot, may_be_robot
from bodycheck.errors import BadInput

#: The end of the names of case files.
SUFFIX = ".case.toml"

#: The largest number of files and folders that are searched for one argument, and of case files that it may stand for.
MAX_ENTRIES = 200_000
MAX_CASES = 10_000

#: The names of the files that may be cases, as messages state them.
OF_CASES = f"case file (*{SUFFIX}) or robot's file ({', '.join(f'*{suffix}' for suffix in SUFFIXES)})"

#: Folders that hold files of others, like hidden folders and virtual environments: installed packages contain case files.
OTHERS_FOLDERS = frozenset({"build", "dist", "node_modules", "__pycache__"})

#: The file by which a folder is known to be a virtual environment.
ENVIRONMENT = "pyvenv.cfg"

#: The characters that make a path a pattern, and the part that stands for any number of folders.
WILD = re.compile(r"[*?\[]")
ANY_FOLDERS = "**"


def is_case_file(path: str | Path) -> bool:
    """Return whether a path has the name of a case file."""
    return Path(path).name.endswith(SUFFIX)


def named(arguments: Sequence[str], shipped: Collection[str]) -> tuple[str, ...]:
    """Return the names of shipped cases and the paths of case files and robots' files that arguments stand for, each once.

    Parameters
    ----------
    arguments
        Each is the name of a shipped case, a path, a folder, or a pattern of paths with `*`, `?`, `[...]` or `**`. A pattern
        that no path matches may match names of shipped cases. The order is that of the arguments; a folder and a pattern give
        sorted paths. An argument that is none of these is returned as it is, so that loading it says what is wrong.
    shipped
        The names of the shipped cases.

    Raises
    ------
    BadInput
        A folder or a pattern stands for no file, or for more than `MAX_CASES`; more than `MAX_ENTRIES` files and folders
        must be searched; a folder cannot be read; a link in a folder has the name of such a file and leads out of the folder.
    """
    paths: dict[str, str] = {}
    for argument in arguments:
        for name in _meant(argument, shipped):
            paths.setdefault(name if name in shipped else os.path.realpath(name), name)
    return tuple(paths.values())


def _meant(argument: str, shipped: Collection[str]) -> Sequence[str]:
    """Return the names and paths that one argument stands for."""
    if argument in shipped or "\0" in argument:
        return [argument]
    path, tally = Path(argument), Tally(argument)
    if _is_folder(path):
        files = _cases_or_robots(_below(path, tally))
        if not files:
            raise BadInput(f"{argument}: there is no {OF_CASES} in this folder or below it")
    elif is_pattern(argument):
        files = _cases_or_robots(file for match in matches(path, tally) for file in _cases_at(match, tally))
        if not files:
            names = fnmatch.filter(sorted(shipped), argument)
            if not names:
                raise BadInput(f"{argument}: no {OF_CASES} and no shipped case matches this pattern")
            return names
    else:
        return [argument]
    if len(files) > MAX_CASES:
        raise BadInput(f"{argument}: stands for more than {MAX_CASES} case files or robots' files; name fewer")
    return [str(file) for file in files]


def _cases_or_robots(files: Iterable[tuple[Path, str]]) -> list[Path]:
    """Return the sorted case files among files, or the robots' files if there is no case file.

    files: with the reasons not to read them. Raises `BadInput` for a file that is meant and must not be read.
    """
    sorted_files = sorted(set(files))
    cases = [(path, refused) for path, refused in sorted_files if is_case_file(path)]
    meant = cases or [(path, refused) for path, refused in sorted_files[: MAX_CASES + 1] if refused or may_be_robot(path)]
    for path, refused in meant:
        if refused:
            raise BadInput(f"{path}: {refused}")
    return [path for path, _ in meant]


def is_pattern(argument: str) -> bool:
    """Return whether an argument is a pattern of paths, and not a path that exists."""
    return WILD.search(argument) is not None and not os.path.lexists(argument)


def matches(pattern: Path, tally: "Tally") -> Iterator[Path]:
    """Yield the files and folders that match a pattern."""
    first, parts = (Path(pattern.anchor), pattern.parts[1:]) if pattern.anchor else (Path(), pattern.parts)
    yield from _matches(first, parts, tally)


class Tally:
    """A count of the files and folders that are searched for an argument."""

    def __init__(self, argument: str) -> None:
        self.argument, self.entries = argument, 0

    def add(self, count: int) -> None:
        """Add to the count. Raises `BadInput` if it exceeds `MAX_ENTRIES`."""
        self.entries += count
        if self.entries > MAX_ENTRIES:
            raise BadInput(f"{self.argument}: has more than {MAX_ENTRIES} files and folders; name a smaller folder")


def below(folder: Path, wanted: Callable[[str], bool], tally: Tally) -> Iterator[tuple[Path, str]]:
    """Yield the files of some names in a folder and in the folders below it, each with the reason why it must not be read.

    The reason is empty except for a link that leads out of the folder. wanted: whether a file of a name is meant. Raises
    `BadInput` if a folder cannot be read, or there are too many files and folders for the tally.
    """
    root = os.path.join(os.path.realpath(folder), "")
    for _, entries in _folders(folder, tally):
        for entry in entries:
            if wanted(entry.name) and not entry.is_dir():
                outside = entry.is_symlink() and not os.path.realpath(entry.path).startswith(root)
                yield (
                    Path(entry.path),
                    f"is a link that leads out of {folder}; name the file that it leads to" if outside else "",
                )


def _below(folder: Path, tally: Tally) -> Iterator[tuple[Path, str]]:
    """Yield the case files and robots' files in a folder and in the folders below it, with the reasons not to read them."""
    return below(folder, _may_be_case, tally)


def _may_be_case(name: str) -> bool:
    return is_case_file(name) or is_named_as_robot(name)


def _folders(folder: Path, tally: Tally) -> Iterator[tuple[Path, list[os.DirEntry[str]]]]:
    """Yield a folder and the folders below it, each with its entries, without links to folders and folders of others."""
    left = [folder]
    while left:
        inside = left.pop()
        entries = _entries(inside, tally)
        if inside != folder and any(entry.name == ENVIRONMENT for entry in entries):
            continue
        yield inside, entries
        left += [Path(entry.path) for entry in entries if entry.is_dir(follow_symlinks=False) and _is_own(entry.name)]


def _is_own(name: str) -> bool:
    """Return whether a file or folder of this name may be the user's."""
    return not name.startswith(".") and name not in OTHERS_FOLDERS


def _matches(folder: Path, parts: Sequence[str], tally: Tally) -> Iterator[Path]:
    """Yield the files and folders below a folder whose path from there matches the parts of a pattern."""
    if not parts:
        yield folder
    elif parts[0] == ANY_FOLDERS:
        for inside, _ in _folders(folder, tally):
            yield from _matches(inside, parts[1:], tally)
    elif not WILD.search(parts[0]):
        if os.path.lexists(folder / parts[0]):
            yield from _matches(folder / parts[0], parts[1:], tally)
    elif _is_folder(folder):
        for entry in _entries(folder, tally):
            path = Path(entry.path)
            if fnmatch.fnmatch(entry.name, parts[0]) and _is_own(entry.name) and not os.path.lexists(path / ENVIRONMENT):
                yield from _matches(path, parts[1:], tally)


def _cases_at(path: Path, tally: Tally) -> Iterator[tuple[Path, str]]:
    """Yield the files at a path that a pattern matches: those in a folder, or the file itself if it may be a case."""
    if _is_folder(path):
        yield from _below(path, tally)
    elif _may_be_case(path.name):
        yield path, ""


def _is_folder(path: Path) -> bool:
    try:
        return path.is_dir()
    except OSError:  # a name that is too long; loading says so
        return False


def _entries(folder: Path, tally: Tally) -> list[os.DirEntry[str]]:
    """Return the entries of a folder. Raises `BadInput` if it cannot be read."""
    files_and_folders = []
    try:
        with os.scandir(folder) as entries:
            for entry in entries:
                tally.add(1)
                files_and_folders.append(entry)
    except OSError as error:
        raise BadInput(f"{folder}: cannot be read: {error.strerror}") from error
    return files_and_folders
