"""Change the elements of an MJCF file so that it needs no files but the meshes that carry inertia.

https://mujoco.readthedocs.io/en/stable/XMLreference.html. Included files replace the elements that include them. Textures,
skins, plug-ins and the sizes of memory are removed, because no term of the equations of motion depends on them; a height field
is made flat. A mesh that carries no inertia is replaced by a small mesh, so that references to it stay valid. Bodies and joints
without names get names, because engines would give them different names, so that results could not be assigned to bodies and
joints.
"""

from collections.abc import Mapping
from pathlib import Path

from bodycheck.errors import BadInput
from bodycheck.robots import elements, mjcf_meshes
from bodycheck.robots.elements import MAX_ELEMENTS, Element, place, quoted, refuse
from bodycheck.robots.named_files import Folders, NotFound, Removed, local, remove

#: Elements that are removed.
UNWANTED = {"texture", "skin", "plugin", "extension", "size", "layer"}

#: The elements that get names, with the beginnings of the names and the elements that contain them.
NAMED: Mapping[str, str] = {"body": "body", "joint": "joint", "freejoint": "joint"}
AROUND = {"worldbody", "body", "frame", "replicate"}

#: Most files that are included.
MAX_INCLUDES = 200


def prepare(
    root: Element, folders: Folders, into: Path, removed: Removed, needed: mjcf_meshes.Needed = mjcf_meshes.INERTIAL
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

    Raises
    ------
    BadInput
        A file that is needed is not inside the folders, or the model needs something that is not copied.
    """
    origins = _include(root, folders)
    for element in root.everything():
        tag = local(element.tag)
        if tag == "attach" or (tag == "model" and "file" in element.attributes):
            refuse(element, None, "brings another model, which is not read here; write its bodies into this one")
        if tag == "flexcomp" and "file" in element.attributes:
            refuse(element, "file", "brings a deformable body, which is not read here")
        if tag == "hfield":
            _flatten(element, removed)
    _name(root)
    kept = mjcf_meshes.prepare(root, folders, origins, into, removed, needed)
    remove(root, lambda element: local(element.tag) in UNWANTED, kept, removed)


def _include(root: Element, folders: Folders) -> dict[Element, Path]:
    """Replace the `include` elements by the content of their files, and return the folder of the file of each element.

    Raises `BadInput` for a file that cannot be read, is included twice, or makes the model too large.
    """
    origins: dict[Element, Path] = {}
    included: set[Path] = set()
    left = [(root, folders.home)]
    while left:
        element, folder = left.pop()
        origins[element] = folder
        if len(origins) > MAX_ELEMENTS:
            refuse(element, None, f"the model has more than {MAX_ELEMENTS} elements with those that it includes")
        children = []
        next_ones = [(child, folder) for child in reversed(element.children)]
        while next_ones:
            child, within = next_ones.pop()
            if local(child.tag) != "include":
                children.append((child, within))
                continue
            path, content = _content(child, within, folders, included)
            next_ones += [(inner, path.parent) for inner in reversed(content.children)]
        element.children = [child for child, _ in children]
        left += reversed(children)
    return origins


def _content(include: Element, folder: Path, folders: Folders, included: set[Path]) -> tuple[Path, Element]:
    """Return the path and the root element of a file that an `include` element in a file of `folder` names."""
    name = include.attributes.get("file", "")
    try:
        path = folders.find(name, (folders.home, folder))
    except NotFound as error:
        refuse(include, "file", f"{quoted(name)} {error}")
    if path in included:
        refuse(include, "file", f"{quoted(name)} is included twice")
    if len(included) == MAX_INCLUDES:
        refuse(include, "file", f"more than {MAX_INCLUDES} files are included")
    included.add(path)
    try:
        return path, elements.read(path)
    except BadInput as error:
        raise BadInput(f"{place(include, 'file')}: {error}") from error


def _name(root: Element) -> None:
    """Name the bodies and joints without a name: each gets its kind and the first number that makes its name unique."""
    taken = {element.attributes.get("name", "") for element in root.everything()}
    numbers = dict.fromkeys(NAMED.values(), 0)
    for around in root.everything():
        for element in around.children if around.tag in AROUND else ():
            if element.tag in NAMED and not element.attributes.get("name"):
                kind = NAMED[element.tag]
                while f"{kind}{numbers[kind]}" in taken:
                    numbers[kind] += 1
                element.attributes["name"] = f"{kind}{numbers[kind]}"
                numbers[kind] += 1


def _flatten(hfield: Element, removed: Removed) -> None:
    """Make a height field flat, which does not change the motion, because it has no inertia."""
    if "file" in hfield.attributes:
        name = Path(hfield.attributes["file"]).stem
        hfield.attributes.setdefault("name", name)
        del hfield.attributes["file"]
        removed.add(hfield, "file")
        hfield.attributes |= {"nrow": "2", "ncol": "2"}
