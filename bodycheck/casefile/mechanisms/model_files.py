"""The files of a robot model: the model itself, and the files that it may name, each with its digest.

Includes and meshes lie in the folder of the model or below it, or in folders of packages that the user named.
"""

from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path, PurePosixPath

from bodycheck.errors import BadInput
from bodycheck.files import reading
from bodycheck.robots import elements
from bodycheck.robots.elements import quoted
from bodycheck.robots.named_files import Folders, NotFound, folders

#: Limits in bytes of one file, and of all files of a model together. A file that is read twice counts twice.
LIMITS = {"texts": (elements.MAX_BYTES, elements.MAX_BYTES), "meshes": (64 << 20, 256 << 20)}

#: The largest number of files of a model.
MAX_FILES = 1000


class ModelFiles:
    """The files that are read for a robot model.

    Attributes
    ----------
    texts
        The contents of the texts, by their names: paths from the folder of the model, or in a package. The model comes first.
    digests
        The SHA-256 digests of all files, by their names.
    """

    def __init__(self, model: Path, packages: Sequence[Path] = (), follow: bool = False) -> None:
        """Read a model.

        model: the path of its file. packages: the folders of packages. follow: whether the path itself may be a symbolic link.

        Raises `BadInput` if the model is missing, no regular file, too large or not UTF-8.
        """
        self.folders: Folders = folders(model, packages)
        self.texts: dict[str, str] = {}
        self.digests: dict[str, str] = {}
        self.sizes = dict.fromkeys(LIMITS, 0)
        self._keep(model.name, self._read(model, "texts", follow))

    def text(self, name: str, near: str) -> tuple[str, str]:
        """Return the path, from the folder of the robot, and the text of a named file. near: the path of the naming file.

        Raises `NotFound` if it is missing or elsewhere, and `BadInput` if it cannot be read.
        """
        bases = (self.folders.home, self._folder(near))
        path = self.folders.find(name, bases)
        inside = self._name_inside(path)
        return inside, self._keep(inside, self._read(path, "texts"))

    def content(self, name: str) -> bytes:
        """Return the content of a named mesh. Its path is relative to the folder of the robot, or in a package.

        Raises as `text` does.
        """
        path = self.folders.find(name, (self.folders.home,))
        content = self._read(path, "meshes")
        self._digest(self._name_inside(path), content)
        return content

    def _read(self, path: Path, kind: str, follow: bool = False) -> bytes:
        """Return the content of a file of a kind of `LIMITS`. Raises `BadInput` if it cannot be read or is too large."""
        shown, (most, in_all) = quoted(path.name)[1:-1], LIMITS[kind]
        try:
            content = reading.content(path, most, follow)
        except reading.Refused as error:
            raise BadInput(f"{shown}: {error.reason}") from error
        except OSError as error:
            raise BadInput(f"{shown}: cannot be read: {error.strerror}") from error
        except ValueError as error:  # a path with a null character
            raise BadInput(f"{shown}: cannot be read: {error}") from error
        self.sizes[kind] += len(content)
        if self.sizes[kind] > in_all:
            raise BadInput(f"{shown}: the {kind} of the model are larger than {in_all} bytes in all, the limit for them")
        return content

    def _keep(self, name: str, content: bytes) -> str:
        try:
            self.texts[name] = content.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            raise BadInput(f"{quoted(name)[1:-1]}: cannot be read: it is not UTF-8") from error
        self._digest(name, content)
        return self.texts[name]

    def _digest(self, name: str, content: bytes) -> None:
        self.digests[name] = sha256(content).hexdigest()
        if len(self.digests) > MAX_FILES:
            raise BadInput(f"{quoted(name)[1:-1]}: the model names more than {MAX_FILES} files")

    def _name_inside(self, path: Path) -> str:
        """Return the path of a file from the folder of the model, or in a package, with slashes."""
        if path.is_relative_to(self.folders.home):
            return path.relative_to(self.folders.home).as_posix()
        package = next(folder for folder in self.folders.packages if path.is_relative_to(folder))
        return f"package://{package.name}/{path.relative_to(package).as_posix()}"

    def _folder(self, inside: str) -> Path:
        """Return the folder of a file with a name that `text` returned."""
        for package in self.folders.packages:
            if inside.startswith(start := f"package://{package.name}/"):
                return package / PurePosixPath(inside.removeprefix(start)).parent
        return self.folders.home / PurePosixPath(inside).parent


class NoFiles:
    """The files of a model of which only the text of the model is at hand: none."""

    def text(self, name: str, near: str) -> tuple[str, str]:
        """Raise `NotFound`."""
        raise NotFound("is not there, as only the text of the model is stored")

    def content(self, name: str) -> bytes:
        """Raise `NotFound`."""
        raise NotFound("is not there, as only the text of the model is stored")
