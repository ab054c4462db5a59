"""Copy the meshes of an MJCF file that carry inertia, and replace each other mesh by a small one.

A mesh carries inertia if a geom uses it in a body without an <inertial>, or if the compiler takes all inertia from geoms.
Meshes are files of strangers too: only files up to a size, and only from the allowed folders, are copied.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from bodycheck.errors import BadInput
from bodycheck.files import reading, writing
from bodycheck.robots.elements import Element, place, quoted, refuse
from bodycheck.robots.named_files import Folders, NotFound, Removed, local

#: The kinds of files that are copied, and the largest size of all of them together.
SUFFIXES = (".stl", ".obj", ".msh")
MAX_BYTES = 256 << 20

#: The first words of the lines of an OBJ file that are copied. Other lines may name files of materials.
OBJ_WORDS = (b"v", b"vn", b"vt", b"f", b"o", b"g", b"s", b"l", b"p")

#: The attributes of the mesh that replaces a mesh without inertia: four corners of a cube with edges of 1 m.
SMALL = {"vertex": "0 0 0 1 0 0 0 1 0 0 0 1", "scale": "1 1 1"}


@dataclass(frozen=True)
class Needed:
    """The files that a copy of a model needs.

    Attributes
    ----------
    names
        A function from the root of the model to the names of the meshes.
    what
        What these meshes do, for messages.
    whole
        Whether everything that acts on the motion of the whole scene is needed: also height fields and sizes, and no plug-ins.
    """

    names: Callable[[Element], set[str]]
    what: str
    whole: bool = False


def prepare(
    root: Element,
    folders: Folders,
    origins: dict[Element, Path],
    into: Path,
    removed: Removed,
    needed: Needed,
    absent: dict[str, str] | None = None,
) -> frozenset[Element]:
    """Copy the meshes that are needed, and return the elements that name the copies.

    Parameters
    ----------
    root
        The root of the model.
    folders
        The folders whose files may be read.
    origins
        The folder of the file that each element comes from.
    into
        The folder of the copy.
    removed
        The counts of removed attributes, to which this function adds the files that are not copied.
    needed
        The meshes that are copied.
    absent
        The names of meshes that are needed, but cannot be copied, each with the reason, to which this function adds; small
        meshes replace them. None if such a mesh is an error.

    Raises
    ------
    BadInput
        A mesh that is needed is not inside the folders, is too large, or is not one of the kinds in `SUFFIXES`.
    """
    copied = needed.names(root)
    below, stripped = folder(root), _stripped(root)
    kept: set[Element] = set()
    room = MAX_BYTES
    for mesh in _meshes(root):
        file = mesh.attributes["file"]
        name = mesh.attributes.setdefault("name", _stem(file))
        if name not in copied:
            mesh.attributes = {"name": name, **SMALL}
            removed.add(mesh, "file")
            continue
        wanted = file.replace("\\", "/").rpartition("/")[2] if stripped else file
        bases = (folders.home / below, origins[mesh] / below, folders.home)
        try:
            data, suffix = content(mesh, wanted, bases, folders, room, needed.what)
        except BadInput as error:
            if absent is None:
                raise
            mesh.attributes = {"name": name, **SMALL}
            absent[name] = str(error)
            continue
        room -= len(data)
        copy = f"mesh-{len(kept)}{suffix}"
        writing.write(into / copy, data)
        mesh.attributes["file"] = copy
        kept.add(mesh)
    for geom in root.everything():
        if absent and local(geom.tag) == "geom" and geom.attributes.get("mesh") in absent:
            geom.attributes["type"] = "mesh"  # no other shape is fitted to the small mesh
    return frozenset(kept)


def _meshes(root: Element) -> Iterator[Element]:
    """Yield the mesh elements that name a file."""
    for element in root.everything():
        if local(element.tag) == "asset":
            yield from (mesh for mesh in element.children if local(mesh.tag) == "mesh" and "file" in mesh.attributes)


def _stem(file: str) -> str:
    """Return the default name of a mesh with a file: the name of the file without folder and ending."""
    return PurePosixPath(file.replace("\\", "/")).stem


def _compilers(root: Element, attribute: str) -> list[str]:
    """Return the values of an attribute of the <compiler> elements, in their order; the last value counts."""
    return [
        element.attributes[attribute]
        for element in root.everything()
        if local(element.tag) == "compiler" and attribute in element.attributes
    ]


def folder(root: Element) -> str:
    """Return the path of the folder of meshes, relative to the folder of the model."""
    folders = _compilers(root, "meshdir") or _compilers(root, "assetdir")
    return folders[-1] if folders else ""


def _stripped(root: Element) -> bool:
    """Return whether folders are removed from the names of files."""
    return _compilers(root, "strippath")[-1:] == ["true"]


def carriers(root: Element) -> set[str]:
    """Return the names of the meshes that may carry inertia."""
    everywhere = "true" in _compilers(root, "inertiafromgeom")
    names = set()
    left = [(child, False, "") for child in root.children]
    while left:
        element, counts, parent = left.pop()
        tag = local(element.tag)
        if tag == "body":
            counts = everywhere or not any(local(child.tag) == "inertial" for child in element.children)
        if tag in ("geom", "composite", "flexcomp") and (counts or parent == "default"):
            names.add(element.attributes.get("mesh", ""))
        left += [(child, counts, tag) for child in element.children]
    return names


def content(mesh: Element, name: str, bases: Sequence[Path], folders: Folders, room: int, what: str) -> tuple[bytes, str]:
    """Return the content of the file of a mesh, and the ending of its name.

    what: what the shape does, for messages. Raises `BadInput` if the file cannot be copied.
    """
    attribute = "file" if "file" in mesh.attributes else "filename"
    try:
        path = folders.find(name, bases)
    except NotFound as error:
        refuse(mesh, attribute, f"{quoted(name)} {error}, and its shape {what}")
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        refuse(mesh, attribute, f"read {quoted(name)}; allowed where a shape {what}: {', '.join(SUFFIXES)}")
    try:
        data = reading.content(path, room)
    except reading.Refused as error:
        raise BadInput(f"{place(mesh, attribute)}: {quoted(name)}: {error.reason}") from error
    except OSError as error:
        raise BadInput(f"{place(mesh, attribute)}: {quoted(name)} cannot be read: {error.strerror}") from error
    return (_plain_obj(data) if suffix == ".obj" else data), suffix


def of_shapes(root: Element) -> set[str]:
    """Return the names of the meshes of all shapes."""
    return {element.attributes.get("mesh", "") for element in root.everything() if local(element.tag) == "geom"}


#: The meshes that carry inertia, those of all shapes, which may touch, and everything that acts on a motion.
INERTIAL, TOUCHING = Needed(carriers, "carries inertia"), Needed(of_shapes, "may touch others")
WHOLE = Needed(of_shapes, TOUCHING.what, whole=True)


def _plain_obj(content: bytes) -> bytes:
    """Return an OBJ file without the lines that name other files."""
    joined = content.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ")
    lines = (line for line in joined.splitlines() if line.split(maxsplit=1)[:1] and line.split(maxsplit=1)[0] in OBJ_WORDS)
    return b"\n".join(lines) + b"\n"
