"""Digests of the packages in folders, by which a change of an installation is detected without reading its files."""

import os
from collections.abc import Iterable, Iterator
from hashlib import sha256
from importlib.machinery import all_suffixes
from pathlib import Path

#: A file's name or path, its size in bytes, and the time of its last change in ns.
Stated = tuple[str, int, int]

#: The ends of the names of modules.
SUFFIXES = tuple(all_suffixes())


def of_distributions(folders: Iterable[Path]) -> str:
    """Return a digest of the distributions that are installed in folders, and of the modules that lie there on their own.

    It does not depend on other files, so that work in one of the folders does not change it. Missing folders count as empty.
    """
    return _digest(sorted(file for folder in folders for file in _distributions(folder)))


def of_files(files: Iterable[Path]) -> str:
    """Return a digest of the sizes and times of files."""
    return _digest(sorted(file for path in files for file in _stated(str(path))))


def of_folders(folders: Iterable[Path]) -> str:
    """Return a digest of all files in folders and their subfolders, apart from bytecode."""
    return _digest(sorted(file for folder in folders for file in _files(folder)))


def _distributions(folder: Path) -> Iterator[Stated]:
    try:
        with os.scandir(folder) as entries:
            for entry in entries:
                if entry.name.endswith(".dist-info"):
                    yield from _stated(os.path.join(entry.path, "RECORD"))
                elif entry.name.endswith(SUFFIXES):
                    yield from _stated(entry.path)
    except OSError:  # sys.path may name files, and folders that do not exist
        return


def _files(folder: Path) -> Iterator[Stated]:
    for parent, folders, names in os.walk(folder):
        if "__pycache__" in folders:
            folders.remove("__pycache__")
        for name in names:
            yield from _stated(os.path.join(parent, name))


def _stated(path: str) -> Iterator[Stated]:
    """Yield the statement about a file, or nothing if there is no such file."""
    try:
        status = os.stat(path)
    except OSError:
        return
    yield path, status.st_size, status.st_mtime_ns


def _digest(files: list[Stated]) -> str:
    return sha256(repr(files).encode("utf-8", "surrogatepass")).hexdigest()
