"""Put an MJCF file together for a case: with the files that it includes, names for all parts, and replicas written out."""

from functools import partial

from bodycheck.casefile.robots.mjcf import schema
from bodycheck.casefile.robots.mjcf.settings import Settings, attitude, settings
from bodycheck.casefile.robots.numbers import number, numbers
from bodycheck.casefile.robots.reading import Files
from bodycheck.casefile.robots.tables import turned
from bodycheck.errors import BadInput
from bodycheck.reference.exact.numbers import vector
from bodycheck.reference.exact.rotations import ORIGIN, plus
from bodycheck.robots import elements, mjcf_assembly
from bodycheck.robots.elements import MAX_DEPTH, MAX_ELEMENTS, Element, place, quoted, refuse
from bodycheck.robots.named_files import NotFound

#: The attributes of elements of bodies that hold names which replicas get anew.
NAMING = ("name",)


def assemble(root: Element, files: Files) -> None:
    """Change the elements of a file so that they are the whole model. Raises `BadInput` for what MuJoCo refuses.

    files: the files that it may include.
    """
    mjcf_assembly.include(root, root.file, partial(_opened, files))
    _limit_depth(root)
    schema.check(root)
    mjcf_assembly.name(root)
    rules, count = settings(root), sum(1 for _ in root.everything())
    for world in root.all("worldbody"):
        for element in reversed(list(world.everything())):  # replicas inside others are written out first
            for replica in [child for child in element.children if child.tag == "replicate"]:
                copies = _copies(replica, rules, MAX_ELEMENTS - count)
                count += sum(1 for copy in copies for _ in copy.everything())
                at = element.children.index(replica)
                element.children[at : at + 1] = copies


def _opened(files: Files, include: Element, near: str) -> tuple[str, Element]:
    """Return the path and the root element of the file that an <include> in the file `near` names."""
    name = include.attributes.get("file", "")
    if include.children:
        refuse(include, None, "has elements inside; allowed: none")
    try:
        path, text = files.text(name, near)
        return path, elements.parsed(text.encode("utf-8", "replace"), path)
    except NotFound as error:
        refuse(include, "file", f"{quoted(name)} {error}")
    except BadInput as error:
        raise BadInput(f"{place(include, 'file')}: {error}") from error


def _limit_depth(root: Element) -> None:
    """Raise `BadInput` if elements are nested too deep, as they may be after files have been included in others."""
    left = [(root, 1)]
    while left:
        element, depth = left.pop()
        if depth > MAX_DEPTH:
            refuse(element, None, f"elements are nested more than {MAX_DEPTH} deep")
        left += [(child, depth + 1) for child in element.children]


def _copies(replica: Element, rules: Settings, room: int) -> list[Element]:
    """Return the frames that a <replicate> stands for. room: the largest number of elements in them."""
    count, size = number(replica, "count"), sum(1 for _ in replica.everything())
    if count != int(count) or count < 0:
        refuse(replica, "count", f"read {quoted(replica.attributes['count'])}; allowed: a whole number")
    if count * size > room:
        refuse(replica, "count", f"the model has more than {MAX_ELEMENTS} elements with those that it stands for")
    angles = numbers(replica, "euler", (3,), (0.0, 0.0, 0.0))
    offset, position = vector(numbers(replica, "offset", (3,), (0.0, 0.0, 0.0))), ORIGIN
    separator, digits = replica.attributes.get("sep", ""), len(str(int(count)))
    copies = []
    for index in range(int(count)):
        attributes = {
            "pos": " ".join(repr(float(part)) for part in position),
            "euler": " ".join(repr(index * angle) for angle in angles),
        }
        if "childclass" in replica.attributes:
            attributes["childclass"] = replica.attributes["childclass"]
        frame = Element("frame", attributes, replica.file, replica.line)
        position = plus(position, turned(attitude(frame, rules), offset))
        suffix = f"{separator}{index:0{digits}}"
        copies.append(Element("frame", attributes, *(replica.file, replica.line), _renamed(replica.children, suffix)))
    return copies


def _renamed(children: list[Element], suffix: str) -> list[Element]:
    """Return copies of elements, with everything in them, whose names have a suffix."""
    copies = []
    for child in children:
        attributes = {key: value + suffix if key in NAMING else value for key, value in child.attributes.items()}
        copies.append(Element(child.tag, attributes, child.file, child.line, _renamed(child.children, suffix)))
    return copies
