"""The tendons of an MJCF file: those that exert forces, and the limits of others, which act once they are reached."""

from collections.abc import Iterator

from bodycheck.casefile.robot_notes import TendonRange
from bodycheck.casefile.robots.mjcf.carriers import Tree
from bodycheck.casefile.robots.mjcf.equalities import joint_named
from bodycheck.casefile.robots.mjcf.features import idle
from bodycheck.casefile.robots.mjcf.settings import Defaults, word
from bodycheck.casefile.robots.numbers import number, numbers
from bodycheck.robots.elements import Element

#: Attributes by which a tendon exerts a force.
FORCES = ("stiffness", "damping", "frictionloss", "armature")

#: The noun for a tendon.
NOUN = ("tendon", "tendons")


def add_tendons(root: Element, read: Tree) -> list[TendonRange]:
    """Add the tendons of a file to its features, and return the limits of fixed ones that exert no forces.

    The length of a fixed tendon is a linear form of coordinates of joints. Limits of spatial tendons are not looked at.
    """
    ranges, defaults = [], Defaults(root, "tendon")
    for index, element in enumerate(each for section in root.all("tendon") for each in section.children):
        tendon = defaults.resolved(element, None)
        between = limits(tendon) if "limit" not in read.features.off else None
        if any(any(numbers(tendon, name, (1, 2, 3), (0.0,))) for name in FORCES):
            read.features.add(("tendons", True, "exert forces", NOUN), element)
        elif between is None:
            read.features.add(idle(*NOUN, "exert nothing by themselves"), element)
        elif element.tag == "fixed" and "tendons" not in read.features.ignore:
            read.features.add(("tendons", False, "act only at their limits", NOUN), element)
            name = element.attributes.get("name", str(index))
            ranges.append(TendonRange(f"tendon {name}", tuple(_terms(element, read)), *between))
        else:
            read.features.add(("tendons", False, "have limits, which are not looked at", NOUN), element)
    return ranges


def limits(tendon: Element) -> tuple[float, float] | None:
    """Return the limits of the length of a tendon, given with its default attributes; None if it is not limited."""
    limited = word(tendon, "limited", "auto", ("true", "false", "auto"))
    lower, upper = numbers(tendon, "range", (2,), (0.0, 0.0))
    return (lower, upper) if limited == "true" or (limited == "auto" and (lower or upper)) else None


def _terms(tendon: Element, read: Tree) -> Iterator[tuple[str, float]]:
    """Yield the joints of a fixed tendon by their names, each with its coefficient in the length."""
    for part in tendon.all("joint"):
        yield joint_named(part, "joint", read).name, number(part, "coef")
