"""Refuse MJCF files whose elements stand for more parts than an engine can make, before an engine reads them."""

from math import prod

from bodycheck.robots.elements import Element, quoted, refuse
from bodycheck.robots.named_files import local

#: The largest number of parts that an element may stand for.
MOST_PARTS = 10_000

#: The elements that stand for several parts, which their attribute `count` states along one or more directions.
REPEATING = {"replicate", "composite", "flexcomp"}


def check(root: Element) -> None:
    """Check the numbers of parts in an MJCF file. Raises `BadInput` with file, line and attribute."""
    left = [(root, 1)]
    while left:
        element, times = left.pop()
        if local(element.tag) in REPEATING and "count" in element.attributes:
            times *= _count(element)
            if times > MOST_PARTS:
                refuse(element, "count", f"stands for {times:.6g} parts; allowed: at most {MOST_PARTS:,}")
        left += ((child, times) for child in element.children)


def _count(element: Element) -> int:
    """Return the number of parts that an element stands for."""
    text = element.attributes["count"]
    try:
        numbers = [int(word) for word in text.split()]
    except ValueError:
        numbers = []
    if not numbers or min(numbers) < 1:
        refuse(element, "count", f"read {quoted(text)}; allowed: positive whole numbers")
    return prod(numbers)
