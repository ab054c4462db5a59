"""Find the files that a robot model names inside the folders that may be read, or remove the references to them.

Files are read only from the folder of the model and the folders of packages. The remaining model must not make an engine open
any other file.
"""

import os
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from bodycheck.robots.elements import Element, quoted

#: Attributes by which elements of any format name files and folders. Readers of engines compare some without regard to case.
PATHS = {
    "assetdir", "content_type", "file", "fileback", "filedown", "filefront", "fileleft", "filename", "fileright", "fileup",
    "folder", "href", "library", "meshdir", "path", "plugin", "src", "texture", "texturedir", "uri", "url",
}  # fmt: skip


def local(name: str) -> str:
    """Return the name of an element or attribute in small letters and without its prefix."""
    return name.rpartition(":")[2].lower()


class Removed:
    """Counts what has been removed, by a phrase for its kind."""

    def __init__(self) -> None:
        self.counts = Counter[str]()

    def add(self, element: Element, attribute: str | None = None) -> None:
        """Count an element, or an attribute of it."""
        tag = quoted(element.tag)[1:-1]
        self.counts[f"<{tag}>" if attribute is None else f"{quoted(attribute)[1:-1]} of <{tag}>"] += 1

    def phrases(self) -> tuple[str, ...]:
        """Return a phrase for each kind of removed element or attribute, with its count."""
        return tuple(f"{kind} ({count})" for kind, count in sorted(self.counts.items()))


def remove(root: Element, unwanted: Callable[[Element], bool], kept: Collection[Element], removed: Removed) -> None:
    """Remove elements, and the attributes `PATHS` of all others.

    Parameters
    ----------
    root
        The element that contains them.
    unwanted
        Function that returns whether an element is removed, with everything in it.
    kept
        Elements that keep their attributes.
    removed
        Counts of removed elements and attributes, to which this function adds.
    """
    for element in root.everything():
        for child in element.children:
            if unwanted(child):
                removed.add(child)
        element.children = [child for child in element.children if not unwanted(child)]
        if element in kept:
            continue
        for name in [name for name in element.attributes if local(name) in PATHS]:
            removed.add(element, name)
            del element.attributes[name]


#: The beginnings of names of files in packages.
SCHEMES = ("package://", "model://")


class NotFound(Exception):
    """Raised if a file that a model names is missing or outside the folders that may be read; the text says which."""


@dataclass(frozen=True)
class Folders:
    """The folders whose files may be read, without symbolic links in their paths.

    Attributes
    ----------
    home
        The folder of the model.
    packages
        Folders that contain packages or are packages.
    """

    home: Path
    packages: tuple[Path, ...] = ()

    def find(self, name: str, bases: Sequence[Path]) -> Path:
        """Return the path of a named file, without symbolic links.

        Parameters
        ----------
        name
            The name in the model: a path, or a path in a package, as package://NAME/PATH.
        bases
            The folders that a path may be relative to, in the order in which they are tried.

        Raises
        ------
        NotFound
            No such file is inside the folders. The text says nothing else about files outside them.
        """
        inside = False
        for candidate in self._candidates(name, bases):
            try:
                path = candidate.resolve()
            except (OSError, RuntimeError, ValueError):  # a name that is too long, links in a circle, a null character
                continue
            if any(path.is_relative_to(folder) for folder in (self.home, *self.packages)):
                inside = True
                if os.path.isfile(path):  # False also for a name that is too long
                    return path
        raise NotFound("is not there" if inside else "is outside the folder of the model and those of --package-path")

    def _candidates(self, name: str, bases: Sequence[Path]) -> Iterator[Path]:
        scheme = next((scheme for scheme in SCHEMES if name.startswith(scheme)), None)
        if scheme is not None:
            package, _, rest = name.removeprefix(scheme).partition("/")
            for folder in self.packages:
                yield folder / package / rest
                if folder.name == package:
                    yield folder / rest
        elif "://" not in name:
            yield from (base / name for base in bases)


def folders(model: Path, packages: Sequence[Path]) -> Folders:
    """Return the folders from which files may be read for a model: the folder of its path as given, and the packages."""
    return Folders(model.parent.resolve(), tuple(package.resolve() for package in packages))
