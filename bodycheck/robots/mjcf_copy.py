"""Change the elements of an MJCF file so that it needs no files but the meshes that carry inertia.

https://mujoco.readthedocs.io/en/stable/XMLreference.html. Included files replace the elements that include them. Textures,
skins, plug-ins and the sizes of memory are removed, because no term of the equations of motion depends on them; a height field
is made flat. A mesh that carries no inertia is replaced by a small mesh, so that references to it stay valid. Bodies and joints
without names get names.
"""

from functools import partial
from pathlib import Path

from bodycheck.errors import BadInput
from bodycheck.robots import elements, mjcf_assembly, mjcf_meshes
from bodycheck.robots.elements import Element, place, quoted, refuse
from bodycheck.robots.named_files import Folders, NotFound, Removed, local, remove

#: Elements that are removed.
UNWANTED = {"texture", "skin", "plugin", "extension", "size", "layer"}


def prepare(
    root: Element,
    folders: Folders,
    into: Path,
    removed: Removed,
    needed: mjcf_meshes.Needed = mjcf_meshes.INERTIAL,
    absent: dict[str, str] | None = None,
) -> None:
    """Change the elements of an MJCF file so that they need no file but meshes, which are copied.

    Parameters
    ----------
    root
        The root of the file.
    folders
        The folders whose files may be read.
    into
        The folder of the copy.
    removed
        Counts of removed elements, to which this function adds.
    needed
        The meshes that are copied.
    absent
        The names of meshes that cannot be copied, with the reasons, to which this function adds; None if they are errors.

    Raises
    ------
    BadInput
        A file that is needed is not inside the folders, or the model needs something that is not copied.
    """
    paths = mjcf_assembly.include(root, folders.home / root.file, partial(_opened, folders))
    for element in root.everything():
        tag = local(element.tag)
        if tag == "attach" or (tag == "model" and "file" in element.attributes):
            refuse(element, None, "brings another model, which is not read here; write its bodies into this one")
        if tag == "flexcomp" and "file" in element.attributes:
            refuse(element, "file", "brings a deformable body, which is not read here")
        if tag == "hfield":
            _flatten(element, removed)
    mjcf_assembly.name(root)
    origins = {element: path.parent for element, path in paths.items()}
    kept = mjcf_meshes.prepare(root, folders, origins, into, removed, needed, absent)
    remove(root, lambda element: local(element.tag) in UNWANTED, kept, removed)


def _opened(folders: Folders, include: Element, near: Path) -> tuple[Path, Element]:
    """Return the path and the root element of the file that an `include` element in the file `near` names."""
    name = include.attributes.get("file", "")
    try:
        path = folders.find(name, (folders.home, near.parent))
    except NotFound as error:
        refuse(include, "file", f"{quoted(name)} {error}")
    try:
        return path, elements.read(path)
    except BadInput as error:
        raise BadInput(f"{place(include, 'file')}: {error}") from error


def _flatten(hfield: Element, removed: Removed) -> None:
    """Make a height field flat, which does not change the motion, because it has no inertia."""
    if "file" in hfield.attributes:
        name = Path(hfield.attributes["file"]).stem
        hfield.attributes.setdefault("name", name)
        del hfield.attributes["file"]
        removed.add(hfield, "file")
        hfield.attributes |= {"nrow": "2", "ncol": "2"}
