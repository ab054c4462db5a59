"""Write the copy of a robot model that engines get, from which nothing leads to another file than those written beside it.

A robot model comes from a stranger, and the readers of engines open whatever a model names. So engines get no file of a
stranger but one written anew from its elements: without document type definition, in UTF-8, and without what names files.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

from bodycheck.adapters.robot_reading import RobotFile
from bodycheck.files import writing
from bodycheck.robots import elements, mjcf_copy
from bodycheck.robots.elements import MAX_DEPTH, Element, refuse
from bodycheck.robots.named_files import Removed, folders, local, remove

#: Elements that are left out of the copy of a URDF: shapes to be seen, and what names or holds other files. Shapes for
#: collisions stay where they have sizes of their own.
UNWANTED = {
    "visual", "material", "mesh", "texture", "deformable", "reduced_deformable", "include", "plugin", "script", "size", "sdf",
    "uri", "url", "file", "filename",
}  # fmt: skip


def written(root: Element) -> bytes:
    """Return the content of an XML file with an element and everything in it.

    Raises `BadInput` if elements are nested more than `MAX_DEPTH` deep, as they may be after files have been put into others.
    """
    parts = ['<?xml version="1.0" encoding="UTF-8"?>\n']
    left: list[tuple[Element | str, int]] = [(root, 1)]
    while left:
        item, depth = left.pop()
        if isinstance(item, str):
            parts.append(item)
            continue
        if depth > MAX_DEPTH:
            refuse(item, None, f"elements are nested more than {MAX_DEPTH} deep")
        attributes = "".join(f" {name}={quoteattr(value)}" for name, value in item.attributes.items())
        text = "".join(escape(piece, {"\r": "&#13;"}) for piece in item.text)
        if not item.children and not text:
            parts.append(f"<{item.tag}{attributes}/>\n")
            continue
        parts.append(f"<{item.tag}{attributes}>{text or chr(10)}")
        left.append((f"</{item.tag}>\n", depth))
        left += [(child, depth + 1) for child in reversed(item.children)]
    return "".join(parts).encode("utf-8")


@dataclass(frozen=True)
class Checked:
    """A robot model for engines.

    Attributes
    ----------
    file
        The copy.
    removed
        What of the model is not in it, as phrases.
    """

    file: RobotFile
    removed: tuple[str, ...]


def checked(path: Path, packages: Sequence[Path], into: Path) -> Checked:
    """Write a copy of a robot model for engines.

    A URDF loses its meshes, and an MJCF those that carry no inertia. An MJCF file holds all files that it includes.

    Parameters
    ----------
    path
        The file, URDF or MJCF.
    packages
        Folders of packages.
    into
        A folder for the copy, which is this model's alone.

    Raises
    ------
    BadInput
        The file is not there, too large, no XML or no robot model, or an MJCF file needs another file that is not inside the
        folder of the model or those of packages.
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
    return Checked(copy, removed.phrases())


def _unwanted(element: Element) -> bool:
    """Return whether an element of a URDF is left out: one of `UNWANTED`, or a shape for collisions that has one in it."""
    if local(element.tag) in UNWANTED:
        return True
    return element.tag == "collision" and any(local(inner.tag) in UNWANTED for inner in element.everything())
