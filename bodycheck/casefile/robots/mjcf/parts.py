"""The elements of a body of an MJCF file, with the poses of the frames and the default classes that apply to them."""

from collections.abc import Iterator
from dataclasses import dataclass

from bodycheck.casefile.robots.mjcf.settings import Defaults, Settings, attitude
from bodycheck.casefile.robots.numbers import numbers
from bodycheck.casefile.robots.tables import HERE, Pose
from bodycheck.reference.exact.numbers import vector
from bodycheck.robots.elements import Element

#: The elements of a body that take default attributes and are read.
WITH_DEFAULTS = ("geom", "joint", "site")


@dataclass(frozen=True, eq=False)
class Part:
    """An element of a body.

    Attributes
    ----------
    element
        The element, with the default attributes of its class.
    frame
        The pose in the body's frame of the <frame> around it.
    inherited
        The default class that bodies inherit there; None for the class of all others.
    """

    element: Element
    frame: Pose
    inherited: str | None


#: The default classes of a file, by the tags of elements.
Classes = dict[str, Defaults]


def classes_of(root: Element) -> Classes:
    """Return the default classes of a file for the elements of bodies."""
    return {tag: Defaults(root, tag) for tag in WITH_DEFAULTS}


def parts_of(body: Element, inherited: str | None, rules: Settings, of_file: Classes) -> list[Part]:
    """Return the elements of a body, also those inside its frames; the elements of bodies inside it are not among them.

    inherited: the default class of the body itself.
    """
    return list(_parts(body, inherited, rules, of_file))


def _parts(body: Element, inherited: str | None, rules: Settings, of_file: Classes) -> Iterator[Part]:
    left = [(child, HERE, inherited) for child in reversed(body.children)]
    while left:
        element, frame, name = left.pop()
        if element.tag == "frame":
            inner = frame.then(pose_of(element, rules))
            name = element.attributes.get("childclass", name)
            left += [(child, inner, name) for child in reversed(element.children)]
            continue
        resolved = of_file[element.tag].resolved(element, name) if element.tag in of_file else element
        yield Part(resolved, frame, name)


def pose_of(element: Element, rules: Settings) -> Pose:
    """Return the pose of an element in the frame around it."""
    return Pose(vector(numbers(element, "pos", (3,), (0.0, 0.0, 0.0))), attitude(element, rules))
