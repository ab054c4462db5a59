"""Put an MJCF file together from the files that it includes, and name its bodies and joints.

https://mujoco.readthedocs.io/en/stable/XMLreference.html. The content of an included file replaces the element that includes
it. Bodies and joints without names get names, because engines give them different names or none, so that results could not be
assigned to bodies and joints.
"""

from collections.abc import Callable, Iterator, Mapping
from typing import TypeVar

from bodycheck.robots.elements import MAX_ELEMENTS, Element, quoted, refuse
from bodycheck.robots.named_files import local

#: The elements that get names, with the beginnings of the names and the elements that contain them.
NAMED: Mapping[str, str] = {"body": "body", "joint": "joint", "freejoint": "joint"}
AROUND = {"worldbody", "body", "frame", "replicate"}

#: Most files that are included.
MAX_INCLUDES = 200

#: The place of a file: what finds the files that it names.
Place = TypeVar("Place")


def include(root: Element, home: Place, opened: Callable[[Element, Place], tuple[Place, Element]]) -> dict[Element, Place]:
    """Replace the `include` elements by the content of their files, and return the place of the file of each element.

    Parameters
    ----------
    root
        The root of the model.
    home
        The place of its file.
    opened
        Function that returns the place and the root of the file that an `include` element names, given this element and the
        place of its file.

    Raises
    ------
    BadInput
        A file is included twice, or the model becomes too large; and what `opened` raises.
    """
    origins: dict[Element, Place] = {}
    included: set[Place] = {home}
    left = [(root, home)]
    while left:
        element, origin = left.pop()
        origins[element] = origin
        if len(origins) > MAX_ELEMENTS:
            refuse(element, None, f"the model has more than {MAX_ELEMENTS} elements with those that it includes")
        children = []
        next_ones = [(child, origin) for child in reversed(element.children)]
        while next_ones:
            child, within = next_ones.pop()
            if local(child.tag) != "include":
                children.append((child, within))
                continue
            if len(included) > MAX_INCLUDES:
                refuse(child, "file", f"more than {MAX_INCLUDES} files are included")
            there, content = opened(child, within)
            if there in included:
                refuse(child, "file", f"{quoted(child.attributes.get('file', ''))} is included twice")
            included.add(there)
            next_ones += [(inner, there) for inner in reversed(content.children)]
        element.children = [child for child, _ in children]
        left += reversed(children)
    return origins


def name(root: Element) -> None:
    """Name the bodies and joints without a name.

    The only joint of a body gets the name of its body, if no other joint has that name. All others get their kind and the first
    number that makes their name unique.
    """
    taken = {element.attributes.get("name", "") for element in root.everything()}
    of_joints = {joint.attributes.get("name", "") for joint in root.everything() if NAMED.get(joint.tag) == "joint"}
    numbers = dict.fromkeys(NAMED.values(), 0)
    for around in root.everything():
        joints = [joint for joint in own(around) if NAMED.get(joint.tag) == "joint"] if around.tag == "body" else []
        of_body = around.attributes.get("name", "")
        if len(joints) == 1 and of_body and of_body not in of_joints and not joints[0].attributes.get("name"):
            joints[0].attributes["name"] = of_body
            of_joints.add(of_body)
        for element in around.children if around.tag in AROUND else ():
            if element.tag in NAMED and not element.attributes.get("name"):
                kind = NAMED[element.tag]
                while f"{kind}{numbers[kind]}" in taken:
                    numbers[kind] += 1
                element.attributes["name"] = f"{kind}{numbers[kind]}"
                numbers[kind] += 1


def tops_of(root: Element) -> list[Element]:
    """Return the bodies in the world that have mass or joints in them."""
    return [
        element
        for world in root.all("worldbody")
        for element in own(world)
        if element.tag == "body"
        and any(inner.tag in ("joint", "freejoint", "inertial", "geom") for inner in element.everything())
    ]


def own(body: Element) -> Iterator[Element]:
    """Yield the elements of a body, also those inside its frames, but not the elements of bodies inside it."""
    left = list(reversed(body.children))
    while left:
        element = left.pop()
        yield element
        if element.tag in ("frame", "replicate"):
            left += reversed(element.children)
