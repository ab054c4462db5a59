"""The front page: engines by scenes, and what changed since the last date."""

from collections.abc import Iterator

from bodycheck.site import links
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.front import Front, Line, Shown
from bodycheck.site.render import File, page


def pages(catalogue: Catalogue) -> Iterator[File]:
    """Yield the front page."""
    front = Front(catalogue)
    best = [_best(line) for group in front.groups for line in group.lines]
    yield page(links.INDEX, "index.html.jinja", front=front, catalogue=catalogue, best=best)


def _best(line: Line) -> dict[int, list[str]]:
    """Return the cells of a line that are others for the best methods, by their places."""
    pairs = enumerate(zip(line.own, line.best, strict=True))
    return {place: _fields(best) for place, (own, best) in pairs if own != best}


def _fields(shown: Shown) -> list[str]:
    return [shown.text, shown.word, shown.mark, shown.style, shown.told, shown.address]
