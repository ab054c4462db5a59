"""Remove from the elements of a robot model what would make an engine open another file."""

from collections import Counter
from collections.abc import Callable, Collection

from bodycheck.robots.elements import Element, quoted

#: Attributes by which elements of any format name files and folders. Readers of engines compare some without regard to case.
PATHS = {
    "assetdir", "content_type", "file", "fileback", "filedown", "filefront", "fileleft", "filename", "fileright", "fileup",
    "folder", "href", "library", "meshdir", "path", "plugin", "src", "texture", "texturedir", "uri", "url",
}  # fmt: skip


def local(name: str) -> str:
    """Return the name of an element or attribute in small letters and without its prefix."""
    return name.rpartition(":")[2].lower()


class Removed:
    """Counts what has been removed, by a phrase for its kind."""

    def __init__(self) -> None:
        self.counts = Counter[str]()

    def add(self, element: Element, attribute: str | None = None) -> None:
        """Count an element, or an attribute of it."""
        tag = quoted(element.tag)[1:-1]
        self.counts[f"<{tag}>" if attribute is None else f"{quoted(attribute)[1:-1]} of <{tag}>"] += 1

    def phrases(self) -> tuple[str, ...]:
        """Return what has been removed, each kind once, with its number."""
        return tuple(f"{kind} ({count})" for kind, count in sorted(self.counts.items()))


def remove(root: Element, unwanted: Callable[[Element], bool], kept: Collection[Element], removed: Removed) -> None:
    """Remove elements, and the attributes `PATHS` of all others.

    Parameters
    ----------
    root
        The element in which they are.
    unwanted
        Whether an element is removed, with everything in it.
    kept
        Elements whose attributes are kept.
    removed
        Where it is counted.
    """
    for element in root.everything():
        for child in element.children:
            if unwanted(child):
                removed.add(child)
        element.children = [child for child in element.children if not unwanted(child)]
        if element in kept:
            continue
        for name in [name for name in element.attributes if local(name) in PATHS]:
            removed.add(element, name)
            del element.attributes[name]
