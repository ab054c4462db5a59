"""The order of the bodies of a mechanism from the world on."""

from collections.abc import Iterator

from bodycheck.reference.mechanisms.mechanism import WORLD, Mechanism


def depth_first(mechanism: Mechanism) -> Iterator[int]:
    """The places of all bodies, each followed by all that hang on it, children in the order of the file."""
    children: dict[int, list[int]] = {}
    for place, joint in enumerate(mechanism.joint_of):
        children.setdefault(WORLD if joint is None else joint.parent, []).append(place)
    waiting = children.get(WORLD, [])[::-1]
    while waiting:
        yield (place := waiting.pop())
        waiting += children.get(place, [])[::-1]
