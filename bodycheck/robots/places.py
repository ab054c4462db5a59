"""Find the files that a robot model names, inside the folder of the model and the folders of packages only."""

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

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
