"""Write the copy of a robot model that engines get, which refers to no files but the copies written beside it.

A robot model comes from a stranger, and the readers of engines open whatever a model names. Engines therefore get a file that
is written anew from the elements of the stranger's file: in UTF-8, without a document type definition, and without references
to other files.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from bodycheck.adapters.robot_reading import RobotFile
from bodycheck.files import writing
from bodycheck.robots import elements, mjcf_copy
from bodycheck.robots.elements import MAX_DEPTH, Element, refuse
from bodycheck.robots.named_files import Removed, folders, local, remove

#: Elements that are left out of the copy of a URDF: visual shapes, and elements that name or contain other files. Collision
#: shapes stay if they state their sizes.
UNWANTED = {
    "visual", "material", "mesh", "texture", "deformable", "reduced_deformable", "include", "plugin", "script", "size", "sdf",
    "uri", "url", "file", "filename",
}  # fmt: skip


def written(root: Element) -> bytes:
    """Return the content of an XML file that contains an element and everything in it.

    Raises `BadInput` if elements are nested more than `MAX_DEPTH` deep, as they may be after files have been included in
    others.
    """
    return "".join(piece for piece, _ in _pieces(root)).encode("utf-8")


def sources(root: Element) -> dict[int, str]:
    """Return the file and the line of each element, as in `robot.xml:12`, by the line at which it starts in `written(root)`."""
    places: dict[int, str] = {}
    line = 1
    for piece, element in _pieces(root):
        places |= {} if element is None else {line: f"{element.file}:{element.line}"}
        line += piece.count("\n")
    return places


def _pieces(root: Element) -> Iterator[tuple[str, Element | None]]:
    """Yield the text of a file that contains an element in pieces, each with the element that starts with it."""
    from xml.sax.saxutils import escape, quoteattr  # it imports urllib and ssl, and only robots' files need it

    yield '<?xml version="1.0" encoding="UTF-8"?>\n', None
    left: list[tuple[Element | str, int]] = [(root, 1)]
    while left:
        item, depth = left.pop()
        if isinstance(item, str):
            yield item, None
            continue
        if depth > MAX_DEPTH:
            refuse(item, None, f"elements are nested more than {MAX_DEPTH} deep")
        attributes = "".join(f" {name}={quoteattr(value)}" for name, value in item.attributes.items())
        text = "".join(escape(piece, {"\r": "&#13;"}) for piece in item.text)
        if not item.children and not text:
            yield f"<{item.tag}{attributes}/>\n", item
            continue
        yield f"<{item.tag}{attributes}>{text or chr(10)}", item
        left.append((f"</{item.tag}>\n", depth))
        left += [(child, depth + 1) for child in reversed(item.children)]


@dataclass(frozen=True)
class Checked:
    """A robot model for engines.

    Attributes
    ----------
    file, root
        The copy, and its elements.
    removed
        Phrases for the parts of the model that the copy lacks.
    """

    file: RobotFile
    root: Element
    removed: tuple[str, ...]


def checked(path: Path, packages: Sequence[Path], into: Path) -> Checked:
    """Write a copy of a robot model for engines.

    The copy of a URDF has no meshes, and the copy of an MJCF file only the meshes that carry inertia. The copy of an MJCF file
    contains all files that the original includes.

    Parameters
    ----------
    path
        The file, URDF or MJCF.
    packages
        Folders of packages.
    into
        A folder for the copy, which no other model uses.

    Raises
    ------
    BadInput
        The file does not exist, is too large, or is no XML or no robot model, or an MJCF file needs another file that is not
        inside the folder of the model or the folders of packages.
    NotWritten
        The copy cannot be written.
    """
    root = elements.read(path)
    removed = Removed()
    match root.tag:
        case "robot":
            remove(root, _unwanted, (), removed)
            copy = RobotFile(str(into / "robot.urdf"), "urdf")
        case "mujoco":
            mjcf_copy.prepare(root, folders(path, packages), into, removed)
            copy = RobotFile(str(into / "robot.xml"), "mjcf")
        case _:
            elements.refuse_root(root)
    writing.write(Path(copy.path), written(root))
    return Checked(copy, root, removed.phrases())


def _unwanted(element: Element) -> bool:
    """Return whether an element of a URDF is left out: an element of `UNWANTED`, or a collision shape that contains one."""
    if local(element.tag) in UNWANTED:
        return True
    return element.tag == "collision" and any(local(inner.tag) in UNWANTED for inner in element.everything())
