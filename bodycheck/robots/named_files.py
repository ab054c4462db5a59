"""Files that a robot model names: find them inside the folders that may be read, or remove what names them.

Files are read from the folder of the model and the folders of packages only. What remains must not make an engine open another
file.
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
        """Return what has been removed, each kind once, with its number."""
        return tuple(f"{kind} ({count})" for kind, count in sorted(self.counts.items()))


def remove(root: Element, unwanted: Callable[[Element], bool], kept: Collection[Element], removed: Removed) -> None:
    """Remove elements, and the attributes `PATHS` of all others.

    Parameters
    ----------
    root
        The element in which they are.
    unwanted
        Whether an element is removed, with everything in it.
    kept
        Elements whose attributes are kept.
    removed
        Where it is counted.
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
    """A file that a model names is outside the folders whose files may be read, or is not there; the text says so."""


@dataclass(frozen=True)
class Folders:
    """The folders whose files may be read, without symbolic links in their paths.

    Attributes
    ----------
    home
        The folder of the model.
    packages
        Folders of packages: each holds packages, or is one.
    """

    home: Path
    packages: tuple[Path, ...] = ()

    def find(self, name: str, bases: Sequence[Path]) -> Path:
        """Return the file of a name, without symbolic links in its path.

        Parameters
        ----------
        name
            What stands in the model: a path, or one in a package, as package://NAME/PATH.
        bases
            The folders from which a path begins, in the order in which they are tried.

        Raises
        ------
        NotFound
            No such file is inside the folders. Of what is outside nothing is told but that.
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
    """Return the folders from which files may be read for a model: that of its path as the user gave it, and the packages."""
    return Folders(model.parent.resolve(), tuple(package.resolve() for package in packages))
