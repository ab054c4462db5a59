"""Change the elements of an MJCF file so that it needs no files but the meshes that carry inertia.

https://mujoco.readthedocs.io/en/stable/XMLreference.html. Included files replace the elements that include them. Textures,
skins, plug-ins and the sizes of memory are removed, because no term of the equations of motion depends on them; a height field
is made flat. The copy of a whole scene keeps height fields and the sizes of its arrays, and has no plug-ins. A mesh that
carries no inertia is replaced by a small mesh, so that references to it stay valid. Bodies and joints without names get names.
"""

from functools import partial
from pathlib import Path

from bodycheck.errors import BadInput
from bodycheck.files import reading, writing
from bodycheck.robots import elements, mjcf_assembly, mjcf_meshes
from bodycheck.robots.elements import Element, place, quoted, refuse
from bodycheck.robots.named_files import Folders, NotFound, Removed, local, remove

#: Elements that are removed, and those of them that the copy of a whole scene keeps.
UNWANTED = {"texture", "skin", "plugin", "extension", "size", "layer"}
OF_SCENES = {"size"}

#: The attributes of sizes that allocate memory, which a whole scene gets as it needs it.
MEMORY = ("memory", "njmax", "nconmax", "nstack")

#: The largest size of the file of a height field.
MAX_FIELD_BYTES = 64 << 20


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
        if tag == "hfield" and not needed.whole:
            _flatten(element, removed)
        if tag == "plugin" and needed.whole:
            refuse(element, None, "needs a plug-in, and none is loaded for files of robots")
        if tag == "size":
            element.attributes = {name: value for name, value in element.attributes.items() if name not in MEMORY}
    mjcf_assembly.name(root)
    origins = {element: path.parent for element, path in paths.items()}
    fields = _copy_fields(root, folders, origins, into) if needed.whole else frozenset()
    kept = fields | mjcf_meshes.prepare(root, folders, origins, into, removed, needed, absent)
    unwanted = UNWANTED - OF_SCENES if needed.whole else UNWANTED
    remove(root, lambda element: local(element.tag) in unwanted, kept, removed)


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


def _copy_fields(root: Element, folders: Folders, origins: dict[Element, Path], into: Path) -> frozenset[Element]:
    """Copy the files of height fields, and return the elements that name the copies. Raises `BadInput`."""
    below = mjcf_meshes.folder(root)
    kept: set[Element] = set()
    for element in root.everything():
        if local(element.tag) != "hfield" or "file" not in element.attributes:
            continue
        name = element.attributes["file"]
        element.attributes.setdefault("name", Path(name.replace("\\", "/")).stem)
        try:
            path = folders.find(name, (folders.home / below, origins[element] / below, folders.home))
            data = reading.content(path, MAX_FIELD_BYTES)
        except NotFound as error:
            refuse(element, "file", f"{quoted(name)} {error}")
        except reading.Refused as error:
            refuse(element, "file", f"{quoted(name)}: {error.reason}")
        except OSError as error:
            refuse(element, "file", f"{quoted(name)} cannot be read: {error.strerror}")
        element.attributes["file"] = f"field-{len(kept)}{'.png' if path.suffix.lower() == '.png' else '.bin'}"
        writing.write(into / element.attributes["file"], data)
        kept.add(element)
    return frozenset(kept)


def _flatten(hfield: Element, removed: Removed) -> None:
    """Make a height field flat, which does not change the motion, because it has no inertia."""
    if "file" in hfield.attributes:
        name = Path(hfield.attributes["file"]).stem
        hfield.attributes.setdefault("name", name)
        del hfield.attributes["file"]
        removed.add(hfield, "file")
        hfield.attributes |= {"nrow": "2", "ncol": "2"}
